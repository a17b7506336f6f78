//! Splits a triangle mesh into convex parts: voxel-based approximate convex decomposition
//! (Mamou and Ghorbel 2009, V-HACD) as parry has it.

use rapier3d::math::Vector;
use rapier3d::parry::transformation::vhacd::{VHACD, VHACDParameters};
use rapier3d::parry::transformation::voxelization::FillMode;

use super::convex::Hull;

/// Voxels along the mesh's longest side. Gaps narrower than a voxel or two are filled: legs and
/// horns of 1/30 of the mesh's size stay apart.
const RESOLUTION: u32 = 64;

/// Hulls whose union approximates the solid that the triangles enclose; at most `max_parts`.
/// Empty if nothing has a volume.
pub(super) fn convex_parts(
    positions: &[Vector],
    triangles: &[[u32; 3]],
    max_parts: u32,
) -> Vec<Hull> {
    let parameters = VHACDParameters {
        resolution: RESOLUTION,
        max_convex_hulls: max_parts,
        fill_mode: FillMode::FloodFill {
            detect_cavities: false,
        },
        ..VHACDParameters::default()
    };
    VHACD::decompose(&parameters, positions, triangles, true)
        .compute_primitive_intersections(positions, triangles)
        .iter()
        .filter_map(|points| Hull::of(points))
        .collect()
}
