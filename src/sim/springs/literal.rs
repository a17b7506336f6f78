//! O09 eq. 6-7 as written: every spring from the same nodes, all moves added up (Jacobi).
//!
//! The moves are a step of gradient descent on ½Σw(‖l‖ − l₀)², w = 1 between movable nodes and 2
//! beside a pinned one, whose partner moves twice as far. Linearised at rest it multiplies a mode
//! of the stiffness K = Σ w·d·dᵀ by 1 − aλ: below a = 1/λmax each mode shrinks without a change of
//! sign, from 2/λmax on it explodes. O09 has no bound; 0.9/λmax is kept here.
//!
//! Away from rest K is larger: a stretched spring also has stiffness across its direction.
//! ‖x_i − x_j‖² instead of (d·(x_i − x_j))² bounds both, for any pose (see
//! [`chain_eigenvalue`]); for a straight chain the two are equal. So a blade's weighted energy
//! never grows; a billboard's may, and the unweighted energy of either: it is measured.

use crate::base::{Real, Vec3};

use super::network::{Network, Spring, blade_pairs};
use super::{SHARE_FREE, edge, shares};

/// The power iteration ends when λmax changes by less than this share in a round.
const SETTLED: f64 = 1e-12;
/// Rounds of it. The quotient lies below λmax by the square of the gap that is left: after these
/// rounds by less than 1e-4 on a billboard of 17 × 17, far less than the share of the bound that
/// is not taken.
const ROUNDS: u32 = 4000;

/// One pass. `moves` is room for a vector per node.
pub(super) fn pass<R: Real>(
    network: &Network<R>,
    nodes: &mut [Vec3<R>],
    step: R,
    moves: &mut Vec<Vec3<R>>,
) {
    moves.clear();
    moves.resize(nodes.len(), Vec3::ZERO);
    let twice_a = step + step;
    for spring in &network.springs {
        let [a, b] = spring.ends;
        let (direction, length) = edge(nodes[a], nodes[b], spring.rest_direction);
        let correction = direction * (twice_a * (length - spring.rest_length));
        moves[a] -= correction * spring.shares[0];
        moves[b] += correction * spring.shares[1];
    }
    for (node, &by) in nodes.iter_mut().zip(moves.iter()) {
        *node += by;
    }
}

/// λmax of Σ w·d·dᵀ over the movable nodes, w = 1, or 2 beside a pinned node.
pub(super) fn largest_eigenvalue<R: Real>(nodes: usize, springs: &[Spring<R>]) -> f64 {
    let terms: Vec<_> = springs
        .iter()
        .map(|spring| Term {
            ends: spring.ends,
            // A share of ½ moves a node by a, one of 1 by 2a.
            weights: spring.shares.map(|share| share.to_f64() / SHARE_FREE),
            direction: Vec3::of(spring.rest_direction.to_f64()),
        })
        .collect();
    power_iteration(nodes, &terms)
}

/// λmax that holds for a blade of so many segments in any pose: that of a straight one with
/// structural and bend springs and a pinned root.
pub fn chain_eigenvalue(segments: usize) -> f64 {
    any_pose_eigenvalue(segments + 1, blade_pairs(segments), |end| end == 0)
}

/// λmax that holds for a network in any pose: as if all its springs lay along one line.
pub fn any_pose_eigenvalue(
    nodes: usize,
    pairs: impl Iterator<Item = [usize; 2]>,
    pinned: impl Fn(usize) -> bool,
) -> f64 {
    let terms: Vec<_> = pairs
        .map(|ends| Term {
            ends,
            weights: shares(ends.map(&pinned)).map(|share| share / SHARE_FREE),
            direction: Vec3::UP,
        })
        .collect();
    power_iteration(nodes, &terms)
}

/// A spring in the stiffness matrix.
pub(super) struct Term {
    pub ends: [usize; 2],
    /// 0 for a pinned end, else 1, or 2 beside a pinned one.
    pub weights: [f64; 2],
    pub direction: Vec3<f64>,
}

pub(super) fn power_iteration(nodes: usize, terms: &[Term]) -> f64 {
    // Any start with a part along the wanted mode: neighbours against each other, uneven, so that
    // no symmetry of the network hides it.
    let mut mode: Vec<Vec3<f64>> = (0..nodes)
        .map(|j| {
            let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
            let j = j as f64;
            Vec3::new(1.0 + 0.01 * j, 0.9 - 0.013 * j, 0.7 + 0.017 * j) * sign
        })
        .collect();
    let mut largest = 0.0;
    for _ in 0..ROUNDS {
        let mut next = vec![Vec3::ZERO; nodes];
        for term in terms {
            let [a, b] = term.ends;
            let stretch = term.direction.dot(mode[a] - mode[b]);
            next[a] += term.direction * (stretch * term.weights[0]);
            next[b] -= term.direction * (stretch * term.weights[1]);
        }
        let size = norm(&next);
        if size <= 0.0 {
            return 0.0;
        }
        next.iter_mut().for_each(|v| *v = *v * (1.0 / size));
        mode = next;
        if (size - largest).abs() <= SETTLED * size {
            return size;
        }
        largest = size;
    }
    largest
}

fn norm(vectors: &[Vec3<f64>]) -> f64 {
    vectors
        .iter()
        .map(|v| v.length_squared())
        .sum::<f64>()
        .sqrt()
}
