//! Laws of the cpu engine, on whole scenes: what must hold whatever the scene looks like.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]

mod analytic;
mod billboards;
mod bounds;
mod convergence;
mod pressed;
mod shoved;

use std::collections::BTreeMap;

use sward::base::{Real, Vec3};
use sward::run::Timeline;
use sward::scene::{LoadedScene, parse_scene};
use sward::sim::contact::ON_SURFACE_M;
use sward::sim::measure::{self, Standing};
use sward::sim::state_hash::state_hash;
use sward::sim::{Grass, Meadow, tick};

/// A ball rolls over four tiles' common corner while a box falls beside it.
const ROLL: &str = r#"(
    duration_s: 2.0,
    terrain: (ground: Rolling(size_m: (8, 6), amplitude_m: 0.1, wavelength_m: 7.0)),
    wind: (strength: 0.1, gust: 0.1),
    bodies: [
        (name: "ball", shape: Ball(radius_m: 0.15), position_m: (-1.5, 0.16, 0.0),
         above_ground: true, motion: Thrown(velocity_m_per_s: (2.0, 0.0, 0.0))),
        (name: "box", shape: Box(size_m: (0.5, 0.3, 0.4)), position_m: (1.2, 0.7, 0.9),
         above_ground: true),
    ],
)"#;

fn scene(text: &str) -> LoadedScene {
    parse_scene("law", text, &[]).expect("a valid scene")
}

fn meadow(loaded: &LoadedScene) -> Meadow {
    Meadow::new(loaded.scene.clone(), &loaded.assets).expect("a meadow")
}

fn run<R: Real>(loaded: &LoadedScene, ticks: u32) -> (Meadow, Grass<R>) {
    let mut meadow = meadow(loaded);
    let mut grass = Grass::new();
    for _ in 0..ticks {
        tick(&mut meadow, &mut grass).expect("a tick");
    }
    (meadow, grass)
}

fn hash_after(loaded: &LoadedScene, ticks: u32) -> u64 {
    let (meadow, grass) = run::<f32>(loaded, ticks);
    assert!(!meadow.tiles.is_empty(), "an empty state proves nothing");
    state_hash(&meadow, &grass)
}

/// Every touched plant by the bits of its root.
fn touched<R: Real>(meadow: &Meadow, grass: &Grass<R>) -> BTreeMap<[u64; 2], Standing<R>> {
    let tiles = meadow.work.tiles.iter();
    tiles
        .filter_map(|tile| Some(measure::standing(meadow, tile, grass.slab(tile.slab)?)))
        .flatten()
        .filter(|plant| plant.touched_at > 0)
        .map(|plant| (plant.root_in_world().map(f64::to_bits), plant))
        .collect()
}

#[test]
fn every_frame_rate_leaves_the_same_bits() {
    let loaded = scene(ROLL);
    let at_rate = |hz: f64| {
        let (mut meadow, mut grass) = (meadow(&loaded), Grass::<f32>::new());
        let mut timeline = Timeline::unlimited(loaded.scene.solver.substep_s);
        for _ in 0..(1.2 * hz) as u32 {
            for _ in 0..timeline.advance(1.0 / hz) {
                tick(&mut meadow, &mut grass).expect("a tick");
            }
        }
        state_hash(&meadow, &grass)
    };
    let at_60 = at_rate(60.0);
    for hz in [15.0, 30.0, 120.0, 1000.0] {
        assert_eq!(at_rate(hz), at_60, "{hz} Hz");
    }
}

#[test]
fn tile_size_changes_no_plant() {
    let with_tile = |tile_m: f32| {
        let mut loaded = scene(ROLL);
        loaded.scene.solver.tile_m = tile_m;
        let (meadow, grass) = run::<f32>(&loaded, 130);
        touched(&meadow, &grass)
    };
    let whole = with_tile(1.0);
    assert!(whole.len() > 200, "{} plants", whole.len());
    for tile_m in [0.5, 2.0] {
        let sharded = with_tile(tile_m);
        assert!(
            sharded.keys().eq(whole.keys()),
            "{tile_m} m: other plants touched"
        );
        for (root, plant) in &sharded {
            assert_eq!(plant.nodes, whole[root].nodes, "{tile_m} m, {root:?}");
        }
    }
}

#[test]
fn order_of_bodies_and_number_of_threads_change_nothing() {
    let loaded = scene(ROLL);
    let whole = hash_after(&loaded, 130);
    let mut reversed = scene(ROLL);
    reversed.scene.bodies.reverse();
    assert_eq!(hash_after(&reversed, 130), whole, "bodies reversed");
    for threads in [1, 2, 3, 7] {
        let pool = rayon_pool(threads);
        let hash = pool.install(|| hash_after(&loaded, 130));
        assert_eq!(hash, whole, "{threads} threads");
    }
}

