//! The static shape of one blade: P15 eq. 12.
//!
//! N equal segments hang on one another by springs. With θ_j the angle of segment j from the
//! vertical, φ_j = θ_j − θ_{j−1} the opening of the hinge at its base, θ_0 the lean of the root and
//! k′ = k/(m g l), the torques balance where
//!
//! ```text
//! k′_j φ_j − k′_{j+1} φ_{j+1} = (N − j + ½) sin θ_j,   j = 1 … N,   k′_{N+1} = 0
//! E = ½ Σ k′_j φ_j² + Σ (N − j + ½) cos θ_j
//! ```
//!
//! This is eq. 12 differenced, with the sum over i put inside the sum over n (as printed, it does
//! not give eq. 11 for N = 3). k′_1 is k′ as in the paper, or 2k′, which agrees with a continuous
//! beam at second order; all other k′_j are k′.
//!
//! Upright solves the equations always, and a soft blade has many other equilibria. The one a
//! blade takes is the one with all angles in (0, π). On that range the left minus the right side
//! is convex in every angle, so that undamped Newton from θ ≡ π falls onto it without overshoot,
//! and onto upright where nothing else is left (above the critical stiffness, without lean).
//!
//! Limits: the search runs in `f64` whatever the result's float is. In `f32` the rounding of the
//! torques alone would move a blade of 64 segments by 1e-4 of its length where k′ is within 0.1% of
//! the critical value. The result is rounded once; `residual` is that of the rounded angles.

pub mod descent;

use std::f64::consts::PI;

use thiserror::Error;

use crate::base::{Real, most};
use crate::scene::Root;

/// Most segments of a blade.
pub const MAX_SEGMENTS: u32 = 64;

/// Smallest and largest k′ that are accepted.
pub const STIFFNESS_RANGE: [f64; 2] = [1e-9, 1e9];

/// A Newton step below this, in radians, ends the search: the next one would be its square.
const SETTLED_RAD: f64 = 1e-13;

/// Relative residual at which only rounding is left, so that a step which no longer shrinks says
/// nothing.
const ROUNDING_RESIDUAL: f64 = 1e-14;

/// Steps shrink by a third only at the critical stiffness itself, where rounding ends the search
/// after some 40 of them; elsewhere it takes 2 to 20.
const MAX_ITERATIONS: u32 = 200;

/// A blade at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct BladeShape<R> {
    /// θ_1 … θ_N from the vertical, in radians, from root to tip; in 0…π, never falling.
    pub angles_rad: Vec<R>,
    /// N + 1 points [x, y] in units of the blade's length, root first; y is up.
    pub nodes: Vec<[R; 2]>,
    /// Potential energy in units of m g l, zero with every segment level and every spring relaxed.
    pub energy: R,
    /// Newton steps taken.
    pub iterations: u32,
    /// Largest torque left at a hinge, relative to k′π + N²/2.
    pub residual: R,
}

/// Why a blade has no shape.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ShapeError {
    #[error("a blade of {0} segments: give 1 to {MAX_SEGMENTS} segments")]
    Segments(u32),
    #[error(
        "stiffness {0}: k′ must be a number from {low:e} to {high:e}",
        low = STIFFNESS_RANGE[0],
        high = STIFFNESS_RANGE[1]
    )]
    Stiffness(f64),
    #[error("a lean of {0} rad: the root may lean 0 to π (180°) from the vertical")]
    Lean(f64),
    #[error(
        "no shape found for {segments} segments, k′ = {k_prime}, lean {lean_rad} rad in \
         {MAX_ITERATIONS} steps: choose another stiffness"
    )]
    NotSettled {
        segments: u32,
        k_prime: f64,
        lean_rad: f64,
    },
}

/// Finds the shape of a blade whose root hinge rests at `lean_rad`.
///
/// # Errors
///
/// `segments` outside 1…[`MAX_SEGMENTS`], `k_prime` outside [`STIFFNESS_RANGE`], `lean_rad` outside
/// 0…π, or one of them not a number.
pub fn solve<R: Real>(
    segments: u32,
    k_prime: R,
    root: Root,
    lean_rad: R,
) -> Result<BladeShape<R>, ShapeError> {
    let chain = Chain::new(segments, k_prime.to_f64(), root, lean_rad.to_f64())?;
    let (openings, iterations) = chain.settle()?;
    let angles = chain.angles(&openings);
    let angles_rad: Vec<R> = angles.iter().map(|&a| round_angle(a)).collect();
    let rounded: Vec<f64> = angles_rad.iter().map(|a| a.to_f64()).collect();
    Ok(BladeShape {
        nodes: nodes(&angles),
        energy: R::of(chain.energy(&openings, &angles)),
        iterations,
        residual: R::of(chain.relative(&chain.torques(&chain.openings(&rounded), &rounded))),
        angles_rad,
    })
}

