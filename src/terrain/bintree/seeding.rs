//! The seeding traversal: which seeding triangles a picture may show (P15 section 3.1).
//!
//! It goes from the roots down to one level, chosen by the length of its cells, whatever of the
//! ground is drawn. A corner is turned into eye axes once, when the split that makes it is done:
//! the middle of the base, moved up to the ground. Below the samples' spacing the middle lies on
//! the ground already. So a seeding triangle's corners lie on the ground, and neither they nor its
//! number depend on the eye.
//!
//! Deviations: a large triangle may hold near ground far from all its corners, so above the
//! seeding level 'too far' is asked of all it holds, and only at that level of its closest corner;
//! what faces away is dropped only where it hides its plants (`hidden.rs`).

use crate::base::{Vec3, least, most};

use super::Bintree;
use super::geometry::{Point, Triangle};
use super::hidden::{Core, Facing};
use super::viewpoint::Viewpoint;

/// What a traversal looks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seeding {
    /// Halvings of the sample spacing down to the cells, of two triangles each; negative for
    /// cells of several samples.
    pub halvings: i32,
    /// Triangles whose closest corner is farther from the eye are left out, in metres.
    pub reach_m: f32,
    /// Plants reach this far from their roots, in metres.
    pub plant_m: f32,
    /// Leave out what hides behind its own slope.
    pub drops_hidden: bool,
}

/// A triangle of the seeding level.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub struct SeedTriangle {
    /// Its cell, counted from the field's corner along x and z.
    pub cell: [u32; 2],
    /// 0 if its right angle is at the cell's smaller z, 1 if at the larger.
    pub half: u32,
}

/// What a traversal did.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct SeedCounts {
    /// Triangles that were looked at.
    pub visited: u64,
    pub found: u64,
    /// Dropped, with all below them.
    pub out_of_picture: u64,
    pub too_far: u64,
    pub hidden: u64,
}

/// Rounding of eye coordinates some kilometres away, in metres, with room to spare.
const SLACK_M: f32 = 0.01;
/// No point of a triangle is farther from its closest corner than 1/√3 of the longest side.
const TO_CORNER: f32 = 0.578;

#[derive(Clone, Copy)]
struct Corner {
    at: Point,
    /// Along the eye's axes, in metres.
    in_eye: [f32; 3],
    height_m: f32,
    distance2_m2: f32,
}

/// What is known of a triangle from those it is a part of.
#[derive(Clone, Copy)]
struct Known<'c> {
    /// Sides of the picture it may cross.
    open: u8,
    /// All of it is within reach.
    is_near: bool,
    core: Option<&'c Core>,
}

struct Traversal<'a, F> {
    tree: &'a Bintree,
    seeding: &'a Seeding,
    /// Seeding cells per sample spacing, or 1 if cells are larger.
    unit: i32,
    unit_m: f64,
    /// Splits down to the samples, and to the seeding level.
    sample_depth: u32,
    last_depth: u32,
    last_leg: i32,
    sides: [[f32; 3]; 4],
    /// The world's up along the eye's axes.
    up: [f32; 3],
    eye_y: f64,
    counts: SeedCounts,
    found: F,
}

impl Bintree {
    /// Calls `found` with every triangle of the seeding level that may be in the picture, each
    /// once.
    pub fn seed(
        &self,
        viewpoint: &Viewpoint,
        seeding: &Seeding,
        found: impl FnMut(SeedTriangle),
    ) -> SeedCounts {
        let root_halvings = self.lattice.root_side.ilog2();
        // Cells larger than a root square are not asked for: a tile is at most four samples wide.
        let halvings = seeding.halvings.max(-(root_halvings as i32));
        let unit = 1 << halvings.max(0);
        let mut traversal = Traversal {
            tree: self,
            seeding,
            unit,
            unit_m: f64::from(self.ground().spacing_m) / f64::from(unit),
            sample_depth: 2 * root_halvings,
            last_depth: 2 * (root_halvings as i32 + halvings) as u32,
            last_leg: 1 << (-halvings).max(0),
            sides: viewpoint.sides_in_eye(),
            up: viewpoint.turned(Vec3::UP),
            eye_y: viewpoint.eye_in_world.y,
            counts: SeedCounts::default(),
            found,
        };
        let known = Known {
            open: 0b1111,
            is_near: false,
            core: None,
        };
        for root in self.lattice.roots().flatten() {
            let [a, b, c] = root.corners().map(|p| traversal.root_corner(viewpoint, p));
            traversal.visit([&a, &b, &c], 0, known);
        }
        traversal.counts
    }
}

