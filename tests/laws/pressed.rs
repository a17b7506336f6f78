//! Grass between a body and the ground: flat ground, slopes, and bodies that appear.

use sward::base::Vec3;
use sward::sim::measure;
use sward::sim::{Grass, Meadow, tick};

use super::{meadow, run, scene, touched};

/// A ball that stands 2 mm in the ground: with its skin it overlaps the ground in a disc of 30 mm.
const SUNK: &str = r#"(
    terrain: (ground: Flat(size_m: (2, 2))),
    grass: (density_per_m2: 4000),
    wind: (strength: 0, gust: 0, flutter: 0),
    bodies: [(name: "ball", shape: Ball(radius_m: 0.15), position_m: (0, 0.148, 0), motion: Fixed)],
)"#;

/// The nodes of touched plants, from the ball's foot, at least one segment from their root.
fn nodes_about_the_ball(meadow: &Meadow, grass: &Grass<f32>) -> Vec<[f64; 3]> {
    let plants = touched(meadow, grass).into_values();
    let ball = Vec3::of(meadow.bodies.links()[0].to.place.to_f64());
    plants
        .flat_map(|plant| {
            let [x, z] = plant.root_in_world();
            let root = plant.nodes[0].to_f64();
            let aside = Vec3::new(x - root[0], 0.0, z - root[2]);
            let nodes = plant.nodes.into_iter().skip(1);
            nodes.map(move |node| (aside + Vec3::of(node.to_f64()) - ball).to_f64())
        })
        .collect()
}

/// The same ball, led over the grass to where the other one stands.
const LED_SUNK: &str = r#"(
    terrain: (ground: Flat(size_m: (1.5, 1))),
    grass: (density_per_m2: 4000),
    wind: (strength: 0, gust: 0, flutter: 0),
    bodies: [(name: "ball", shape: Ball(radius_m: 0.15), motion: Path(waypoints: [
        (at_s: 0, position_m: (-0.5, 0.148, 0)), (at_s: 0.5, position_m: (0, 0.148, 0))]))],
)"#;

/// Sliding such nodes out along the ball's normal moves them a little aside in every round, until
/// they lie around the disc and none in it.
#[test]
fn what_is_pressed_onto_the_ground_stays() {
    let mut loaded = scene(LED_SUNK);
    let mut pressed = |rounds: [u32; 2]| {
        loaded.scene.solver.rounds = rounds;
        let (meadow, grass) = run::<f32>(&loaded, 72);
        let nodes = nodes_about_the_ball(&meadow, &grass);
        let in_disc = |n: &&[f64; 3]| n[0].hypot(n[2]) < 0.025 && n[1] < -0.1479;
        nodes.iter().filter(in_disc).count()
    };
    let (few, many) = (pressed([2, 2]), pressed([16, 16]));
    println!("{few} nodes in the disc after 2 rounds, {many} after 16");
    assert!(few > 10, "{few}");
    assert_eq!(few, many);
}

/// Which way a blade leaves a body that is suddenly around it would hang on millimetres; one that
/// comes from above presses it down.
#[test]
fn a_body_that_appears_is_let_down_on_the_grass() {
    let (meadow, grass) = run::<f32>(&scene(SUNK), 2);
    let nodes = nodes_about_the_ball(&meadow, &grass);
    let under = |n: &&[f64; 3]| n[0].hypot(n[2]) < 0.075;
    let over = |n: &&[f64; 3]| under(n) && n[1] > 0.0;
    let (under, over) = (
        nodes.iter().filter(under).count(),
        nodes.iter().filter(over).count(),
    );
    println!("{under} nodes within half the ball's radius, {over} of them over its middle");
    assert!(under > 20, "{under}");
    assert_eq!(over, 0);
}

/// Rolling ground with slopes of up to about 45°, and a ball that is sunk into it.
fn on_rolling_ground(bodies: &str) -> String {
    format!(
        "(
    terrain: (ground: Rolling(size_m: (24, 24), amplitude_m: 3, wavelength_m: 9, octaves: 1)),
    grass: (density_per_m2: 1000),
    wind: (strength: 0, gust: 0, flutter: 0),
    bodies: [{bodies}],
)"
    )
}

/// A ball's middle such that it stands `sunk_m` deep in ground that is `steep_deg` steep, or close to
/// it, and how steep it is there.
fn in_the_slope(meadow: &Meadow, steep_deg: f64, sunk_m: f64) -> ([f64; 3], f64) {
    let ground = &meadow.field.ground;
    let places = (0..40_000).map(|k| [k % 200, k / 200].map(|n| 0.1 * f64::from(n) - 10.0));
    let steep = |[x, z]: [f64; 2]| ground.normal_in_world(x, z)[1].acos().to_degrees();
    let off = |place: &[f64; 2]| (steep(*place) - steep_deg).abs();
    let [x, z] = places
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .expect("some places");
    let normal = ground.normal_in_world(x, z).map(|n| n * (0.15 - sunk_m));
    let foot = [x, ground.height_in_world(x, z), z];
    ([0, 1, 2].map(|a| foot[a] + normal[a]), steep([x, z]))
}

/// What lies between a ball and a slope does not slide out of there, and rests.
#[test]
fn what_is_pressed_onto_a_slope_rests() {
    let bare = meadow(&scene(&on_rolling_ground("")));
    for (steep_deg, sunk_m) in [(15.0, 0.02), (28.0, 0.02), (35.0, 0.03), (39.0, 0.03)] {
        let ([x, y, z], found_deg) = in_the_slope(&bare, steep_deg, sunk_m);
        assert!((found_deg - steep_deg).abs() < 1.0, "{found_deg}");
        let ball = format!(
            "(name: \"ball\", shape: Ball(radius_m: 0.15), position_m: ({x:?}, {y:?}, {z:?}), \
             collider: analytic, motion: Fixed)"
        );
        let (mut meadow, mut grass) = run::<f32>(&scene(&on_rolling_ground(&ball)), 240);
        let (mut largest_m, mut deepest_m) = (0.0_f64, 0.0_f64);
        let mut before = touched(&meadow, &grass);
        for _ in 0..15 {
            for _ in 0..4 {
                tick(&mut meadow, &mut grass).expect("a tick");
            }
            let now = touched(&meadow, &grass);
            for (root, plant) in &now {
                let old = before
                    .get(root)
                    .filter(|old| old.touched_at + 8 >= meadow.ticks);
                let pairs = old
                    .into_iter()
                    .flat_map(|old| old.nodes.iter().zip(&plant.nodes));
                for (&a, &b) in pairs {
                    largest_m = largest_m.max(f64::from((b - a).length()));
                }
            }
            deepest_m = deepest_m.max(measure::snapshot(&meadow, &grass).worst.depth_m);
            before = now;
        }
        println!("{found_deg:.1}°: {largest_m:.1e} m per frame, {deepest_m:.1e} m deep");
        assert!(before.len() > 50, "{}", before.len());
        // The limits of a ball at rest on flat ground.
        assert!(largest_m <= 1e-5, "{found_deg}°: {largest_m:e} m per frame");
        assert!(deepest_m <= 1e-4, "{found_deg}°: {deepest_m:e} m deep");
    }
}
