//! Every mistake that is planted must turn a law red which holds without it: a law that cannot
//! fail proves nothing.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]

use std::collections::BTreeMap;

use sward::scene::method::{Collide, Method, Recovery, Sampling};
use sward::scene::{LoadedScene, parse_scene};
use sward::sim::fault::{Fault, Planted};
use sward::sim::measure::{self, Standing};
use sward::sim::{Grass, Meadow, tick};

/// A ball on a path through calm grass, over the corner of four tiles.
const ROLL: &str = r#"(
    terrain: (ground: Flat(size_m: (6, 6))),
    wind: (strength: 0.0, gust: 0.0, flutter: 0.0),
    bodies: [(
        name: "ball", shape: Ball(radius_m: 0.15), position_m: (-1.0, 0.15, 0.02),
        motion: Path(waypoints: [
            (at_s: 0.0, position_m: (-1.0, 0.15, 0.02)),
            (at_s: 1.0, position_m: (1.0, 0.15, 0.02)),
        ]),
    )],
)"#;

/// What a law looks at: a meadow after a while, and the worst on the way there.
struct Seen {
    ticks: u32,
    /// By the bits of the root.
    plants: BTreeMap<[u64; 2], Standing<f32>>,
    depth_over_limit: f64,
    strain: f64,
}

fn scene(text: &str) -> LoadedScene {
    parse_scene("fault", text, &[]).expect("a valid scene")
}

fn run(loaded: &LoadedScene, fault: Option<Fault>, seconds: f64) -> Seen {
    let mut meadow = Meadow::new(loaded.scene.clone(), &loaded.assets).expect("a meadow");
    meadow.planted = fault.map_or(Planted::NONE, Planted::plant);
    let mut grass = Grass::<f32>::new();
    let (mut depth_over_limit, mut strain) = (0.0_f64, 0.0_f64);
    let ticks = (seconds / loaded.scene.solver.substep_s).round() as u32;
    for _ in 0..ticks {
        tick(&mut meadow, &mut grass).expect("a tick");
        let now = measure::snapshot(&meadow, &grass);
        depth_over_limit = depth_over_limit.max(now.worst.depth_m / now.worst.limit_m);
        strain = strain.max(now.max_strain);
    }
    let standing = meadow
        .work
        .tiles
        .iter()
        .filter_map(|tile| Some(measure::standing(&meadow, tile, grass.slab(tile.slab)?)))
        .flatten()
        .filter(|plant| plant.touched_at > 0);
    Seen {
        ticks,
        plants: standing
            .map(|plant| (plant.root_in_world().map(f64::to_bits), plant))
            .collect(),
        depth_over_limit,
        strain,
    }
}

/// Largest distance between the nodes of plants in both, and how many plants only one has.
fn apart(a: &Seen, b: &Seen) -> (f64, usize) {
    let far = |(root, plant): (&[u64; 2], &Standing<f32>)| {
        let other = b.plants.get(root)?;
        let pairs = plant.nodes.iter().zip(&other.nodes);
        let distances = pairs.map(|(x, y)| f64::from((*x - *y).length()));
        distances.reduce(f64::max)
    };
    let both: Vec<f64> = a.plants.iter().filter_map(far).collect();
    let missing = a.plants.len() + b.plants.len() - 2 * both.len();
    (both.into_iter().fold(0.0, f64::max), missing)
}

#[test]
fn springs_last_leave_nodes_inside() {
    let loaded = scene(ROLL);
    assert!(run(&loaded, None, 1.0).depth_over_limit <= 1.0);
    let faulty = run(&loaded, Some(Fault::SpringsLast), 1.0);
    assert!(
        faulty.depth_over_limit > 1.0 || faulty.strain > 0.02,
        "{} of the limit, strain {}",
        faulty.depth_over_limit,
        faulty.strain
    );
}

#[test]
fn a_wrong_root_weight_stretches_blades() {
    let mut loaded = scene(ROLL);
    // Springs that pull hard enough on the root for lengths not to hide it.
    loaded.scene.solver.spring_rate_per_s = 60.0;
    assert!(run(&loaded, None, 1.0).strain <= 0.02);
    let strain = run(&loaded, Some(Fault::RootWeight), 1.0).strain;
    assert!(strain > 0.02, "{strain}");
}

