//! A run beside the reference engine: the same scene, tick by tick, and how far the poses differ.

use serde::Serialize;

use crate::gpu::{GpuError, TickError};
use crate::scene::Scene;
use crate::scene::assets::Assets;
use crate::sim::{Meadow, MeadowError};

pub use super::compare::Difference;
use super::compare::{Comparison, touched_plants};
use super::engine::Engine;
use super::judge::Verdict;
use super::report::Expectation;

/// Pose error that a run may have, in metres, root mean square: at sub-steps of the grass longer than
/// [`SHORT_S`], and at those not longer.
const MOST_RMS_M: [f64; 2] = [0.010, 0.003];
/// 1/480 s, and the rounding of a division.
const SHORT_S: f64 = 1.0 / 479.9;
/// Share of the touched plants that may end on another side of a body.
const MOST_FLIPS: f64 = 0.01;
/// Overlap that imprints have at least.
const LEAST_OVERLAP: f64 = 0.95;

/// The limits of a run's distance from the reference.
#[derive(Clone, Debug, Serialize)]
pub struct AgainstReference {
    /// Null where nothing was touched.
    pub within_limits: Option<bool>,
    pub limits: Vec<Expectation>,
}

impl AgainstReference {
    pub fn of(difference: &Difference, substep_s: f64) -> Self {
        let verdicts = verdicts(difference, substep_s);
        let judged: Option<Vec<bool>> = verdicts.iter().map(|verdict| verdict.passed).collect();
        Self {
            within_limits: judged.map(|all| all.into_iter().all(|passed| passed)),
            limits: verdicts.iter().map(Expectation::of).collect(),
        }
    }
}

/// What a difference is worth: one verdict per limit. They are told, but no scenario fails by them: a
/// scene says with its expectations what it needs.
fn verdicts(difference: &Difference, substep_s: f64) -> Vec<Verdict> {
    let unjudged = |reason: &str| Verdict {
        passed: None,
        measured: None,
        limit: None,
        reason: Some(reason.into()),
        ..limited("poses", 0.0, 0.0, "m")
    };
    let left_out = (difference.billboards_left_out > 0)
        .then(|| unjudged("billboards are not compared with the reference yet"));
    if difference.touched_plants == 0 {
        let untouched = || unjudged("no plant was touched in either run");
        return vec![left_out.unwrap_or_else(untouched)];
    }
    let rms_limit_m = MOST_RMS_M[usize::from(substep_s <= SHORT_S)];
    let flips = difference.side_flips as f64 / difference.touched_plants as f64;
    let mut verdicts = vec![
        limited(
            "poses, root mean square",
            difference.pose_rms_m,
            rms_limit_m,
            "m",
        ),
        limited(
            "plants on another side",
            100.0 * flips,
            100.0 * MOST_FLIPS,
            "%",
        ),
    ];
    verdicts.extend(difference.imprint_iou.map(|overlap| Verdict {
        passed: Some(overlap >= LEAST_OVERLAP),
        ..limited("imprint overlap, at least", overlap, LEAST_OVERLAP, "")
    }));
    verdicts.extend(left_out);
    verdicts
}

fn limited(what: &str, measured: f64, limit: f64, unit: &'static str) -> Verdict {
    Verdict {
        what: what.into(),
        passed: Some(measured <= limit),
        measured: Some(measured),
        limit: Some(limit),
        unit,
        at_s: None,
        reason: None,
    }
}

/// The reference beside a run, and what differed so far.
pub struct Against {
    meadow: Meadow,
    engine: Engine,
    comparison: Comparison,
    /// Most billboards at once that a body had touched in the run.
    billboards: u64,
}

impl Against {
    /// Lays the scene out once more for the reference engine.
    ///
    /// # Errors
    ///
    /// As for [`Meadow::new`].
    pub fn reference(scene: Scene, assets: &Assets) -> Result<Self, MeadowError> {
        let mut meadow = Meadow::new(scene, assets)?;
        let engine = Engine::reference(&mut meadow);
        Ok(Self::new(meadow, engine))
    }

    /// Compares with any other run of the same scene at its start.
    pub fn new(meadow: Meadow, engine: Engine) -> Self {
        Self {
            engine,
            meadow,
            comparison: Comparison::default(),
            billboards: 0,
        }
    }

    /// Advances the reference to the time of a meadow: by one sub-step where both have the same.
    ///
    /// # Errors
    ///
    /// The script's.
    pub fn catch_up(&mut self, time_s: f64) -> Result<(), TickError> {
        // A thousandth of a sub-step forgives the rounding of two ways to count time.
        let step_s = self.meadow.scene.solver.substep_s;
        while self.meadow.time_s() + 0.999 * step_s < time_s {
            self.engine.tick(&mut self.meadow)?;
        }
        Ok(())
    }

    /// Compares both at the end of a frame.
    ///
    /// # Errors
    ///
    /// The engine's.
    pub fn frame(&mut self, meadow: &Meadow, engine: &mut Engine) -> Result<(), GpuError> {
        let ours = touched_plants(meadow, engine)?;
        let theirs = touched_plants(&self.meadow, &mut self.engine)?;
        self.comparison.frame(&ours, &theirs);
        let mut touched = 0;
        for tile in &meadow.work.tiles {
            let billboards = engine.standing_billboards(meadow, tile)?;
            touched += billboards.iter().filter(|b| b.touched_at != 0).count() as u64;
        }
        self.billboards = self.billboards.max(touched);
        Ok(())
    }

    /// What differed over all frames.
    pub fn finish(&self) -> Difference {
        Difference {
            billboards_left_out: self.billboards,
            ..self.comparison.finish(&self.meadow.field)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passed(difference: &Difference, substep_s: f64) -> Vec<Option<bool>> {
        let verdicts = verdicts(difference, substep_s);
        verdicts.iter().map(|verdict| verdict.passed).collect()
    }

    #[test]
    fn each_limit_is_judged_and_short_sub_steps_more_strictly() {
        let fine = Difference {
            pose_rms_m: 0.004,
            imprint_iou: Some(0.96),
            side_flips: 1,
            touched_plants: 100,
            ..Difference::default()
        };
        assert_eq!(passed(&fine, 1.0 / 120.0), [Some(true); 3]);
        assert_eq!(
            passed(&fine, 1.0 / 480.0),
            [Some(false), Some(true), Some(true)]
        );
        let poor = Difference {
            pose_rms_m: f64::NAN,
            imprint_iou: Some(0.94),
            side_flips: 2,
            ..fine
        };
        assert_eq!(passed(&poor, 1.0 / 120.0), [Some(false); 3]);
        assert_eq!(passed(&Difference::default(), 1.0 / 120.0), [None]);
        let mixed = Difference {
            billboards_left_out: 3,
            ..poor
        };
        let last = passed(&mixed, 1.0 / 120.0).pop();
        assert_eq!(last, Some(None), "billboards are not judged");
    }
}
