//! Relax: what a touched plant does within one sub-step.
//!
//! Push out, springs, then lay out from root to tip, along the ground and around bodies, until no
//! segment is strained by more than the limit, at least and at most as often as the solver says; the
//! ground wins over the body. The sub-step is cut into sweeps, so that no body crosses more than a
//! sixteenth of its half thickness at once.
//!
//! Springs (O09 eq. 6-7, responsibilities r₁ + r₂ = 1): structural ones are replaced by lengths
//! from root to tip, which hold exactly after one pass, and in which a pushed node turns about the
//! one below. That one does not move towards it (r = 0): where blades are pressed from above it
//! would bow out backwards, and they fold up in ways that hang on the last bit. Bend springs join
//! every second node, rest at the wind pose's distance, and act once per sweep, before the rounds. A
//! node moves by r·2a·(‖l‖ − l₀) with a = κΔt/(1 + 2κΔt), which acts alike at any Δt, instead of
//! k·Δt, which does not. Springs act only on plants pushed in this sub-step: one that a resting body merely holds
//! stays as it is, so nothing trembles. WGSL twin: `shaders/relax.wgsl`.

mod bends;
mod bodies;
mod ground;

use crate::base::{Real, Vec3};
use crate::field::Nodes;
use crate::scene::method::{Collide, Springs};

use super::contact::{Laid, Moment, Touch};
use super::depth_cube::cover_m;
use super::fault::{Fault, Planted};
use super::springs::{LiteralBlade, relax_blade};
use bends::bend_springs;

pub use bends::SPRING_TRIES;
pub use bodies::{Bodies, LOOKS};
pub use ground::Ground;

/// A body whose surface makes less than 45° with the ground (this cosine) holds what it presses onto
/// it; a steeper one pushes it along. A wedge holds what rubs against both its sides with a friction
/// coefficient of at least the tangent of half its angle: 0.41 here.
pub const STICKS: f64 = 0.707;
/// A node this close to the ground lies on it, in metres: some roundings of its coordinates.
pub const ON_GROUND_M: f64 = 1e-6;

/// What the kernel needs besides the plant.
#[derive(Clone, Copy, Debug)]
pub struct RelaxSettings<R> {
    /// κΔt of the bend springs over a whole sub-step.
    pub bend: R,
    /// The printed springs, where the method asks for them.
    pub literal: Option<LiteralBlade<R>>,
    pub fewest_rounds: u32,
    pub most_rounds: u32,
    pub strain_limit: R,
    /// Rounds go on, up to the most, while one still moved a node out of a body.
    pub until_clear: bool,
    /// A point this deep in a part with its skin is in the part, in metres.
    pub cover_m: R,
    pub planted: Planted,
}

impl<R: Real> RelaxSettings<R> {
    pub fn new(solver: &crate::scene::Solver) -> Self {
        let rate_step = f64::from(solver.spring_rate_per_s) * solver.substep_s;
        Self {
            bend: R::of(rate_step),
            literal: (solver.method.springs == Springs::Literal)
                .then(|| LiteralBlade::new(rate_step, solver.segments as usize)),
            fewest_rounds: solver.rounds[0],
            most_rounds: solver.rounds[1],
            strain_limit: R::of_f32(solver.strain_limit),
            until_clear: solver.method.collide == Collide::Exact,
            cover_m: R::of_f32(cover_m(f64::from(solver.skin_m))),
            planted: Planted::default(),
        }
    }
}

/// A plant's surroundings.
#[derive(Clone, Copy, Debug)]
pub struct Place<'a, R> {
    pub ground: Ground<'a>,
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
        let moment = Moment {
            touches,
            share,
            cover_m: settings.cover_m,
        };
        let bodies = Bodies::at(moment, nodes[0], reach);
        if !push_out(nodes, faces, &bodies, place) {
            continue;
        }
        if let Some(literal) = &settings.literal {
            relax_blade(nodes, place.wind, literal);
            keep_above_ground(nodes, place);
            rounds_used = rounds_used.max(1);
            continue;
        }
        let rate = settings.bend / R::of(f64::from(sweeps));
        bend_springs(nodes, place, rate, settings.planted);
        for round in 1..=settings.most_rounds {
            let turned = lay_out(nodes, faces, &bodies, place);
            keep_above_ground(nodes, place);
            rounds_used = rounds_used.max(round);
            let strain = largest_strain(nodes, place.segments, place.length);
            let clear = !turned || !settings.until_clear;
            if round >= settings.fewest_rounds && strain <= settings.strain_limit && clear {
                break;
            }
        }
        if settings.planted.is(Fault::SpringsLast) {
            bend_springs(nodes, place, rate, settings.planted);
        }
    }
    rounds_used
}

/// Pushes every node out of every part, parts in their order, and those that are pressed onto the
/// ground straight down to it. Returns whether one was moved.
fn push_out<R: Real>(
    nodes: &mut Nodes<R>,
    faces: &mut [u32],
    bodies: &Bodies<R>,
    place: &Place<R>,
) -> bool {
    let mut pushed = false;
    for part in 0..bodies.len() {
        for (j, face) in faces.iter_mut().enumerate() {
            if let Some(pushed_to) = bodies.push(part, nodes[j + 1], face, &place.ground) {
                nodes[j + 1] = pushed_to.to;
                pushed = true;
            }
        }
    }
    pushed
}

/// Moves nodes onto the rest length of their segments, from root to tip. A segment that would dip
/// into the ground is laid on it at its full length (cutting it off there would shorten it), one
/// that would end in a body is turned out of it. Returns whether one was.
fn lay_out<R: Real>(
    nodes: &mut Nodes<R>,
    faces: &mut [u32],
    bodies: &Bodies<R>,
    place: &Place<R>,
) -> bool {
    let mut any_turned = false;
    for (j, face) in faces.iter_mut().enumerate() {
        let from = nodes[j];
        let rest = (place.wind[j + 1] - place.wind[j]).unit_or(Vec3::UP);
        let direction = (nodes[j + 1] - from).unit_or(rest);
        let end = from + direction * place.length;
        let next = place.ground.lay_on_ground(from, end, rest, place.length);
        let laid = Laid {
            from,
            length: place.length,
            before: nodes[j + 1],
        };
        let (next, turned) = bodies.turn_out(&laid, next, rest, face, &place.ground);
        nodes[j + 1] = place.ground.lay_on_ground(from, next, rest, place.length);
        any_turned |= turned;
    }
    any_turned
}

fn keep_above_ground<R: Real>(nodes: &mut Nodes<R>, place: &Place<R>) {
    for node in &mut nodes[1..=place.segments] {
        node.y = node.y.max(place.ground.below(*node).y);
    }
}

/// Largest relative change of a segment's length.
pub fn largest_strain<R: Real>(nodes: &Nodes<R>, segments: usize, length: R) -> R {
    (0..segments).fold(R::ZERO, |worst, j| {
        let strain = (nodes[j + 1] - nodes[j]).length() / length - R::ONE;
        worst.max(strain.abs())
    })
}

#[cfg(test)]
mod tests;
