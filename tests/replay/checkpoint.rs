//! Checkpoints and the state hash on whole scenes of the cpu engine.

use sward::run::Engine;
use sward::scene::{Action, LoadedScene, parse_scene, parse_value};
use sward::sim::{Checkpoint, Grass, Meadow, StateHash, tick};

/// A vehicle drives through balls and a pile of boxes while the script goes on and the wind turns.
const BUSY: &str = r#"(
    duration_s: 3.0,
    terrain: (ground: Rolling(size_m: (10, 10), amplitude_m: 0.1, wavelength_m: 7.0)),
    wind: (strength: 0.1, gust: 0.1),
    grass: (density_per_m2: 64),
    solver: (recovery_s: 0.6),
    bodies: [
        (name: "car", shape: Vehicle(chassis_m: (0.6, 0.3, 1.1), wheel_radius_m: 0.18,
         wheel_width_m: 0.12), position_m: (0, 0.5, -2.5), above_ground: true,
         mass: Kilograms(120)),
        (name: "ball", shape: Ball(radius_m: 0.15), position_m: (-1.5, 0.16, 0.0),
         above_ground: true, motion: Thrown(velocity_m_per_s: (2.0, 0.0, 0.0))),
        (name: "low", shape: Box(size_m: (0.5, 0.3, 0.4)), position_m: (0.1, 0.2, -0.6),
         above_ground: true),
        (name: "high", shape: Box(size_m: (0.3, 0.3, 0.3)), position_m: (0.15, 0.6, -0.5),
         above_ground: true),
        (name: "sweep", shape: Capsule(radius_m: 0.05, length_m: 0.6), above_ground: true,
         motion: Path(repeat: true, waypoints: [(at_s: 0, position_m: (1.5, 0.3, 1)),
         (at_s: 1, position_m: (2.5, 0.3, 1.5)), (at_s: 2, position_m: (1.5, 0.3, 1))])),
    ],
    script: [
        (at_s: 0.1, action: Drive(body: "car", engine_n: 500)),
        (at_s: 0.9, action: SetWind(strength: 0.3, direction_deg: 120)),
        (at_s: 1.3, action: Spawn(name: "late", shape: Cylinder(radius_m: 0.2, height_m: 0.3),
         position_m: (-1, 1.0, 1))),
        (at_s: 1.6, action: Remove(body: "ball")),
        (at_s: 1.8, action: Impulse(body: "high", impulse_kg_m_per_s: (3, 20, 0))),
    ],
)"#;

/// Contacts of cars and boxes, the wind half way between two, three events still to come.
const SAVED_AT: u32 = 150;
const END: u32 = 280;

fn busy() -> LoadedScene {
    parse_scene("busy", BUSY, &[]).expect("a valid scene")
}

fn meadow(loaded: &LoadedScene) -> Meadow {
    Meadow::new(loaded.scene.clone(), &loaded.assets).expect("a meadow")
}

/// The hash after each tick up to `end`.
fn run_on(meadow: &mut Meadow, grass: &mut Grass<f32>, end: u32) -> Vec<u64> {
    let mut hashes = Vec::new();
    while meadow.ticks < end {
        tick(meadow, grass).expect("a tick");
        grass.chain_hash(meadow);
        hashes.push(grass.state_hash.value());
    }
    hashes
}

fn run_whole(loaded: &LoadedScene, end: u32) -> Vec<u64> {
    run_on(&mut meadow(loaded), &mut Grass::new(), end)
}

#[test]
fn a_restored_collision_goes_on_with_the_same_bits() {
    let loaded = busy();
    let whole = run_whole(&loaded, END);
    let (mut meadow, mut grass) = (meadow(&loaded), Grass::new());
    run_on(&mut meadow, &mut grass, SAVED_AT);
    let saved = Checkpoint::save(&meadow, &grass);
    assert!(grass.pushed > 20, "only {} plants are pushed", grass.pushed);
    assert_eq!(saved.own_slab_bytes(), 0, "slabs are shared at first");
    let rest = &whole[SAVED_AT as usize..];
    assert_eq!(run_on(&mut meadow, &mut grass, END), rest, "saving");
    assert!(saved.own_slab_bytes() > 0, "contacts have written since");
    for round in 0..2 {
        saved.restore(&mut meadow, &mut grass);
        assert_eq!(meadow.ticks, SAVED_AT);
        let again = run_on(&mut meadow, &mut grass, END);
        let differs = again.iter().zip(rest).position(|(a, b)| a != b);
        assert_eq!(differs, None, "round {round}: ticks after the checkpoint");
    }
}

