//! The wind pose: where a plant's centre line is when nothing has touched it.
//!
//! Each segment's direction is that of the static shape (P15 eq. 12, from the blade table), pushed
//! sideways by the wind and brought back to unit length, so that lengths hold exactly and no
//! angle function is needed. The sideways push grows over the blade as s(2 − s), the slope of a
//! clamped beam under an even load. WGSL twin: `shaders/shared/pose.wgsl`.

use crate::base::{Real, Vec3};

use super::blade_table::BladeTable;
use super::plant::Plant;

/// Most segments of a blade.
pub const MAX_SEGMENTS: usize = 16;
/// Nodes of the longest centre line: the root and one per segment.
pub const MAX_NODES: usize = MAX_SEGMENTS + 1;

/// Nodes from root to tip; only the first `segments + 1` count.
pub type Nodes<R> = [Vec3<R>; MAX_NODES];

/// Share of the wind's push that segment `j` (0 at the root) of `segments` takes.
pub fn wind_share<R: Real>(j: usize, segments: usize) -> R {
    let s = R::of((j as f64 + 0.5) / segments as f64);
    s * (R::of(2.0) - s)
}

/// The nodes of a plant bent by the wind, in its anchor's coordinates.
pub fn wind_pose<R: Real>(plant: &Plant, table: &BladeTable, bend: [R; 2]) -> Nodes<R> {
    let segments = table.segments as usize;
    let mut nodes = [Vec3::ZERO; MAX_NODES];
    nodes[0] = Vec3::of_f32(plant.root_in_anchor);
    let [cos, sin] = plant.azimuth.map(R::of_f32);
    let length = R::of_f32(plant.height_m) * R::of(1.0 / segments as f64);
    let cell = table.place(R::of_f32(plant.stiffness), R::of_f32(plant.lean));
    for j in 0..segments {
        let [across, up] = table.direction(cell, j);
        let share = wind_share::<R>(j, segments);
        let leaning = Vec3::new(
            across * cos + bend[0] * share,
            up,
            across * sin + bend[1] * share,
        );
        nodes[j + 1] = nodes[j] + leaning.unit_or(Vec3::UP) * length;
    }
    nodes
}
