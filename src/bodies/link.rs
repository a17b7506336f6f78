//! A rigid piece of a body as the grass sees it during one sub-step.

use crate::base::Pose;
use crate::scene::Collider;

/// One rigid piece: a plain body has one link, a vehicle one for its chassis and one per wheel.
#[derive(Clone, Debug)]
pub struct Link {
    /// Rank of the body's name among all names of the scene, spawned ones included.
    pub body: u32,
    /// Index into the shape library.
    pub shape: u32,
    /// `world_from_body` at the start of the sub-step. Equal to `to` after a teleport.
    pub from: Pose<f64>,
    /// `world_from_body` at its end.
    pub to: Pose<f64>,
    /// As the scene wishes; the simulation resolves `Auto`.
    pub collider: Collider,
    /// Linear RGB.
    pub rgb: [f32; 3],
}
