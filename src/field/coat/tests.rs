//! Laws of coats: how many plants there are, where they stand, and that they stay.

use super::*;
use crate::field::count::places;

fn ranges(seed: u32) -> CoatRanges {
    let coat = Coat {
        seed,
        ..Coat::default()
    };
    CoatRanges::new(&coat, 7)
}

/// A strip of `count` triangles of this many plants each.
fn strip(count: u32, full: f32) -> Vec<CoatTriangle> {
    let side = (2.0 * full).sqrt();
    (0..count)
        .map(|i| CoatTriangle {
            corners: [(0.0, 0.0), (side, 0.0), (0.0, side)]
                .map(|(x, z)| Vec3::new(x + i as f32 * side, 0.5 * x, -z)),
            normals: [Vec3::UP; 3],
            full,
        })
        .collect()
}

/// The plants of a coat in full are as many as its area says: over 4000 triangles rounded fractions
/// scatter by at most ½ each, 0.5 · √4000 = 32 plants, of which three are below 2% of 1.3 plants each.
#[test]
fn the_full_count_follows_the_area() {
    for (seed, full) in [(1, 1.3_f32), (2, 2.75), (9, 12.4)] {
        let coat = ranges(seed);
        let total: u32 = (0..4000).map(|t| places(full, coat.rounding(t))).sum();
        let wanted = 4000.0 * f64::from(full);
        assert!(
            (f64::from(total) / wanted - 1.0).abs() < 0.02,
            "{total} for {wanted}"
        );
    }
}

#[test]
fn roots_lie_on_their_triangles() {
    let coat = ranges(5);
    for (t, on) in strip(200, 3.0).iter().enumerate() {
        let [a, b, c] = on.corners;
        let normal = (b - a).cross(c - a);
        for index in 0..40 {
            let plant = coat.plant(on, t as u32, index);
            // A sum of coordinates up to 500 m: an ulp of them is 3e-5 m, and there are three sums.
            let off_plane = normal.unit_or(Vec3::UP).dot(plant.root - a);
            assert!(off_plane.abs() < 2e-4, "{off_plane}");
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let inward = normal.cross(to - from).unit_or(Vec3::UP);
                assert!(inward.dot(plant.root - from) > -2e-4);
            }
            assert!((plant.direction.length() - 1.0).abs() < 1e-5);
            let Coat {
                height_m,
                width_m,
                lean_deg,
                ..
            } = Coat::default();
            let within = |x: f32, [low, high]: [f32; 2]| x >= low - 1e-6 && x <= high + 1e-6;
            assert!(within(plant.height_m, height_m) && within(plant.width_m, width_m));
            let lean = plant.direction.dot(plant.normal).clamp(-1.0, 1.0).acos();
            // Near 15° an error of 1e-6 in the cosine is 4e-6 rad.
            assert!(within(
                lean.to_degrees(),
                [lean_deg[0] - 0.01, lean_deg[1] + 0.01]
            ));
        }
    }
}

/// χ² of 4096 plants in the 16 congruent parts of a triangle, for each of 20 triangles: with 15 degrees
/// of freedom one in 10⁴ is above 44.3, so that of 20 one is in 500 of such tests.
#[test]
fn plants_are_spread_evenly() {
    let coat = ranges(3);
    let on = CoatTriangle {
        corners: [
            Vec3::ZERO,
            Vec3::new(4.0, 0.0, 0.0),
            Vec3::new(0.0, 0.0, -4.0),
        ],
        normals: [Vec3::UP; 3],
        full: 0.0,
    };
    for t in 0..20 {
        let mut counts = [0_u32; 32];
        for index in 0..4096 {
            let root = coat.plant(&on, t, index).root;
            let (x, z) = (root.x, -root.z);
            // Squares of side 1, halved where they hold two parts.
            let upper = usize::from(x.fract() + z.fract() >= 1.0);
            let square = (x as usize).min(3) + 4 * (z as usize).min(3);
            counts[2 * square + upper] += 1;
        }
        let parts: Vec<u32> = counts.into_iter().filter(|&n| n > 0).collect();
        assert_eq!(parts.len(), 16);
        let chi2: f64 = (parts.iter())
            .map(|&n| (f64::from(n) - 256.0).powi(2) / 256.0)
            .sum();
        assert!(chi2 < 44.3, "triangle {t}: {chi2}");
    }
}

/// Splitting keeps the surface: its area, its order and its directions.
#[test]
fn large_triangles_are_split() {
    let positions = [
        [0.0, 0.0, 0.0],
        [9.0, 0.0, 0.0],
        [0.0, 0.0, -5.0],
        [1.0, 2.0, 0.0],
    ];
    let normals = [[0.0, 1.0, 0.0]; 4];
    let made = coat_triangles(&positions, &normals, &[0, 1, 2, 0, 1, 3], 400.0);
    let (flat, upright) = (22.5 * 400.0, 9.0 * 400.0);
    let total: f32 = made.iter().map(|t| t.full).sum();
    // Some 60 halves, each a sum of products exact to 2⁻²³.
    assert!((total - (flat + upright)).abs() < 1e-4 * total, "{total}");
    assert!(
        made.iter()
            .all(|t| t.full <= MOST_ON_TRIANGLE && t.full > 0.4 * MOST_ON_TRIANGLE)
    );
    for triangle in &made {
        let [a, b, c] = triangle.corners;
        let across = (b - a).cross(c - a).unit_or(Vec3::ZERO);
        assert!(across.y > 0.999 || across.z > 0.999, "{across:?}");
    }
    let same = coat_triangles(&positions, &normals, &[0, 1, 2], 400.0);
    assert_eq!(same[..], made[..same.len()]);
    assert!(coat_triangles(&positions, &normals, &[0, 1, 2], 0.0)[0].full == 0.0);
}

/// Turned away, a triangle grows nothing that is drawn; facing the eye, what eq. 1 says up to its own.
#[test]
fn only_faces_are_counted() {
    let on = CoatTriangle {
        corners: [
            Vec3::ZERO,
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.0, 1.0, 0.0),
        ],
        normals: [Vec3::new(0.0, 0.0, 1.0); 3],
        full: 200.0,
    };
    let view = CountView {
        right: Vec3::new(1.0, 0.0, 0.0),
        up: Vec3::UP,
        forward: Vec3::new(0.0, 0.0, -1.0),
        pixel_rad: 1e-3,
    };
    let at = |z: f32| Pose {
        place: Vec3::new(0.0, 0.0, z),
        ..Pose::IDENTITY
    };
    let count = |z, per_px, density| drawn_count(&on, at(z), &view, per_px, density);
    // Half a square metre at 10 m: 5000 pixels.
    assert!((count(-10.0, 0.01, 1.0) - 50.0).abs() < 0.01);
    assert_eq!(count(-10.0, 1.0, 1.0), 200.0);
    assert_eq!(count(-10.0, 1.0, 0.5), 100.0);
    assert_eq!(count(10.0, 1.0, 1.0), 0.0);
}

/// On the last plants of a prefix: they are small, and those before them do not change.
#[test]
fn a_prefix_stays() {
    let coat = ranges(8);
    for t in 0..50 {
        let rounding = coat.rounding(t);
        let mut last = 0;
        for step in 1..200 {
            let count = 0.25 * step as f32;
            let shown = places(count, rounding);
            assert!(shown >= last && shown <= last + 1);
            assert!((0..shown).all(|i| grown(count, rounding, i) > 0.0));
            assert_eq!(grown(count, rounding, shown), 0.0);
            last = shown;
        }
    }
}
