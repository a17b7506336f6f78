//! Plants that their own slope hides.
//!
//! P15 drops triangles that face away. A plant just behind a crest may still look over it, so a
//! triangle is dropped only where it lies so deep within ground that faces away that the line
//! from the eye to the tip of its longest plant must enter that ground.
//!
//! Where the eye is `g` below the plane of some ground whose slopes differ from the plane's by at
//! most ρ and whose heights by at most w, the gap between that line and the ground shrinks towards
//! the eye by at least f/D per metre, f = g − w − ρD, D being the largest horizontal distance. A
//! tip `h` above the ground is hidden if the ground goes on for hD/f towards the eye.

use super::geometry::Triangle;

/// What a triangle that may face away is judged by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing {
    /// How far the eye lies below the triangle's plane, in metres straight up.
    pub(super) eye_below_m: f32,
    /// Largest horizontal distance of a corner from the eye, in metres.
    pub(super) farthest_m: f32,
    /// Steepest rise of the plane, in metres per metre.
    pub(super) steepness: f32,
    /// How far the ground may lie off the plane, in metres.
    pub(super) half_m: f32,
    /// How far slopes of the ground may differ from the plane's.
    pub(super) slope_spread: f32,
}

/// The part of a triangle that hides its plants.
#[derive(Clone, Copy, Debug)]
pub(super) struct Core {
    /// Lines along the sides, moved inwards: a point lies within where all are at least 0.
    lines: [[f64; 3]; 3],
}

impl Core {
    /// The hidden part of a triangle whose corners count units of `unit_m`, for plants that reach
    /// `plant_m` from their roots; `None` if there is none.
    pub(super) fn of(
        triangle: &Triangle,
        unit_m: f64,
        facing: &Facing,
        plant_m: f32,
    ) -> Option<Self> {
        let slack_m = facing.half_m + facing.slope_spread * facing.farthest_m;
        let deep_m = facing.eye_below_m - slack_m;
        if deep_m <= 0.0 {
            return None;
        }
        // A blade that leans down the slope has its tip higher over the ground.
        let tip_m = plant_m * (1.0 + facing.steepness + facing.slope_spread);
        let inset_m = f64::from(tip_m * facing.farthest_m / deep_m + plant_m);
        let [apex, first, second] = triangle.corners().map(|p| p.map(f64::from));
        // Radius of the circle within a right-isosceles triangle, over its leg: 1 − 1/√2.
        let leg_m = (first[0] - apex[0]).hypot(first[1] - apex[1]) * unit_m;
        if inset_m >= 0.292 * leg_m {
            return None;
        }
        let inset = inset_m / unit_m;
        let line = |a: [f64; 2], b: [f64; 2]| {
            let (dx, dz) = (b[0] - a[0], b[1] - a[1]);
            let length = dx.hypot(dz);
            // Corners run counter-clockwise from above, where z points down the page: within is
            // to the side of (dz, −dx).
            let normal = [dz / length, -dx / length];
            let offset = -(normal[0] * a[0] + normal[1] * a[1]) - inset;
            [normal[0], normal[1], offset]
        };
        Some(Self {
            lines: [line(apex, first), line(first, second), line(second, apex)],
        })
    }

    /// Whether all of a triangle lies within.
    pub(super) fn holds(&self, triangle: &Triangle) -> bool {
        triangle.corners().iter().all(|&[x, z]| {
            let (x, z) = (f64::from(x), f64::from(z));
            self.lines.iter().all(|[a, b, c]| a * x + b * z + c >= 0.0)
        })
    }
}
