//! Stones: pushed aside by what rolls over them, and back afterwards.

use std::collections::BTreeMap;

use sward::base::most;
use sward::sim::measure::{self, Standing};
use sward::sim::{Grass, Meadow, tick};

use super::{meadow, scene};

/// Of the stones, in metres.
const LENGTH_M: f64 = 0.04;
/// Of the ball, in metres.
const RADIUS_M: f64 = 0.15;

/// A ball is led over stones half of which stay, and taken away.
const STONES: &str = r#"(
    terrain: (ground: Flat(size_m: (4, 1.5))),
    grass: (density_per_m2: 1500, species: [
        (name: "shoved", form: Gravel, response: Shoved, height_m: (0.04, 0.04), lean_deg: (0, 0),
            stiffness: (4000, 4000), flexibility: 0),
        (name: "firm", form: Gravel, response: Stays, height_m: (0.04, 0.04), lean_deg: (0, 0),
            stiffness: (4000, 4000), flexibility: 0),
    ]),
    solver: (recovery_s: 0.5),
    bodies: [(name: "ball", shape: Ball(radius_m: 0.15), collider: analytic, motion: Path(waypoints: [
        (at_s: 0, position_m: (-1, 0.15, 0)), (at_s: 2, position_m: (1, 0.15, 0))]))],
    script: [(at_s: 2, action: Remove(body: "ball"))],
)"#;

/// Place of the kind that stays in the list of kinds.
const FIRM: u32 = 1;

/// The stones of awake tiles that are shoved.
fn stones(meadow: &Meadow, grass: &Grass<f32>) -> Vec<Standing<f32>> {
    let tiles = meadow.work.tiles.iter();
    tiles
        .filter_map(|tile| Some(measure::standing(meadow, tile, grass.slab(tile.slab)?)))
        .flatten()
        .collect()
}

/// How many stones of awake tiles stay; none of them has a state.
fn firm_stones(meadow: &Meadow, grass: &Grass<f32>) -> usize {
    let mut firm = 0;
    for tile in &meadow.work.tiles {
        let slab = grass.slab(tile.slab).expect("the slab of an awake tile");
        for (place, &touched_at) in (0..).zip(&slab.touched_at) {
            let plant = meadow.field.plant(&tile.anchor, tile.tile, place);
            if plant.is_some_and(|plant| plant.species == FIRM) {
                firm += 1;
                assert_eq!(touched_at, 0, "a stone that stays is touched");
            }
        }
    }
    firm
}

/// How far a stone is shoved: the level way of its tip.
fn shove_m(stone: &Standing<f32>) -> f64 {
    let way = stone.nodes.last().zip(stone.wind.last());
    let [x, _, z] = way.map_or([0.0; 3], |(&tip, &free)| (tip - free).to_f64());
    x.hypot(z)
}

/// When the ball of radius R is over a root, the tip of what grows there, L long, is out of it. With the
/// tip o away, level, and the root d from the ball's axis, √(L² − o²) ≤ R − √(R² − (d + o)²). At the end
/// of a tick the axis is up to half of 1/120 m off along the way; with 20 mm across d is at most 20.5 mm,
/// and the least such o for 40 mm is 38.1 mm, above nine tenths of L. Nor can the tip be off by more than
/// the length, which is kept to a fiftieth.
#[test]
fn stones_are_shoved_by_no_more_than_their_length_and_go_back() {
    let loaded = scene(STONES);
    let (mut meadow, mut grass) = (meadow(&loaded), Grass::<f32>::new());
    let mut farthest_m: BTreeMap<[u64; 2], f64> = BTreeMap::new();
    let mut firm = 0;
    for _ in 0..240 {
        tick(&mut meadow, &mut grass).expect("a tick");
        firm = firm.max(firm_stones(&meadow, &grass));
        for stone in stones(&meadow, &grass) {
            let root = stone.root_in_world().map(f64::to_bits);
            let farthest = farthest_m.entry(root).or_default();
            *farthest = most(*farthest, shove_m(&stone));
        }
    }
    check_shoves(&meadow, &farthest_m);
    assert!(firm > 500, "only {firm} stones that stay");

    let recovery = (0.5 / meadow.scene.solver.substep_s).ceil() as u32;
    for _ in 0..recovery {
        tick(&mut meadow, &mut grass).expect("a tick");
    }
    let back = stones(&meadow, &grass);
    assert!(!back.is_empty(), "no tile is awake");
    for stone in back {
        assert_eq!(stone.nodes, stone.wind, "back, bit for bit");
    }
    for _ in 0..2 {
        tick(&mut meadow, &mut grass).expect("a tick");
    }
    assert_eq!(meadow.tiles.len(), 0);
}

/// The farthest that each stone was shoved, by the bits of its root's place in the world.
fn check_shoves(meadow: &Meadow, farthest_m: &BTreeMap<[u64; 2], f64>) {
    // Of the ball with its skin where the tips meet it, which is where it is widest for stones.
    let with_skin_m = RADIUS_M + f64::from(meadow.scene.solver.skin_m);
    let half_width_m = (with_skin_m.powi(2) - (RADIUS_M - LENGTH_M).powi(2)).sqrt();
    let (mut met, mut beside, mut most_m) = (0, 0, 0.0);
    for (root, &farthest_m) in farthest_m {
        let [x, z] = root.map(f64::from_bits);
        let what = format!("{farthest_m} m at ({x}, {z})");
        if x.abs() < 0.9 && z.abs() < 0.02 {
            met += 1;
            assert!(farthest_m >= 0.9 * LENGTH_M, "under the ball: {what}");
        }
        if z.abs() > half_width_m {
            beside += 1;
            assert_eq!(farthest_m, 0.0, "beside the ball: {what}");
        }
        most_m = most(most_m, farthest_m);
    }
    println!("{met} stones under the ball, {beside} beside it; shoved by {most_m} m at the most");
    assert!(met > 20 && beside > 500, "{met} met, {beside} not");
    assert!(most_m <= 1.02 * LENGTH_M, "{most_m} m");
}
