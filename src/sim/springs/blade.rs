//! The literal springs of a simulated blade, in place, for one sub-step.
//!
//! O09 eq. 6-7 as in [`literal`](super::literal), over the structural and bend springs of a blade's
//! centre line, its root pinned, rest lengths those of the wind pose. What the default does
//! instead is in [`relax`](crate::sim::relax). Nothing is allocated.
//!
//! Limits: the stable bound is that of the blade in any pose, so it needs the number of segments
//! alone; see [`chain_eigenvalue`].

use crate::base::{Real, Vec3};
use crate::field::{MAX_NODES, Nodes};

use super::crumpled::is_lost;
use super::literal::chain_eigenvalue;
use super::network::blade_pairs;
use super::{edge, shares, step};

/// What all blades of a meadow share in a sub-step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiteralBlade<R> {
    pub segments: usize,
    /// a of eq. 7: r·2a is the share of a spring's extension by which a node moves.
    pub step: R,
    /// The step asked for was above 0.9/λmax, which was taken.
    pub clamped: bool,
}

impl<R: Real> LiteralBlade<R> {
    /// The settings for springs of rate κ (1/s) over Δt, `rate_step` = κΔt, on blades of `segments`
    /// segments; more than a blade can have count as that many.
    pub fn new(rate_step: f64, segments: usize) -> Self {
        let segments = segments.min(MAX_NODES - 1);
        let bounded = step::literal(rate_step, chain_eigenvalue(segments));
        Self {
            segments,
            step: R::of(bounded.step),
            clamped: bounded.clamped,
        }
    }
}

/// One literal pass over a blade. Returns how many nodes were put back because an edge was
/// crumpled.
pub fn relax_blade<R: Real>(
    nodes: &mut Nodes<R>,
    wind: &Nodes<R>,
    settings: &LiteralBlade<R>,
) -> u32 {
    let reset = put_back(nodes, wind, settings.segments);
    let mut moves = [Vec3::ZERO; MAX_NODES];
    let twice_a = settings.step + settings.step;
    for [a, b] in blade_pairs(settings.segments) {
        let rest = wind[a] - wind[b];
        let (direction, length) = edge(nodes[a], nodes[b], rest.unit_or(-Vec3::UP));
        let correction = direction * (twice_a * (length - rest.length()));
        let [share_a, share_b] = shares([a == 0, false]).map(R::of);
        moves[a] -= correction * share_a;
        moves[b] += correction * share_b;
    }
    for (node, by) in nodes.iter_mut().zip(moves) {
        *node += by;
    }
    reset
}

/// As [`crumpled::put_back`](super::crumpled), for the edges of a blade's segments and bends.
fn put_back<R: Real>(nodes: &mut Nodes<R>, wind: &Nodes<R>, segments: usize) -> u32 {
    let before = *nodes;
    let mut moved = 0;
    for later in 1..=segments {
        let lost = |earlier: &usize| {
            let rest_length = (wind[*earlier] - wind[later]).length();
            is_lost(before[*earlier] - before[later], rest_length)
                || !(nodes[*earlier] - nodes[later]).length().is_finite()
        };
        let nearest = (later.saturating_sub(2)..later).find(lost);
        if let Some(earlier) = nearest {
            nodes[later] = nodes[earlier] + (wind[later] - wind[earlier]);
            moved += 1;
        }
    }
    moved
}
