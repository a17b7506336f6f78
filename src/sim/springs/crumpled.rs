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

use super::network::Network;

/// Share of its rest length below which an edge is crumpled.
pub const CRUMPLED_SHARE: f64 = 0.01;

/// Whether an edge is too short, or too long, to have a direction.
pub fn is_lost<R: Real>(across: Vec3<R>, rest_length: R) -> bool {
    let length = across.length();
    !length.is_finite() || length < rest_length * R::of(CRUMPLED_SHARE)
}

/// Puts back what is crumpled, then what is inverted. Returns how many nodes were moved. `before` is room for a vector
/// per node.
pub(super) fn put_back<R: Real>(
    network: &Network<R>,
    nodes: &mut [Vec3<R>],
    before: &mut Vec<Vec3<R>>,
) -> u32 {
    before.clear();
    before.extend_from_slice(nodes);
    let mut moved = 0;
    for (later, springs) in network.of_node.iter().enumerate() {
        if network.pinned[later] {
            continue;
        }
        let lost = springs.iter().map(|&s| &network.springs[s]).find(|spring| {
            let [earlier, end] = spring.ends;
            // As the nodes were, since a node put back is no longer near the next one; and as
            // they are, since it may now be out of reach of it.
            end == later
                && (is_lost(before[earlier] - before[end], spring.rest_length)
                    || !(nodes[earlier] - nodes[end]).length().is_finite())
        });
        if let Some(spring) = lost {
            let offset = network.rest[later] - network.rest[spring.ends[0]];
            nodes[later] = nodes[spring.ends[0]] + offset;
            moved += 1;
        }
    }
    moved + turn_back(network, nodes, before)
}

/// Puts back the rows of a billboard that run against the row below them. Returns how many nodes
/// were moved.
fn turn_back<R: Real>(
    network: &Network<R>,
    nodes: &mut [Vec3<R>],
    before: &mut Vec<Vec3<R>>,
) -> u32 {
    let columns = network.columns;
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
                let offset = network.rest[here] - network.rest[here - columns];
                nodes[here] = nodes[here - columns] + offset;
                moved += 1;
            }
        }
    }
    moved
}
