//! Rapier's colliders: of a rigid shape's parts, and of the ground.

use rapier3d::math::Vector;
use rapier3d::parry::shape::{HeightField, HeightFieldCellStatus, HeightFieldFlags};
use rapier3d::parry::utils::Array2;
use rapier3d::prelude::{Collider, ColliderBuilder, SharedShape};

use crate::base::Vec3;
use crate::terrain::HeightGrid;

use super::error::BodyError;
use super::frame::local_pose_to_rapier;
use super::shape::{ConvexPart, RigidShape, Solid};

/// One collider shape of the same parts as the grass feels; `None` if rapier finds a part flat.
pub(super) fn shared_shape(shape: &RigidShape) -> Option<SharedShape> {
    if let [part] = shape.parts.as_slice()
        && part.pose == crate::base::Pose::IDENTITY
    {
        return solid(part);
    }
    let parts: Option<Vec<_>> = shape
        .parts
        .iter()
        .map(|part| Some((local_pose_to_rapier(part.pose), solid(part)?)))
        .collect();
    parts.map(SharedShape::compound)
}

fn solid(part: &ConvexPart) -> Option<SharedShape> {
    Some(match &part.solid {
        Solid::Ball { radius } => SharedShape::ball(*radius as f32),
        Solid::Box { half } => {
            let [x, y, z] = half.map(|h| h as f32);
            SharedShape::cuboid(x, y, z)
        }
        Solid::Capsule { radius, half } => SharedShape::capsule_y(*half as f32, *radius as f32),
        Solid::Cylinder { radius, half } => SharedShape::cylinder(*half as f32, *radius as f32),
        Solid::Convex { vertices, .. } => {
            let points: Vec<Vector> = vertices
                .iter()
                .map(|v| Vector::from_array(v.map(|c| c as f32)))
                .collect();
            return SharedShape::convex_hull(&points);
        }
    })
}

/// Longest side of one of the ground's colliders, in metres: within it, rapier's f32 rounds a
/// place on the ground by 3e-5 m at most.
const LONGEST_M: f64 = 1024.0;

/// The ground's colliders, each with its place in the world: the same triangles as [`HeightGrid`]
/// has. A ground within 1,024 m each way is one collider, a larger one is cut into several.
///
/// Parry's rows run along z and its columns along x, as ours do. It cuts a cell across, from
/// (1, 0) to (0, 1), unless the cell is marked `ZIGZAG_SUBDIVISION`; ours are cut from (0, 0) to
/// (1, 1) where column + row is even.
///
/// # Errors
/// If the grid has fewer than two samples along a side, or their number is wrong.
pub(super) fn ground(
    grid: &HeightGrid,
    friction: f32,
) -> Result<Vec<(Vec3<f64>, Collider)>, BodyError> {
    let (rows, columns) = (grid.rows as usize, grid.columns as usize);
    if rows < 2 || columns < 2 || grid.heights_m.len() != rows * columns {
        return Err(BodyError::Ground {
            reason: format!(
                "it has {} height samples for {columns} columns and {rows} rows; each side needs \
                 two and the product must agree",
                grid.heights_m.len()
            ),
        });
    }
    // An even number of squares, so that a piece's cells are cut as the whole ground's are.
    let most = ((LONGEST_M / f64::from(grid.spacing_m) / 2.0) as usize * 2).max(2);
    let pieces = |squares: usize| {
        let firsts = (0..squares).step_by(most);
        firsts.map(move |first| [first, (first + most).min(squares)])
    };
    let mut colliders = Vec::new();
    for along_z in pieces(rows - 1) {
        for along_x in pieces(columns - 1) {
            colliders.push(piece(grid, along_x, along_z, friction));
        }
    }
    Ok(colliders)
}

/// The collider of the squares between a first and a last sample along x and z. Its heights count
/// from the place it is given.
fn piece(
    grid: &HeightGrid,
    along_x: [usize; 2],
    along_z: [usize; 2],
    friction: f32,
) -> (Vec3<f64>, Collider) {
    let [rows, columns] = [along_z, along_x].map(|[first, last]| last - first + 1);
    let sample = |row: usize, column: usize| {
        grid.heights_m[(along_z[0] + row) * grid.columns as usize + along_x[0] + column]
    };
    // Whole steps of 64 m, which a low ground has none of: its heights stay as they are.
    let base_m = (sample(0, 0) / 64.0).floor() * 64.0;
    let base_m = if base_m.abs() <= 64.0 { 0.0 } else { base_m };
    let mut heights = Array2::repeat(rows, columns, 0.0_f32);
    for row in 0..rows {
        for column in 0..columns {
            heights[(row, column)] = sample(row, column) - base_m;
        }
    }
    let spacing_m = f64::from(grid.spacing_m);
    let [width, depth] = [columns, rows].map(|n| ((n - 1) as f64 * spacing_m) as f32);
    let mut field = HeightField::with_flags(
        heights,
        Vector::new(width, 1.0, depth),
        HeightFieldFlags::FIX_INTERNAL_EDGES,
    );
    for row in 0..rows - 1 {
        for column in (row % 2..columns - 1).step_by(2) {
            field.set_cell_status(row, column, HeightFieldCellStatus::ZIGZAG_SUBDIVISION);
        }
    }
    let corner = grid.corner_in_world();
    let middle = |[first, last]: [usize; 2]| 0.5 * (first + last) as f64 * spacing_m;
    let place = Vec3::new(
        corner[0] + middle(along_x),
        f64::from(base_m),
        corner[1] + middle(along_z),
    );
    let collider = ColliderBuilder::new(SharedShape::new(field)).friction(friction);
    (place, collider.build())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::philox::{philox2x32, unit};
    use rapier3d::parry::query::Ray;

    #[test]
    fn the_collider_is_the_ground() {
        let mut grid = HeightGrid::flat(9, 6, 0.5);
        for (k, h) in grid.heights_m.iter_mut().enumerate() {
            *h = unit(philox2x32([k as u32, 0], 3, 7)[0]);
        }
        let colliders = ground(&grid, 0.8).expect("a grid of 9 by 6");
        assert_eq!(colliders.len(), 1);
        let (place, collider) = &colliders[0];
        assert_eq!(*place, Vec3::ZERO);
        let [width, depth] = grid.size_m();
        let mut both = [0, 0];
        for k in 0..1000 {
            let words = philox2x32([k, 1], 5, 7);
            let x = (unit(words[0]) - 0.5) * width as f32 * 0.999;
            let z = (unit(words[1]) - 0.5) * depth as f32 * 0.999;
            let ray = Ray::new(Vector::new(x, 3.0, z), -Vector::Y);
            let far = collider.shape().cast_local_ray(&ray, 10.0, true);
            let hit = 3.0 - far.expect("the ray meets the ground");
            let want = grid.height_in_world(f64::from(x), f64::from(z)) as f32;
            // Heights below 1 m on slopes below 2·√2: a place rounded to f32 at 2.25 m (1.2e-7)
            // and a ray of 3 m (1.2e-7 each in its length and dot products).
            assert!((hit - want).abs() < 3e-6, "{k}: {hit} {want}");
            let cell = |p: f32, size: f64| ((f64::from(p) + 0.5 * size) / 0.5) as usize;
            both[(cell(x, width) + cell(z, depth)) % 2] += 1;
        }
        assert!(both.iter().all(|&n| n > 300), "{both:?}");
    }
}