/// What every search of a shape asks of its numbers.
fn check(segments: u32, k_prime: f64, lean_rad: f64) -> Result<(), ShapeError> {
    if !(1..=MAX_SEGMENTS).contains(&segments) {
        return Err(ShapeError::Segments(segments));
    }
    if !(STIFFNESS_RANGE[0]..=STIFFNESS_RANGE[1]).contains(&k_prime) {
        return Err(ShapeError::Stiffness(k_prime));
    }
    // π as an `f32` lies above π; it means the same lean.
    if !(0.0..=f64::from(std::f32::consts::PI)).contains(&lean_rad) {
        return Err(ShapeError::Lean(lean_rad));
    }
    Ok(())
}

/// The k′ above which a blade without lean stands upright.
///
/// # Errors
///
/// `segments` outside 1…[`MAX_SEGMENTS`].
pub fn critical_stiffness(segments: u32, root: Root) -> Result<f64, ShapeError> {
    let chain = Chain::new(segments, 1.0, root, 0.0)?;
    // Upright turns unstable where k′S − W is singular: S the springs with k′ = 1, W the weights.
    // The largest eigenvalue of S⁻¹W by power iteration; the next is less than a third of it.
    let mut shape = vec![1.0; chain.weights.len()];
    let mut critical = 0.0;
    for _ in 0..64 {
        let mut torque: Vec<f64> = shape
            .iter()
            .zip(&chain.weights)
            .map(|(s, w)| s * w)
            .collect();
        // S⁻¹: the torques of all segments above a hinge open it, the hinges below turn a segment.
        for j in (1..torque.len()).rev() {
            torque[j - 1] += torque[j];
        }
        let mut angle = 0.0;
        for (t, k) in torque.iter_mut().zip(&chain.springs) {
            angle += *t / k;
            *t = angle;
        }
        critical = angle;
        shape = torque.iter().map(|t| t / angle).collect();
    }
    Ok(critical)
}

/// k′ for `segments` segments of the material that has `k_prime` for eight: k′ grows with N³,
/// because the segments get both lighter and shorter and the springs stiffer.
pub fn stiffness_for_segments(k_prime: f64, segments: u32) -> f64 {
    let ratio = f64::from(segments) / 8.0;
    k_prime * ratio * ratio * ratio
}

/// Rounds towards 0 where rounding to nearest would leave 0…π: π itself rounds up in `f32`.
fn round_angle<R: Real>(angle: f64) -> R {
    let nearest = R::of(angle);
    if nearest.to_f64() > PI {
        R::of(PI - f64::from(f32::EPSILON))
    } else {
        nearest
    }
}

fn nodes<R: Real>(angles: &[f64]) -> Vec<[R; 2]> {
    let length = 1.0 / angles.len() as f64;
    let mut at = [0.0, 0.0];
    let mut nodes = vec![[R::ZERO; 2]];
    for &a in angles {
        at[0] += libm::sin(a) * length;
        at[1] += libm::cos(a) * length;
        nodes.push([R::of(at[0]), R::of(at[1])]);
    }
    nodes
}

/// The springs and weights of one blade.
struct Chain {
    /// k′_j of the hinge below segment j.
    springs: Vec<f64>,
    /// N − j + ½: segment j carries all above it and half of itself.
    weights: Vec<f64>,
    lean_rad: f64,
    /// k′π + N²/2, the size of the torques.
    scale: f64,
}

impl Chain {
    fn new(segments: u32, k_prime: f64, root: Root, lean_rad: f64) -> Result<Self, ShapeError> {
        check(segments, k_prime, lean_rad)?;
        let n = f64::from(segments);
        let root_factor = match root {
            Root::Double => 2.0,
            Root::Paper => 1.0,
        };
        let mut springs = vec![k_prime; segments as usize];
        springs[0] *= root_factor;
        Ok(Self {
            springs,
            weights: (1..=segments).map(|j| n - f64::from(j) + 0.5).collect(),
            lean_rad: lean_rad.min(PI),
            scale: k_prime * PI + n * n / 2.0,
        })
    }

