//! Laws of billboards in the engines on the processor.

use std::collections::BTreeMap;

use super::*;
use sward::run::Engine;
use sward::scene::{Action, Event};
use sward::sim::measure::StandingBillboard;
use sward::sim::work::TileWork;

/// A ball rolls through a meadow of billboards alone.
const BOARDS: &str = r#"(
    duration_s: 2.0,
    terrain: (ground: Rolling(size_m: (8, 6), amplitude_m: 0.1, wavelength_m: 7.0)),
    grass: (species: []),
    billboards: (density_per_m2: 80),
    wind: (strength: 0.1, gust: 0.1),
    solver: (recovery_s: 0.5),
    bodies: [
        (name: "ball", shape: Ball(radius_m: 0.15), position_m: (-1.5, 0.16, 0.0),
         above_ground: true, motion: Thrown(velocity_m_per_s: (2.0, 0.0, 0.0))),
        (name: "box", shape: Box(size_m: (0.5, 0.3, 0.4)), position_m: (1.2, 0.7, 0.9),
         above_ground: true),
    ],
)"#;

type Boards = BTreeMap<[u64; 3], StandingBillboard<f64>>;

/// Every billboard of the active tiles by the bits of its root and edge.
fn boards<R: Real>(meadow: &Meadow, grass: &Grass<R>) -> Boards {
    let of_tile = |tile: &TileWork| {
        let slab = grass.billboards().slab(tile.slab)?;
        Some(measure::standing_billboards(meadow, tile, slab))
    };
    let all = meadow.work.tiles.iter().filter_map(of_tile).flatten();
    all.map(|board| (key(&board), board.widened())).collect()
}

fn key<R: Real>(board: &StandingBillboard<R>) -> [u64; 3] {
    let [x, z] = board.root_in_world().map(f64::to_bits);
    [x, z, f64::from(board.billboard.across[0]).to_bits()]
}

#[test]
fn untouched_and_recovered_billboards_are_their_quad_bit_for_bit() {
    let mut loaded = scene(BOARDS);
    loaded.scene.script.push(Event {
        at_s: 0.5,
        action: Action::Remove {
            body: "ball".into(),
        },
    });
    let (mut meadow, mut grass) = (meadow(&loaded), Grass::<f32>::new());
    let (mut untouched, mut recovered, mut bent) = (0, 0, 0);
    for _ in 0..132 {
        tick(&mut meadow, &mut grass).expect("a tick");
        for board in boards(&meadow, &grass).values() {
            let age = meadow.work.now - board.touched_at;
            let is_back = board.touched_at != 0 && age >= meadow.recovery_ticks();
            if board.touched_at == 0 || is_back {
                assert_eq!(board.nodes, board.wind);
                assert_eq!(board.corners(), board.quad);
                recovered += u32::from(is_back);
                untouched += u32::from(!is_back);
            } else {
                bent += u32::from(board.nodes != board.wind);
            }
        }
    }
    println!("{untouched} untouched, {recovered} recovered, {bent} bent");
    assert!(untouched > 1000 && recovered > 20 && bent > 1000);
}

#[test]
fn tile_size_changes_no_billboard() {
    let with_tile = |tile_m: f32| {
        let mut loaded = scene(BOARDS);
        loaded.scene.solver.tile_m = tile_m;
        // Nothing has recovered by then, so that no tile has forgotten what another still knows.
        loaded.scene.solver.recovery_s = 2.0;
        let (meadow, grass) = run::<f32>(&loaded, 100);
        let mut all = boards(&meadow, &grass);
        all.retain(|_, board| board.touched_at > 0);
        all
    };
    let whole = with_tile(1.0);
    assert!(whole.len() > 40, "{} billboards", whole.len());
    for tile_m in [0.5, 2.0] {
        let sharded = with_tile(tile_m);
        let missing = whole.keys().filter(|key| !sharded.contains_key(*key));
        assert_eq!(missing.count(), 0, "{tile_m} m: billboards missing");
        assert_eq!(sharded.len(), whole.len(), "{tile_m} m");
        for (root, board) in &sharded {
            assert_eq!(board.nodes, whole[root].nodes, "{tile_m} m, {root:?}");
        }
    }
}

