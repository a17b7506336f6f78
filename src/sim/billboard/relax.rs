//! Relax: what touched billboards do within one sub-step.
//!
//! As for blades (see [`sim::relax`](crate::sim::relax)): push out, then rounds of springs and lengths
//! until no spring is strained by more than the limit, at least and at most as often as the solver
//! says; the ground wins over the body. A billboard is a row of blades that its springs tie together:
//! in each round O09's springs (structural and shear, here with bends) move all nodes, then every column
//! is laid out from the ground to its top, at its lengths, along the ground and around bodies. So a
//! round ends with columns of their lengths and with no node in a body, and what strain is left is that of rows
//! and diagonals. Pushing nodes out last instead leaves two to three times as much of it.
//!
//! A body that comes edge-on meets a surface that cannot be shortened and has no reason to yield to
//! either side: it would crumple, strained by 80% and more. So a node that is pushed goes aside as well,
//! to the side of the quad that it is pushed to anyway, by [`PUSH_ASIDE`] of the way.
//!
//! Deviations from O09: lengths of columns are exact; the sub-step has sweeps, twice as many as blades
//! take, since a surface bends less readily than a line, and more rounds in them; an energy guard (see [`springs`]).

use crate::base::{Real, Vec3};
use crate::scene::Solver;
use crate::scene::method::{Collide, Springs};
use crate::sim::contact::Laid;
use crate::sim::depth_cube::cover_m;
use crate::sim::springs::{BILLBOARD_PASSES, step};

use super::batch::Batch;
use super::grid::Side;
use super::springs::{self, Measured, POINT_M2, Pull};

/// Rate κ of structural and shear springs, in 1/s: in a sub-step of 1/120 s they lose 94% of their
/// extension one by one.
pub const RATE_PER_S: f64 = 1000.0;
/// Rate of bend springs, in 1/s: they smooth a fold over some sub-steps and yield to a body at once.
pub const BEND_RATE_PER_S: f64 = 60.0;
/// Passes over the springs in a round.
pub const PASSES: u32 = BILLBOARD_PASSES;
/// Most rounds for each one that a blade may take: a surface has more springs that hinder each other.
/// With as many as a blade takes, folds begin that later rounds do not undo: the most strained of ten
/// billboards around a ball and a box has 6 to 30% then, instead of 2% as in the reference.
pub const ROUNDS: u32 = 3;
/// Strain at which rounds end, over that of blades.
pub const STRAIN: f64 = 0.5;
/// Sweeps of a billboard for each one that a blade takes.
pub const FINENESS: u32 = 2;
/// How far a pushed node goes aside, over the way that it is pushed.
pub const PUSH_ASIDE: f64 = 0.3;

/// What the kernel needs besides the billboards.
#[derive(Clone, Copy, Debug)]
pub struct Settings<R> {
    /// κΔt over a whole sub-step, of structural and shear springs and of bend springs.
    pub rate_step: f64,
    pub bend_step: f64,
    pub passes: u32,
    pub fewest_rounds: u32,
    pub most_rounds: u32,
    pub strain_limit: R,
    /// Rounds go on, up to the most, while one still moved a node out of a body.
    pub until_clear: bool,
    /// The printed formulas: passes from the same nodes, once after the push.
    pub literal: bool,
    /// A point this deep in a part with its skin is in the part, in metres.
    pub cover_m: R,
}

impl<R: Real> Settings<R> {
    pub fn new(solver: &Solver) -> Self {
        Self {
            rate_step: RATE_PER_S * solver.substep_s,
            bend_step: BEND_RATE_PER_S * solver.substep_s,
            passes: PASSES,
            fewest_rounds: solver.rounds[0],
            most_rounds: solver.rounds[1] * ROUNDS,
            strain_limit: R::of_f32(solver.strain_limit) * R::of(STRAIN),
            until_clear: solver.method.collide == Collide::Exact,
            literal: solver.method.springs == Springs::Literal,
            cover_m: R::of_f32(cover_m(f64::from(solver.skin_m))),
        }
    }

    /// 2a of one of so many sweeps.
    pub fn pull(&self, sweeps: u32) -> Pull<R> {
        let twice_a = |rate_step: f64| 2.0 * step::rational(rate_step / f64::from(sweeps));
        Pull {
            shape: R::of(twice_a(self.rate_step)),
            bend: R::of(twice_a(self.bend_step)),
        }
    }
}

/// What a sub-step did to a billboard.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome<R> {
    /// Most rounds a sweep took; 0 if nothing touched it.
    pub rounds: u32,
    /// Largest strain at the end of the last sweep that touched it.
    pub strain: R,
    /// Nodes put back because an edge was crumpled or a row inverted.
    pub reset: u32,
    /// Rounds whose passes would have raised the energy and were replaced.
    pub replaced: u32,
    /// The step of the printed springs was above their stable bound, which was taken.
    pub clamped: bool,
}