    /// Newton from θ ≡ π. Returns the hinges' openings φ and the number of steps.
    ///
    /// The openings are the unknowns that are kept, because the torques are their differences:
    /// taken from rounded angles these would lose N times as much.
    fn settle(&self) -> Result<(Vec<f64>, u32), ShapeError> {
        let mut openings = vec![0.0; self.weights.len()];
        openings[0] = PI - self.lean_rad;
        let mut last_step = f64::INFINITY;
        for iteration in 1..=MAX_ITERATIONS {
            let angles = self.angles(&openings);
            let torques = self.torques(&openings, &angles);
            let turns = self.newton_turns(&angles, &torques);
            let step = turns.iter().fold(0.0, |m: f64, t| most(m, t.abs()));
            let only_rounding = step >= last_step && self.relative(&torques) < ROUNDING_RESIDUAL;
            if only_rounding {
                return Ok((openings, iteration - 1));
            }
            let mut below = 0.0;
            for (opening, turn) in openings.iter_mut().zip(&turns) {
                *opening += turn - below;
                below = *turn;
            }
            if step < SETTLED_RAD {
                // All torques act one way, so every hinge opens that way; rounding may disagree.
                openings.iter_mut().for_each(|o| *o = o.max(0.0));
                return Ok((openings, iteration));
            }
            last_step = step;
        }
        Err(ShapeError::NotSettled {
            segments: self.weights.len() as u32,
            k_prime: self.springs[self.springs.len() - 1],
            lean_rad: self.lean_rad,
        })
    }

    /// Solves J·turns = −torques, J the tridiagonal derivative of the torques by the angles.
    /// No pivoting: J is symmetric and, above the wanted root, positive definite.
    fn newton_turns(&self, angles: &[f64], torques: &[f64]) -> Vec<f64> {
        let n = angles.len();
        let mut turns = vec![0.0; n];
        let mut upper = vec![0.0; n];
        for j in 0..n {
            let above = self.spring_above(j);
            let mut pivot = self.springs[j] + above - self.weights[j] * libm::cos(angles[j]);
            let mut right = -torques[j];
            if j > 0 {
                pivot += self.springs[j] * upper[j - 1];
                right += self.springs[j] * turns[j - 1];
            }
            upper[j] = -above / pivot;
            turns[j] = right / pivot;
        }
        for j in (1..n).rev() {
            turns[j - 1] -= upper[j - 1] * turns[j];
        }
        turns
    }

    /// The spring of the hinge above segment `j` (from 0); none above the last.
    fn spring_above(&self, j: usize) -> f64 {
        self.springs.get(j + 1).copied().unwrap_or(0.0)
    }

    /// k′_j φ_j − k′_{j+1} φ_{j+1} − (N − j + ½) sin θ_j.
    fn torques(&self, openings: &[f64], angles: &[f64]) -> Vec<f64> {
        (0..angles.len())
            .map(|j| {
                let above = openings
                    .get(j + 1)
                    .map_or(0.0, |o| o * self.spring_above(j));
                self.springs[j] * openings[j] - above - self.weights[j] * libm::sin(angles[j])
            })
            .collect()
    }

    fn angles(&self, openings: &[f64]) -> Vec<f64> {
        let mut angle = self.lean_rad;
        let turn = |opening: &f64| {
            angle = (angle + opening).min(PI);
            angle
        };
        openings.iter().map(turn).collect()
    }

    fn openings(&self, angles: &[f64]) -> Vec<f64> {
        let mut below = self.lean_rad;
        let open = |&angle: &f64| {
            let opening = angle - below;
            below = angle;
            opening
        };
        angles.iter().map(open).collect()
    }

    fn relative(&self, torques: &[f64]) -> f64 {
        torques.iter().fold(0.0, |m: f64, t| most(m, t.abs())) / self.scale
    }

    fn energy(&self, openings: &[f64], angles: &[f64]) -> f64 {
        let bent: f64 = openings
            .iter()
            .zip(&self.springs)
            .map(|(o, k)| 0.5 * k * o * o)
            .sum();
        let lifted: f64 = angles
            .iter()
            .zip(&self.weights)
            .map(|(a, w)| w * libm::cos(*a))
            .sum();
        bent + lifted
    }
}

#[cfg(test)]
pub(super) mod tests;
