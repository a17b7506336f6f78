//! Springs that keep the shape of a blade or a billboard.
//!
//! O09 section 5.4, eq. 6-7: a spring of rest length l₀ between v₁ and v₂, l = v₁ − v₂, moves its
//! ends by
//!
//! ```text
//! v₁ ← v₁ − r₁·2a·(‖l‖ − l₀)·l/‖l‖,   v₂ ← v₂ + r₂·2a·(‖l‖ − l₀)·l/‖l‖,   r₁ + r₂ = 1
//! ```
//!
//! with r = ½ between movable nodes, and 0 for a pinned node and 1 for the one beside it. O09
//! writes k·Δt for 2a, k ≤ 1, once per frame: that depends on the frame rate, does nothing with Δt
//! in seconds and explodes when scaled up. Here κ is a rate in 1/s, and [`relax`] knows two methods for
//! a network of springs, a billboard or a chain. The blades of a meadow are not relaxed by it: theirs
//! are the bend springs of [`sim::relax`](crate::sim::relax), or [`relax_blade`] where a scene asks for
//! the printed formulas.
//!
//! - [`Method::Sequential`]: spring after spring, each seeing what the ones before it
//!   did, with a = κΔt/(1 + 2κΔt), which is first-order XPBD with compliance 1/(κΔt) (see
//!   [`step`]). Stable at any κΔt. A blade's segments keep their exact lengths, and its bend springs
//!   turn its hinges. The energy ½Σ(‖l‖ − l₀)² never grows: a pass that would raise it is replaced
//!   by one that descends node by node (see [`sequential`]).
//! - [`Method::Literal`]: all springs at once from the same nodes (Jacobi) with
//!   a = min(κΔt/2, 0.9/λmax), λmax the largest eigenvalue of the springs' stiffness at rest, pinned
//!   ends counted with weight 2 (see [`literal`]). Whether the bound was taken is reported.
//!
//! An edge shorter than 1% of its rest length has no direction worth following: before the first
//! pass its node is put back at the rest offset from the node before it, and counted. So are the
//! rows of a billboard that run against the row below them (see [`crumpled`]).
//!
//! Limits: every result is finite for any finite nodes; an edge too long for its square to be a
//! float is put back like a crumpled one. Springs between two pinned nodes do nothing and are left
//! out.

pub mod blade;
pub mod crumpled;
pub mod hinge;
pub mod literal;
pub mod network;
pub mod sequential;
pub mod step;

use crate::base::{Real, Vec3};

pub use blade::{LiteralBlade, relax_blade};
pub use network::{Network, Spring};

/// Passes of the default method in a sub-step of 1/120 s that take a billboard of up to 5 × 5 nodes
/// from any of the tested distortions to 1% strain within a second, at κ = 60 /s: a billboard's springs
/// hold its lengths, and are stiffer than a blade's bend springs, whose lengths are laid out.
///
/// There a is ¼, and on 3 × 5 nodes the slowest mode (λ = 0.0171) shrinks by 0.78% a pass, nearly
/// twice the aλ of a Jacobi pass, because a sweep sees its own moves. 480 passes leave 2.4% of it,
/// and that mode is a small part of the largest strain.
pub const BILLBOARD_PASSES: u32 = 4;

/// r of a node between movable nodes.
pub const SHARE_FREE: f64 = 0.5;
/// r of a pinned node: it stays where it is.
pub const SHARE_PINNED: f64 = 0.0;
/// r of a movable node beside a pinned one: it takes the whole correction.
pub const SHARE_BESIDE_PINNED: f64 = 1.0;

/// r₁ and r₂ of the ends of a spring, given whether each is pinned. They add up to 1, or to 0 where
/// nothing can move.
pub fn shares(pinned: [bool; 2]) -> [f64; 2] {
    match pinned {
        [false, false] => [SHARE_FREE; 2],
        [true, false] => [SHARE_PINNED, SHARE_BESIDE_PINNED],
        [false, true] => [SHARE_BESIDE_PINNED, SHARE_PINNED],
        [true, true] => [SHARE_PINNED; 2],
    }
}

/// How springs are relaxed.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Method {
    #[default]
    Sequential,
    /// O09 eq. 6-7 as written, behind the bound that keeps it stable.
    Literal,
}

/// What a call to [`relax`] did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxed {
    /// a of the passes.
    pub step: f64,
    /// The step asked for was above the stable bound of the literal method, and the bound was
    /// taken.
    pub clamped: bool,
    /// Nodes put back from the rest shape because an edge was crumpled or too long to measure.
    pub reset: u32,
    /// Passes that would have raised the energy and were replaced by a descending one.
    pub replaced: u32,
}

/// Moves `nodes` towards the network's rest lengths: `passes` passes, each for `rate_step` = κΔt.
///
/// `nodes` are as many as the network has; others are left alone. `rate_step` below 0 or not a
/// number counts as 0.
pub fn relax<R: Real>(
    network: &Network<R>,
    nodes: &mut [Vec3<R>],
    method: Method,
    rate_step: f64,
    passes: u32,
    scratch: &mut Vec<Vec3<R>>,
) -> Relaxed {
    if nodes.len() < network.rest.len() {
        return Relaxed {
            step: 0.0,
            clamped: false,
            reset: 0,
            replaced: 0,
        };
    }
    let nodes = &mut nodes[..network.rest.len()];
    let mut done = Relaxed {
        step: 0.0,
        clamped: false,
        reset: crumpled::put_back(&network.at_rest(), nodes, scratch),
        replaced: 0,
    };
    match method {
        Method::Sequential => {
            done.step = step::rational(rate_step);
            for _ in 0..passes {
                done.replaced +=
                    u32::from(sequential::pass(network, nodes, R::of(done.step), scratch));
            }
        }
        Method::Literal => {
            let bounded = step::literal(rate_step, network.largest_eigenvalue);
            (done.step, done.clamped) = (bounded.step, bounded.clamped);
            for _ in 0..passes {
                literal::pass(network, nodes, R::of(done.step), scratch);
            }
        }
    }
    done
}

/// l/‖l‖ and ‖l‖ of an edge from `b` to `a`; the rest direction where it is too short to have one
/// or too long to measure.
fn edge<R: Real>(a: Vec3<R>, b: Vec3<R>, rest_direction: Vec3<R>) -> (Vec3<R>, R) {
    let across = a - b;
    let length = across.length();
    if length.is_finite() {
        (across.unit_or(rest_direction), length)
    } else {
        (rest_direction, R::ZERO)
    }
}

#[cfg(test)]
mod tests;
