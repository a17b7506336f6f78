//! Laws of the bintree, on rough grounds of awkward sizes.

use std::collections::{BTreeMap, BTreeSet};

use super::geometry::Triangle;
use super::lattice::Side;
use super::*;
use crate::base::Vec3;
use crate::base::philox::{philox2x32, unit};
use crate::terrain::noise::octaves;

/// Sizes that are and are not powers of two, even and odd, long and tiny.
const SIZES: [[u32; 2]; 5] = [[65, 65], [61, 44], [130, 18], [2, 2], [37, 103]];

pub(super) fn hills(columns: u32, rows: u32, spacing_m: f32) -> Arc<HeightGrid> {
    let mut grid = HeightGrid::flat(columns, rows, spacing_m);
    grid.centre_m = [3000.0, -500.0];
    for (k, h) in grid.heights_m.iter_mut().enumerate() {
        let (x, z) = (k as u32 % columns, k as u32 / columns);
        let at = |n: u32| f64::from(n) * f64::from(spacing_m) / 60.0;
        *h = (14.0 * octaves(at(x), at(z), 6, 3)) as f32;
    }
    Arc::new(grid)
}

pub(super) fn random(k: u32, n: u32) -> f64 {
    f64::from(unit(philox2x32([k, n], 77, 7)[0]))
}

/// Looks over the ground from a random place: every third from near the ground, one straight
/// down.
pub(super) fn somewhere(ground: &HeightGrid, k: u32) -> Viewpoint {
    let [wide, deep] = ground.size_m();
    let x = ground.centre_m[0] + (random(k, 0) - 0.5) * 1.2 * wide;
    let z = ground.centre_m[1] + (random(k, 1) - 0.5) * 1.2 * deep;
    let above_m = if k.is_multiple_of(3) {
        1.7
    } else {
        1.0 + 80.0 * random(k, 2)
    };
    let eye = Vec3::new(x, ground.height_in_world(x, z) + above_m, z);
    let yaw = random(k, 3) * std::f64::consts::TAU;
    let pitch: f64 = if k == 1 { -1.57 } else { 0.2 - random(k, 4) };
    looking(eye, yaw, pitch)
}

pub(super) fn looking(eye: Vec3<f64>, yaw: f64, pitch: f64) -> Viewpoint {
    let forward = Vec3::new(
        pitch.cos() * yaw.sin(),
        pitch.sin(),
        -pitch.cos() * yaw.cos(),
    );
    let right = forward.cross(Vec3::UP).unit_or(Vec3::new(1.0, 0.0, 0.0));
    Viewpoint {
        eye_in_world: eye,
        right,
        up: right.cross(forward),
        forward,
        half_tan: [0.7, 0.4],
        pixel_rad: 0.8 / 720.0,
    }
}

fn detail(error_px: f32, budget: usize, held_m: f32) -> MeshDetail {
    MeshDetail {
        error_px,
        budget,
        held_m,
        canopy_m: 0.6,
    }
}

pub(super) fn sees(viewpoint: &Viewpoint, place: Vec3<f64>) -> bool {
    let away = place - viewpoint.eye_in_world;
    let ahead = away.dot(viewpoint.forward);
    ahead > 0.0
        && away.dot(viewpoint.right).abs() <= ahead * viewpoint.half_tan[0]
        && away.dot(viewpoint.up).abs() <= ahead * viewpoint.half_tan[1]
}

/// Height of a drawn triangle at weights of its corners, and the ground's there.
fn heights_at(ground: &HeightGrid, corners: &[u32], weights: [f64; 3]) -> [f64; 2] {
    let [corner_x, corner_z] = ground.corner_in_world();
    let (mut x, mut z, mut drawn) = (corner_x, corner_z, 0.0);
    for (&rank, w) in corners.iter().zip(weights) {
        let (column, row) = (rank % ground.columns, rank / ground.columns);
        x += w * f64::from(column) * f64::from(ground.spacing_m);
        z += w * f64::from(row) * f64::from(ground.spacing_m);
        drawn += w * f64::from(ground.sample(column, row));
    }
    [drawn, ground.height_in_world(x, z)]
}

fn weights(k: u32) -> [f64; 3] {
    let (a, b) = (random(k, 8), random(k, 9));
    let (a, b) = if a + b > 1.0 {
        (1.0 - a, 1.0 - b)
    } else {
        (a, b)
    };
    [a, b, 1.0 - a - b]
}

