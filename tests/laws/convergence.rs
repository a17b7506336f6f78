//! The reference engine converges: the error falls with its step at the order its method promises.

use std::collections::BTreeMap;

use sward::base::statistics::median;
use sward::run::Engine;
use sward::run::compare::{Comparison, Difference, PlantId, Plants, touched_plants};
use sward::scene::LoadedScene;
use sward::sim::Meadow;
use sward::sim::reference::refined;

use super::{meadow, scene};

/// Sub-steps of the reference in one of the scene's, and the finest, which is taken for true.
const LEVELS: [u32; 4] = [1, 2, 4, 8];
const FINEST: u32 = 32;
/// One sweep in each sub-step, so that the length of a step alone is refined.
const ONE_SWEEP: f64 = 1e6;
/// Frames that are compared, at 30 per second.
const FRAMES: u32 = 130;

/// A body is led through 2 m of grass at 0.5 m/s, its middle at a height, while it turns.
fn led(shape: &str, middle_m: f64, turn_deg: [f64; 2]) -> LoadedScene {
    let [spun, rolled] = turn_deg;
    scene(&format!(
        r#"(
        terrain: (ground: Flat(size_m: (4, 2))),
        grass: (density_per_m2: 128, species: [(name: "meadow grass", height_m: (0.38, 0.42),
            stiffness: (90, 160), lean_deg: (2, 12))]),
        wind: (strength: 0, gust: 0, flutter: 0),
        bodies: [(name: "body", shape: {shape}, motion: Path(waypoints: [
            (at_s: 0, position_m: (-1, {middle_m:?}, 0.1), rotation_deg: (0, 20, 75)),
            (at_s: 4, position_m: (1, {middle_m:?}, 0.1),
             rotation_deg: (0, {:?}, {:?}))]))],
    )"#,
        20.0 + spun,
        75.0 + rolled
    ))
}

/// How far a level is from the finest.
#[derive(Default)]
struct Level {
    comparison: Comparison,
    /// Sums of squares of the distances of each plant's nodes, and their number.
    plants: BTreeMap<PlantId, (f64, u32)>,
}

impl Level {
    fn frame(&mut self, ours: &Plants, truth: &Plants) {
        self.comparison.frame(ours, truth);
        for (id, plant) in truth {
            let Some(other) = ours.get(id) else {
                continue;
            };
            let sum = self.plants.entry(*id).or_default();
            for (&a, &b) in plant.nodes.iter().zip(&other.nodes).skip(1) {
                sum.0 += (a - b).length_squared();
                sum.1 += 1;
            }
        }
    }

    /// Over plants, of the root mean square distance of each, in metres.
    fn median_m(&self) -> f64 {
        let plants = self.plants.values();
        let each = plants.map(|&(sum, nodes)| (sum / f64::from(nodes.max(1))).sqrt());
        median(&each.collect::<Vec<_>>()).unwrap_or(0.0)
    }
}

/// How far the reference is from the finest at each level.
fn distances_from_finest(loaded: &LoadedScene) -> Vec<(Difference, f64)> {
    let lane = |steps: u32| {
        let mut meadow = meadow(loaded);
        meadow.scene.solver = refined(&loaded.scene.solver, steps, ONE_SWEEP);
        (meadow, Engine::Reference(Box::default()))
    };
    let mut finest = lane(FINEST);
    let mut coarse = LEVELS.map(lane);
    let mut levels = LEVELS.map(|_| Level::default());
    let advanced = |(meadow, engine): &mut (Meadow, Engine), seconds: f64| {
        // Half a sub-step forgives the rounding of two ways to count time.
        while meadow.time_s() + 0.5 * meadow.scene.solver.substep_s < seconds {
            engine.tick(meadow).expect("a tick");
        }
        touched_plants(meadow, engine).expect("plants of the processor")
    };
    for frame in 1..=FRAMES {
        let seconds = f64::from(frame) / 30.0;
        let truth = advanced(&mut finest, seconds);
        for (lane, level) in coarse.iter_mut().zip(&mut levels) {
            level.frame(&advanced(lane, seconds), &truth);
        }
    }
    let field = &finest.0.field;
    let found = levels.iter();
    found
        .map(|level| (level.comparison.finish(field), level.median_m()))
        .collect()
}