#[test]
fn order_of_bodies_and_number_of_threads_change_no_billboard() {
    let loaded = scene(BOARDS);
    let whole = hash_after(&loaded, 100);
    let mut reversed = scene(BOARDS);
    reversed.scene.bodies.reverse();
    assert_eq!(hash_after(&reversed, 100), whole, "bodies reversed");
    for threads in [1, 2, 3, 7] {
        let hash = rayon_pool(threads).install(|| hash_after(&loaded, 100));
        assert_eq!(hash, whole, "{threads} threads");
    }
}

#[test]
fn the_state_hash_takes_in_billboards() {
    let one = scene(BOARDS);
    let mut other = scene(BOARDS);
    let billboards = other.scene.billboards.as_mut().expect("the scene has some");
    billboards.nodes = [5, 3];
    assert_ne!(hash_after(&one, 100), hash_after(&other, 100));
}

#[test]
fn nothing_of_the_refined_form_is_left_after_the_recovery() {
    let (mut meadow, mut grass) = run::<f32>(&scene(BOARDS), 100);
    for name in ["ball", "box"] {
        let action = Action::Remove { body: name.into() };
        meadow.act(&action).expect("the body is there");
    }
    assert!(meadow.state_bytes() > 0 && grass.billboards().bytes() > 0);
    assert!(meadow.counters.plants_peak > 0);
    // One for the removal, and one in which the last tile has been seen at rest.
    for _ in 0..meadow.recovery_ticks() + 2 {
        tick(&mut meadow, &mut grass).expect("a tick");
    }
    assert_eq!((meadow.tiles.len(), meadow.state_bytes()), (0, 0));
    assert_eq!(grass.billboards().bytes(), 0);
}

#[test]
fn a_checkpoint_goes_on_with_the_same_bits() {
    let (mut meadow, mut grass) = run::<f32>(&scene(BOARDS), 60);
    let kept = sward::sim::Checkpoint::save(&meadow, &grass);
    let mut later = || {
        for _ in 0..40 {
            tick(&mut meadow, &mut grass).expect("a tick");
        }
        let hash = state_hash(&meadow, &grass);
        kept.restore(&mut meadow, &mut grass);
        hash
    };
    assert_eq!(later(), later());
}

/// Clumps that reach no farther than blades, so that bodies are let down onto both from the same height.
#[test]
fn blades_do_not_feel_billboards() {
    let small =
        "billboards: (density_per_m2: 30, clumps: [(height_m: (0.1, 0.2), width_m: (0.2, 0.3))]),";
    let mixed = BOARDS
        .replace("grass: (species: []),", "")
        .replace("billboards: (density_per_m2: 80),", small);
    let blades_only = mixed.replace(small, "");
    let (meadow, grass) = run::<f32>(&scene(&mixed), 60);
    let (alone, alone_grass) = run::<f32>(&scene(&blades_only), 60);
    assert_eq!(meadow.field.farthest_m(), alone.field.farthest_m());
    assert!(boards(&meadow, &grass).values().any(|b| b.touched_at > 0));
    let (ours, theirs) = (touched(&meadow, &grass), touched(&alone, &alone_grass));
    assert!(ours.len() > 100 && ours.keys().eq(theirs.keys()));
    for (root, plant) in &ours {
        assert_eq!(plant.nodes, theirs[root].nodes);
    }
}

