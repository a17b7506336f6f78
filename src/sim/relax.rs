//! Relax: what a touched plant does within one sub-step.
//!
//! Push out, then (springs and lengths, push out, ground) until no segment is strained by more
//! than the limit, at least and at most as often as the solver says; the ground wins over the
//! body. The sub-step is cut into sweeps, so that no body crosses more than half its half
//! thickness at once.
//!
//! Springs (O09 eq. 6-7, responsibilities r₁ + r₂ = 1): structural ones are replaced by lengths
//! from root to tip, which hold exactly after one pass; bend springs join every second node and
//! rest at the wind pose's distance. A node moves by r·2a·(‖l‖ − l₀) with a = ½(1 − e^(−2κΔt)),
//! which is the same at any Δt, instead of k·Δt, which is not. Springs act only on plants pushed in
//! this sub-step. WGSL twin: `shaders/relax.wgsl`.

use crate::base::{Real, Vec3};
use crate::field::{Anchor, Nodes};
use crate::terrain::HeightGrid;

use super::contact::Touch;
use super::recover::restore_lengths;

/// What the kernel needs besides the plant.
#[derive(Clone, Copy, Debug)]
pub struct RelaxSettings<R> {
    /// 2a of the bend springs.
    pub bend: R,
    pub fewest_rounds: u32,
    pub most_rounds: u32,
    pub strain_limit: R,
}

impl<R: Real> RelaxSettings<R> {
    pub fn new(solver: &crate::scene::Solver) -> Self {
        let rate = f64::from(solver.spring_rate_per_s) * solver.substep_s;
        Self {
            bend: R::of(1.0 - libm::exp(-2.0 * rate)),
            fewest_rounds: solver.rounds[0],
            most_rounds: solver.rounds[1],
            strain_limit: R::of_f32(solver.strain_limit),
        }
    }
}

/// A plant's surroundings.
#[derive(Clone, Copy, Debug)]
pub struct Place<'a, R> {
    pub ground: &'a HeightGrid,
    pub anchor: &'a Anchor,
    pub wind: &'a Nodes<R>,
    pub segments: usize,
    /// Rest length of a segment, in metres.
    pub length: R,
}

/// Sweeps a plant needs: the most of any body that may reach it; 0 if none does.
pub fn sweeps_for<R: Real>(touches: &[Touch<R>], root: Vec3<R>, reach: R) -> u32 {
    touches
        .iter()
        .filter(|touch| touch.reaches(root, reach))
        .map(|touch| touch.sweeps)
        .max()
        .unwrap_or(0)
}

/// Runs one sub-step for a plant. `nodes` and the nodes' `faces` are changed in place. Returns the
/// largest number of rounds a sweep took; 0 means that nothing touched the plant.
pub fn respond<R: Real>(
    nodes: &mut Nodes<R>,
    faces: &mut [u32],
    touches: &[Touch<R>],
    sweeps: u32,
    reach: R,
    place: &Place<R>,
    settings: &RelaxSettings<R>,
) -> u32 {
    let mut rounds_used = 0;
    for sweep in 1..=sweeps {
        let share = R::of(f64::from(sweep)) / R::of(f64::from(sweeps));
        if !push_out_all(nodes, faces, touches, share, reach, place.segments) {
            continue;
        }
        for round in 1..=settings.most_rounds {
            bend_springs(nodes, place, settings.bend);
            restore_lengths(nodes, place.wind, place.segments, place.length);
            push_out_all(nodes, faces, touches, share, reach, place.segments);
            keep_above_ground(nodes, place);
            rounds_used = rounds_used.max(round);
            let strain = largest_strain(nodes, place.segments, place.length);
            if round >= settings.fewest_rounds && strain <= settings.strain_limit {
                break;
            }
        }
    }
    rounds_used
}

/// Pushes every node out of every part that reaches the plant, parts in their order.
fn push_out_all<R: Real>(
    nodes: &mut Nodes<R>,
    faces: &mut [u32],
    touches: &[Touch<R>],
    share: R,
    reach: R,
    segments: usize,
) -> bool {
    let mut pushed = false;
    for touch in touches {
        if !touch.reaches(nodes[0], reach) {
            continue;
        }
        let pose = touch.from.lerp(touch.to, share);
        for j in 0..segments {
            pushed |= touch.push_out(&pose, &mut nodes[j + 1], &mut faces[j]);
        }
    }
    pushed
}

fn bend_springs<R: Real>(nodes: &mut Nodes<R>, place: &Place<R>, twice_a: R) {
    let half = R::of(0.5);
    for j in 0..place.segments.saturating_sub(1) {
        let rest = (place.wind[j + 2] - place.wind[j]).length();
        let across = nodes[j + 2] - nodes[j];
        let length = across.length();
        let direction = across.unit_or(Vec3::UP);
        let correction = direction * (twice_a * (length - rest));
        // The root is pinned: it has no responsibility, its partner has all of it.
        let lower = if j == 0 { R::ZERO } else { half };
        nodes[j] += correction * lower;
        nodes[j + 2] -= correction * (R::ONE - lower);
    }
}

fn keep_above_ground<R: Real>(nodes: &mut Nodes<R>, place: &Place<R>) {
    for node in &mut nodes[1..=place.segments] {
        let height =
            crate::field::grid::ground_in_anchor(place.ground, place.anchor, node.x, node.z);
        node.y = node.y.max(height);
    }
}

/// Largest relative change of a segment's length.
pub fn largest_strain<R: Real>(nodes: &Nodes<R>, segments: usize, length: R) -> R {
    (0..segments).fold(R::ZERO, |worst, j| {
        let strain = (nodes[j + 1] - nodes[j]).length() / length - R::ONE;
        worst.max(strain.abs())
    })
}
