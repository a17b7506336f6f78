//! The height samples as the bintree sees them: a lattice of whole root squares, of which the
//! terrain is the part next to the field's corner.

use std::sync::Arc;

use crate::base::widened;
use crate::terrain::HeightGrid;

use super::geometry::{Point, Triangle};

/// Most root squares along the terrain's longer side: what is done at every root then does not
/// grow with the terrain.
const MOST_ROOTS: u32 = 8;
/// Smallest side of a root square; a tile of plants is at most that wide.
const LEAST_ROOT: u32 = 4;

/// A lattice and the terrain in it.
#[derive(Clone, Debug)]
pub(super) struct Lattice {
    pub(super) ground: Arc<HeightGrid>,
    /// Side of a root square, in samples: a power of two.
    pub(super) root_side: i32,
    /// Last column and row of the lattice.
    pub(super) extent: Point,
    /// Last column and row of the terrain.
    pub(super) squares: Point,
}

/// How a triangle lies to the terrain's edge.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Side {
    Inside,
    /// Reaches over the edge; it is drawn with its corners moved to the edge.
    Straddling,
    /// Nothing of it is terrain.
    Outside,
}

impl Lattice {
    pub(super) fn new(ground: Arc<HeightGrid>) -> Self {
        let [columns, rows] = ground.squares();
        let by_length = columns.max(rows).div_ceil(MOST_ROOTS).next_power_of_two();
        // A long strip has more roots rather than mostly empty ones.
        let by_width = columns.min(rows).next_power_of_two();
        let root_side = by_length.min(by_width).max(LEAST_ROOT);
        let squares = [columns, rows].map(|n| n as i32);
        Self {
            root_side: root_side as i32,
            extent: [columns, rows].map(|n| (n.div_ceil(root_side) * root_side) as i32),
            squares,
            ground,
        }
    }

    /// Number of lattice points.
    pub(super) fn points(&self) -> usize {
        (self.extent[0] as usize + 1) * (self.extent[1] as usize + 1)
    }

    /// Rank of a lattice point.
    pub(super) fn index(&self, [x, z]: Point) -> usize {
        z as usize * (self.extent[0] as usize + 1) + x as usize
    }

    /// The point of a rank.
    pub(super) fn point(&self, index: u32) -> Point {
        let width = self.extent[0] as u32 + 1;
        [(index % width) as i32, (index / width) as i32]
    }

    pub(super) fn holds(&self, [x, z]: Point) -> bool {
        (0..=self.extent[0]).contains(&x) && (0..=self.extent[1]).contains(&z)
    }

    /// The point moved to the terrain's edge where it lies beyond.
    pub(super) fn on_terrain(&self, [x, z]: Point) -> Point {
        [x.min(self.squares[0]), z.min(self.squares[1])]
    }

    pub(super) fn height_m(&self, point: Point) -> f32 {
        self.ground.sample(point[0] as u32, point[1] as u32)
    }

    pub(super) fn side(&self, triangle: &Triangle) -> Side {
        let [low, high] = triangle.bounds();
        if (0..2).any(|i| low[i] < 0 || low[i] >= self.squares[i]) {
            Side::Outside
        } else if (0..2).all(|i| high[i] <= self.squares[i]) {
            Side::Inside
        } else {
            Side::Straddling
        }
    }

    /// Difference of the largest and smallest height in the box around a triangle.
    pub(super) fn range_m(&self, triangle: &Triangle) -> f32 {
        let [low, high] = triangle.bounds().map(|p| self.on_terrain(p));
        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
        for z in low[1]..=high[1] {
            for x in low[0]..=high[0] {
                let h = self.height_m([x, z]);
                range = widened(range, [h, h]);
            }
        }
        (range[1] - range[0]).next_up()
    }

    /// Rise along x and z of a triangle between samples, in metres per metre.
    pub(super) fn slope(&self, triangle: &Triangle) -> [f32; 2] {
        let apex_m = self.height_m(triangle.apex);
        let [ax, az] = triangle.apex;
        let leg = |p: Point| {
            let [dx, dz] = [p[0] - ax, p[1] - az].map(|n| n as f32);
            let per_metre = 1.0 / ((dx * dx + dz * dz) * self.ground.spacing_m);
            [dx, dz].map(|d| d * (self.height_m(p) - apex_m) * per_metre)
        };
        // The legs are square to each other, so their slopes add up.
        let [one, other] = triangle.base.map(leg);
        [one[0] + other[0], one[1] + other[1]]
    }

    /// The two triangles of every root square.
    pub(super) fn roots(&self) -> impl Iterator<Item = [Triangle; 2]> + '_ {
        let half = self.root_side / 2;
        let [columns, rows] = self.extent.map(|n| n / self.root_side);
        (0..rows).flat_map(move |row| {
            (0..columns).filter_map(move |column| {
                let centre = [column, row].map(|n| n * self.root_side + half);
                let diamond = super::geometry::Diamond::at(centre, self.root_side)?;
                Some(diamond.triangles())
            })
        })
    }
}