fn rayon_pool(threads: usize) -> rayon::ThreadPool {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
    builder.build().expect("a pool of threads")
}

#[test]
fn a_removed_body_leaves_nothing_after_the_recovery() {
    let mut loaded = scene(ROLL);
    loaded.scene.solver.recovery_s = 0.5;
    let (mut meadow, mut grass) = run::<f32>(&loaded, 100);
    for name in ["ball", "box"] {
        let action = sward::scene::Action::Remove { body: name.into() };
        meadow.act(&action).expect("the body is there");
    }
    assert!(meadow.state_bytes() > 0);
    for _ in 0..60 {
        tick(&mut meadow, &mut grass).expect("a tick");
    }
    for plant in touched(&meadow, &grass).values() {
        assert_eq!(plant.nodes, plant.wind, "the wind pose, bit for bit");
    }
    for _ in 0..2 {
        tick(&mut meadow, &mut grass).expect("a tick");
    }
    assert_eq!((meadow.tiles.len(), meadow.state_bytes()), (0, 0));
    assert!(
        (0..64).all(|slab| grass.slab(slab).is_none()),
        "slabs are given back"
    );
}

#[test]
fn a_teleport_touches_nothing_on_its_way() {
    let text = r#"(
        terrain: (ground: Flat(size_m: (60, 6))),
        wind: (strength: 0.0, gust: 0.0, flutter: 0.0),
        bodies: [(name: "ball", shape: Ball(radius_m: 0.15), position_m: (-25.0, 0.15, 0.0))],
        script: [(at_s: 0.5, action: Teleport(body: "ball", position_m: (25.0, 0.15, 0.0)))],
    )"#;
    let (meadow, grass) = run::<f32>(&scene(text), 90);
    let touched = touched(&meadow, &grass);
    let places: Vec<f64> = touched.values().map(|p| p.root_in_world()[0]).collect();
    assert!(places.iter().any(|x| *x < -24.0) && places.iter().any(|x| *x > 24.0));
    assert!(places.iter().all(|x| x.abs() > 24.0), "{places:?}");
}

#[test]
fn nothing_is_left_inside_and_nothing_is_stretched() {
    for collider in ["cube", "analytic"] {
        let loaded = scene(&ROLL.replace("(name:", &format!("(collider: {collider}, name:")));
        let (mut meadow, mut grass) = (meadow(&loaded), Grass::<f32>::new());
        for _ in 0..150 {
            tick(&mut meadow, &mut grass).expect("a tick");
            let now = measure::snapshot(&meadow, &grass);
            let worst = now.worst;
            assert!(worst.depth_m <= worst.limit_m, "{collider}: {worst:?}");
            assert!(now.max_strain <= 0.02, "{collider}: {}", now.max_strain);
            // A closed form sees whatever is deeper than a rounding; the silhouettes of a cube are
            // known to a texel.
            let unseen_m = if collider == "cube" {
                TEXEL_M
            } else {
                f64::from(ON_SURFACE_M)
            };
            let missed_m = now.missed_m;
            assert!(missed_m <= unseen_m, "{collider}: {missed_m} m");
            assert_eq!(now.not_finite, 0);
        }
    }
}

/// Of the depth cube of the larger body of [`ROLL`], in metres: 64 over 0.502 m.
const TEXEL_M: f64 = 0.502 / 64.0;

/// What single precision costs in a scene: the kernels in f32 beside f64 on the same bodies.
#[derive(Default)]
struct Cost {
    squares: f64,
    nodes: u32,
    plants: usize,
    /// Plants that are touched in one float only, or went another way.
    strayed: usize,
}

/// A plant went another way where a node stands farther from its twin's than this, ten times the limit:
/// where a blade folds or slips off, less than rounding may decide which way. Such plants are counted.
const STRAYED_M: f64 = 1e-3;

