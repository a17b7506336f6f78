//! Collide: which plants a body touches in this sub-step.
//!
//! O09 section 5.2: bounding spheres first, then the vertices against the body's depth cube (or its
//! closed form). A plant that no vertex of which is inside a body in any sweep is left alone: it
//! only recovers. WGSL twin: `shaders/collide.wgsl`.

use crate::base::Real;
use crate::field::Nodes;

use super::contact::Touch;

/// True where a node of the plant is inside a part during one of the sweeps.
pub fn touched<R: Real>(
    nodes: &Nodes<R>,
    segments: usize,
    touches: &[Touch<R>],
    sweeps: u32,
    reach: R,
) -> bool {
    touches
        .iter()
        .filter(|touch| touch.reaches(nodes[0], reach))
        .any(|touch| {
            (1..=sweeps).any(|sweep| {
                let share = R::of(f64::from(sweep)) / R::of(f64::from(sweeps));
                let pose = touch.from.lerp(touch.to, share);
                nodes[1..=segments]
                    .iter()
                    .any(|&node| touch.holds(&pose, node))
            })
        })
}