#[test]
fn a_timer_per_tile_depends_on_the_tile() {
    let with_tile = |tile_m: f32, fault| {
        let mut loaded = scene(ROLL);
        loaded.scene.solver.tile_m = tile_m;
        run(&loaded, fault, 1.2)
    };
    let right = apart(&with_tile(1.0, None), &with_tile(0.5, None));
    assert_eq!(right, (0.0, 0));
    let (far_m, _) = apart(
        &with_tile(1.0, Some(Fault::TimerPerTile)),
        &with_tile(0.5, Some(Fault::TimerPerTile)),
    );
    assert!(far_m > 1e-3, "{far_m} m");
}

#[test]
fn world_coordinates_in_f32_err_far_away() {
    let at = |x_m: f64, fault| {
        let mut loaded = scene(ROLL);
        loaded.scene.terrain.centre_m = [x_m, 0.0];
        for body in &mut loaded.scene.bodies {
            let sward::scene::Motion::Path { waypoints, .. } = &mut body.motion else {
                panic!("the ball is on a path");
            };
            body.position_m[0] += x_m;
            for waypoint in waypoints {
                waypoint.position_m[0] += x_m;
            }
        }
        let mut seen = run(&loaded, fault, 0.8);
        let plants = std::mem::take(&mut seen.plants).into_values();
        seen.plants = plants
            .map(|plant| {
                let [x, z] = plant.root_in_world();
                // Roots agree to a hundredth of a millimetre: a float's step at 100 km is 1e-11 m.
                let key = [x - x_m, z].map(|v| (v * 1e5).round() as i64 as u64);
                (key, plant)
            })
            .collect();
        seen
    };
    const FAR_M: f64 = 100_000.0;
    // Nodes are relative to cells, so they are compared from their roots.
    let from_root = |mut seen: Seen| {
        for plant in seen.plants.values_mut() {
            let root = plant.nodes[0];
            for node in &mut plant.nodes {
                *node -= root;
            }
        }
        seen
    };
    let far_m = |fault| {
        let (near, far) = (from_root(at(0.0, fault)), from_root(at(FAR_M, fault)));
        assert!(near.plants.len() > 50, "{} plants", near.plants.len());
        apart(&near, &far)
    };
    let (right, missing) = far_m(None);
    assert!(
        right <= 1e-5 && missing == 0,
        "{right} m, {missing} missing"
    );
    let (wrong, missing) = far_m(Some(Fault::WorldCoordinatesInF32));
    assert!(wrong > 1e-5 || missing > 0, "{wrong} m");
}

#[test]
fn weights_upon_the_blended_pose_depend_on_the_rate() {
    let at_rate = |hz: f64, recovery| {
        let mut loaded = scene(ROLL);
        loaded.scene.solver.substep_s = 1.0 / hz;
        loaded.scene.solver.method.recovery = recovery;
        let seen = run(&loaded, None, 1.0);
        let let_go = seen.plants.values().filter(|p| p.touched_at < seen.ticks);
        let offsets: Vec<f64> = let_go.map(Standing::offset_m).collect();
        offsets.iter().sum::<f64>() / offsets.len().max(1) as f64
    };
    let apart = |recovery| {
        let (slow, fast) = (at_rate(60.0, recovery), at_rate(240.0, recovery));
        (slow - fast).abs() / fast
    };
    let (right, wrong) = (apart(Recovery::Lengths), apart(Recovery::Literal));
    // The rate changes the contact itself by some per cent.
    assert!(right < 0.1, "{right}");
    assert!(wrong > 0.3, "{wrong}");
}

#[test]
fn without_sweeps_a_fast_ball_misses_blades() {
    let share = |sweep_share: f64| {
        let text = ROLL.replace("at_s: 1.0", "at_s: 0.02");
        let mut loaded = scene(&text);
        loaded.scene.solver.method.sweep_share = sweep_share;
        run(&loaded, None, 0.05).plants.len() as f64
    };
    let (all, missed) = (share(Method::default().sweep_share), share(1e6));
    assert!(all > 50.0, "{all}");
    assert!(missed < 0.9 * all, "{missed} of {all}");
}

#[test]
fn nearest_texels_leave_nodes_inside() {
    let deepest = |sampling| {
        let mut loaded = scene(ROLL);
        loaded.scene.solver.method.collide = Collide::Cube;
        loaded.scene.solver.method.sampling = sampling;
        loaded.scene.solver.cube_resolution = 16;
        run(&loaded, None, 1.0).depth_over_limit
    };
    let (masked, nearest) = (deepest(Sampling::Masked), deepest(Sampling::Nearest));
    println!("deepest over a texel: masked {masked}, nearest {nearest}");
    assert!(nearest > 2.0 * masked, "masked {masked}, nearest {nearest}");
}