impl Cost {
    fn of(loaded: &LoadedScene, ticks: u32) -> Self {
        let (m32, g32) = run::<f32>(loaded, ticks);
        let (m64, g64) = run::<f64>(loaded, ticks);
        let (single, double) = (touched(&m32, &g32), touched(&m64, &g64));
        let mut cost = Self {
            plants: double.len(),
            ..Self::default()
        };
        for (root, plant) in &double {
            let nodes = single
                .get(root)
                .map(|other| other.nodes.iter().zip(&plant.nodes));
            let off =
                |(&a, &b): (&Vec3<f32>, &Vec3<f64>)| (Vec3::<f64>::of(a.to_f64()) - b).length();
            let off: Option<Vec<f64>> = nodes.map(|nodes| nodes.map(off).collect());
            match off {
                Some(off) if off.iter().all(|&d| d <= STRAYED_M) => {
                    cost.squares += off.iter().map(|d| d * d).sum::<f64>();
                    cost.nodes += off.len() as u32;
                }
                _ => cost.strayed += 1,
            }
        }
        cost
    }

    fn rms_m(&self) -> f64 {
        (self.squares / f64::from(self.nodes.max(1))).sqrt()
    }
}

/// What single precision may cost in a contact: metres, root mean square, and the share of the touched
/// plants that may go another way.
struct Allowed {
    body: &'static str,
    collider: &'static str,
    ground: &'static str,
    rms_m: f64,
    strayed: f64,
}

/// A tenth of a millimetre is the limit between engines too.
const fn precise(body: &'static str, collider: &'static str, ground: &'static str) -> Allowed {
    Allowed {
        body,
        collider,
        ground,
        rms_m: 1e-4,
        strayed: 0.01,
    }
}

/// For the box that falls flat.
const fn pressed(collider: &'static str) -> Allowed {
    Allowed {
        strayed: 4.5 / 72.0,
        ..precise("box", collider, FLAT)
    }
}

/// A ball rolls, a capsule is led along and turned, a box falls: on flat and on rolling ground, met by
/// their depth cubes and by their closed forms.
///
/// Flat under a box lie blades that were pressed down head on: there less than rounding decides which way
/// a blade gives: three plants of 72 go another way there, by 1 to 29 mm, and the others are 0.07 mm apart.
/// One of 134 does under the stick's cube on rolling ground, by 3.4 mm; all others are within 0.2 mm.
#[test]
fn single_precision_stays_within_a_tenth_of_a_millimetre() {
    let mut over = Vec::new();
    for allowed in [
        precise("ball", "cube", FLAT),
        precise("ball", "analytic", FLAT),
        precise("ball", "analytic", ROLLING),
        precise("stick", "cube", FLAT),
        precise("stick", "analytic", FLAT),
        precise("stick", "cube", ROLLING),
        precise("stick", "analytic", ROLLING),
        precise("ball", "cube", ROLLING),
        pressed("cube"),
        pressed("analytic"),
    ] {
        let Allowed {
            body,
            collider,
            ground,
            ..
        } = allowed;
        let text = PRECISE
            .replace("GROUND", ground)
            .replace("COLLIDER", collider);
        let mut loaded = scene(&text);
        loaded.scene.bodies.retain(|b| b.name == body);
        let cost = Cost::of(&loaded, 130);
        let what = format!(
            "{body} by {collider} on {ground}: rms {:.1e} m over {} nodes, {} of {} plants strayed",
            cost.rms_m(),
            cost.nodes,
            cost.strayed,
            cost.plants
        );
        println!("{what}");
        let strayed = cost.strayed as f64 / cost.plants.max(1) as f64;
        if cost.nodes < 400 || cost.rms_m() > allowed.rms_m || strayed > allowed.strayed {
            over.push(what);
        }
    }
    assert!(over.is_empty(), "{over:#?}");
}

const FLAT: &str = "Flat(size_m: (8, 6))";
const ROLLING: &str = "Rolling(size_m: (8, 6), amplitude_m: 0.1, wavelength_m: 7.0)";

/// Three bodies that meet grass in three ways.
const PRECISE: &str = r#"(
    duration_s: 2.0,
    terrain: (ground: GROUND),
    wind: (strength: 0.1, gust: 0.1),
    bodies: [
        (name: "ball", shape: Ball(radius_m: 0.15), position_m: (-1.5, 0.16, 0.0), collider: COLLIDER,
         above_ground: true, motion: Thrown(velocity_m_per_s: (2.0, 0.0, 0.0))),
        (name: "stick", shape: Capsule(radius_m: 0.08, length_m: 0.6), collider: COLLIDER,
         above_ground: true, motion: Path(waypoints: [(at_s: 0, position_m: (-1.5, 0.3, -1)),
         (at_s: 1.2, position_m: (0.5, 0.2, -1), rotation_deg: (0, 60, 80))])),
        (name: "box", shape: Box(size_m: (0.5, 0.3, 0.4)), position_m: (1.2, 0.7, 0.9),
         above_ground: true, collider: COLLIDER),
    ],
)"#;
