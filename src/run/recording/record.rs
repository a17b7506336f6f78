//! Recording a run while it goes on.

use crate::scene::LoadedScene;
use crate::sim::{Meadow, StateHash};

use super::super::engine::Engine;
use super::super::scenario::RunOptions;
use super::{Hashed, Input, MOST_TICKS, Recording};

/// Takes a run down, tick by tick.
#[derive(Clone, Debug)]
pub struct Recorder {
    recording: Recording,
    bodies: StateHash,
}

/// A run has more ticks than a recording can hold.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the run has {ticks} sub-steps, but a recording holds at most {MOST_TICKS}: shorten \
     duration_s or lengthen --substep"
)]
pub struct TooLong {
    pub ticks: f64,
}

impl Recorder {
    /// Begins a recording of a scene that is about to be run.
    ///
    /// # Errors
    ///
    /// A run that is too long.
    pub fn new(loaded: &LoadedScene, options: &RunOptions) -> Result<Self, TooLong> {
        let mut solver = loaded.scene.solver.clone();
        solver.substep_s = options.substep_s.unwrap_or(solver.substep_s);
        if let Some(method) = options.method {
            method.apply(&mut solver);
        }
        let substep_s = solver.substep_s;
        let ticks = options
            .ticks
            .map_or_else(|| (loaded.scene.duration_s / substep_s).ceil(), f64::from);
        if ticks > f64::from(MOST_TICKS) {
            return Err(TooLong { ticks });
        }
        Ok(Self {
            recording: Recording {
                sward: env!("CARGO_PKG_VERSION").to_owned(),
                scene: loaded.name.clone(),
                source: loaded.source.clone(),
                assets: loaded.assets.file_hashes.clone(),
                hz: options.hz,
                substep_s: options.substep_s,
                seed: options.seed,
                method: options.method.map(|method| method.name.to_owned()),
                hashed: Hashed::default(),
                inputs: options.inputs.clone(),
                hashes: Vec::new(),
            },
            bodies: StateHash::default(),
        })
    }

    /// Takes down an input that has just been applied, between two ticks.
    pub fn input(&mut self, input: Input) {
        self.recording.inputs.push(input);
    }

    /// Takes down a tick that is done. Past [`MOST_TICKS`] nothing is added any more.
    pub fn tick(&mut self, meadow: &Meadow, engine: &Engine) {
        self.bodies.bodies(meadow);
        let hash = match engine.state_hash() {
            Some(hash) => {
                self.recording.hashed = Hashed::GrassAndBodies;
                hash
            }
            None => self.bodies.value(),
        };
        if self.recording.hashes.len() < MOST_TICKS as usize {
            self.recording.hashes.push(hash as u32);
        }
    }

    /// The recording up to the last tick.
    pub fn recording(&self) -> &Recording {
        &self.recording
    }
}