/// Every edge belongs to two triangles, or to one and lies on the terrain's edge; together the
/// triangles cover the terrain.
fn assert_no_cracks(tree: &Bintree, mesh: &Mesh) {
    let drawn = mesh.whole(tree);
    assert_eq!(drawn.corners.len(), 3 * mesh.triangles());
    let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    let columns = tree.ground().columns;
    let mut twice_area = 0;
    for corners in drawn.corners.chunks_exact(3) {
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (corners[a], corners[b]);
            // Counted with its direction: neighbours run along it in opposite ones.
            *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
        }
        let [a, b, c] =
            [0, 1, 2].map(|k| [corners[k] % columns, corners[k] / columns].map(|n| n as i64));
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        assert!(area < 0, "a triangle is empty or upside down");
        twice_area -= area;
    }
    let border: BTreeSet<_> = drawn
        .border
        .iter()
        .map(|&[a, b]| (a.min(b), a.max(b)))
        .collect();
    for (edge, sum) in &edges {
        assert_eq!(*sum == 0, !border.contains(edge), "edge {edge:?}");
        assert!(sum.abs() <= 1, "edge {edge:?} is shared by more than two");
    }
    let [nx, nz] = tree.ground().squares().map(i64::from);
    assert_eq!(twice_area, 2 * nx * nz);
}

#[test]
fn a_moving_mesh_has_no_cracks_and_keeps_its_budget() {
    for [columns, rows] in SIZES {
        let ground = hills(columns, rows, 2.0);
        let tree = Bintree::new(Arc::clone(&ground));
        let mut mesh = Mesh::new(&tree);
        assert_no_cracks(&tree, &mesh);
        let mut was_bound = false;
        for k in 0..16 {
            let wanted = detail(0.5 + 3.0 * random(k, 5) as f32, 200 + 60 * k as usize, 10.0);
            let change = mesh
                .update(&tree, &somewhere(&ground, k), &wanted)
                .expect("a mesh");
            assert!(change.triangles <= wanted.budget, "{change:?}");
            assert_eq!(change.triangles, mesh.triangles());
            assert_eq!(change.is_bound, change.worst_px > wanted.error_px);
            was_bound |= change.is_bound;
            assert_no_cracks(&tree, &mesh);
        }
        assert!(was_bound || columns == 2, "no budget was ever felt");
    }
}

#[test]
fn a_budget_below_the_roots_is_refused() {
    let ground = hills(65, 65, 2.0);
    let tree = Bintree::new(Arc::clone(&ground));
    let refused = Mesh::new(&tree).update(&tree, &somewhere(&ground, 0), &detail(1.0, 3, 0.0));
    assert!(refused.is_err_and(|e| e.to_string().contains("3 triangles")));
}

/// With everything split the mesh is the ground itself: every triangle has the cut of its square.
#[test]
fn split_to_the_end_the_mesh_is_the_height_grid() {
    for [columns, rows] in SIZES {
        let ground = hills(columns, rows, 2.0);
        let tree = Bintree::new(Arc::clone(&ground));
        let mut mesh = Mesh::new(&tree);
        let all = ground.squares().map(|n| n as i32);
        mesh.pin(&tree, vec![[[0, 0], all]]);
        let wanted = detail(1e9, tree.finest_triangles(), 0.0);
        let change = mesh
            .update(&tree, &somewhere(&ground, 2), &wanted)
            .expect("a mesh");
        assert_eq!(change.triangles, tree.finest_triangles());
        for (k, corners) in mesh.whole(&tree).corners.chunks_exact(3).enumerate() {
            let [drawn, truth] = heights_at(&ground, corners, weights(k as u32));
            // Places are sums of f64 below 10⁴: 1e-12 relative, times slopes below 10.
            assert!((drawn - truth).abs() < 1e-7, "{corners:?}: {drawn} {truth}");
        }
        mesh.pin(&tree, Vec::new());
        let change = mesh
            .update(&tree, &somewhere(&ground, 2), &wanted)
            .expect("a mesh");
        assert_eq!(
            change.triangles,
            root_triangles(&tree),
            "nothing is merged again"
        );
    }
}

fn root_triangles(tree: &Bintree) -> usize {
    Mesh::new(tree).triangles()
}

#[test]
fn no_ground_leaves_its_wedgie() {
    for [columns, rows] in SIZES {
        let ground = hills(columns, rows, 2.0);
        let tree = Bintree::new(Arc::clone(&ground));
        let mut pending: Vec<Triangle> = tree.lattice.roots().flatten().collect();
        while let Some(triangle) = pending.pop() {
            let Some(middle) = triangle.split_point() else {
                continue;
            };
            if tree.lattice.side(&triangle) == Side::Outside {
                continue;
            }
            pending.extend(triangle.halves(middle));
            let bound_m = f64::from(tree.wedgies.half_m(tree.lattice.index(middle)));
            let ranks = triangle.corners().map(|p| {
                let [x, z] = tree.lattice.on_terrain(p);
                z as u32 * columns + x as u32
            });
            for k in 0..20 {
                let [drawn, truth] = heights_at(&ground, &ranks, weights(k));
                // Rounding of the weights, as above.
                assert!((drawn - truth).abs() <= bound_m + 1e-7, "{triangle:?}");
            }
        }
    }
}

