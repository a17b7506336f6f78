//! The default passes.
//!
//! Billboards: spring after spring, each seeing what the ones before it did. Each spring shrinks its
//! own extension by the factor 1 − 2a, in (0, 1) for any κΔt. Correcting one of the springs that
//! share a node may stretch the others by more, at steps near ½.
//!
//! Blades: the segments get their exact lengths from root to tip (follow the leader), and each
//! bend spring shrinks its extension by 1 − 2a by turning all that is above its hinge as one, so that
//! no other bend spring notices (see [`hinge`](super::hinge)).
//!
//! A pass that ends with more energy than it began with is taken back, and each movable node in
//! turn moves against the gradient of the springs it has, by a share over their number. A spring's
//! energy has no curvature above 1 along any path of one end, so a node of n springs falls for any
//! share up to 2/n: this pass cannot raise the energy by more than rounding, and what is left of
//! that is taken back too.

use crate::base::{Real, Vec3};

use super::network::Network;
use super::{edge, hinge};

/// One pass. Returns whether it had to be replaced by a descending one. `before` is room for a
/// vector per node.
pub(super) fn pass<R: Real>(
    network: &Network<R>,
    nodes: &mut [Vec3<R>],
    step: R,
    before: &mut Vec<Vec3<R>>,
) -> bool {
    before.clear();
    before.extend_from_slice(nodes);
    let energy = network.energy(nodes);
    if network.is_blade {
        lay_out(network, nodes);
        hinge::turn(&network.rest, nodes, step + step);
    } else {
        sweep(network, nodes, step);
    }
    if network.energy(nodes) <= energy {
        return false;
    }
    nodes.copy_from_slice(before);
    // A blade's lengths are to hold at any rate of its bend springs.
    let share = if network.is_blade {
        R::ONE
    } else {
        step + step
    };
    descend(network, nodes, share);
    if network.energy(nodes) > energy {
        nodes.copy_from_slice(before);
    }
    true
}

fn sweep<R: Real>(network: &Network<R>, nodes: &mut [Vec3<R>], step: R) {
    let twice_a = step + step;
    for spring in &network.springs {
        let [a, b] = spring.ends;
        let (direction, length) = edge(nodes[a], nodes[b], spring.rest_direction);
        let correction = direction * (twice_a * (length - spring.rest_length));
        nodes[a] -= correction * spring.shares[0];
        nodes[b] += correction * spring.shares[1];
    }
}

/// Moves each node onto the rest length from the one before it, keeping directions.
fn lay_out<R: Real>(network: &Network<R>, nodes: &mut [Vec3<R>]) {
    for j in 1..nodes.len() {
        let rest = network.rest[j] - network.rest[j - 1];
        let (direction, _) = edge(nodes[j], nodes[j - 1], rest.unit_or(Vec3::UP));
        nodes[j] = nodes[j - 1] + direction * rest.length();
    }
}

fn descend<R: Real>(network: &Network<R>, nodes: &mut [Vec3<R>], share: R) {
    for (j, springs) in network.of_node.iter().enumerate() {
        if network.pinned[j] || springs.is_empty() {
            continue;
        }
        let mut gradient = Vec3::ZERO;
        for &s in springs {
            let spring = &network.springs[s];
            let [a, b] = spring.ends;
            let (direction, length) = edge(nodes[a], nodes[b], spring.rest_direction);
            let towards = if j == a { direction } else { -direction };
            gradient += towards * (length - spring.rest_length);
        }
        nodes[j] -= gradient * (share / R::of(springs.len() as f64));
    }
}
