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

use crate::base::{Pose, Real, Vec3, vec3};
use crate::field::grid::{GroundPlane, ground_plane_in_anchor};
use crate::field::{Anchor, Nodes};
use crate::scene::method::{Collide, Springs};
use crate::terrain::HeightGrid;

use super::contact::{Laid, Moment, Touch};
use super::depth_cube::cover_m;
use super::fault::{Fault, Planted};
use super::solid::Exit;
use super::springs::{LiteralBlade, relax_blade};
use bends::bend_springs;

pub use bends::SPRING_TRIES;

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

/// The bodies around a plant at one instant of a sub-step.
struct Bodies<'a, R> {
    moment: Moment<'a, R>,
    /// Touches that reach the plant, with their `anchor_from_part` of this instant.
    posed: Vec<(&'a Touch<'a, R>, Pose<R>)>,
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
        if !bodies.push_out(nodes, faces, place) {
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

impl<'a, R: Real> Bodies<'a, R> {
    fn at(moment: Moment<'a, R>, root: Vec3<R>, reach: R) -> Self {
        let near = (moment.touches.iter()).filter(|touch| touch.reaches(root, reach));
        Self {
            posed: near.map(|touch| (touch, moment.pose_of(touch))).collect(),
            moment,
        }
    }

    /// Pushes every node out of every part, parts in their order, and those that are pressed onto
    /// the ground straight down to it. Returns whether one was moved.
    fn push_out(&self, nodes: &mut Nodes<R>, faces: &mut [u32], place: &Place<R>) -> bool {
        let mut pushed = false;
        for (touch, pose) in &self.posed {
            for (j, face) in faces.iter_mut().enumerate() {
                let node = nodes[j + 1];
                let Some(exit) = touch.exit(&self.moment, pose, node, face, None) else {
                    continue;
                };
                let out = node + exit.normal * exit.depth;
                if !place.is_pressed(out, exit.normal) {
                    nodes[j + 1] = out;
                } else if place.is_on_ground(node) {
                    continue;
                } else {
                    nodes[j + 1] = place.below(node);
                }
                pushed = true;
            }
        }
        pushed
    }

    /// Turns a segment about its lower node until its upper one is out of every part, where its
    /// length allows that: both constraints hold after one step, which pushing and restoring
    /// lengths in turn reaches slowly where a blade meets a body head on. The way out of one part may
    /// lead into an earlier one, in the inner corner of a body above all: those are asked once more.
    fn turn_out(
        &self,
        laid: &Laid<R>,
        to: Vec3<R>,
        rest: Vec3<R>,
        face: &mut u32,
        place: &Place<R>,
    ) -> (Vec3<R>, bool) {
        let mut to = to;
        let mut turned_at = None;
        let parts = self.posed.len();
        for (step, (touch, pose)) in self.posed.iter().cycle().take(LOOKS * parts).enumerate() {
            if step >= parts && turned_at.is_none_or(|at| step - at >= parts) {
                break;
            }
            let Some(exit) = touch.exit(&self.moment, pose, to, face, Some(laid)) else {
                continue;
            };
            if let Some(out) = place.turned_out(laid.from, to, rest, &exit) {
                to = out;
                turned_at = Some(step);
            }
        }
        (to, turned_at.is_some())
    }
}

/// How often a segment that is laid out asks the parts, the later times only those that it has not
/// asked since one turned it. In a corner the ways out of two parts lead into each other a few times,
/// less far every time.
pub const LOOKS: usize = 4;

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
        let next = place.lay_on_ground(from, from + direction * place.length, rest);
        let laid = Laid {
            from,
            length: place.length,
            before: nodes[j + 1],
        };
        let (next, turned) = bodies.turn_out(&laid, next, rest, face, place);
        nodes[j + 1] = place.lay_on_ground(from, next, rest);
        any_turned |= turned;
    }
    any_turned
}

