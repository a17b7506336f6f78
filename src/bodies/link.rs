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
    /// It came to `from` by a jump: it was spawned, teleported, or started its path anew.
    pub placed: bool,
    /// As the scene wishes; the simulation resolves `Auto`.
    pub collider: Collider,
    /// Linear RGB.
    pub rgb: [f32; 3],
    /// Index into [`Bodies::coated`](super::Bodies::coated).
    pub coat: Option<u32>,
}

impl Link {
    /// The piece's way through one of `parts` equal shares of the sub-step.
    pub fn piece(&self, part: u32, parts: u32) -> Self {
        let at = |n: u32| match n {
            0 => self.from,
            n if n == parts => self.to,
            n => self.from.lerp(self.to, f64::from(n) / f64::from(parts)),
        };
        Self {
            from: at(part),
            to: at(part + 1),
            placed: self.placed && part == 0,
            ..self.clone()
        }
    }
}
