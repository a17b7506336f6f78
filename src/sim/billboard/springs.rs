//! O09 eq. 6-7 over lanes of billboards.
//!
//! The formulas, steps and shares are those of [`sim::springs`](crate::sim::springs): sequential sweeps
//! with a = κΔt/(1 + 2κΔt) by default, behind a guard that keeps the energy from growing, or the
//! printed form (Jacobi) behind its stable bound. Two nodes at one place have no direction; a spring
//! between them waits for the others.

use crate::base::Real;

use super::Weave;
use super::grid::{SIDES, Thread};
use super::lanes::Lanes;

/// Ends of a spring are at one place where the square of its length is less, in square metres.
pub const POINT_M2: f64 = 1e-24;

/// Rest lengths of `L` billboards.
#[derive(Clone, Debug)]
pub struct Rest<R, const L: usize> {
    /// By [`Side`](super::grid::Side), in metres.
    pub length: [[R; L]; SIDES],
    /// Their inverse; 0 for a side of no length, which is never strained.
    pub inverse: [[R; L]; SIDES],
}

impl<R: Real, const L: usize> Default for Rest<R, L> {
    fn default() -> Self {
        Self {
            length: [[R::ZERO; L]; SIDES],
            inverse: [[R::ZERO; L]; SIDES],
        }
    }
}

impl<R: Real, const L: usize> Rest<R, L> {
    pub fn set(&mut self, side: usize, lane: usize, length: R) {
        let inverse = R::ONE / length;
        self.length[side][lane] = length;
        self.inverse[side][lane] = if length > R::ZERO && inverse.is_finite() {
            inverse
        } else {
            R::ZERO
        };
    }
}

/// 2a of the springs of O09, and of the bend springs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull<R> {
    pub shape: R,
    pub bend: R,
}

impl<R: Real> Pull<R> {
    fn of(&self, spring: &Thread) -> R {
        if spring.side.is_bend() {
            self.bend
        } else {
            self.shape
        }
    }

    /// Weight of a spring in the energy: that of a bend is as much smaller as its pull.
    fn weight(&self, spring: &Thread) -> R {
        if spring.side.is_bend() && self.bend < self.shape {
            self.bend / self.shape
        } else {
            R::ONE
        }
    }
}

/// How far billboards are from rest.
#[derive(Clone, Copy, Debug)]
pub struct Measured<R, const L: usize> {
    /// ½Σw(‖l‖ − l₀)², in m²; w is 1 for the springs of O09.
    pub energy: [R; L],
    /// Largest relative change of a spring's length but of a bend's.
    pub strain: [R; L],
}

pub fn measure<R: Real, const L: usize>(
    weave: &Weave,
    rest: &Rest<R, L>,
    pull: Pull<R>,
    nodes: &Lanes<R, L>,
) -> Measured<R, L> {
    let mut twice_energy = [R::ZERO; L];
    let mut strain = [R::ZERO; L];
    for spring in &weave.springs {
        let [a, b] = spring.ends;
        let (ax, ay, az) = (&nodes.x[a], &nodes.y[a], &nodes.z[a]);
        let (bx, by, bz) = (&nodes.x[b], &nodes.y[b], &nodes.z[b]);
        let length = &rest.length[spring.side as usize];
        let inverse = &rest.inverse[spring.side as usize];
        let counts = if spring.side.is_bend() {
            R::ZERO
        } else {
            R::ONE
        };
        let weight = pull.weight(spring);
        for l in 0..L {
            let (x, y, z) = (ax[l] - bx[l], ay[l] - by[l], az[l] - bz[l]);
            let longer = (x * x + y * y + z * z).sqrt() - length[l];
            twice_energy[l] += longer * longer * weight;
            strain[l] = R::max(strain[l], longer.abs() * inverse[l] * counts);
        }
    }
    Measured {
        energy: twice_energy.map(|twice| twice * R::of(0.5)),
        strain,
    }
}

/// One sequential pass: spring after spring, each seeing what those before it did.
pub fn pass<R: Real, const L: usize>(
    weave: &Weave,
    rest: &Rest<R, L>,
    pull: Pull<R>,
    nodes: &mut Lanes<R, L>,
) {
    let point = R::of(POINT_M2);
    for spring in &weave.springs {
        let [a, b] = spring.ends;
        let length = &rest.length[spring.side as usize];
        let twice_a = pull.of(spring);
        let [from_a, from_b] = spring.shares.map(|share| twice_a * R::of(share));
        let (mut ax, mut ay, mut az) = (nodes.x[a], nodes.y[a], nodes.z[a]);
        let (mut bx, mut by, mut bz) = (nodes.x[b], nodes.y[b], nodes.z[b]);
        for l in 0..L {
            let (x, y, z) = (ax[l] - bx[l], ay[l] - by[l], az[l] - bz[l]);
            let square = x * x + y * y + z * z;
            let longer = R::ONE - length[l] / square.sqrt();
            let longer = if square > point { longer } else { R::ZERO };
            let (a_by, b_by) = (longer * from_a, longer * from_b);
            ax[l] -= x * a_by;
            ay[l] -= y * a_by;
            az[l] -= z * a_by;
            bx[l] += x * b_by;
            by[l] += y * b_by;
            bz[l] += z * b_by;
        }
        // The later end is never pinned.
        if spring.shares[0] > 0.0 {
            (nodes.x[a], nodes.y[a], nodes.z[a]) = (ax, ay, az);
        }
        (nodes.x[b], nodes.y[b], nodes.z[b]) = (bx, by, bz);
    }
}

