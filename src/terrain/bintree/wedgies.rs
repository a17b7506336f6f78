//! Nested bounds of error: how far the ground may lie above or below a triangle.
//!
//! A *wedgie* (Duchaineau et al. 1997) is a triangle made thick enough to hold every surface that
//! any splitting below it can give. Its half thickness is kept per diamond, the larger of its two
//! triangles': w(T) = |h(m) − mean of the base's ends| + max over both halves. A triangle that
//! reaches over the terrain's edge is drawn with its corners moved to the edge, where that sum says
//! nothing; its bound is the range of the heights below it.
//!
//! Beside it is kept how far the slopes below a triangle may differ from its own, for back faces.

use rayon::prelude::*;

use crate::base::most;

use super::geometry::{Diamond, Point, Triangle};
use super::lattice::{Lattice, Side};

/// Steps of a stored slope difference: 16 bits hold up to 16, steeper than 86°.
const SLOPE_STEPS: f32 = 4096.0;

/// The bounds of all diamonds of a terrain.
#[derive(Clone, Debug)]
pub(super) struct Wedgies {
    /// Half thickness per lattice point, in metres.
    half_m: Vec<f32>,
    /// Largest difference of slopes, in steps rounded up; `u16::MAX` where it is not known.
    slope: Vec<u16>,
}

#[derive(Clone, Copy)]
struct Bound {
    half_m: f32,
    slope: u16,
}

impl Wedgies {
    pub(super) fn new(lattice: &Lattice) -> Self {
        let count = lattice.points();
        let mut wedgies = Self {
            half_m: vec![0.0; count],
            slope: vec![0; count],
        };
        let mut half = 1;
        while half < lattice.root_side {
            // A square's quarters are split at the middles of its sides, so sides come first.
            for is_square in [false, true] {
                wedgies.fill(lattice, half, is_square);
            }
            half *= 2;
        }
        wedgies
    }

    /// Computes all diamonds of one kind and size from the next smaller ones.
    fn fill(&mut self, lattice: &Lattice, half: i32, is_square: bool) {
        let [width, depth] = lattice.extent;
        let rows: Vec<Vec<(usize, Bound)>> = (0..=depth / half)
            .into_par_iter()
            .map(|step| {
                let z = step * half;
                let first = match (is_square, step & 1 == 1) {
                    (true, true) | (false, false) => half,
                    (false, true) => 0,
                    (true, false) => return Vec::new(),
                };
                (first..=width)
                    .step_by(2 * half as usize)
                    .filter_map(|x| {
                        let diamond = Diamond::at([x, z], lattice.root_side)?;
                        Some((lattice.index([x, z]), self.bound(lattice, &diamond)))
                    })
                    .collect()
            })
            .collect();
        for (index, bound) in rows.into_iter().flatten() {
            self.half_m[index] = bound.half_m;
            self.slope[index] = bound.slope;
        }
    }

    fn bound(&self, lattice: &Lattice, diamond: &Diamond) -> Bound {
        let mut worst = Bound {
            half_m: 0.0,
            slope: 0,
        };
        for triangle in diamond.triangles() {
            let found = match lattice.side(&triangle) {
                Side::Outside => continue,
                Side::Inside => self.inside(lattice, diamond.centre, &triangle),
                Side::Straddling => Bound {
                    half_m: (lattice.range_m(&triangle)).max(self.of_halves(
                        lattice,
                        diamond.centre,
                        &triangle,
                    )),
                    slope: u16::MAX,
                },
            };
            worst.half_m = most(worst.half_m, found.half_m);
            worst.slope = worst.slope.max(found.slope);
        }
        worst
    }

    fn inside(&self, lattice: &Lattice, middle: Point, triangle: &Triangle) -> Bound {
        let [a, b] = triangle.base.map(|p| f64::from(lattice.height_m(p)));
        let off_m = (f64::from(lattice.height_m(middle)) - 0.5 * (a + b)).abs();
        let below_m = self.of_halves(lattice, middle, triangle);
        let sum_m = off_m + f64::from(below_m);
        let half_m = if sum_m > 0.0 {
            (sum_m as f32).next_up()
        } else {
            0.0
        };
        let own = lattice.slope(triangle);
        let mut slope = 0;
        for half in triangle.halves(middle) {
            let [dx, dz] = [0, 1].map(|i| lattice.slope(&half)[i] - own[i]);
            let steps = ((dx * dx + dz * dz).sqrt() * SLOPE_STEPS).ceil();
            let below = half
                .split_point()
                .map_or(0, |p| self.slope[lattice.index(p)]);
            // The cast of a float stops at u16::MAX, which stands for any larger number.
            slope = slope.max(below.saturating_add(steps as u16));
        }
        Bound { half_m, slope }
    }

    fn of_halves(&self, lattice: &Lattice, middle: Point, triangle: &Triangle) -> f32 {
        let halves = triangle.halves(middle);
        let points = halves.iter().filter_map(Triangle::split_point);
        points.fold(0.0, |worst, p| most(worst, self.half_m[lattice.index(p)]))
    }

    /// Half thickness of the diamond that a point splits, in metres.
    pub(super) fn half_m(&self, index: usize) -> f32 {
        self.half_m[index]
    }

    /// Largest difference between the slope of a diamond's triangles and of those below it;
    /// `None` where nothing is known.
    pub(super) fn slope_spread(&self, index: usize) -> Option<f32> {
        let steps = self.slope[index];
        (steps < u16::MAX).then(|| f32::from(steps) / SLOPE_STEPS)
    }

    pub(super) fn bytes(&self) -> usize {
        self.half_m.capacity() * size_of::<f32>() + self.slope.capacity() * size_of::<u16>()
    }
}