impl<R: Real> Place<'_, R> {
    /// The ground's plane under a node.
    fn plane_below(&self, node: Vec3<R>) -> GroundPlane<R> {
        ground_plane_in_anchor(self.ground, self.anchor, node.x, node.z)
    }

    /// The ground under a node.
    fn below(&self, node: Vec3<R>) -> Vec3<R> {
        vec3(node.x, self.plane_below(node).height, node.z)
    }

    /// True for a node that a body presses onto the ground: its way out leads below it, and into it
    /// rather than along. Such a node goes straight down and stays. Sliding along the body's
    /// normal as well would creep on in every round and sweep, until the node lies beside the
    /// place where body and ground overlap: the pose would tell their number.
    fn is_pressed(&self, out: Vec3<R>, normal: Vec3<R>) -> bool {
        let GroundPlane { height, slope } = self.plane_below(out);
        let steepness = R::ONE + slope[0] * slope[0] + slope[1] * slope[1];
        let into = slope[0] * normal.x + slope[1] * normal.z - normal.y;
        into > R::of(STICKS) * steepness.sqrt() && out.y < height
    }

    /// The upper node of a segment, turned about the lower one until it is at the end of a way out of
    /// a part, or of the way between the part and the ground; `None` where it is too short for both,
    /// or lies there already.
    fn turned_out(
        &self,
        from: Vec3<R>,
        to: Vec3<R>,
        rest: Vec3<R>,
        exit: &Exit<R>,
    ) -> Option<Vec3<R>> {
        let n = exit.normal;
        let along = (to - from).dot(n);
        let rise = along + exit.depth;
        let run = self.length * self.length - rise * rise;
        if run <= R::ZERO {
            // Too short for every way out, as where its lower node is held under the body: it stays on
            // the ground with that.
            let is_under = self.is_on_ground(from) && !self.is_on_ground(to);
            return is_under.then(|| self.turn_to(from, to, &self.plane_below(to), rest));
        }
        let sideways = (rest - n * rest.dot(n)).unit_or(n.across());
        let flat = ((to - from) - n * along).unit_or(sideways);
        let out = from + n * rise + flat * run.sqrt();
        if !self.is_pressed(out, n) {
            Some(out)
        } else if self.is_on_ground(to) {
            None
        } else {
            Some(self.turn_to(from, to, &self.plane_below(to), rest))
        }
    }

    fn is_on_ground(&self, node: Vec3<R>) -> bool {
        node.y - self.below(node).y <= R::of(ON_GROUND_M)
    }

    /// Turns a segment about its lower node until its upper one is on the ground, if it is below.
    fn lay_on_ground(&self, from: Vec3<R>, to: Vec3<R>, rest: Vec3<R>) -> Vec3<R> {
        let plane = self.plane_below(to);
        if to.y >= plane.height {
            return to;
        }
        self.turn_to(from, to, &plane, rest)
    }

    /// Turns a segment about its lower node, up or down, until its upper one is on the plane of the
    /// ground below it, as far as its length allows.
    fn turn_to(
        &self,
        from: Vec3<R>,
        to: Vec3<R>,
        plane: &GroundPlane<R>,
        rest: Vec3<R>,
    ) -> Vec3<R> {
        let sideways = vec3(rest.x, R::ZERO, rest.z).unit_or(vec3(R::ONE, R::ZERO, R::ZERO));
        let aside = vec3(to.x - from.x, R::ZERO, to.z - from.z);
        let flat = aside.unit_or(sideways);
        // Along `flat` the plane is `start + slope·run` above the lower node, and the upper one is
        // where run² + rise² is the square of the length.
        let slope = plane.slope[0] * flat.x + plane.slope[1] * flat.z;
        let square = R::ONE + slope * slope;
        let reach = self.length * square.sqrt();
        let start = plane.height - slope * aside.dot(flat) - from.y;
        let start = start.clamp(-reach, reach);
        let left = (reach * reach - start * start).max(R::ZERO).sqrt();
        let run = (left - start * slope) / square;
        from + flat * run + Vec3::UP * (start + slope * run)
    }
}

fn keep_above_ground<R: Real>(nodes: &mut Nodes<R>, place: &Place<R>) {
    for node in &mut nodes[1..=place.segments] {
        node.y = node.y.max(place.below(*node).y);
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
