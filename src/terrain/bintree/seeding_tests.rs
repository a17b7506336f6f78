//! Laws of the seeding traversal.

use std::collections::HashSet;

use super::tests::{hills, looking, random, sees, somewhere};
use super::*;
use crate::base::Vec3;

const PLANT_M: f32 = 0.6;

fn seeding(halvings: i32, reach_m: f32) -> Seeding {
    Seeding {
        halvings,
        reach_m,
        plant_m: PLANT_M,
        drops_hidden: true,
    }
}

fn found(tree: &Bintree, viewpoint: &Viewpoint, seeding: &Seeding) -> HashSet<SeedTriangle> {
    let mut all = HashSet::new();
    let counts = tree.seed(viewpoint, seeding, |triangle| {
        assert!(all.insert(triangle), "{triangle:?} twice");
    });
    assert_eq!(counts.found as usize, all.len());
    all
}

/// Cells along x and z, the last ones reaching over the edge.
fn cells(ground: &HeightGrid, halvings: i32) -> [u32; 2] {
    ground.squares().map(|n| match halvings {
        0.. => n << halvings,
        _ => n.div_ceil(1 << -halvings),
    })
}

/// World places of a triangle's corners, the right angle first.
fn corners(ground: &HeightGrid, halvings: i32, triangle: SeedTriangle) -> [Vec3<f64>; 3] {
    let [i, j] = triangle.cell;
    let even = (i + j) % 2 == 0;
    let lower = triangle.half;
    let upright = u32::from(even != (lower == 1));
    let cell_m = f64::from(ground.spacing_m) * 0.5_f64.powi(halvings);
    [(upright, lower), (1 - upright, lower), (upright, 1 - lower)].map(|(di, dj)| {
        let [x, z] = ground.corner_in_world();
        let (x, z) = (
            x + f64::from(i + di) * cell_m,
            z + f64::from(j + dj) * cell_m,
        );
        Vec3::new(x, ground.height_in_world(x, z), z)
    })
}

#[test]
fn from_high_above_every_triangle_is_found_once() {
    for ([columns, rows], halvings) in [
        ([37, 22], 0),
        ([37, 22], 2),
        ([9, 70], -2),
        ([2, 3], 3),
        ([30, 30], -1),
    ] {
        let ground = hills(columns, rows, 2.0);
        let tree = Bintree::new(Arc::clone(&ground));
        let [x, z] = ground.centre_m;
        let above = looking(Vec3::new(x, 2000.0, z), 0.0, -1.57);
        let [wide, deep] = cells(&ground, halvings);
        let all = found(&tree, &above, &seeding(halvings, 1e4));
        assert_eq!(all.len(), 2 * wide as usize * deep as usize);
        assert!(
            all.iter()
                .all(|t| t.cell[0] < wide && t.cell[1] < deep && t.half < 2)
        );
    }
}

/// Whether the ground hides a place from the eye: somewhere on the way the line is below it.
fn is_behind_ground(ground: &HeightGrid, viewpoint: &Viewpoint, place: Vec3<f64>) -> bool {
    let way = place - viewpoint.eye_in_world;
    (1..4000).any(|k| {
        let p = viewpoint.eye_in_world + way * (f64::from(k) / 4000.0);
        ground.contains(p.x, p.z) && p.y < ground.height_in_world(p.x, p.z)
    })
}

/// A ridge of even slopes with slight bumps, which hides what grows behind it.
fn ridge() -> Arc<HeightGrid> {
    let mut ground = (*hills(60, 48, 2.0)).clone();
    for (k, h) in ground.heights_m.iter_mut().enumerate() {
        let from_crest_m = 2.0 * (k as f32 % 60.0 - 30.0).abs();
        *h = 20.0 - 0.6 * from_crest_m + 0.001 * *h;
    }
    Arc::new(ground)
}

