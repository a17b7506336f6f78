//! What a sub-step costs by method, at equal sub-steps and in turns, so that a machine that gets
//! slower does not favour one of them; and what each method costs per simulated second at the rate
//! it is used at.

use super::lane::{Kind, Lane};
use super::relative::Relative;
use crate::base::statistics::median;
use crate::run::methods::NamedMethod;
use crate::run::scenario::RunError;
use crate::scene::{LoadedScene, Solver};

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

/// A method's lane, and what each of the scene's sub-steps took.
struct Timed {
    method: &'static str,
    lane: Lane,
    steps_ms: Vec<Option<f64>>,
}

/// A method's cost.
#[derive(Clone, Debug, PartialEq)]
pub struct CostRow {
    pub method: &'static str,
    /// Rate of its sub-steps, per second.
    pub hz: f64,
    /// Median of collide and relax.
    pub ms_per_substep: f64,
    /// The same over that of the literal method in the same sub-steps; `None` at another rate.
    pub over_literal: Option<Relative>,
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
    let mut lanes = Vec::new();
    for method in methods.iter().filter(|m| METHODS.contains(&m.name)) {
        let mut solver = loaded.scene.solver.clone();
        method.apply(&mut solver);
        lanes.push(Timed::new(method.name, loaded, &solver)?);
        if method.name == LITERAL {
            solver.substep_s = 1.0 / LITERAL_HZ;
            lanes.push(Timed::new(method.name, loaded, &solver)?);
        }
    }
    let ends = 1..=(TIMED_S / scene_step_s) as u32;
    for end in ends {
        let mut turn: Vec<&mut Timed> = lanes.iter_mut().collect();
        // The first to run finds the caches cold, and load may come and go with the turns: each is
        // first in its turn.
        let first = end as usize % turn.len().max(1);
        turn.rotate_left(first);
        for timed in turn {
            timed.lane.advance_to(f64::from(end) * scene_step_s)?;
            timed.steps_ms.push(timed.lane.take_frame_ms());
        }
    }
    let literal = lanes.iter().find(|timed| timed.method == LITERAL);
    let rows = lanes.iter().map(|timed| timed.row(literal, scene_step_s));
    Ok(rows.collect())
}

impl Timed {
    fn new(method: &'static str, loaded: &LoadedScene, solver: &Solver) -> Result<Self, RunError> {
        Ok(Self {
            method,
            lane: Lane::new(loaded, solver, Kind::Single)?,
            steps_ms: Vec::new(),
        })
    }

    fn row(&self, literal: Option<&Self>, scene_step_s: f64) -> CostRow {
        let substep_s = self.lane.meadow.scene.solver.substep_s;
        let at_equal_steps = substep_s == scene_step_s;
        let literal = literal.filter(|_| at_equal_steps);
        CostRow {
            method: self.method,
            hz: 1.0 / substep_s,
            ms_per_substep: median(&self.lane.grass_ms).unwrap_or(0.0),
            over_literal: literal.and_then(|of| Relative::of(&self.steps_ms, &of.steps_ms)),
            at_equal_steps,
        }
    }
}
