//! How much a diamond wants to be split: its error in the picture.

use std::collections::HashSet;

use super::geometry::Diamond;
use super::lattice::{Lattice, Side};
use super::sight::{ALL_SIDES, Sight};
use super::viewpoint::Viewpoint;
use super::wedgies::Wedgies;

/// What the drawn mesh is held to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshDetail {
    /// Error that need not be mended, in pixels: metres of height over metres of distance, as an
    /// angle, over that of a pixel in the middle of the picture.
    pub error_px: f32,
    /// Most triangles of the whole mesh, in view or not.
    pub budget: usize,
    /// What is in view within this distance of the eye keeps the samples' full resolution, so
    /// that roots of drawn plants lie on the drawn ground.
    pub held_m: f32,
    /// Plants reach this far from the ground, in metres.
    pub canopy_m: f32,
}

/// Bounds up to this count as full resolution, in metres: a fiftieth of a blade's width.
pub const HELD_ERROR_M: f32 = 1e-4;
/// Least distance to which errors are projected, in metres.
const NEAR_M: f32 = 0.1;
/// Lifts a held diamond above all that are judged by pixels, which have below 10¹⁰ of them: 10⁴ m
/// at 0.1 m, over 10⁻⁵ rad.
const HELD: f32 = 1e18;
/// Least error a held diamond counts with, in pixels.
const LEAST_HELD_PX: f32 = 1e-7;

/// Tells the urgency of diamonds from one viewpoint.
///
/// It never grows towards smaller diamonds: a quarter's wedgie and its box lie in those of the
/// half it is a part of. So a mesh in which every leaf is below a threshold is the smallest one.
pub(super) struct Judge<'a> {
    lattice: &'a Lattice,
    wedgies: &'a Wedgies,
    sight: Sight<'a>,
    pixel_rad: f32,
    idle_px: f32,
    held_m: f32,
    pins: &'a HashSet<u32>,
}

impl<'a> Judge<'a> {
    pub(super) fn new(
        (lattice, wedgies): (&'a Lattice, &'a Wedgies),
        viewpoint: &Viewpoint,
        detail: &MeshDetail,
        pins: &'a HashSet<u32>,
    ) -> Self {
        Self {
            lattice,
            wedgies,
            sight: Sight::new(lattice, viewpoint, detail.canopy_m),
            pixel_rad: viewpoint.pixel_rad as f32,
            idle_px: detail.error_px,
            held_m: detail.held_m,
            pins,
        }
    }

    /// Pixels of error that splitting may mend; 0 where nothing can be seen of it. An error that
    /// need not be mended is told without asking whether it can be seen.
    pub(super) fn urgency(&self, diamond: &Diamond) -> f32 {
        let index = self.lattice.index(diamond.centre);
        let half_m = self.wedgies.half_m(index);
        if half_m <= 0.0 {
            return 0.0;
        }
        let is_pinned = self.pins.contains(&(index as u32));
        let mut most = 0.0_f32;
        for triangle in diamond.triangles() {
            if self.lattice.side(&triangle) == Side::Outside {
                continue;
            }
            // Most are far enough for this to settle it.
            let level_m = self.sight.level_distance_m(&triangle);
            let level_px = self.error_at(half_m, level_m);
            if !is_pinned && level_m > self.held_m && level_px <= self.idle_px {
                most = most.max(level_px);
                continue;
            }
            let bounds = self.sight.bounds(&triangle, half_m);
            let away_m = bounds.distance_m();
            let error_px = self.error_at(half_m, away_m);
            let is_held = is_pinned || (half_m > HELD_ERROR_M && away_m <= self.held_m);
            if !is_held && error_px <= self.idle_px.max(most) {
                most = most.max(error_px);
            } else if is_pinned || self.sight.crossed(&bounds, ALL_SIDES).is_some() {
                most = most.max(if is_held {
                    error_px.max(LEAST_HELD_PX) * HELD
                } else {
                    error_px
                });
            }
        }
        most
    }

    fn error_at(&self, half_m: f32, away_m: f32) -> f32 {
        half_m / (away_m.max(NEAR_M) * self.pixel_rad)
    }

    /// The error in pixels behind an urgency.
    pub(super) fn error_px(urgency: f32) -> f32 {
        if urgency >= HELD * LEAST_HELD_PX {
            urgency / HELD
        } else {
            urgency
        }
    }
}
