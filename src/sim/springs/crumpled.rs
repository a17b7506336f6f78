//! Edges without a direction: put back from the rest shape before the springs act.
//!
//! An edge shorter than 1% of its rest length, or too long for its square to be a float, says
//! nothing about where its nodes should go. Nodes are visited in the network's order: a movable
//! node with such an edge to a node before it is placed at the rest offset from that one, so
//! that a network whose nodes all lie at one point unfolds to its rest shape at once.
//!
//! A row of a billboard that runs against the row below it is inverted. Flat as it is, no spring
//! pulls it out of its plane, and within the plane it settles crumpled, strained by half and more
//! (measured); so its nodes are put back above those below them, too.
//!
//! Source: none; O09 divides by ‖l‖ here. Limits: the rest shape is not turned with the plant,
//! so that a bent part comes back upright and bends anew.

use crate::base::{Real, Vec3};

/// Share of its rest length below which an edge is crumpled.
pub const CRUMPLED_SHARE: f64 = 0.01;

/// Whether an edge is too short, or too long, to have a direction.
pub fn is_lost<R: Real>(across: Vec3<R>, rest_length: R) -> bool {
    let length = across.length();
    !length.is_finite() || length < rest_length * R::of(CRUMPLED_SHARE)
}

/// What is known of a network at rest.
#[derive(Clone, Copy, Debug)]
pub struct AtRest<'a, R> {
    pub nodes: &'a [Vec3<R>],
    /// Nodes in a row of a billboard; 0 for chains.
    pub columns: usize,
    /// Nodes at the front that are pinned.
    pub pinned: usize,
    /// Earlier nodes that a node has a spring to.
    pub earlier: &'a [Vec<usize>],
}

/// Puts back what is crumpled, then what is inverted. Returns how many nodes were moved. `before` is room for a vector
/// per node.
pub fn put_back<R: Real>(
    rest: &AtRest<R>,
    nodes: &mut [Vec3<R>],
    before: &mut Vec<Vec3<R>>,
) -> u32 {
    before.clear();
    before.extend_from_slice(nodes);
    let mut moved = 0;
    for later in rest.pinned..nodes.len() {
        let lost = rest.earlier[later].iter().copied().find(|&earlier| {
            let rest_length = (rest.nodes[earlier] - rest.nodes[later]).length();
            // As the nodes were, since a node put back is no longer near the next one; and as
            // they are, since it may now be out of reach of it.
            is_lost(before[earlier] - before[later], rest_length)
                || !(nodes[earlier] - nodes[later]).length().is_finite()
        });
        if let Some(earlier) = lost {
            nodes[later] = nodes[earlier] + (rest.nodes[later] - rest.nodes[earlier]);
            moved += 1;
        }
    }
    moved + turn_back(rest, nodes, before)
}

/// Puts back the rows of a billboard that run against the row below them. Returns how many nodes
/// were moved.
fn turn_back<R: Real>(rest: &AtRest<R>, nodes: &mut [Vec3<R>], before: &mut Vec<Vec3<R>>) -> u32 {
    let columns = rest.columns;
    if columns < 2 {
        return 0;
    }
    before.clear();
    before.extend_from_slice(nodes);
    let mut moved = 0;
    for row in 1..nodes.len() / columns {
        let first = row * columns;
        let against = |nodes: &[Vec3<R>], left: usize| {
            let below = nodes[left + 1 - columns] - nodes[left - columns];
            (before[left + 1] - before[left]).dot(below) < R::ZERO
        };
        for column in 0..columns {
            let here = first + column;
            let left = column > 0 && against(nodes, here - 1);
            let right = column + 1 < columns && against(nodes, here);
            if left || right {
                let offset = rest.nodes[here] - rest.nodes[here - columns];
                nodes[here] = nodes[here - columns] + offset;
                moved += 1;
            }
        }
    }
    moved
}
