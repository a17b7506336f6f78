//! One scenario from start to end, without a window.

use std::collections::BTreeMap;

use crate::gpu::{Gpu, GpuError, GrassKernels, TickError};
use crate::scene::{LoadedScene, Scene};
use crate::sim::measure::Snapshot;
use crate::sim::{Meadow, MeadowError};

use super::accuracy::why_not_comparable;
use super::against::{Against, Difference};
use super::engine::Engine;
use super::judge::{Judge, Verdict, exceeded_limits};
use super::methods::NamedMethod;
use super::pass_times::PassTimes;
use super::recording::Input;
use super::timeline::Timeline;
use super::watch::Watch;

/// How to run a scenario. The default runs it as the scene says.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Frames per second of the run; results do not depend on it.
    pub hz: f64,
    /// Sub-step instead of the scene's, in seconds.
    pub substep_s: Option<f64>,
    /// Seed of the grass instead of the scene's.
    pub seed: Option<u32>,
    /// Settings instead of the scene's.
    pub method: Option<&'static NamedMethod>,
    /// Runs the reference engine beside the other and compares them.
    pub against_reference: bool,
    /// Sub-steps to run instead of the scene's duration.
    pub ticks: Option<u32>,
    /// What happens from outside of the scene's script, in the order of ticks.
    pub inputs: Vec<Input>,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self {
            hz: 60.0,
            substep_s: None,
            seed: None,
            method: None,
            against_reference: false,
            ticks: None,
            inputs: Vec::new(),
        }
    }
}

impl RunOptions {
    /// True if sub-steps are other ones than those of the scene as it is written.
    fn changes_the_run(&self) -> bool {
        let settings = self.substep_s.is_some() || self.seed.is_some() || self.method.is_some();
        settings || !self.inputs.is_empty()
    }
}

/// What a scenario came to.
pub struct Outcome {
    pub name: String,
    /// One per expectation, and one for every limit that was exceeded.
    pub verdicts: Vec<Verdict>,
    pub watch: Watch,
    /// The meadow as it stands at the end.
    pub meadow: Meadow,
    pub engine: Engine,
    /// Median milliseconds per sub-step of each pass.
    pub pass_ms: BTreeMap<String, f64>,
    /// Wall-clock seconds of the run without setting up.
    pub wall_s: f64,
    /// How far it was from the reference, where that was asked for.
    pub difference: Option<Difference>,
}

impl Outcome {
    /// True if every expectation that applies holds and no limit was exceeded.
    pub fn passed(&self) -> bool {
        self.verdicts.iter().all(|v| v.passed != Some(false))
    }
}

/// The end of a frame, for whoever watches a run.
pub struct Frame<'a> {
    /// Share of the run that is done, 0…1.
    pub done: f64,
    pub meadow: &'a Meadow,
    pub engine: &'a Engine,
    /// This frame's measures alone.
    pub snapshot: &'a Snapshot,
}

/// Whoever follows a run from outside.
pub trait RunWatcher {
    /// The end of a sub-step.
    ///
    /// # Errors
    ///
    /// The engine's, where it is asked for its state; it ends the run.
    fn tick(&mut self, _meadow: &Meadow, _engine: &mut Engine) -> Result<(), GpuError> {
        Ok(())
    }

    /// The end of a frame.
    fn frame(&mut self, _frame: &Frame<'_>) {}
}

/// A watcher of frames alone.
struct EachFrame<F>(F);

impl<F: FnMut(&Frame<'_>)> RunWatcher for EachFrame<F> {
    fn frame(&mut self, frame: &Frame<'_>) {
        (self.0)(frame);
    }
}

/// What a run computes on.
#[derive(Clone, Debug)]
pub enum Device {
    /// The processor, for the cpu engine.
    Processor,
    /// The processor, for the reference engine.
    Reference,
    /// A graphics device with its compiled passes, for the gpu engine.
    Graphics(Gpu, Box<GrassKernels>),
}

impl Device {
    /// Compiles the passes for a graphics device.
    ///
    /// # Errors
    ///
    /// A shader that the driver refuses.
    pub fn graphics(gpu: Gpu) -> Result<Self, GpuError> {
        let kernels = Box::new(GrassKernels::new(&gpu)?);
        Ok(Self::Graphics(gpu, kernels))
    }

    /// The graphics device, if it is one.
    pub fn gpu(&self) -> Option<&Gpu> {
        match self {
            Self::Processor | Self::Reference => None,
            Self::Graphics(gpu, _) => Some(gpu),
        }
    }

    /// Name of the engine that it runs.
    pub fn engine_name(&self) -> &'static str {
        match self {
            Self::Processor => "cpu",
            Self::Reference => "reference",
            Self::Graphics(..) => "gpu",
        }
    }

    /// An engine for a meadow.
    ///
    /// # Errors
    ///
    /// A meadow larger than the device can bind.
    pub fn engine(&self, meadow: &mut Meadow) -> Result<Engine, GpuError> {
        match self {
            Self::Processor => Ok(Engine::cpu()),
            Self::Reference => Ok(Engine::reference(meadow)),
            Self::Graphics(gpu, kernels) => Engine::gpu(gpu, kernels, meadow),
        }
    }
}

/// Why a scenario could not be run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    #[error("{name}: {source}")]
    Meadow { name: String, source: MeadowError },
    #[error("{name}: {source}")]
    Gpu { name: String, source: GpuError },
    #[error(
        "{name}: --against reference has nothing to say of --method {method}, since {why}; leave one of \
         them out"
    )]
    NotComparable {
        name: String,
        method: &'static str,
        why: &'static str,
    },
    #[error("--hz is {0}; it must be a number of frames per second from 1 to 10000")]
    Rate(f64),
}