/// One printed pass: all springs from the same nodes, all moves added up. `moves` is room for as many
/// nodes.
pub fn literal_pass<R: Real, const L: usize>(
    weave: &Weave,
    rest: &Rest<R, L>,
    twice_a: R,
    nodes: &mut Lanes<R, L>,
    moves: &mut Lanes<R, L>,
) {
    for axis in [&mut moves.x, &mut moves.y, &mut moves.z] {
        axis.fill([R::ZERO; L]);
    }
    let point = R::of(POINT_M2);
    for spring in &weave.springs {
        let [a, b] = spring.ends;
        let length = &rest.length[spring.side as usize];
        let [from_a, from_b] = spring.shares.map(|share| twice_a * R::of(share));
        for l in 0..L {
            let x = nodes.x[a][l] - nodes.x[b][l];
            let y = nodes.y[a][l] - nodes.y[b][l];
            let z = nodes.z[a][l] - nodes.z[b][l];
            let square = x * x + y * y + z * z;
            let longer = R::ONE - length[l] / square.sqrt();
            let longer = if square > point { longer } else { R::ZERO };
            let (a_by, b_by) = (longer * from_a, longer * from_b);
            moves.x[a][l] += -(x * a_by);
            moves.y[a][l] += -(y * a_by);
            moves.z[a][l] += -(z * a_by);
            moves.x[b][l] += x * b_by;
            moves.y[b][l] += y * b_by;
            moves.z[b][l] += z * b_by;
        }
    }
    for node in weave.grid.columns..nodes.len() {
        for l in 0..L {
            nodes.x[node][l] += moves.x[node][l];
            nodes.y[node][l] += moves.y[node][l];
            nodes.z[node][l] += moves.z[node][l];
        }
    }
}

/// One descending pass: each movable node in turn moves against the gradient of its springs, by a share
/// over their number, which cannot raise the energy (see
/// [`sequential`](crate::sim::springs::sequential)).
fn descend<R: Real, const L: usize>(
    weave: &Weave,
    rest: &Rest<R, L>,
    pull: Pull<R>,
    nodes: &mut Lanes<R, L>,
) {
    let point = R::of(POINT_M2);
    for (node, springs) in weave.of_node.iter().enumerate().skip(weave.grid.columns) {
        let mut down = [[R::ZERO; L]; 3];
        for &s in springs {
            let spring = &weave.springs[s];
            let other = spring.ends[usize::from(spring.ends[0] == node)];
            let length = &rest.length[spring.side as usize];
            let weight = pull.weight(spring);
            for l in 0..L {
                let x = nodes.x[node][l] - nodes.x[other][l];
                let y = nodes.y[node][l] - nodes.y[other][l];
                let z = nodes.z[node][l] - nodes.z[other][l];
                let square = x * x + y * y + z * z;
                let longer = R::ONE - length[l] / square.sqrt();
                let longer = if square > point {
                    longer * weight
                } else {
                    R::ZERO
                };
                down[0][l] += x * longer;
                down[1][l] += y * longer;
                down[2][l] += z * longer;
            }
        }
        let by = pull.shape / R::of(springs.len() as f64);
        for l in 0..L {
            nodes.x[node][l] += -(down[0][l] * by);
            nodes.y[node][l] += -(down[1][l] * by);
            nodes.z[node][l] += -(down[2][l] * by);
        }
    }
}

/// `passes` sequential passes, of which the energy does not grow: where it would, as many descending
/// ones instead, or none. `before` holds the energies of `nodes`. Returns which billboards took the
/// other way. `start` and `spare` are room for as many nodes.
pub fn relax<R: Real, const L: usize>(
    weave: &Weave,
    rest: &Rest<R, L>,
    pull: Pull<R>,
    passes: u32,
    before: &[R; L],
    nodes: &mut Lanes<R, L>,
    [start, spare]: [&mut Lanes<R, L>; 2],
) -> [bool; L] {
    start.copy_all(nodes);
    for _ in 0..passes {
        pass(weave, rest, pull, nodes);
    }
    let after = measure(weave, rest, pull, nodes).energy;
    let mut grew = [false; L];
    for l in 0..L {
        let fell = after[l] <= before[l];
        grew[l] = !fell;
    }
    if !grew.contains(&true) {
        return grew;
    }
    spare.copy_all(start);
    for _ in 0..passes {
        descend(weave, rest, pull, spare);
    }
    let descended = measure(weave, rest, pull, spare).energy;
    for l in (0..L).filter(|&l| grew[l]) {
        let fell = descended[l] <= before[l];
        nodes.copy_lane(l, if fell { spare } else { start });
    }
    grew
}