/// Runs one sub-step of `sweeps` sweeps for the billboards of a batch.
pub fn respond<R: Real, const L: usize>(
    batch: &mut Batch<R, L>,
    sweeps: u32,
    settings: &Settings<R>,
) -> [Outcome<R>; L] {
    let mut outcomes = [Outcome::default(); L];
    for sweep in 1..=sweeps {
        let share = R::of(f64::from(sweep)) / R::of(f64::from(sweeps));
        let mut pushed = [false; L];
        for l in 0..batch.lanes.len() {
            batch.lanes[l].bodies.set_share(share);
            pushed[l] = push_out(batch, l);
        }
        if !pushed.contains(&true) {
            continue;
        }
        if settings.literal {
            relax_literally(batch, &pushed, sweeps, settings, &mut outcomes);
        } else {
            relax(
                batch,
                &pushed,
                settings,
                settings.pull(sweeps),
                &mut outcomes,
            );
        }
    }
    outcomes
}

/// Pushes every node of a billboard out of every part, parts in their order, and a little aside; those
/// that are pressed onto the ground go straight down to it. Returns whether one was moved.
fn push_out<R: Real, const L: usize>(batch: &mut Batch<R, L>, l: usize) -> bool {
    let columns = batch.weave.grid.columns;
    let lane = &batch.lanes[l];
    let facing = lane.quad.normal();
    let mut any = false;
    for part in 0..lane.bodies.len() {
        for (n, faces) in batch.faces.iter_mut().enumerate() {
            let node = batch.nodes.get(columns + n, l);
            if !lane.bodies.may_hold(node) {
                continue;
            }
            let Some(pushed) = lane.bodies.push(part, node, &mut faces[l], &lane.ground) else {
                continue;
            };
            let mut to = pushed.to;
            if let Some(normal) = pushed.normal {
                let aside = facing * (pushed.depth * R::of(PUSH_ASIDE));
                to = if facing.dot(normal) < R::ZERO {
                    to - aside
                } else {
                    to + aside
                };
            }
            batch.nodes.set(columns + n, l, to);
            any = true;
        }
    }
    any
}

/// Rounds of springs and lengths, each billboard for as long as it needs.
fn relax<R: Real, const L: usize>(
    batch: &mut Batch<R, L>,
    pushed: &[bool; L],
    settings: &Settings<R>,
    pull: Pull<R>,
    outcomes: &mut [Outcome<R>; L],
) {
    let reset = batch.put_in_order(pushed);
    for (outcome, reset) in outcomes.iter_mut().zip(reset) {
        outcome.reset += reset;
    }
    let mut active = *pushed;
    // Those that are done while others go on, and are put aside meanwhile.
    let mut aside = [false; L];
    for l in (0..batch.lanes.len()).filter(|&l| !active[l]) {
        batch.kept.copy_lane(l, &batch.nodes);
        aside[l] = true;
    }
    let mut measured = springs::measure(batch.weave, &batch.rest, pull, &batch.nodes);
    for round in 1..=settings.most_rounds {
        let [start, spare] = &mut batch.spare;
        let grew = springs::relax(
            batch.weave,
            &batch.rest,
            pull,
            settings.passes,
            &measured.energy,
            &mut batch.nodes,
            [start, spare],
        );
        let turned = lay_out(batch, &active);
        measured = springs::measure(batch.weave, &batch.rest, pull, &batch.nodes);
        let is_last = round == settings.most_rounds;
        for l in 0..batch.lanes.len() {
            if !active[l] {
                continue;
            }
            let outcome = &mut outcomes[l];
            outcome.replaced += u32::from(grew[l]);
            outcome.rounds = outcome.rounds.max(round);
            outcome.strain = measured.strain[l];
            let clear = !turned[l] || !settings.until_clear;
            let done = measured.strain[l] <= settings.strain_limit && clear;
            active[l] = !(is_last || done && round >= settings.fewest_rounds);
        }
        if !active.contains(&true) {
            break;
        }
        for l in (0..batch.lanes.len()).filter(|&l| !active[l]) {
            if !std::mem::replace(&mut aside[l], true) {
                batch.kept.copy_lane(l, &batch.nodes);
            }
        }
    }
    for l in (0..L).filter(|&l| aside[l]) {
        batch.nodes.copy_lane(l, &batch.kept);
    }
}