impl RunError {
    pub(super) fn new(name: &str, source: impl Into<TickError>) -> Self {
        let name = name.to_owned();
        match source.into() {
            TickError::Meadow(source) => Self::Meadow { name, source },
            TickError::Gpu(source) => Self::Gpu { name, source },
        }
    }
}

/// Whether a method's poses mean anything beside those of the scene's own reference.
fn comparable(
    name: &str,
    scene: &Scene,
    method: Option<&'static NamedMethod>,
) -> Result<(), RunError> {
    let why = method.and_then(|method| Some((method, why_not_comparable(scene, method)?)));
    match why {
        None => Ok(()),
        Some((method, why)) => Err(RunError::NotComparable {
            name: name.to_owned(),
            method: method.name,
            why,
        }),
    }
}

/// Runs a scene to its end. `each_frame` is called at the end of every frame.
///
/// # Errors
///
/// A scene that cannot be laid out, or an event that cannot happen.
pub fn run_scene(
    loaded: &LoadedScene,
    options: &RunOptions,
    device: &Device,
    each_frame: impl FnMut(&Frame<'_>),
) -> Result<Outcome, RunError> {
    run_watched(loaded, options, device, &mut EachFrame(each_frame))
}

/// Runs a scene to its end while `watcher` follows every sub-step and every frame.
///
/// # Errors
///
/// As for [`run_scene`], and what ends the watcher's interest.
pub fn run_watched(
    loaded: &LoadedScene,
    options: &RunOptions,
    device: &Device,
    watcher: &mut dyn RunWatcher,
) -> Result<Outcome, RunError> {
    if !(options.hz >= 1.0 && options.hz <= 10_000.0) {
        return Err(RunError::Rate(options.hz));
    }
    let name = loaded.name.as_str();
    let mut scene = loaded.scene.clone();
    scene.solver.substep_s = options.substep_s.unwrap_or(scene.solver.substep_s);
    scene.grass.seed = options.seed.unwrap_or(scene.grass.seed);
    let mut against = None;
    if options.against_reference {
        comparable(name, &scene, options.method)?;
        let reference = Against::reference(scene.clone(), &loaded.assets);
        against = Some(reference.map_err(|error| RunError::new(name, error))?);
    }
    if let Some(method) = options.method {
        method.apply_to_scene(&mut scene);
    }
    let substep_s = scene.solver.substep_s;
    // A millionth of a sub-step forgives the rounding of the division.
    let scene_ticks = || (scene.duration_s / substep_s + 1e-6) as u32;
    let whole = options.ticks.is_none_or(|ticks| ticks == scene_ticks());
    let as_written = whole && !options.changes_the_run();
    let duration_s = match options.ticks {
        Some(ticks) => f64::from(ticks) * substep_s,
        None => scene.duration_s,
    };
    let mut inputs = options.inputs.iter().peekable();
    let mut meadow =
        Meadow::new(scene, &loaded.assets).map_err(|error| RunError::new(name, error))?;
    let mut engine = (device.engine(&mut meadow)).map_err(|error| RunError::new(name, error))?;
    // The reference engine has given the meadow shorter sub-steps.
    let engine_ticks = || (duration_s / meadow.scene.solver.substep_s + 1e-6) as u32;
    let ticks = options.ticks.unwrap_or_else(engine_ticks);
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
            // The last frame may reach beyond the end.
            if meadow.ticks == ticks {
                break;
            }
            while let Some(input) = inputs.next_if(|input| input.tick <= meadow.ticks) {
                meadow
                    .act(&input.action)
                    .map_err(|error| RunError::new(name, error))?;
            }
            engine
                .tick(&mut meadow)
                .map_err(|error| RunError::new(name, error))?;
            passes.tick(&engine.pass_ms());
            for judge in &mut judges {
                judge
                    .tick(&meadow, &mut engine)
                    .map_err(|error| RunError::new(name, error))?;
            }
            watcher
                .tick(&meadow, &mut engine)
                .map_err(|error| RunError::new(name, error))?;
        }
        watch
            .frame(&meadow, &mut engine)
            .map_err(|error| RunError::new(name, error))?;
        if let Some(against) = &mut against {
            against
                .catch_up(meadow.time_s())
                .map_err(|error| RunError::new(name, error))?;
            against
                .frame(&meadow, &mut engine)
                .map_err(|error| RunError::new(name, error))?;
        }
        watcher.frame(&Frame {
            done: (frame + 1) as f64 / frames as f64,
            meadow: &meadow,
            engine: &engine,
            snapshot: &watch.last,
        });
    }
    let wall_s = started.elapsed().as_secs_f64();
    let mut verdicts: Vec<Verdict> = judges
        .into_iter()
        .map(|judge| judge.finish(&meadow, &engine, &watch, as_written))
        .collect();
    verdicts.extend(exceeded_limits(&meadow, &watch));
    let mut pass_ms = passes.median_ms();
    let device_ms = engine.device_pass_ms().into_iter();
    pass_ms.extend(device_ms.map(|(pass, ms)| (pass.to_owned(), ms)));
    Ok(Outcome {
        name: loaded.name.clone(),
        verdicts,
        watch,
        meadow,
        engine,
        pass_ms,
        wall_s,
        difference: against.map(|against| against.finish()),
    })
}
