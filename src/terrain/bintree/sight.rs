//! Boxes around triangles, relative to the eye: whether they are in the picture, and how near.

use crate::base::widened;

use super::geometry::Triangle;
use super::lattice::Lattice;
use super::viewpoint::Viewpoint;

/// Which sides of the picture a box crosses, a bit each; none if it lies wholly within.
pub(super) type Crossed = u8;
/// All four sides: nothing is known yet.
pub(super) const ALL_SIDES: Crossed = 0b1111;

/// A viewpoint over one terrain.
#[derive(Clone, Debug)]
pub(super) struct Sight<'a> {
    lattice: &'a Lattice,
    corner_from_eye: [f64; 2],
    eye_y: f64,
    spacing_m: f64,
    /// Inward normals of the picture's sides along the world's axes.
    sides: [[f32; 3]; 4],
    /// Plants reach this far from the ground, in metres.
    canopy_m: f32,
}

/// A box along the world's axes, relative to the eye.
#[derive(Clone, Copy, Debug)]
pub(super) struct EyeBox {
    low: [f32; 3],
    high: [f32; 3],
}

impl<'a> Sight<'a> {
    pub(super) fn new(lattice: &'a Lattice, viewpoint: &Viewpoint, canopy_m: f32) -> Self {
        let [eye_x, eye_y, eye_z] = viewpoint.eye_in_world.to_f64();
        let [corner_x, corner_z] = lattice.ground.corner_in_world();
        Self {
            lattice,
            corner_from_eye: [corner_x - eye_x, corner_z - eye_z],
            eye_y,
            spacing_m: f64::from(lattice.ground.spacing_m),
            sides: viewpoint.sides_in_world().map(|n| n.to_f32()),
            canopy_m,
        }
    }

    /// The box around a triangle's wedgie: all ground that any splitting below can show.
    pub(super) fn bounds(&self, triangle: &Triangle, half_m: f32) -> EyeBox {
        let mut heights = [f32::INFINITY, f32::NEG_INFINITY];
        for corner in triangle.corners() {
            let h = self.lattice.height_m(corner);
            heights = widened(heights, [h, h]);
        }
        let [low, high] = triangle.bounds().map(|p| self.lattice.on_terrain(p));
        let along = |n: i32, axis: usize| {
            (self.corner_from_eye[axis] + f64::from(n) * self.spacing_m) as f32
        };
        let up = |h: f32| (f64::from(h) - self.eye_y) as f32;
        EyeBox {
            low: [along(low[0], 0), up(heights[0] - half_m), along(low[1], 1)],
            high: [
                along(high[0], 0),
                up(heights[1] + half_m),
                along(high[1], 1),
            ],
        }
    }

    /// Horizontal distance of a triangle's nearest point from the eye at most, in metres: without
    /// a look at the heights.
    pub(super) fn level_distance_m(&self, triangle: &Triangle) -> f32 {
        let [low, high] = triangle.bounds().map(|p| self.lattice.on_terrain(p));
        let away = [0, 1].map(|axis| {
            let along = |n: i32| self.corner_from_eye[axis] + f64::from(n) * self.spacing_m;
            along(low[axis]).max(-along(high[axis])).max(0.0) as f32
        });
        (away[0] * away[0] + away[1] * away[1]).sqrt()
    }

    /// Which of the sides in `open` the box with its plants crosses; `None` if it lies wholly
    /// beyond one of them. What lies within a side need not be asked again for parts of the box.
    pub(super) fn crossed(&self, bounds: &EyeBox, open: Crossed) -> Option<Crossed> {
        let mut crossed = 0;
        for (bit, normal) in self.sides.iter().enumerate() {
            if open & (1 << bit) == 0 {
                continue;
            }
            let (mut nearest, mut farthest) = (-self.canopy_m, self.canopy_m);
            for (axis, &n) in normal.iter().enumerate() {
                let (a, b) = (n * bounds.low[axis], n * bounds.high[axis]);
                nearest += a.min(b);
                farthest += a.max(b);
            }
            if farthest < 0.0 {
                return None;
            }
            if nearest < 0.0 {
                crossed |= 1 << bit;
            }
        }
        Some(crossed)
    }
}

impl EyeBox {
    /// Distance of its nearest point from the eye, in metres.
    pub(super) fn distance_m(&self) -> f32 {
        let square = |axis: usize| {
            let away = self.low[axis].max(-self.high[axis]).max(0.0);
            away * away
        };
        (square(0) + square(1) + square(2)).sqrt()
    }
}
