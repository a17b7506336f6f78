//! Collide: which plants a body touches in this sub-step.
//!
//! O09 section 5.2: bounding spheres first, then the vertices against the body's depth cube (or its
//! closed form). A plant that no vertex of which is inside a body in any sweep is left alone: it
//! only recovers. WGSL twin: `shaders/collide.wgsl`.

use crate::base::{Real, Vec3};
use crate::field::{MAX_NODES, Nodes};

use super::contact::Touch;

/// True where a plant that was pushed in the sub-step before is still held by a body: it keeps its
/// pose, and does not recover yet. Without this it would sink into the body a little in every
/// sub-step and be pushed out again, and tremble for ever.
pub fn held<R: Real>(nodes: &Nodes<R>, segments: usize, touches: &[Touch<R>], reach: R) -> bool {
    any_node(nodes, segments, touches, reach, Touch::nearly_holds)
}

/// True where a plant that is let go would recover into a body within this sub-step, in which nobody
/// looks at it again: it keeps its pose too. `nodes` is its pose of now.
pub fn in_the_way<R: Real>(
    nodes: &Nodes<R>,
    segments: usize,
    touches: &[Touch<R>],
    reach: R,
) -> bool {
    any_node(nodes, segments, touches, reach, Touch::will_hold)
}

/// True where a movable node is to a part within reach what `holds` asks.
fn any_node<'a, R: Real>(
    nodes: &Nodes<R>,
    segments: usize,
    touches: &[Touch<'a, R>],
    reach: R,
    holds: impl Fn(&Touch<'a, R>, Vec3<R>) -> bool,
) -> bool {
    let mut near = touches
        .iter()
        .filter(|touch| touch.reaches(nodes[0], reach));
    near.any(|touch| nodes[1..=segments].iter().any(|&node| holds(touch, node)))
}

/// A node this close to the ground cannot get out of a body that stands on it, in metres.
pub const PINNED_M: f64 = 1e-3;

/// True where a node of the plant is inside a part during one of the sweeps. Nodes that are
/// `pinned` are passed over: those of a plant pushed in the sub-step before that lie on the ground,
/// where pushing again would only shuffle them.
pub fn touched<R: Real>(
    nodes: &Nodes<R>,
    segments: usize,
    touches: &[Touch<R>],
    sweeps: u32,
    reach: R,
    pinned: impl Fn(Vec3<R>) -> bool,
) -> bool {
    let mut free = [false; MAX_NODES];
    for (free, &node) in free.iter_mut().zip(&nodes[..=segments]) {
        *free = !pinned(node);
    }
    touches
        .iter()
        .filter(|touch| touch.reaches(nodes[0], reach))
        .any(|touch| {
            (1..=sweeps).any(|sweep| {
                let share = R::of(f64::from(sweep)) / R::of(f64::from(sweeps));
                let pose = touch.from.lerp(touch.to, share);
                (1..=segments).any(|j| free[j] && touch.holds(&pose, nodes[j]))
            })
        })
}
