//! What is taken for true of a scene: the reference engine's poses at every frame, recorded once
//! for all methods; and the noise floor, how far a second reference is from it.
//!
//! The second reference has 11 instead of 8 sub-steps of the grass, sweeps of a thirty-third instead
//! of a twentieth of a body's half thickness, and the union of closed forms of the convex parts
//! instead of the body's true shape. Both share the physics of the bodies, the order of constraints,
//! and for a body of one convex part the closed form itself: the floor holds the error of time and
//! of splitting a body, not that of the model.

use super::lane::{Lane, end_of_frame_s, frames};
use crate::run::compare::{Comparison, Difference, Plants};
use crate::run::scenario::RunError;
use crate::scene::method::Collide;
use crate::scene::{LoadedScene, Solver};
use crate::sim::reference;

/// Sub-steps of the grass in one of the scene's, and travel of a sweep, of the second reference.
const SECOND: (u32, f64) = (11, 1.0 / 33.0);

/// The reference's poses of a scene.
pub struct Truth {
    pub frames: Vec<Plants>,
    /// How far a second reference is from this one.
    pub floor: Difference,
}

impl Truth {
    /// Runs both references. `progress` gets the share done.
    ///
    /// # Errors
    ///
    /// A scene that cannot be laid out, or an event that cannot happen.
    pub fn record(loaded: &LoadedScene, mut progress: impl FnMut(f64)) -> Result<Self, RunError> {
        let scene = &loaded.scene;
        let mut first = Lane::reference(loaded, reference::solver(&scene.solver))?;
        let mut second = Lane::reference(loaded, second_solver(&scene.solver))?;
        let mut comparison = Comparison::default();
        let count = frames(scene.duration_s);
        let mut recorded = Vec::new();
        for frame in 0..count {
            first.advance_to(end_of_frame_s(frame))?;
            second.advance_to(end_of_frame_s(frame))?;
            let mut plants = first.plants()?;
            comparison.frame(&second.plants()?, &plants);
            for plant in plants.values_mut() {
                // Only measures of recovery read them.
                plant.offsets = Vec::new();
            }
            recorded.push(plants);
            progress(f64::from(frame + 1) / f64::from(count));
        }
        Ok(Self {
            frames: recorded,
            floor: comparison.finish(&first.meadow.field),
        })
    }

    /// Bytes of the recorded nodes.
    pub fn bytes(&self) -> u64 {
        let plants = self.frames.iter().flat_map(Plants::values);
        let nodes = plants.map(|plant| plant.nodes.len() + plant.wind.len());
        (nodes.sum::<usize>() * size_of::<[f64; 3]>()) as u64
    }
}

fn second_solver(scene: &Solver) -> Solver {
    let (grass_steps, sweep_share) = SECOND;
    let mut solver = reference::refined(scene, grass_steps, sweep_share);
    solver.method.collide = Collide::Analytic;
    solver
}