/// Observed order between the coarsest and the finest of the levels.
fn order(errors_m: &[f64]) -> f64 {
    let halvings = f64::from(LEVELS[3] / LEVELS[0]).log2();
    (errors_m[0] / errors_m[3]).log2() / halvings
}

const BALL: &str = "Ball(radius_m: 0.15)";
const BOX: &str = "Box(size_m: (0.3, 0.24, 0.4))";
const CAPSULE: &str = "Capsule(radius_m: 0.1, length_m: 0.3)";

/// Fails unless the engine converges as its method promises.
///
/// A contact is found, a spring acts and a plant is let go at the end of a step of length h: each errs
/// by c·h, so that the order is 1. Two steps differ by c·|h − h′| where their errors go the same way,
/// and by c·√(h² + h′²) where they have nothing to do with each other, since it is by chance where in
/// a step a contact begins. Against h/32, from h to h/8, the distance then falls to between 3/31 and
/// 1/7.8, an observed order of 1.12 to 0.99. A method of order ½ would show 0.74 at most, one of order
/// 2 at least 2.
///
/// That holds where a contact moves a plant by as much as the body moves. A blade that is folded
/// between body and ground, or slips off a box's edge, amplifies, and which way it goes may turn on less
/// than a step: the root mean square is theirs, and shows an order of 0.6 under a box that turns. So it
/// is the median plant that must show the order; of the root mean square it is asked that every finer
/// step is nearer, and its order only where no blade folds.
fn converges(what: &str, loaded: &LoadedScene, some_fold: bool) {
    let found = distances_from_finest(loaded);
    let rms_m: Vec<f64> = found.iter().map(|(d, _)| d.pose_rms_m).collect();
    let median_m: Vec<f64> = found.iter().map(|&(_, median_m)| median_m).collect();
    let in_mm = |errors_m: &[f64]| errors_m.iter().map(|m| m * 1e3).collect::<Vec<_>>();
    let orders = [&rms_m, &median_m].map(|errors_m| order(errors_m));
    println!(
        "{what}: rms {:.3?} mm (order {:.2}), median plant {:.3?} mm (order {:.2}) at {LEVELS:?} \
         sub-steps against {FINEST}, {:?} of {} plants on another side",
        in_mm(&rms_m),
        orders[0],
        in_mm(&median_m),
        orders[1],
        found.iter().map(|(d, _)| d.side_flips).collect::<Vec<_>>(),
        found[0].0.touched_plants
    );
    let is_first = |order: f64| (0.75..=1.4).contains(&order);
    assert!(found[0].0.touched_plants > 60, "{what}: too few plants");
    assert!(rms_m.is_sorted_by(|a, b| a > b), "{what}: {rms_m:?}");
    assert!(median_m.is_sorted_by(|a, b| a > b), "{what}: {median_m:?}");
    assert!(is_first(orders[1]), "{what}: order {}", orders[1]);
    assert!(
        some_fold || is_first(orders[0]),
        "{what}: order {}",
        orders[0]
    );
}

#[test]
fn the_reference_converges_at_first_order_beside_a_ball() {
    converges("ball, pushes aside", &led(BALL, 0.25, [0.0, -764.0]), false);
    converges("ball, rolls over", &led(BALL, 0.15, [0.0, -764.0]), true);
}

#[test]
fn the_reference_converges_at_first_order_beside_a_capsule() {
    converges(
        "capsule, led and turned",
        &led(CAPSULE, 0.25, [60.0, 0.0]),
        false,
    );
}

#[test]
fn the_reference_converges_at_first_order_beside_a_box() {
    converges("box, led", &led(BOX, 0.3, [0.0, 0.0]), true);
    converges("box, led and turned", &led(BOX, 0.3, [60.0, 45.0]), true);
}
