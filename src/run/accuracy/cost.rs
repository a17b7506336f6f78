//! What a sub-step costs by method, at equal sub-steps and in turns, so that a machine that gets
//! slower does not favour one of them; and what each method costs per simulated second at the rate
//! it is used at.

use super::lane::{Kind, Lane};
use crate::base::statistics::median;
use crate::run::methods::NamedMethod;
use crate::run::scenario::RunError;
use crate::scene::LoadedScene;

/// The scene that is timed.
pub const SCENE: &str = "ball_roll";
/// The methods that are timed: the literal one, the default, and what lies between the two.
pub const METHODS: [&str; 8] = [
    "paper",
    "default",
    "springs-literal",
    "recovery-literal",
    "push-literal",
    "nearest-64",
    "body-cube-64",
    "one-sweep",
];
/// The literal method, which others are divided by.
pub const LITERAL: &str = "paper";
/// Rate of the literal method where it is used: one sub-step per displayed frame.
const LITERAL_HZ: f64 = 60.0;
/// Simulated time, in seconds: the ball is in the grass all along.
const TIMED_S: f64 = 2.0;

/// A method's cost.
#[derive(Clone, Debug, PartialEq)]
pub struct CostRow {
    pub method: &'static str,
    /// Rate of its sub-steps, per second.
    pub hz: f64,
    /// Median of collide and relax.
    pub ms_per_substep: f64,
    /// True for the rows that are compared with each other: those at the scene's sub-step.
    pub at_equal_steps: bool,
}

impl CostRow {
    pub fn ms_per_s(&self) -> f64 {
        self.ms_per_substep * self.hz
    }
}

/// Times these methods in turns, sub-step by sub-step, and the literal one at its own rate too.
///
/// # Errors
///
/// A scene that cannot be laid out.
pub fn measure(
    loaded: &LoadedScene,
    methods: &[&'static NamedMethod],
) -> Result<Vec<CostRow>, RunError> {
    let scene_step_s = loaded.scene.solver.substep_s;
    let timed = methods.iter().filter(|m| METHODS.contains(&m.name));
    let mut lanes = Vec::new();
    for method in timed {
        let mut solver = loaded.scene.solver.clone();
        method.apply(&mut solver);
        lanes.push((method.name, Lane::new(loaded, &solver, Kind::Single)?));
        if method.name == LITERAL {
            solver.substep_s = 1.0 / LITERAL_HZ;
            lanes.push((method.name, Lane::new(loaded, &solver, Kind::Single)?));
        }
    }
    let ends = 1..=(TIMED_S / scene_step_s) as u32;
    for end_s in ends.map(|n| f64::from(n) * scene_step_s) {
        for (_, lane) in &mut lanes {
            lane.advance_to(end_s)?;
        }
    }
    let row = |(method, lane): &(&'static str, Lane)| {
        let substep_s = lane.meadow.scene.solver.substep_s;
        CostRow {
            method,
            hz: 1.0 / substep_s,
            ms_per_substep: median(&lane.grass_ms).unwrap_or(0.0),
            at_equal_steps: substep_s == scene_step_s,
        }
    };
    Ok(lanes.iter().map(row).collect())
}
