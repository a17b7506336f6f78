//! Collide: which plants a body touches in this sub-step.
//!
//! O09 section 5.2: bounding spheres first, then the vertices against the body's depth cube (or its
//! closed form). A plant that no vertex of which is inside a body in any sweep is left alone: it
//! only recovers. WGSL twin: `shaders/collide.wgsl`.

use crate::base::{Real, Vec3};
use crate::field::Nodes;

use super::contact::Touch;

/// Most movable nodes of a plant: a billboard's of 9 × 9, but for its lowest row.
pub const MAX_MOVABLE: usize = 72;

/// The nodes of a plant that a body may move, and its root.
#[derive(Clone, Copy, Debug)]
pub struct Movable<'a, R> {
    pub root: Vec3<R>,
    /// [`MAX_MOVABLE`] at most.
    pub nodes: &'a [Vec3<R>],
}

impl<'a, R: Real> Movable<'a, R> {
    /// All nodes of a blade but its root.
    pub fn of_blade(nodes: &'a Nodes<R>, segments: usize) -> Self {
        Self {
            root: nodes[0],
            nodes: &nodes[1..=segments],
        }
    }
}

/// True where a plant that was pushed in the sub-step before is still held by a body: it keeps its
/// pose, and does not recover yet. Without this it would sink into the body a little in every
/// sub-step and be pushed out again, and tremble for ever.
pub fn held<R: Real>(plant: Movable<R>, touches: &[Touch<R>], reach: R) -> bool {
    any_node(plant, touches, reach, Touch::nearly_holds)
}

/// True where a plant that is let go would recover into a body within this sub-step, in which nobody
/// looks at it again: it keeps its pose too. `plant` is in its pose of now.
pub fn in_the_way<R: Real>(plant: Movable<R>, touches: &[Touch<R>], reach: R) -> bool {
    any_node(plant, touches, reach, Touch::will_hold)
}

/// True where a movable node is to a part within reach what `holds` asks.
fn any_node<'a, R: Real>(
    plant: Movable<R>,
    touches: &[Touch<'a, R>],
    reach: R,
    holds: impl Fn(&Touch<'a, R>, Vec3<R>) -> bool,
) -> bool {
    let mut near = touches
        .iter()
        .filter(|touch| touch.reaches(plant.root, reach));
    near.any(|touch| plant.nodes.iter().any(|&node| holds(touch, node)))
}

/// A node this close to the ground cannot get out of a body that stands on it, in metres.
pub const PINNED_M: f64 = 1e-3;

/// True where a node of the plant is inside a part during one of the sweeps. Nodes that are
/// `pinned` are passed over: those of a plant pushed in the sub-step before that lie on the ground,
/// where pushing again would only shuffle them.
pub fn touched<R: Real>(
    plant: Movable<R>,
    touches: &[Touch<R>],
    sweeps: u32,
    reach: R,
    pinned: impl Fn(Vec3<R>) -> bool,
) -> bool {
    let mut free = [false; MAX_MOVABLE];
    for (free, &node) in free.iter_mut().zip(plant.nodes) {
        *free = !pinned(node);
    }
    touches
        .iter()
        .filter(|touch| touch.reaches(plant.root, reach))
        .any(|touch| {
            (1..=sweeps).any(|sweep| {
                let share = R::of(f64::from(sweep)) / R::of(f64::from(sweeps));
                let pose = touch.from.lerp(touch.to, share);
                let mut movable = plant.nodes.iter().zip(&free);
                movable.any(|(&node, &free)| free && touch.holds(&pose, node))
            })
        })
}
