//! A run beside the reference engine: the same scene, tick by tick, and how far the poses differ.

use crate::gpu::{GpuError, TickError};
use crate::scene::Scene;
use crate::scene::assets::Assets;
use crate::sim::{Meadow, MeadowError};

pub use super::compare::Difference;
use super::compare::{Comparison, touched_plants};
use super::engine::Engine;

/// The reference beside a run, and what differed so far.
pub struct Against {
    meadow: Meadow,
    engine: Engine,
    comparison: Comparison,
}

impl Against {
    /// Lays the scene out once more for the reference engine.
    ///
    /// # Errors
    ///
    /// As for [`Meadow::new`].
    pub fn reference(scene: Scene, assets: &Assets) -> Result<Self, MeadowError> {
        let mut meadow = Meadow::new(scene, assets)?;
        let engine = Engine::reference(&mut meadow);
        Ok(Self::new(meadow, engine))
    }

    /// Compares with any other run of the same scene at its start.
    pub fn new(meadow: Meadow, engine: Engine) -> Self {
        Self {
            engine,
            meadow,
            comparison: Comparison::default(),
        }
    }

    /// Advances the reference to the time of a meadow: by one sub-step where both have the same.
    ///
    /// # Errors
    ///
    /// The script's.
    pub fn catch_up(&mut self, time_s: f64) -> Result<(), TickError> {
        // A thousandth of a sub-step forgives the rounding of two ways to count time.
        let step_s = self.meadow.scene.solver.substep_s;
        while self.meadow.time_s() + 0.999 * step_s < time_s {
            self.engine.tick(&mut self.meadow)?;
        }
        Ok(())
    }

    /// Compares both at the end of a frame.
    ///
    /// # Errors
    ///
    /// The engine's.
    pub fn frame(&mut self, meadow: &Meadow, engine: &mut Engine) -> Result<(), GpuError> {
        let ours = touched_plants(meadow, engine)?;
        let theirs = touched_plants(&self.meadow, &mut self.engine)?;
        self.comparison.frame(&ours, &theirs);
        Ok(())
    }

    /// What differed over all frames.
    pub fn finish(&self) -> Difference {
        self.comparison.finish(&self.meadow.field)
    }
}
