//! The reference engine beside answers that share none of its code.

use sward::base::Vec3;
use sward::run::Engine;
use sward::run::accuracy::rods::{Apart, WAYS};
use sward::run::compare::touched_plants;

use super::{meadow, scene};

/// Steps of the grass in one of the bodies', each half as long as the one before; the third is the
/// reference's own.
const STEPS: [u32; 4] = [2, 4, 8, 16];

/// Blades of one segment, whose tips a ball pushes, against a differential equation that is solved on
/// its own (see [`rods`](sward::run::accuracy::rods)). The engine's error is of first order in its
/// step, so that over three halvings of it the distance falls to an eighth: an order of 1, within a
/// tenth for what chance has in the first contact. And every tip is within the bound that the equation
/// gives for the step.
///
/// When a tip is let go is known to a step only, and one that is met again in this step or in the next
/// starts its way back anew: over all the while, the order is seen less well, at least ⅔.
#[test]
fn the_reference_is_near_rods_that_are_solved_on_their_own() {
    for way in WAYS {
        let found = STEPS.map(|steps| way.measure(steps).expect("a run"));
        for apart in &found {
            println!("{}: {apart:?}", way.what);
        }
        let order =
            |error_m: fn(&Apart) -> f64| (error_m(&found[0]) / error_m(&found[3])).log2() / 3.0;
        let [pushed, all] = [order(|a| a.pushed_rms_m), order(|a| a.rms_m)];
        println!(
            "{}: order {pushed:.2} while pushed, {all:.2} all the while",
            way.what
        );
        for apart in &found {
            assert!(apart.met > 30, "{apart:?}");
            assert_eq!(apart.met_by_one, 0, "{apart:?}");
            assert!(apart.share_of_bound <= 1.0, "{apart:?}");
        }
        assert!((0.9..=1.1).contains(&pushed), "order {pushed}");
        assert!(all >= 2.0 / 3.0, "order {all}");
    }
}

/// A ball of 0.15 m is led into blades of 0.4 m, 0.1 m above the ground, and stays.
const PARKED: &str = r#"(
    terrain: (ground: Flat(size_m: (2, 2))),
    grass: (density_per_m2: 256, species: [(name: "meadow grass", height_m: (0.38, 0.42),
        stiffness: (90, 160), lean_deg: (2, 12))]),
    wind: (strength: 0, gust: 0, flutter: 0),
    bodies: [(name: "ball", shape: Ball(radius_m: 0.15), motion: Path(waypoints: [
        (at_s: 0, position_m: (-1.6, 0.25, 0.02)), (at_s: 1, position_m: (0, 0.25, 0.02))]))],
)"#;
/// Roundings of coordinates below 2 m in the places of body and node, whose pose is of single precision.
const ROUNDING_M: f64 = 4.0 * 2.4e-7;

/// Every node of every blade against the ball as a formula, and every segment against its length, once
/// the ball has come to rest among them.
#[test]
fn no_blade_of_the_reference_is_in_a_ball_or_stretched() {
    let loaded = scene(PARKED);
    let mut meadow = meadow(&loaded);
    let mut engine = Engine::reference(&mut meadow);
    while meadow.time_s() < 1.2 {
        engine.tick(&mut meadow).expect("a tick");
    }
    let segments = f64::from(loaded.scene.solver.segments);
    let middle = Vec3::of([0.0, 0.25, 0.02]);
    let (mut touching, mut deepest_m, mut strain) = (0, f64::NEG_INFINITY, 0.0_f64);
    for plant in touched_plants(&meadow, &mut engine)
        .expect("plants of the processor")
        .values()
    {
        let nodes: Vec<_> = plant
            .nodes
            .iter()
            .map(|&n| n + Vec3::of(plant.origin))
            .collect();
        let length_m = f64::from(plant.plant.height_m) / segments;
        for pair in nodes.windows(2) {
            let depth_m = 0.15 - (pair[1] - middle).length();
            deepest_m = deepest_m.max(depth_m);
            touching += u32::from(depth_m > -1.1e-3);
            strain = strain.max(((pair[1] - pair[0]).length() / length_m - 1.0).abs());
        }
    }
    println!("{touching} nodes at the ball, the deepest {deepest_m:e} m, strain {strain:e}");
    assert!(touching > 20, "{touching}");
    // The grass keeps a skin of 1 mm.
    assert!(deepest_m <= -1e-3 + ROUNDING_M, "{deepest_m:e}");
    assert!(strain <= 1e-10, "{strain:e}");
}
