//! One run of a scene, advanced frame by frame beside others.

use crate::gpu::TickError;
use crate::run::compare::{Plants, touched_plants};
use crate::run::engine::Engine;
use crate::run::scenario::{Device, RunError};
use crate::scene::{LoadedScene, Solver};
use crate::sim::Meadow;

/// Frames per second at which poses are compared: every sub-step that a method has fits in whole
/// numbers.
pub const FRAMES_PER_S: f64 = 30.0;

/// Entries of the reference's table of resting blades, whose error falls with their square: for the
/// default kind 1e-5 of a blade's length.
pub const REFERENCE_TABLE: [u32; 2] = [512, 256];

/// What a lane computes with.
#[derive(Clone, Copy, Debug)]
pub enum Kind<'a> {
    /// The cpu engine, in `f32`.
    Single,
    /// The same kernels in `f64`.
    Double,
    Device(&'a Device),
}

/// A meadow with its engine, and the time its sub-steps took.
pub struct Lane {
    name: String,
    pub meadow: Meadow,
    pub engine: Engine,
    /// Milliseconds that collide and relax took in each sub-step in which a body was near grass.
    pub grass_ms: Vec<f64>,
    /// Their sum since it was last taken.
    frame_ms: Option<f64>,
}

impl Lane {
    /// Lays a scene out with other settings of its solver.
    ///
    /// # Errors
    ///
    /// A scene that cannot be laid out, or one that the device cannot hold.
    pub fn new(loaded: &LoadedScene, solver: &Solver, kind: Kind<'_>) -> Result<Self, RunError> {
        let name = loaded.name.clone();
        let mut scene = loaded.scene.clone();
        scene.solver = solver.clone();
        let meadow = Meadow::new(scene, &loaded.assets);
        let mut meadow = meadow.map_err(|error| RunError::new(&name, error))?;
        let engine = match kind {
            Kind::Single => Ok(Engine::cpu()),
            Kind::Double => Ok(Engine::Reference(Box::default())),
            Kind::Device(device) => device.engine(&mut meadow),
        };
        Ok(Self {
            engine: engine.map_err(|error| RunError::new(&name, error))?,
            name,
            meadow,
            grass_ms: Vec::new(),
            frame_ms: None,
        })
    }

    /// Lays a scene out in `f64`, with resting blades from a fine table, and with settings of a
    /// reference, which go beyond what a scene may ask for, so that they come after it was laid out.
    ///
    /// # Errors
    ///
    /// A scene that cannot be laid out.
    pub fn reference(loaded: &LoadedScene, solver: Solver) -> Result<Self, RunError> {
        let laid_out = Solver {
            blade_table: Some(REFERENCE_TABLE),
            ..loaded.scene.solver.clone()
        };
        let mut lane = Self::new(loaded, &laid_out, Kind::Double)?;
        lane.meadow.set_solver(solver);
        Ok(lane)
    }

    /// Runs the sub-steps up to a time.
    ///
    /// # Errors
    ///
    /// The script's or the device's.
    pub fn advance_to(&mut self, time_s: f64) -> Result<(), RunError> {
        // Half a sub-step forgives the rounding of two ways to count time.
        while self.meadow.time_s() + 0.5 * self.meadow.scene.solver.substep_s < time_s {
            self.tick()?;
        }
        Ok(())
    }

    /// Runs one sub-step.
    ///
    /// # Errors
    ///
    /// As for [`Lane::advance_to`].
    pub fn tick(&mut self) -> Result<(), RunError> {
        let before = grass_ms(&self.engine);
        let ticked = self.engine.tick(&mut self.meadow);
        ticked.map_err(|error| self.error(error))?;
        if !self.meadow.work.contacts.is_empty() {
            let ms = grass_ms(&self.engine) - before;
            self.grass_ms.push(ms);
            self.frame_ms = Some(self.frame_ms.unwrap_or(0.0) + ms);
        }
        Ok(())
    }

    /// Milliseconds that collide and relax took since this was last asked; `None` where no body was
    /// near grass.
    pub fn take_frame_ms(&mut self) -> Option<f64> {
        self.frame_ms.take()
    }

    /// Every plant that a body has touched and that is not back at rest.
    ///
    /// # Errors
    ///
    /// The device's.
    pub fn plants(&mut self) -> Result<Plants, RunError> {
        let plants = touched_plants(&self.meadow, &mut self.engine);
        plants.map_err(|error| self.error(error))
    }

    /// Every plant of the field, resting ones included.
    ///
    /// # Errors
    ///
    /// The device's.
    pub fn all_plants(&mut self) -> Result<Plants, RunError> {
        let mut plants = Plants::new();
        for tile in 0..self.meadow.field.grid.tile_count() {
            let found = self.engine.of_tile(&self.meadow, tile);
            let found = found.map_err(|error| self.error(error))?;
            plants.extend(found.into_iter().map(|p| ((tile, p.place), p)));
        }
        Ok(plants)
    }

    /// An error of this run.
    pub fn error(&self, source: impl Into<TickError>) -> RunError {
        RunError::new(&self.name, source)
    }
}

/// Milliseconds of collide and relax so far.
fn grass_ms(engine: &Engine) -> f64 {
    let passes = engine.pass_ms().into_iter();
    let of_grass = passes.filter(|(pass, _)| matches!(*pass, "collide" | "relax"));
    of_grass.map(|(_, ms)| ms).sum()
}

/// Frames of a scene that are compared.
pub fn frames(duration_s: f64) -> u32 {
    (duration_s * FRAMES_PER_S).ceil() as u32
}

/// The end of a frame, counted from 0, in seconds.
pub fn end_of_frame_s(frame: u32) -> f64 {
    f64::from(frame + 1) / FRAMES_PER_S
}