#[test]
fn no_triangle_with_a_visible_plant_is_dropped() {
    drops_no_visible_plant(hills(60, 48, 2.0), false);
    drops_no_visible_plant(ridge(), true);
}

fn drops_no_visible_plant(ground: Arc<HeightGrid>, hides: bool) {
    let halvings = 1;
    let tree = Bintree::new(Arc::clone(&ground));
    let [wide, deep] = cells(&ground, halvings);
    let (mut kept, mut hidden) = (0, 0);
    for k in 0..24 {
        let viewpoint = somewhere(&ground, k);
        let wanted = seeding(halvings, 45.0);
        let seen = found(&tree, &viewpoint, &wanted);
        kept += seen.len();
        let every = (0..2 * wide * deep).map(|id| SeedTriangle {
            cell: [id / 2 % wide, id / 2 / wide],
            half: id % 2,
        });
        for triangle in every.filter(|t| !seen.contains(t)) {
            let at = corners(&ground, halvings, triangle);
            let away_m = at.map(|p| (p - viewpoint.eye_in_world).length());
            let closest_m = away_m.iter().fold(f64::INFINITY, |a, &b| a.min(b));
            if closest_m > f64::from(wanted.reach_m) - 1e-3 {
                continue;
            }
            for n in 0..6 {
                let (a, b) = (random(n, 20), random(n, 21));
                let (a, b) = if a + b > 1.0 {
                    (1.0 - a, 1.0 - b)
                } else {
                    (a, b)
                };
                let root = at[0] + (at[1] - at[0]) * a + (at[2] - at[0]) * b;
                let (turn, lean) = (random(n, 22) * std::f64::consts::TAU, 1.5 * random(n, 23));
                let blade = Vec3::new(lean.sin() * turn.cos(), lean.cos(), lean.sin() * turn.sin());
                let tip = root + blade * f64::from(PLANT_M);
                if sees(&viewpoint, tip) {
                    assert!(
                        is_behind_ground(&ground, &viewpoint, tip),
                        "frame {k}: {triangle:?}"
                    );
                    hidden += 1;
                }
            }
        }
    }
    assert!(kept > 5000, "kept {kept}");
    assert!(!hides || hidden > 20, "hidden {hidden}");
}

/// Leaving hidden triangles in changes nothing else.
#[test]
fn what_is_found_without_dropping_holds_what_is_found_with() {
    let ground = hills(60, 48, 2.0);
    let tree = Bintree::new(Arc::clone(&ground));
    for k in 0..24 {
        let viewpoint = somewhere(&ground, k);
        let wanted = seeding(2, 60.0);
        let fewer = found(&tree, &viewpoint, &wanted);
        let all = found(
            &tree,
            &viewpoint,
            &Seeding {
                drops_hidden: false,
                ..wanted
            },
        );
        assert!(fewer.is_subset(&all), "frame {k}");
    }
}

/// The triangles in reach are those whose closest corner is, however large those above them are.
#[test]
fn reach_is_that_of_the_closest_corner() {
    let ground = hills(60, 48, 2.0);
    let tree = Bintree::new(Arc::clone(&ground));
    let [x, z] = ground.centre_m;
    let above = looking(Vec3::new(x + 3.0, 40.0, z), 0.3, -1.57);
    let near = found(&tree, &above, &seeding(1, 45.0));
    let all = found(&tree, &above, &seeding(1, 1e4));
    let is_near = |t: &SeedTriangle| {
        let at = corners(&ground, 1, *t);
        at.iter()
            .any(|&p| (p - above.eye_in_world).length() <= 45.0)
    };
    let wanted: HashSet<_> = all.into_iter().filter(is_near).collect();
    // Eye coordinates are f32: a corner within a millimetre of the reach may fall either way.
    let differing = near.symmetric_difference(&wanted).count();
    assert!(
        differing <= 1 && near.len() > 100,
        "{differing} of {}",
        near.len()
    );
}
