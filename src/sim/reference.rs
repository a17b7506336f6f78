//! Reference: the settings that make the same kernels the truth in an error report.
//!
//! In `f64`, with the exact distance to a body's true shape in place of depth cubes, sweeps of at
//! most a twentieth of a body's half thickness, and rounds until no segment is strained by more
//! than 1e-10 and no node is moved out of a body any more, and sub-steps of an eighth of the
//! scene's, between which the bodies move evenly: when a plant was let go is known to a sub-step
//! only, and its tip returns by up to 1.5 of its offset per second then. Recovery is the default's,
//! which is exact at any rate. What it shares with the default is the physics of the bodies
//! (rapier, at the scene's sub-step), the order of constraints within a sweep, and the bend
//! springs' rate, which it takes to the limit of short sweeps.

use crate::scene::Solver;
use crate::scene::method::{Collide, Method};

/// Travel of a body in one sweep, over its half thickness.
pub const SWEEP_SHARE: f64 = 1.0 / 20.0;
/// Strain at which rounds may end.
pub const STRAIN: f32 = 1e-10;
/// Most rounds of a sweep; a blade between two bodies may have no way out at all.
pub const ROUNDS: u32 = 64;
/// Most sweeps of a sub-step: 6.8 km/s for a ball of 15 cm at 1/120 s.
pub const SWEEPS: u32 = 65_536;

/// Sub-steps of the grass in one of the scene's.
pub const GRASS_STEPS: u32 = 8;

/// A scene's settings as the reference engine runs them.
pub fn solver(scene: &Solver) -> Solver {
    refined(scene, GRASS_STEPS, SWEEP_SHARE)
}

/// The same with another refinement of time and sweeps, to see it converge.
pub fn refined(scene: &Solver, grass_steps: u32, sweep_share: f64) -> Solver {
    Solver {
        substep_s: scene.substep_s / f64::from(grass_steps),
        rounds: [2, ROUNDS],
        strain_limit: STRAIN,
        max_sweeps: SWEEPS,
        method: Method {
            collide: Collide::Exact,
            sweep_share,
            // The bodies keep the scene's own step, or free ones would go another way.
            grass_steps: grass_steps * scene.method.grass_steps,
            ..Method::default()
        },
        ..scene.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_keep_their_step() {
        let mut scene = Solver::default();
        let body_step_s = |s: &Solver| s.substep_s * f64::from(s.method.grass_steps);
        for grass_steps in [1, 4] {
            scene.substep_s /= f64::from(grass_steps);
            scene.method.grass_steps = grass_steps;
            let step_s = body_step_s(&solver(&scene));
            assert!(
                (step_s - body_step_s(&scene)).abs() < 1e-15,
                "{grass_steps}"
            );
        }
    }
}
