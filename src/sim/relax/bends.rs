//! Bend springs of a blade, and the energy they would have once its lengths are back.

use crate::base::{Real, Vec3};
use crate::field::Nodes;
use crate::sim::fault::{Fault, Planted};
use crate::sim::springs;

use super::Place;

/// Springs of the blade's bends: all of them by 2a, or by half, a quarter or an eighth of it where more
/// would raise their energy ½Σ(‖l‖ − l₀)² once the lengths are back; not at all where that would too.
/// `rate` is κΔt.
pub(super) fn bend_springs<R: Real>(
    nodes: &mut Nodes<R>,
    place: &Place<R>,
    rate: R,
    planted: Planted,
) {
    let before = laid_energy(nodes, place, R::ZERO);
    let mut share = R::of(2.0) * rate / (R::ONE + R::of(2.0) * rate);
    for _ in 0..SPRING_TRIES {
        if planted.is(Fault::RootWeight) || laid_energy(nodes, place, share) <= before {
            pull_bends(nodes, place, share, planted);
            return;
        }
        share *= R::of(0.5);
    }
}

/// Shares of a spring step that are tried.
pub const SPRING_TRIES: u32 = 4;

/// What the bend spring from node j to node j + 2 moves its lower end by, and its upper one against.
fn bend_moves<R: Real>(
    j: usize,
    [lower, upper]: [Vec3<R>; 2],
    place: &Place<R>,
    share: R,
    is_root: bool,
) -> [Vec3<R>; 2] {
    let rest = (place.wind[j + 2] - place.wind[j]).length();
    let across = upper - lower;
    let correction = across.unit_or(Vec3::UP) * (share * (across.length() - rest));
    springs::shares([is_root, false]).map(|weight| correction * R::of(weight))
}

fn pull_bends<R: Real>(nodes: &mut Nodes<R>, place: &Place<R>, share: R, planted: Planted) {
    for j in 0..place.segments.saturating_sub(1) {
        let is_root = j == 0 && !planted.is(Fault::RootWeight);
        let [lower, upper] = bend_moves(j, [nodes[j], nodes[j + 2]], place, share, is_root);
        nodes[j] += lower;
        nodes[j + 2] -= upper;
    }
}

/// The bend springs' energy after they have been pulled by a share and the lengths were restored, in
/// m². Neither is done to the nodes: a spring changes its own ends alone, so that three nodes at a
/// time are enough.
fn laid_energy<R: Real>(nodes: &Nodes<R>, place: &Place<R>, share: R) -> R {
    let mut laid = Bends {
        place,
        last: [nodes[0]; 2],
        energy: R::ZERO,
    };
    let (mut lower, mut middle) = (nodes[0], nodes[1]);
    for j in 0..place.segments.saturating_sub(1) {
        let [down, up] = bend_moves(j, [lower, nodes[j + 2]], place, share, j == 0);
        laid.add(j, lower + down);
        (lower, middle) = (middle, nodes[j + 2] - up);
    }
    laid.add(place.segments - 1, lower);
    laid.add(place.segments, middle);
    laid.energy
}

/// A blade's nodes, laid out from the root one after the other.
struct Bends<'a, R> {
    place: &'a Place<'a, R>,
    /// The last node but one, and the last.
    last: [Vec3<R>; 2],
    energy: R,
}

impl<R: Real> Bends<'_, R> {
    fn add(&mut self, j: usize, node: Vec3<R>) {
        if j == 0 {
            return;
        }
        let (wind, [before, from]) = (self.place.wind, self.last);
        let rest = (wind[j] - wind[j - 1]).unit_or(Vec3::UP);
        let laid = from + (node - from).unit_or(rest) * self.place.length;
        if j >= 2 {
            let longer = (laid - before).length() - (wind[j] - wind[j - 2]).length();
            self.energy += longer * longer;
        }
        self.last = [from, laid];
    }
}