#[test]
fn a_restored_past_can_take_another_way() {
    let loaded = busy();
    let act = |meadow: &mut Meadow| {
        let spawn = r#"(name: "other", shape: Capsule(radius_m: 0.1, length_m: 0.3),
            position_m: (-0.4, 0.6, 0.2))"#;
        let body: sward::scene::Body = parse_value("other", spawn).expect("a body");
        meadow
            .act(&Action::Spawn(Box::new(body)))
            .expect("a free name");
        let remove = Action::Remove { body: "low".into() };
        meadow.act(&remove).expect("the body is there");
    };
    // The other way in one go, by a meadow that never knew the shape of `late`.
    let other = {
        let (mut meadow, mut grass) = (meadow(&loaded), Grass::new());
        run_on(&mut meadow, &mut grass, SAVED_AT);
        act(&mut meadow);
        run_on(&mut meadow, &mut grass, END)
    };
    let (mut meadow, mut grass) = (meadow(&loaded), Grass::new());
    run_on(&mut meadow, &mut grass, SAVED_AT);
    let saved = Checkpoint::save(&meadow, &grass);
    let first = run_on(&mut meadow, &mut grass, END);
    saved.restore(&mut meadow, &mut grass);
    act(&mut meadow);
    let second = run_on(&mut meadow, &mut grass, END);
    assert_ne!(first, second);
    let differs = second.iter().zip(&other).position(|(a, b)| a != b);
    assert_eq!(differs, None, "ticks after the checkpoint");
    // And back to the first way from its end.
    let late = Checkpoint::save(&meadow, &grass);
    saved.restore(&mut meadow, &mut grass);
    assert_eq!(run_on(&mut meadow, &mut grass, END), first);
    late.restore(&mut meadow, &mut grass);
    assert_eq!(meadow.ticks, END);
    assert_eq!(Some(&grass.state_hash.value()), second.last());
}

#[test]
fn the_hash_knows_no_threads_tiles_or_order() {
    let whole = run_whole(&busy(), END);
    for threads in [1, 2, 3, 7] {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = builder.build().expect("a pool of threads");
        assert_eq!(
            pool.install(|| run_whole(&busy(), END)),
            whole,
            "{threads} threads"
        );
    }
    let mut reversed = busy();
    reversed.scene.bodies.reverse();
    assert_eq!(run_whole(&reversed, END), whole, "bodies reversed");
    for tile_m in [0.5, 2.0] {
        let mut tiled = busy();
        tiled.scene.solver.tile_m = tile_m;
        let tiled = run_whole(&tiled, END);
        let differs = tiled.iter().zip(&whole).position(|(a, b)| a != b);
        assert_eq!(differs, None, "tiles of {tile_m} m");
    }
}

#[test]
fn the_hash_notes_the_smallest_change() {
    let loaded = busy();
    let whole = run_whole(&loaded, 40);
    let mut pushed = busy();
    let ball = pushed.scene.bodies.iter_mut().find(|b| b.name == "ball");
    let place = &mut ball.expect("the ball").position_m[0];
    *place = f64::from((*place as f32).next_up());
    assert_ne!(run_whole(&pushed, 40)[0], whole[0]);
    // The chain never comes back: a later tick keeps what an earlier one was.
    let mut engine = Engine::cpu();
    assert_eq!(engine.state_hash(), Some(StateHash::default().value()));
    engine.tick(&mut meadow(&loaded)).expect("a tick");
    assert_eq!(engine.state_hash(), Some(whole[0]));
}
