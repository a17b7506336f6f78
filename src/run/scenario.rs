//! One scenario from start to end, without a window.

use std::collections::BTreeMap;

use crate::scene::LoadedScene;
use crate::sim::measure::Snapshot;
use crate::sim::{Meadow, MeadowError};

use super::engine::{Engine, EngineChoice};
use super::judge::{Judge, Verdict};
use super::pass_times::PassTimes;
use super::timeline::Timeline;
use super::watch::Watch;

/// How to run a scenario. The default runs it as the scene says.
#[derive(Clone, Debug)]
pub struct RunOptions {
    pub engine: EngineChoice,
    /// Frames per second of the run; results do not depend on it.
    pub hz: f64,
    /// Sub-step instead of the scene's, in seconds.
    pub substep_s: Option<f64>,
    /// Seed of the grass instead of the scene's.
    pub seed: Option<u32>,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self {
            engine: EngineChoice::Auto,
            hz: 60.0,
            substep_s: None,
            seed: None,
        }
    }
}

/// What a scenario came to.
pub struct Outcome {
    pub name: String,
    pub verdicts: Vec<Verdict>,
    pub watch: Watch,
    /// The meadow as it stands at the end.
    pub meadow: Meadow,
    pub engine: Engine,
    /// Median milliseconds per sub-step of each pass.
    pub pass_ms: BTreeMap<String, f64>,
    /// Wall-clock seconds of the run without setting up.
    pub wall_s: f64,
}

impl Outcome {
    /// True if every expectation that applies holds and nothing went non-finite.
    pub fn passed(&self) -> bool {
        self.watch.not_finite == 0 && self.verdicts.iter().all(|v| v.passed != Some(false))
    }
}

/// The end of a frame, for whoever watches a run.
pub struct Frame<'a> {
    /// Share of the run that is done, 0…1.
    pub done: f64,
    pub meadow: &'a Meadow,
    /// This frame's measures alone.
    pub snapshot: &'a Snapshot,
}

/// Why a scenario could not be run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    #[error("{name}: {source}")]
    Meadow { name: String, source: MeadowError },
    #[error("--hz is {0}; it must be a number of frames per second from 1 to 10000")]
    Rate(f64),
}

/// Runs a scene to its end. `each_frame` is called at the end of every frame.
///
/// # Errors
///
/// A scene that cannot be laid out, or an event that cannot happen.
pub fn run_scene(
    loaded: &LoadedScene,
    options: &RunOptions,
    engine: Engine,
    mut each_frame: impl FnMut(&Frame<'_>),
) -> Result<Outcome, RunError> {
    if !(options.hz >= 1.0 && options.hz <= 10_000.0) {
        return Err(RunError::Rate(options.hz));
    }
    let named = |source| RunError::Meadow {
        name: loaded.name.clone(),
        source,
    };
    let mut scene = loaded.scene.clone();
    scene.solver.substep_s = options.substep_s.unwrap_or(scene.solver.substep_s);
    scene.grass.seed = options.seed.unwrap_or(scene.grass.seed);
    let duration_s = scene.duration_s;
    let mut meadow = Meadow::new(scene, &loaded.assets).map_err(named)?;
    let mut engine = engine;
    let mut judges: Vec<Judge> = meadow
        .scene
        .expect
        .iter()
        .map(|expectation| Judge::new(expectation, &meadow))
        .collect();
    let mut watch = Watch::default();
    let mut passes = PassTimes::default();
    let mut timeline = Timeline::unlimited(meadow.scene.solver.substep_s);
    let frames = (duration_s * options.hz).ceil() as u64;
    let started = std::time::Instant::now();
    for frame in 0..frames {
        for _ in 0..timeline.advance(1.0 / options.hz) {
            engine.tick(&mut meadow).map_err(named)?;
            passes.tick(&engine.pass_ms());
            for judge in &mut judges {
                judge.tick(&meadow, &mut engine);
            }
        }
        watch.frame(&meadow, &mut engine);
        each_frame(&Frame {
            done: (frame + 1) as f64 / frames as f64,
            meadow: &meadow,
            snapshot: &watch.last,
        });
    }
    let wall_s = started.elapsed().as_secs_f64();
    let verdicts = judges
        .into_iter()
        .map(|judge| judge.finish(&meadow, &engine, &watch))
        .collect();
    Ok(Outcome {
        name: loaded.name.clone(),
        verdicts,
        watch,
        meadow,
        engine,
        pass_ms: passes.median_ms(),
        wall_s,
    })
}