/// The printed springs (O09 eq. 6-7) after the push, once, behind the bound that keeps them stable.
fn relax_literally<R: Real, const L: usize>(
    batch: &mut Batch<R, L>,
    pushed: &[bool; L],
    sweeps: u32,
    settings: &Settings<R>,
    outcomes: &mut [Outcome<R>; L],
) {
    let reset = batch.put_in_order(pushed);
    let rate_step = settings.rate_step / f64::from(sweeps);
    let bounded = step::literal(rate_step, batch.weave.largest_eigenvalue);
    batch.kept.copy_all(&batch.nodes);
    let twice_a = R::of(2.0 * bounded.step);
    for _ in 0..settings.passes {
        let (nodes, moves) = (&mut batch.kept, &mut batch.spare[0]);
        springs::literal_pass(batch.weave, &batch.rest, twice_a, nodes, moves);
    }
    let Measured { strain, .. } =
        springs::measure(batch.weave, &batch.rest, settings.pull(sweeps), &batch.kept);
    for l in (0..batch.lanes.len()).filter(|&l| pushed[l]) {
        batch.nodes.copy_lane(l, &batch.kept);
        for node in batch.weave.grid.columns..batch.nodes.len() {
            let place = batch.nodes.get(node, l);
            batch.nodes.set(node, l, batch.lanes[l].above_ground(place));
        }
        let outcome = &mut outcomes[l];
        outcome.reset += reset[l];
        outcome.rounds = outcome.rounds.max(1);
        outcome.strain = strain[l];
        outcome.clamped |= bounded.clamped;
    }
}

/// Moves the nodes of every column onto the rest length of their segments, from the ground to the top. A
/// segment that would dip into the ground is laid on it at its full length, one that would end in a
/// body is turned out of it. Returns which billboards had one of those.
fn lay_out<R: Real, const L: usize>(batch: &mut Batch<R, L>, active: &[bool; L]) -> [bool; L] {
    let columns = batch.weave.grid.columns;
    let mut turned = [false; L];
    for node in columns..batch.nodes.len() {
        let before = [
            batch.nodes.x[node],
            batch.nodes.y[node],
            batch.nodes.z[node],
        ];
        lay_segment(batch, node);
        for l in (0..batch.lanes.len()).filter(|&l| active[l]) {
            let lane = &batch.lanes[l];
            let place = batch.nodes.get(node, l);
            let near_ground = place.y < lane.ground_top_m;
            if !near_ground && !lane.bodies.may_hold(place) {
                continue;
            }
            let laid = Laid {
                from: batch.nodes.get(node - columns, l),
                length: batch.rest.length[Side::Column as usize][l],
                before: Vec3::new(before[0][l], before[1][l], before[2][l]),
            };
            let rest = lane.quad.lean;
            let place = lane.on_ground(&laid, place, rest);
            let face = &mut batch.faces[node - columns][l];
            let (place, was_turned) = lane.bodies.turn_out(&laid, place, rest, face, &lane.ground);
            turned[l] |= was_turned;
            batch.nodes.set(node, l, lane.on_ground(&laid, place, rest));
        }
    }
    turned
}

/// Moves a node onto the rest length from the one below it, keeping the direction.
fn lay_segment<R: Real, const L: usize>(batch: &mut Batch<R, L>, node: usize) {
    let below = node - batch.weave.grid.columns;
    let nodes = &mut batch.nodes;
    let (fx, fy, fz) = (nodes.x[below], nodes.y[below], nodes.z[below]);
    let (tx, ty, tz) = (&mut nodes.x[node], &mut nodes.y[node], &mut nodes.z[node]);
    let length = &batch.rest.length[Side::Column as usize];
    let mut square = [R::ZERO; L];
    for l in 0..L {
        let (x, y, z) = (tx[l] - fx[l], ty[l] - fy[l], tz[l] - fz[l]);
        square[l] = x * x + y * y + z * z;
        let scale = length[l] / square[l].sqrt();
        tx[l] = fx[l] + x * scale;
        ty[l] = fy[l] + y * scale;
        tz[l] = fz[l] + z * scale;
    }
    // Where two nodes are at one place, or too far apart to measure, the column leans as at rest.
    for l in 0..batch.lanes.len() {
        let has_direction = square[l] > R::of(POINT_M2) && square[l].is_finite();
        if !has_direction {
            let from = Vec3::new(fx[l], fy[l], fz[l]);
            nodes.set(node, l, from + batch.lanes[l].quad.lean * length[l]);
        }
    }
}

impl<R: Real> super::batch::Lane<'_, R> {
    /// The upper node of a segment, laid on the ground where it is below.
    fn on_ground(&self, laid: &Laid<R>, place: Vec3<R>, rest: Vec3<R>) -> Vec3<R> {
        if place.y >= self.ground_top_m {
            return place;
        }
        (self.ground).lay_on_ground(laid.from, place, rest, laid.length)
    }

    fn above_ground(&self, place: Vec3<R>) -> Vec3<R> {
        if place.y >= self.ground_top_m {
            return place;
        }
        let ground = self.ground.below(place);
        Vec3::new(place.x, place.y.max(ground.y), place.z)
    }
}
