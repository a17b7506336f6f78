//! A second way to a blade's shape: the energy of P15 eq. 12 lowered one angle at a time.
//!
//! ```text
//! E = ½ Σ k′_j (θ_j − θ_{j−1})² + Σ (N − j + ½) cos θ_j,   0 ≤ θ_j ≤ π
//! ```
//!
//! With its neighbours held, the slope of E in θ_j is convex on 0…π, at most 0 at θ_j = 0 and at
//! least 0 at π. So the angle of least energy is its largest zero, which is bisected. Repeated over all
//! angles, from many starts, until nothing moves. No derivative of the slope, no linear system, no
//! line of code shared with the Newton search of [`solve`](super::solve): the distance between
//! the two is the noise floor of everything that is compared with either.
//!
//! Limits: the sweeps close in by a factor that tends to 1 with the number of segments squared and
//! at the critical stiffness; what has not settled after [`MOST_SWEEPS`] says so by
//! [`Descent::last_move_rad`].

use std::f64::consts::PI;

use super::{ShapeError, check, solve};
use crate::base::most;
use crate::base::philox::{philox2x32, unit};
use crate::scene::Root;

/// Sweeps after which a start is given up on.
pub const MOST_SWEEPS: u32 = 200_000;

/// A sweep that moves no angle by more than this, in radians, ends the search.
const SETTLED_RAD: f64 = 1e-15;

/// Halvings of 0…π that leave less than an ulp of any angle above 1e-3.
const HALVINGS: u32 = 62;

/// What the descent found.
#[derive(Clone, Debug, PartialEq)]
pub struct Descent {
    /// θ_1 … θ_N of the start that ended lowest, in radians.
    pub angles_rad: Vec<f64>,
    /// Its energy, in units of m g l.
    pub energy: f64,
    /// Largest difference of an angle between the starts' ends, in radians: 0 but for rounding
    /// where there is one minimum.
    pub spread_rad: f64,
    /// Largest move of an angle in the last sweep of any start.
    pub last_move_rad: f64,
}

/// The shape of least energy, from `starts` random starts in 0…π and an upright one a little
/// disturbed.
///
/// # Errors
///
/// As [`solve`](super::solve).
pub fn least_energy(
    segments: u32,
    k_prime: f64,
    root: Root,
    lean_rad: f64,
    starts: u32,
) -> Result<Descent, ShapeError> {
    check(segments, k_prime, lean_rad)?;
    let blade = Blade {
        segments: segments as usize,
        k_prime,
        root,
        lean_rad: lean_rad.min(PI),
    };
    let mut best = blade.descend(vec![1e-3; blade.segments]);
    for start in 0..starts {
        let draw = |j| PI * f64::from(unit(philox2x32([j, start], segments, 10)[0]));
        let found = blade.descend((0..segments).map(draw).collect());
        let apart = |(a, b): (&f64, &f64)| (a - b).abs();
        let gaps = best.angles_rad.iter().zip(&found.angles_rad).map(apart);
        let spread_rad = gaps.fold(best.spread_rad, most);
        let last_move_rad = best.last_move_rad.max(found.last_move_rad);
        let lower = if found.energy < best.energy {
            found
        } else {
            best
        };
        best = Descent {
            spread_rad,
            last_move_rad,
            ..lower
        };
    }
    Ok(best)
}

/// Largest distance of a node between the Newton search and the descent, in blade lengths.
///
/// # Errors
///
/// As [`solve`](super::solve).
pub fn noise_floor(
    segments: u32,
    k_prime: f64,
    root: Root,
    lean_rad: f64,
    starts: u32,
) -> Result<f64, ShapeError> {
    let newton = solve::<f64>(segments, k_prime, root, lean_rad)?;
    let descent = least_energy(segments, k_prime, root, lean_rad, starts)?;
    let length = 1.0 / f64::from(segments);
    let mut at = [0.0, 0.0];
    let mut largest: f64 = 0.0;
    for (angle, node) in descent.angles_rad.iter().zip(&newton.nodes[1..]) {
        at = [
            at[0] + length * libm::sin(*angle),
            at[1] + length * libm::cos(*angle),
        ];
        largest = most(largest, libm::hypot(at[0] - node[0], at[1] - node[1]));
    }
    Ok(largest)
}

struct Blade {
    segments: usize,
    k_prime: f64,
    root: Root,
    lean_rad: f64,
}

impl Blade {
    /// k′ of the hinge below segment `j`, counted from 0; none above the tip.
    fn spring(&self, j: usize) -> f64 {
        match j {
            0 if self.root == Root::Double => 2.0 * self.k_prime,
            _ if j < self.segments => self.k_prime,
            _ => 0.0,
        }
    }

    fn weight(&self, j: usize) -> f64 {
        (self.segments - j) as f64 - 0.5
    }

    fn descend(&self, mut angles: Vec<f64>) -> Descent {
        let mut last_move_rad = f64::INFINITY;
        let mut sweeps = 0;
        while last_move_rad > SETTLED_RAD && sweeps < MOST_SWEEPS {
            last_move_rad = 0.0;
            for j in 0..self.segments {
                let lowest = self.lowest(&angles, j);
                last_move_rad = most(last_move_rad, (lowest - angles[j]).abs());
                angles[j] = lowest;
            }
            sweeps += 1;
        }
        Descent {
            energy: self.energy(&angles),
            angles_rad: angles,
            spread_rad: 0.0,
            last_move_rad,
        }
    }

    /// The angle of segment `j` with the least energy while the others stay.
    fn lowest(&self, angles: &[f64], j: usize) -> f64 {
        let below = if j == 0 { self.lean_rad } else { angles[j - 1] };
        let above = angles.get(j + 1).copied().unwrap_or(0.0);
        let (low_spring, high_spring) = (self.spring(j), self.spring(j + 1));
        let weight = self.weight(j);
        let slope = |angle: f64| {
            low_spring * (angle - below) + high_spring * (angle - above) - weight * libm::sin(angle)
        };
        let (mut low, mut high) = (0.0, PI);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if slope(middle) > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        low
    }

    fn energy(&self, angles: &[f64]) -> f64 {
        let mut below = self.lean_rad;
        let mut energy = 0.0;
        for (j, &angle) in angles.iter().enumerate() {
            let opening = angle - below;
            energy += 0.5 * self.spring(j) * opening * opening;
            energy += self.weight(j) * libm::cos(angle);
            below = angle;
        }
        energy
    }
}
