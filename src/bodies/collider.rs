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
    let mut colliders = Vec::new();
    for along_z in pieces(rows - 1, most) {
        for along_x in pieces(columns - 1, most) {
            colliders.push(piece(grid, along_x, along_z, friction));
        }
    }
    Ok(colliders)
}

/// First and last samples of runs of at most `most` squares.
fn pieces(squares: usize, most: usize) -> impl Iterator<Item = [usize; 2]> {
    let firsts = (0..squares).step_by(most);
    firsts.map(move |first| [first, (first + most).min(squares)])
}

/// So far the land goes on level around the field, in metres: a body that fell off the rim would cut
/// through it, and through the grass that grows there.
pub const LAND_M: f64 = 32.0;

/// Colliders of the land around the field, with their places in the world. It has the heights of the
/// field's edge, as [`HeightGrid::height_in_world`] has beyond it.
pub(super) fn land(grid: &HeightGrid, friction: f32) -> Vec<(Vec3<f64>, Collider)> {
    let last = [grid.columns as usize - 1, grid.rows as usize - 1];
    let most = ((LONGEST_M / f64::from(grid.spacing_m)) as usize).max(1);
    // Along each axis: the land before the field, pieces of the field, the land behind it.
    let runs = last.map(|last| {
        let inside = pieces(last, most);
        [[0, 0]]
            .into_iter()
            .chain(inside)
            .chain([[last, last]])
            .collect::<Vec<_>>()
    });
    let mut colliders = Vec::new();
    for (m, &along_z) in runs[1].iter().enumerate() {
        for (n, &along_x) in runs[0].iter().enumerate() {
            let is_land = [along_x, along_z].iter().any(|[first, last]| first == last);
            if is_land {
                let after = [n > 0, m > 0];
                colliders.push(land_piece(grid, [along_x, along_z], after, friction));
            }
        }
    }
    colliders
}

/// The land beside a run of samples along x and z; where a run is a single sample the land lies
/// before it, or `after` it.
fn land_piece(
    grid: &HeightGrid,
    runs: [[usize; 2]; 2],
    after: [bool; 2],
    friction: f32,
) -> (Vec3<f64>, Collider) {
    let spacing_m = f64::from(grid.spacing_m);
    let corner = grid.corner_in_world();
    let span = |axis: usize| -> (f64, f64) {
        let [first, last] = runs[axis];
        let ends = [first, last].map(|sample| corner[axis] + sample as f64 * spacing_m);
        match (first == last, after[axis]) {
            (false, _) => (0.5 * (ends[0] + ends[1]), ends[1] - ends[0]),
            (true, false) => (ends[0] - 0.5 * LAND_M, LAND_M),
            (true, true) => (ends[0] + 0.5 * LAND_M, LAND_M),
        }
    };
    let (x, width) = span(0);
    let (z, depth) = span(1);
    let samples = runs.map(|[first, last]| if first == last { 2 } else { last - first + 1 });
    let sample = |row: usize, column: usize| {
        let at = |axis: usize, n: usize| (runs[axis][0] + n).min(runs[axis][1]);
        grid.heights_m[at(1, row) * grid.columns as usize + at(0, column)]
    };
    let base_m = base_m(sample(0, 0));
    let mut heights = Array2::repeat(samples[1], samples[0], 0.0_f32);
    for row in 0..samples[1] {
        for column in 0..samples[0] {
            heights[(row, column)] = sample(row, column) - base_m;
        }
    }
    let size = Vector::new(width as f32, 1.0, depth as f32);
    let field = HeightField::with_flags(heights, size, HeightFieldFlags::FIX_INTERNAL_EDGES);
    let collider = ColliderBuilder::new(SharedShape::new(field)).friction(friction);
    (Vec3::new(x, f64::from(base_m), z), collider.build())
}

/// The height that a piece's heights count from, in metres: whole steps of 64 m, which a low ground has
/// none of, so that its heights stay as they are.
fn base_m(first_m: f32) -> f32 {
    let base_m = (first_m / 64.0).floor() * 64.0;
    if base_m.abs() <= 64.0 { 0.0 } else { base_m }
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
    let base_m = base_m(sample(0, 0));
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

    #[test]
    fn the_land_goes_on_from_the_edge() {
        let mut grid = HeightGrid::flat(9, 6, 0.5);
        for (k, h) in grid.heights_m.iter_mut().enumerate() {
            *h = unit(philox2x32([k as u32, 0], 3, 7)[0]);
        }
        let land = land(&grid, 0.8);
        let [width, depth] = grid.size_m();
        let mut met = 0;
        for k in 0..400 {
            let words = philox2x32([k, 2], 5, 7);
            let x = f64::from(unit(words[0]) - 0.5) * (width + 1.9 * LAND_M);
            let z = f64::from(unit(words[1]) - 0.5) * (depth + 1.9 * LAND_M);
            let fall = |(place, collider): &(Vec3<f64>, Collider)| {
                let [x, y, z] = [x - place.x, 3.0 - place.y, z - place.z].map(|c| c as f32);
                let ray = Ray::new(Vector::new(x, y, z), -Vector::Y);
                collider.shape().cast_local_ray(&ray, 10.0, true)
            };
            let hits: Vec<f32> = land.iter().filter_map(fall).collect();
            assert_eq!(hits.len(), usize::from(!grid.contains(x, z)), "({x}, {z})");
            // A cell is cut in two: along the edge its heights are the edge's, whichever way.
            let want = grid.height_in_world(x, z) as f32;
            for hit in hits {
                assert!((3.0 - hit - want).abs() < 2e-5, "({x}, {z}): {hit} {want}");
                met += 1;
            }
        }
        assert!(met > 300, "{met}");
    }
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
