//! How often the clamp acts that keeps the printed springs (O09 eq. 6-7) stable.
//!
//! Its bound depends on the number of segments alone, and the step asked for on the settings alone, so
//! that it acts in every sub-step or in none.

use serde::Serialize;

use crate::scene::Solver;
use crate::scene::method::Springs;
use crate::sim::springs::LiteralBlade;

/// The step of the literal springs, and what the clamp does to it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SpringClamp {
    /// a of O09 eq. 7 that the spring rate and the sub-step ask for.
    pub asked: f64,
    /// The largest that is taken.
    pub bound: f64,
    /// True where the clamp acts in every sub-step, false where it never does.
    pub acts: bool,
}

impl SpringClamp {
    /// That of a solver; `None` without literal springs.
    pub fn of(solver: &Solver) -> Option<Self> {
        if solver.method.springs != Springs::Literal {
            return None;
        }
        let segments = solver.segments as usize;
        let rate_step = f64::from(solver.spring_rate_per_s) * solver.substep_s;
        Some(Self {
            asked: 0.5 * rate_step,
            bound: LiteralBlade::<f64>::new(f64::MAX, segments).step,
            acts: LiteralBlade::<f64>::new(rate_step, segments).clamped,
        })
    }

    /// In words.
    pub fn words(&self) -> String {
        let Self { asked, bound, acts } = self;
        match acts {
            true => format!(
                "the stability clamp acts in every sub-step (a = {asked:.4} asked for, {bound:.4} taken)"
            ),
            false => format!(
                "the stability clamp never acts (a = {asked:.4} asked for, up to {bound:.4} allowed)"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::methods::method;

    #[test]
    fn the_clamp_acts_on_stiff_springs_alone() {
        let mut solver = Solver::default();
        assert_eq!(SpringClamp::of(&solver), None);
        method("springs-literal")
            .expect("a name")
            .apply(&mut solver);
        let soft = SpringClamp::of(&solver).expect("literal springs");
        assert!(!soft.acts && soft.asked < soft.bound, "{soft:?}");
        // Structural and bend springs of one straight chain: λmax is above that of the structural ones
        // alone, 4, and at most their number at a node times twice the weight beside the root, 16.
        assert!((0.9 / 16.0..0.9 / 4.0).contains(&soft.bound), "{soft:?}");
        solver.spring_rate_per_s = 100.0;
        let stiff = SpringClamp::of(&solver).expect("literal springs");
        assert!(
            stiff.acts && stiff.words().contains("every sub-step"),
            "{stiff:?}"
        );
    }
}