impl<F: FnMut(SeedTriangle)> Traversal<'_, F> {
    fn root_corner(&self, viewpoint: &Viewpoint, sample: Point) -> Corner {
        let [corner_x, corner_z] = self.tree.ground().corner_in_world();
        let spacing_m = f64::from(self.tree.ground().spacing_m);
        let height_m = self.tree.lattice.height_m(sample);
        let in_world = Vec3::new(
            corner_x + f64::from(sample[0]) * spacing_m,
            f64::from(height_m),
            corner_z + f64::from(sample[1]) * spacing_m,
        );
        Corner::new(
            sample.map(|n| n * self.unit),
            viewpoint.turned(in_world - viewpoint.eye_in_world),
            height_m,
        )
    }

    fn visit(&mut self, corners: [&Corner; 3], depth: u32, mut known: Known<'_>) {
        let triangle = Triangle {
            apex: corners[0].at,
            base: [corners[1].at, corners[2].at],
        };
        let [low, _] = triangle.bounds();
        if (0..2).any(|i| low[i] >= self.tree.lattice.squares[i] * self.unit) {
            return;
        }
        self.counts.visited += 1;
        let sample = (depth < self.sample_depth)
            .then(|| triangle.split_point())
            .flatten()
            .map(|p| p.map(|n| n / self.unit));
        let index = sample.map(|p| self.tree.lattice.index(p));
        let half_m = index.map_or(0.0, |i| self.tree.wedgies.half_m(i));

        match self.crossed(&corners, half_m, known.open) {
            Some(open) => known.open = open,
            None => {
                self.counts.out_of_picture += 1;
                return;
            }
        }
        if !known.is_near {
            match self.is_near(&corners, &triangle, half_m, depth) {
                Some(is_near) => known.is_near = is_near,
                None => {
                    self.counts.too_far += 1;
                    return;
                }
            }
        }
        let own_core =
            if self.seeding.drops_hidden && known.core.is_none() && depth <= self.sample_depth {
                let spread = index.map_or(Some(0.0), |i| self.tree.wedgies.slope_spread(i));
                spread.and_then(|spread| self.core(&corners, &triangle, half_m, spread))
            } else {
                None
            };
        if known.core.is_some_and(|core| core.holds(&triangle)) {
            self.counts.hidden += 1;
            return;
        }
        let known = Known {
            core: known.core.or(own_core.as_ref()),
            ..known
        };

        if depth == self.last_depth {
            self.report(&triangle);
        } else if depth >= self.sample_depth
            && known.open == 0
            && known.is_near
            && known.core.is_none()
        {
            self.report_all(&triangle);
        } else {
            let middle = self.middle(corners[1], corners[2], sample);
            self.visit([&middle, corners[0], corners[1]], depth + 1, known);
            self.visit([&middle, corners[2], corners[0]], depth + 1, known);
        }
    }

    /// The corner a split adds: the middle of the base, on the ground.
    fn middle(&self, a: &Corner, b: &Corner, sample: Option<Point>) -> Corner {
        let at = [0, 1].map(|i| (a.at[i] + b.at[i]) / 2);
        let mut in_eye = [0, 1, 2].map(|i| 0.5 * (a.in_eye[i] + b.in_eye[i]));
        let mut height_m = 0.5 * (a.height_m + b.height_m);
        if let Some(sample) = sample {
            let rise_m = self.tree.lattice.height_m(sample) - height_m;
            in_eye = [0, 1, 2].map(|i| in_eye[i] + self.up[i] * rise_m);
            height_m += rise_m;
        }
        Corner::new(at, in_eye, height_m)
    }

    /// Sides of the picture, of those in `open`, that the ground and plants of a triangle may
    /// cross; `None` if all of them lie beyond one.
    fn crossed(&self, corners: &[&Corner; 3], half_m: f32, open: u8) -> Option<u8> {
        let mut crossed = 0;
        for (bit, &[x, y, z]) in self.sides.iter().enumerate() {
            if open & (1 << bit) == 0 {
                continue;
            }
            let along = |c: &Corner| x * c.in_eye[0] + y * c.in_eye[1] + z * c.in_eye[2];
            let [a, b, c] = corners.map(along);
            let upright = x * self.up[0] + y * self.up[1] + z * self.up[2];
            let margin_m = half_m * upright.abs() + self.seeding.plant_m + SLACK_M;
            if a.max(b).max(c) < -margin_m {
                return None;
            }
            if a.min(b).min(c) < margin_m {
                crossed |= 1 << bit;
            }
        }
        Some(crossed)
    }

    /// Whether all of a triangle is within reach; `None` if nothing is.
    fn is_near(
        &self,
        corners: &[&Corner; 3],
        triangle: &Triangle,
        half_m: f32,
        depth: u32,
    ) -> Option<bool> {
        let squares = corners.map(|c| c.distance2_m2);
        let closest2 = squares.iter().fold(f32::INFINITY, |a, &b| least(a, b));
        let farthest2 = squares.iter().fold(0.0_f32, |a, &b| most(a, b));
        let reach_m = self.seeding.reach_m;
        let mut beyond_m = reach_m;
        if depth < self.last_depth {
            let heights = corners.map(|c| c.height_m);
            let [low, high] = [
                heights.iter().fold(f32::INFINITY, |a, &b| least(a, b)),
                heights.iter().fold(f32::NEG_INFINITY, |a, &b| most(a, b)),
            ];
            let [a, b] = triangle.base;
            let base_m = [0, 1].map(|i| (b[i] - a[i]) as f32 * self.unit_m as f32);
            let longest2 =
                base_m[0] * base_m[0] + base_m[1] * base_m[1] + (high - low) * (high - low);
            beyond_m += TO_CORNER * longest2.sqrt() + half_m + SLACK_M;
        }
        if closest2 > beyond_m * beyond_m {
            return None;
        }
        let within_m = (reach_m - half_m - SLACK_M).max(0.0);
        Some(farthest2 <= within_m * within_m)
    }

    /// The part of a triangle whose plants it hides, if the eye is below its plane.
    fn core(
        &self,
        corners: &[&Corner; 3],
        triangle: &Triangle,
        half_m: f32,
        slope_spread: f32,
    ) -> Option<Core> {
        let [a, b, c] = corners.map(|c| Vec3::of_f32(c.in_eye));
        let up = Vec3::<f32>::of_f32(self.up);
        // The eye's axes are left-handed, which turns the order of a product round.
        let normal = (c - a).cross(b - a);
        let upright = normal.dot(up);
        let eye_below_m = normal.dot(a) / upright;
        // Nothing between samples is upright; a plane that is says nothing.
        if upright.is_nan() || upright <= 0.0 || eye_below_m <= half_m {
            return None;
        }
        let farthest2 = corners.iter().fold(0.0_f32, |farthest2, c| {
            let above_m = (f64::from(c.height_m) - self.eye_y) as f32;
            most(farthest2, c.distance2_m2 - above_m * above_m)
        });
        let steepness = (normal.length_squared() / (upright * upright) - 1.0)
            .max(0.0)
            .sqrt();
        let facing = Facing {
            eye_below_m,
            farthest_m: farthest2.max(0.0).sqrt() + SLACK_M,
            steepness,
            half_m: half_m + SLACK_M,
            slope_spread,
        };
        Core::of(triangle, self.unit_m, &facing, self.seeding.plant_m)
    }

    fn report(&mut self, triangle: &Triangle) {
        let [low, _] = triangle.bounds();
        self.counts.found += 1;
        (self.found)(SeedTriangle {
            cell: low.map(|n| (n / self.last_leg) as u32),
            half: u32::from(triangle.apex[1] > low[1]),
        });
    }

    /// Reports everything below a triangle of which nothing is to be asked any more.
    fn report_all(&mut self, triangle: &Triangle) {
        let [apex, [x, _], [_, z]] = [triangle.apex, triangle.base[0], triangle.base[1]];
        let [other_z, other_x] = [triangle.base[0][1], triangle.base[1][0]];
        // One leg runs along x and the other along z, unless the base does.
        let [dx, dz] = if other_z == apex[1] && other_x == apex[0] {
            [x - apex[0], z - apex[1]]
        } else if x == apex[0] && z == apex[1] {
            [other_x - apex[0], other_z - apex[1]]
        } else {
            if let Some(middle) = triangle.split_point() {
                for half in triangle.halves(middle) {
                    self.report_all(&half);
                }
            }
            return;
        };
        let half = u32::from(dz < 0);
        let count = dx.abs();
        // The first cell at the right angle, and the way from there.
        let cell = |from: i32, step: i32, n: i32| (from + step.min(0) + step * n) as u32;
        for row in 0..count {
            let z = cell(apex[1], dz.signum(), row);
            for column in 0..count - row {
                let cell = [cell(apex[0], dx.signum(), column), z];
                (self.found)(SeedTriangle { cell, half });
                if column + 1 < count - row {
                    let half = 1 - half;
                    (self.found)(SeedTriangle { cell, half });
                }
            }
        }
        self.counts.found += (count * count) as u64;
    }
}

impl Corner {
    fn new(at: Point, in_eye: [f32; 3], height_m: f32) -> Self {
        let [x, y, z] = in_eye;
        Self {
            at,
            in_eye,
            height_m,
            distance2_m2: x * x + y * y + z * z,
        }
    }
}

impl SeedTriangle {
    /// Its number on a terrain with this many cells along x.
    pub fn id(&self, columns: u32) -> u32 {
        ((self.cell[1] * columns + self.cell[0]) << 1) | self.half
    }
}