/// From frame to frame the mesh becomes what it would be if it were made for this frame alone.
#[test]
fn a_mesh_does_not_depend_on_the_frames_before() {
    let ground = hills(97, 120, 2.0);
    let tree = Bintree::new(Arc::clone(&ground));
    for budget in [100_000, 900] {
        let wanted = detail(1.0, budget, 12.0);
        let mut moving = Mesh::new(&tree);
        for k in 0..24 {
            let viewpoint = somewhere(&ground, k);
            let moved = moving.update(&tree, &viewpoint, &wanted).expect("a mesh");
            let mut fresh = Mesh::new(&tree);
            let made = fresh.update(&tree, &viewpoint, &wanted).expect("a mesh");
            assert_eq!(moved.worst_px, made.worst_px, "frame {k}");
            assert_eq!(moved.is_bound, made.is_bound, "frame {k}");
            if !made.is_bound {
                assert_eq!(moving.whole(&tree), fresh.whole(&tree), "frame {k}");
            }
            let still = moving.update(&tree, &viewpoint, &wanted).expect("a mesh");
            assert_eq!((still.splits, still.merges), (0, 0));
        }
    }
}

#[test]
fn what_is_in_view_and_near_or_pinned_has_full_resolution() {
    let ground = hills(97, 120, 2.0);
    let tree = Bintree::new(Arc::clone(&ground));
    let mut mesh = Mesh::new(&tree);
    let pinned = [[11, 70], [15, 72]];
    mesh.pin(&tree, vec![pinned]);
    let mut held = 0;
    for k in 0..12 {
        let viewpoint = somewhere(&ground, k);
        let wanted = detail(50.0, 100_000, 30.0);
        mesh.update(&tree, &viewpoint, &wanted).expect("a mesh");
        for corners in mesh.whole(&tree).corners.chunks_exact(3) {
            for n in 0..6 {
                let w = weights(n);
                let [drawn, truth] = heights_at(&ground, corners, w);
                let place = place_of(&ground, corners, w, truth);
                let away_m = (place - viewpoint.eye_in_world).length();
                let (x, z) = (place.x, place.z);
                let [cx, cz] = ground.corner_in_world();
                let at = [(x - cx) / 2.0, (z - cz) / 2.0];
                let is_pinned = (0..2)
                    .all(|i| at[i] > f64::from(pinned[0][i]) && at[i] < f64::from(pinned[1][i]));
                if is_pinned || (away_m <= 30.0 && sees(&viewpoint, place)) {
                    held += 1;
                    let off = (drawn - truth).abs();
                    assert!(off <= f64::from(HELD_ERROR_M) + 1e-7, "frame {k}: {off} m");
                }
            }
        }
    }
    assert!(held > 1000);
}

fn place_of(ground: &HeightGrid, corners: &[u32], weights: [f64; 3], y: f64) -> Vec3<f64> {
    let [mut x, mut z] = ground.corner_in_world();
    for (&rank, w) in corners.iter().zip(weights) {
        x += w * f64::from(rank % ground.columns) * f64::from(ground.spacing_m);
        z += w * f64::from(rank / ground.columns) * f64::from(ground.spacing_m);
    }
    Vec3::new(x, y, z)
}

#[test]
fn culling_drops_no_triangle_with_a_visible_plant() {
    let ground = hills(97, 120, 2.0);
    let tree = Bintree::new(Arc::clone(&ground));
    let mut mesh = Mesh::new(&tree);
    let (mut dropped, mut kept) = (0, 0);
    for k in 0..30 {
        let viewpoint = somewhere(&ground, k);
        let wanted = detail(4.0, 2000, 0.0);
        mesh.update(&tree, &viewpoint, &wanted).expect("a mesh");
        let in_view = mesh.in_view(&tree, &viewpoint, wanted.canopy_m);
        let in_view: BTreeSet<_> = in_view.corners.chunks_exact(3).collect();
        let whole = mesh.whole(&tree);
        for corners in whole.corners.chunks_exact(3) {
            if in_view.contains(corners) {
                kept += 1;
                continue;
            }
            dropped += 1;
            for n in 0..8 {
                let w = weights(n);
                let [drawn, truth] = heights_at(&ground, corners, w);
                for y in [drawn, truth, truth + f64::from(wanted.canopy_m)] {
                    let place = place_of(&ground, corners, w, y);
                    assert!(!sees(&viewpoint, place), "frame {k}: {corners:?}");
                }
            }
        }
    }
    assert!(dropped > 2000 && kept > 2000, "{dropped} {kept}");
}