/// What an engine has of a scene at a time, and the strain of all that were pressed on the way, in order.
fn pressed_until(loaded: &LoadedScene, engine: Which, time_s: f64) -> (Boards, Vec<f64>) {
    let mut meadow = meadow(loaded);
    let mut engine = match engine {
        Which::Cpu => Engine::cpu(),
        Which::Reference => Engine::reference(&mut meadow),
    };
    let (mut standing, mut strains) = (Vec::new(), Vec::new());
    while meadow.time_s() + 1e-9 < time_s {
        engine.tick(&mut meadow).expect("a tick");
        let tiles = meadow.work.tiles.iter();
        standing = tiles
            .flat_map(|tile| {
                engine
                    .standing_billboards(&meadow, tile)
                    .expect("on the processor")
            })
            .collect();
        let weave = meadow.weave.as_ref().expect("billboards");
        let pressed = standing.iter().filter(|b| b.touched_at == meadow.work.now);
        strains.extend(pressed.map(|board| board.strain(weave)));
    }
    strains.sort_by(f64::total_cmp);
    let standing = standing.into_iter().map(|board| (key(&board), board));
    (standing.collect(), strains)
}

enum Which {
    Cpu,
    Reference,
}

/// Where a body presses a sheet, its rows and diagonals give by what the exact bodies and fine steps of the
/// reference say, and by what the solver may leave at most. Of the few that are folded up, no more is asked.
#[test]
fn billboards_are_strained_as_in_the_reference() {
    let loaded = scene(BOARDS);
    let at = |strains: &[f64], share: f64| strains[((strains.len() - 1) as f64 * share) as usize];
    let [ours, theirs] = [Which::Cpu, Which::Reference].map(|engine| {
        let strains = pressed_until(&loaded, engine, 0.9).1;
        assert!(strains.len() > 500, "{} pressed", strains.len());
        [0.5, 0.9, 0.95].map(|share| at(&strains, share))
    });
    println!("strain of 50, 90 and 95% at most: {ours:.4?}, in the reference {theirs:.4?}");
    let left = f64::from(loaded.scene.solver.strain_limit);
    for (ours, theirs) in ours.into_iter().zip(theirs) {
        assert!(ours <= theirs + left, "{ours} > {theirs} + {left}");
    }
}

/// The imprint is that of the reference; single nodes are not, since a sheet that is pressed together has
/// many ways to fold. Overlap as blades have to keep it: `LEAST_OVERLAP` of a run beside the reference.
#[test]
fn the_reference_has_the_same_imprint() {
    let mut loaded = scene(BOARDS);
    loaded.scene.solver.recovery_s = 2.0;
    let (meadow, grass) = run::<f32>(&loaded, 90);
    let ours = boards(&meadow, &grass);
    let theirs = pressed_until(&loaded, Which::Reference, meadow.time_s()).0;
    let is_touched = |all: &Boards, key| all.get(key).is_some_and(|b| b.touched_at > 0);
    let (mut both, mut either) = (0, 0);
    let (mut squares, mut nodes, mut folded, mut lean_deg) = (0.0, 0_u32, 0, Vec::new());
    for (key, truth) in &theirs {
        let found = [is_touched(&ours, key), is_touched(&theirs, key)];
        either += u32::from(found != [false, false]);
        if found != [true, true] {
            continue;
        }
        both += 1;
        let board = &ours[key];
        lean_deg.push((board.lean_rad() - truth.lean_rad()).to_degrees().abs());
        let far = |n: usize| (board.nodes[n] - truth.nodes[n]).length();
        let last = truth.nodes.len() - 1;
        let tip = far(last).max(far(last + 1 - truth.columns));
        if tip > 0.25 * f64::from(truth.billboard.height_m) {
            folded += 1;
            continue;
        }
        squares += (truth.columns..=last).map(|n| far(n).powi(2)).sum::<f64>();
        nodes += (last + 1 - truth.columns) as u32;
    }
    lean_deg.sort_by(f64::total_cmp);
    println!(
        "{both} of {either} touched in both, {folded} folded otherwise, rms {:.4} m of the others; leans \
         differ by {:.2} degrees in the middle, {:.2} at most",
        (squares / f64::from(nodes)).sqrt(),
        lean_deg[lean_deg.len() / 2],
        lean_deg[lean_deg.len() - 1],
    );
    assert!(both > 60, "{both}");
    assert!(
        f64::from(both) >= 0.95 * f64::from(either),
        "{both} of {either}"
    );
}
