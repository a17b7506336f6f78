//! The reference engine beside rods that are solved on their own: how far it is from an answer that
//! shares none of its code.

use std::collections::BTreeMap;

use super::AccuracyError;
use super::lane::Lane;
use super::rod::{LedBall, Rod, Tip};
use crate::base::{Vec3, most};
use crate::run::compare::PlantId;
use crate::scene::{LoadedScene, SceneError, parse_scene};
use crate::sim::measure::Standing;
use crate::sim::reference::{self, refined};

/// A ball that is led over blades of one segment, which it meets with their tips alone.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    pub what: &'static str,
    from_m: [f64; 3],
    to_m: [f64; 3],
    arrives_s: f64,
    run_s: f64,
}

/// The ball's radius, in metres.
const RADIUS_M: f64 = 0.15;
/// Steps of the bodies per second, and per frame in which tips are compared.
const BODY_HZ: f64 = 120.0;
const FRAME_STEPS: u32 = 2;

/// Ways on which no tip is ever near the ground: blades of 0.4 m, a ball that is 0.2 m above it or more.
pub const WAYS: [Way; 2] = [
    Way {
        what: "led straight through",
        from_m: [-1.5, 0.4, 0.03],
        to_m: [1.5, 0.4, 0.03],
        arrives_s: 3.0,
        run_s: 4.0,
    },
    Way {
        what: "led down from above",
        from_m: [0.02, 0.9, 0.03],
        to_m: [0.05, 0.35, -0.01],
        arrives_s: 1.0,
        run_s: 1.2,
    },
];

/// How far the engine's tips are from the rods'.
#[derive(Clone, Debug, Default)]
pub struct Apart {
    pub step_s: f64,
    /// Rods that the ball met, and those of them that only one of the two met.
    pub met: usize,
    pub met_by_one: usize,
    /// Over all frames since a rod was met, in metres.
    pub rms_m: f64,
    /// While the ball pushed a tip for the first time: the same, the largest distance, and the largest
    /// share of its bound.
    pub pushed_rms_m: f64,
    pub pushed_most_m: f64,
    pub share_of_bound: f64,
}

impl Way {
    fn scene(&self) -> Result<LoadedScene, SceneError> {
        let Self {
            from_m: [x, y, z],
            to_m: [to_x, to_y, to_z],
            arrives_s,
            run_s,
            ..
        } = self;
        let text = format!(
            "(duration_s: {run_s:?}, terrain: (ground: Flat(size_m: (2, 1))),
              grass: (density_per_m2: 512, species: [(name: \"rod\", height_m: (0.37, 0.4),
                stiffness: (100000, 100000), lean_deg: (2, 12))]),
              wind: (strength: 0, gust: 0, flutter: 0), solver: (segments: 1),
              bodies: [(name: \"ball\", shape: Ball(radius_m: {RADIUS_M:?}), motion: Path(waypoints: [
                (at_s: 0, position_m: ({x:?}, {y:?}, {z:?})),
                (at_s: {arrives_s:?}, position_m: ({to_x:?}, {to_y:?}, {to_z:?}))]))])"
        );
        parse_scene(self.what, &text, &[])
    }

    /// The engine with so many steps of the grass per step of the bodies, beside the rods.
    ///
    /// # Errors
    ///
    /// None is known; the scene's and the engine's are passed on.
    pub fn measure(&self, grass_steps: u32) -> Result<Apart, AccuracyError> {
        let loaded = self.scene()?;
        let solver = refined(&loaded.scene.solver, grass_steps, reference::SWEEP_SHARE);
        let ball = LedBall {
            radius_m: RADIUS_M + f64::from(solver.skin_m),
            from_m: self.from_m,
            to_m: self.to_m,
            arrives_s: self.arrives_s,
            body_step_s: 1.0 / BODY_HZ,
        };
        let (step_s, recovery_s) = (solver.substep_s, solver.recovery_s);
        let mut lane = Lane::reference(&loaded, solver)?;
        let mut pairs: BTreeMap<PlantId, Pair> = BTreeMap::new();
        let mut sums = Sums::default();
        let frames = (self.run_s * BODY_HZ / f64::from(FRAME_STEPS)) as u32;
        for frame in 0..=frames {
            lane.advance_to(f64::from(frame * FRAME_STEPS) / BODY_HZ)?;
            for (id, plant) in lane.all_plants()? {
                let pair = pairs.entry(id).or_insert_with(|| Pair {
                    tip: Tip::new(rod_of(&plant, recovery_s), step_s),
                    was_met: false,
                });
                if frame > 0 {
                    pair.tip.advance(&ball, FRAME_STEPS);
                }
                pair.was_met |= plant.touched_at > 0;
                if pair.was_met || pair.tip.was_met() {
                    let off_m = (in_world(&plant, 1) - pair.tip.place()).length();
                    sums.add(off_m, pair.tip.bound_while_pushed_m());
                }
            }
        }
        let count = |counts: fn(&[bool; 2]) -> bool| {
            let met = pairs
                .values()
                .map(|pair| [pair.was_met, pair.tip.was_met()]);
            met.filter(counts).count()
        };
        Ok(Apart {
            step_s,
            met: count(|met| met.contains(&true)),
            met_by_one: count(|[engine, rod]| engine != rod),
            ..sums.apart()
        })
    }
}

/// A rod, and whether the engine's ball has met its plant.
struct Pair {
    tip: Tip,
    was_met: bool,
}

fn in_world(plant: &Standing<f64>, node: usize) -> Vec3<f64> {
    plant.nodes[node] + Vec3::of(plant.origin)
}

fn rod_of(plant: &Standing<f64>, recovery_s: f64) -> Rod {
    Rod {
        root: in_world(plant, 0),
        rest: plant.wind[1] - plant.wind[0],
        length_m: f64::from(plant.plant.height_m),
        recovery_s,
    }
}

/// Distances of tips, gathered over a run.
#[derive(Default)]
struct Sums {
    squares_m2: Vec<f64>,
    pushed_squares_m2: Vec<f64>,
    share_of_bound: f64,
}

impl Sums {
    fn add(&mut self, off_m: f64, bound_m: Option<f64>) {
        self.squares_m2.push(off_m * off_m);
        // A bound of 0 is that of the instant of contact.
        if let Some(bound_m) = bound_m.filter(|&bound_m| bound_m > 0.0) {
            self.pushed_squares_m2.push(off_m * off_m);
            self.share_of_bound = most(self.share_of_bound, off_m / bound_m);
        }
    }

    fn apart(&self) -> Apart {
        Apart {
            rms_m: root_of_mean(&self.squares_m2),
            pushed_rms_m: root_of_mean(&self.pushed_squares_m2),
            pushed_most_m: self
                .pushed_squares_m2
                .iter()
                .copied()
                .fold(0.0, most)
                .sqrt(),
            share_of_bound: self.share_of_bound,
            ..Apart::default()
        }
    }
}

fn root_of_mean(squares: &[f64]) -> f64 {
    let sum = squares.iter().fold(0.0, |sum, square| sum + square);
    (sum / squares.len().max(1) as f64).sqrt()
}
