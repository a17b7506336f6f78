//! Expectations: each is measured during the run and compared with its limit.

use crate::gpu::GpuError;
use crate::scene::Expectation;
use crate::sim::Meadow;

use super::engine::Engine;
use super::swept::{BENT_M, Swept};
use super::watch::Watch;

/// What came of one expectation.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The expectation in words.
    pub what: String,
    /// `None` if it does not apply to the engine.
    pub passed: Option<bool>,
    pub measured: Option<f64>,
    pub limit: Option<f64>,
    pub unit: &'static str,
    /// Simulated time it speaks of, in seconds.
    pub at_s: Option<f64>,
    /// Why it does not apply or could not be measured.
    pub reason: Option<String>,
}

/// An expectation and what has been seen for it so far.
#[derive(Debug)]
pub struct Judge {
    expectation: Expectation,
    verdict: Option<Verdict>,
    swept: Option<(u32, Swept)>,
}

impl Judge {
    pub fn new(expectation: &Expectation, meadow: &Meadow) -> Self {
        let swept = match expectation {
            Expectation::Imprint { body, .. } => {
                meadow.bodies.id_of(body).map(|id| (id, Swept::default()))
            }
            _ => None,
        };
        Self {
            expectation: expectation.clone(),
            verdict: None,
            swept,
        }
    }

    /// After every sub-step: what must be gathered all along, and what is due now.
    ///
    /// # Errors
    ///
    /// The engine's.
    pub fn tick(&mut self, meadow: &Meadow, engine: &mut Engine) -> Result<(), GpuError> {
        if self.verdict.is_some() {
            return Ok(());
        }
        if let Some((body, swept)) = &mut self.swept {
            swept.tick(meadow, *body);
        }
        let due = |at_s: f64| meadow.time_s() + 1e-9 >= at_s;
        self.verdict = match &self.expectation {
            Expectation::Lean {
                at_s,
                near_m,
                within_m,
                at_least_deg,
                at_most_deg,
            } if due(*at_s) => {
                let plants = engine.near(meadow, *near_m, *within_m)?;
                let billboards = engine.billboards_near(meadow, *near_m, *within_m)?;
                let leans = plants.iter().map(|p| p.lean_rad());
                let leans = leans.chain(billboards.iter().map(|b| b.lean_rad()));
                let leans: Vec<f64> = leans.map(f64::to_degrees).collect();
                let what = format!("plants within {within_m} m of {near_m:?} lean");
                Some(mean_verdict(
                    what,
                    &leans,
                    *at_least_deg,
                    *at_most_deg,
                    "°",
                    *at_s,
                ))
            }
            Expectation::Offset {
                at_s,
                near_m,
                within_m,
                at_least_m,
                at_most_m,
            } if due(*at_s) => {
                let plants = engine.near(meadow, *near_m, *within_m)?;
                let billboards = engine.billboards_near(meadow, *near_m, *within_m)?;
                let offsets = plants.iter().map(|p| p.offset_m());
                let offsets = offsets.chain(billboards.iter().map(|b| b.offset_m()));
                let offsets: Vec<f64> = offsets.collect();
                let what = format!("plants within {within_m} m of {near_m:?} are off");
                Some(mean_verdict(
                    what,
                    &offsets,
                    *at_least_m,
                    *at_most_m,
                    "m",
                    *at_s,
                ))
            }
            Expectation::BodyNear {
                body,
                at_s,
                position_m,
                within_m,
            } if due(*at_s) => Some(body_near(meadow, body, *position_m, *within_m, *at_s)),
            Expectation::Imprint {
                body,
                at_s,
                at_least,
            } if due(*at_s) => Some(imprint(
                meadow,
                engine,
                body,
                self.swept.as_ref(),
                *at_least,
                *at_s,
            )?),
            _ => None,
        };
        Ok(())
    }

    /// The verdict at the end of the run.
    /// A hash is that of the scene as it is written; `as_written` is false for other settings.
    pub fn finish(
        self,
        meadow: &Meadow,
        engine: &Engine,
        watch: &Watch,
        as_written: bool,
    ) -> Verdict {
        if let Some(verdict) = self.verdict {
            return verdict;
        }
        let counters = &meadow.counters;
        match &self.expectation {
            Expectation::Penetration { at_most_m } => {
                let (measured, limit) = match at_most_m {
                    Some(limit) => (watch.max_penetration_m(), *limit),
                    None => (watch.worst.depth_m, watch.worst.limit_m),
                };
                at_most("deepest node inside a body", measured, limit, "m")
            }
            Expectation::Strain { at_most: limit } => {
                at_most("largest strain of a segment", watch.max_strain, *limit, "")
            }
            Expectation::AllRest { by_s } => all_rest(meadow, watch.last_active_s, *by_s),
            Expectation::ActiveTiles { at_least, at_most } => {
                let peak = meadow.tiles.peak as f64;
                between("most active tiles at once", peak, *at_least, *at_most, "")
            }
            Expectation::SimulatedPlants { at_least, at_most } => {
                let peak = counters.plants_peak as f64;
                between(
                    "most plants simulated at once",
                    peak,
                    *at_least,
                    *at_most,
                    "",
                )
            }
            Expectation::StateBytes { at_most } => {
                let peak = counters.state_bytes_peak as f64;
                between("most grass state", peak, None, Some(*at_most), "bytes")
            }
            Expectation::StateHash { is } => state_hash(engine, is, as_written),
            Expectation::Lean { at_s, .. }
            | Expectation::Offset { at_s, .. }
            | Expectation::BodyNear { at_s, .. }
            | Expectation::Imprint { at_s, .. } => Verdict {
                what: "measured before the run ends".into(),
                passed: Some(false),
                measured: None,
                limit: Some(meadow.time_s()),
                unit: "s",
                at_s: Some(*at_s),
                reason: Some(format!(
                    "at_s is {at_s} s, but the run ends at {} s",
                    meadow.time_s()
                )),
            },
        }
    }
}

fn verdict(
    what: impl Into<String>,
    passed: bool,
    measured: f64,
    limit: f64,
    unit: &'static str,
) -> Verdict {
    Verdict {
        what: what.into(),
        passed: Some(passed),
        measured: Some(measured),
        limit: Some(limit),
        unit,
        at_s: None,
        reason: None,
    }
}

fn at_most(what: &str, measured: f64, limit: f64, unit: &'static str) -> Verdict {
    let what = format!("{what} is at most");
    verdict(what, measured <= limit, measured, limit, unit)
}

/// `last_active_s` is `None` where no tile was ever awake.
fn all_rest(meadow: &Meadow, last_active_s: Option<f64>, by_s: f64) -> Verdict {
    let seen_to_the_end = meadow.time_s() + 1e-9 >= by_s;
    let rested = last_active_s.is_none_or(|last| last < by_s);
    Verdict {
        measured: last_active_s,
        reason: match (last_active_s, seen_to_the_end) {
            (_, false) => Some(format!("the run ends at {} s", meadow.time_s())),
            (None, true) => Some("no tile was ever awake".into()),
            (Some(_), true) => None,
        },
        ..verdict(
            "the last tile that was awake rests before",
            rested && seen_to_the_end,
            by_s,
            by_s,
            "s",
        )
    }
}

/// A failed verdict for everything that was limited although a scene did not ask for it: results
/// beyond a limit are no longer those of the scene.
pub fn exceeded_limits(meadow: &Meadow, watch: &Watch) -> Vec<Verdict> {
    let counters = &meadow.counters;
    let none = [
        (
            "sub-steps in which a body was too fast for solver.max_sweeps",
            counters.capped_sweeps,
            "raise max_sweeps or shorten substep_s",
        ),
        (
            "touched tiles that could not wake, summed over sub-steps",
            counters.refused_tiles,
            "all grass state is in use: make tiles larger, or the density lower",
        ),
        (
            "plants with a value that is not finite, summed over frames",
            watch.not_finite,
            "this is a fault of the engine",
        ),
    ];
    none.into_iter()
        .filter(|&(_, count, _)| count > 0)
        .map(|(what, count, advice)| Verdict {
            reason: Some(advice.into()),
            ..verdict(what, false, count as f64, 0.0, "")
        })
        .collect()
}

fn between(
    what: &str,
    measured: f64,
    at_least: Option<u64>,
    at_most: Option<u64>,
    unit: &'static str,
) -> Verdict {
    let low = at_least.map(|n| n as f64);
    let high = at_most.map(|n| n as f64);
    let passed = low.is_none_or(|l| measured >= l) && high.is_none_or(|h| measured <= h);
    let bounds = bounds_in_words(low, high);
    let limit = if low.is_some_and(|l| measured < l) {
        low
    } else {
        high.or(low)
    };
    Verdict {
        limit,
        ..verdict(format!("{what} {bounds}"), passed, measured, 0.0, unit)
    }
}

fn bounds_in_words(low: Option<f64>, high: Option<f64>) -> String {
    match (low, high) {
        (Some(low), Some(high)) => format!("at least {low} and at most {high}"),
        (Some(low), None) => format!("at least {low}"),
        (None, Some(high)) => format!("at most {high}"),
        (None, None) => "any".into(),
    }
}

fn mean_verdict(
    what: String,
    values: &[f64],
    low: Option<f64>,
    high: Option<f64>,
    unit: &'static str,
    at_s: f64,
) -> Verdict {
    let what = format!("{what} {} {unit}", bounds_in_words(low, high));
    if values.is_empty() {
        return Verdict {
            measured: None,
            limit: low.or(high),
            at_s: Some(at_s),
            reason: Some("no plant grows there".into()),
            ..verdict(what, false, 0.0, 0.0, unit)
        };
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let passed = low.is_none_or(|l| mean >= l) && high.is_none_or(|h| mean <= h);
    let limit = if low.is_some_and(|l| mean < l) {
        low
    } else {
        high.or(low)
    };
    Verdict {
        limit,
        at_s: Some(at_s),
        ..verdict(what, passed, mean, 0.0, unit)
    }
}

fn body_near(meadow: &Meadow, body: &str, place: [f64; 3], within_m: f64, at_s: f64) -> Verdict {
    let what = format!("`{body}` is near {place:?}");
    let found = meadow.bodies.info().find(|info| info.name == body);
    let Some(info) = found else {
        return Verdict {
            measured: None,
            at_s: Some(at_s),
            reason: Some("the body is not in the scene at that time".into()),
            ..verdict(what, false, 0.0, within_m, "m")
        };
    };
    let p = info.pose.place.to_f64();
    let squares: f64 = (0..3).map(|a| (p[a] - place[a]).powi(2)).sum();
    let distance = squares.sqrt();
    Verdict {
        at_s: Some(at_s),
        ..verdict(what, distance <= within_m, distance, within_m, "m")
    }
}

/// Intersection over union of the plants swept and the plants bent.
fn imprint(
    meadow: &Meadow,
    engine: &mut Engine,
    body: &str,
    swept: Option<&(u32, Swept)>,
    at_least: f64,
    at_s: f64,
) -> Result<Verdict, GpuError> {
    let what = format!("imprint of `{body}` overlaps its path");
    let Some((id, swept)) = swept else {
        return Ok(Verdict {
            measured: None,
            at_s: Some(at_s),
            reason: Some("no body of that name is in the scene".into()),
            ..verdict(what, false, 0.0, at_least, "")
        });
    };
    // Only what happened within half the recovery time counts, so that no tile of it rests yet;
    // whether it was swept and bent may have been told a little earlier.
    let (recent, all) = (meadow.recovery_ticks() / 2, meadow.recovery_ticks());
    let bent_lately = engine.bent(meadow, *id, recent, BENT_M)?;
    let either = &swept.since(meadow.ticks, recent) | &bent_lately;
    let both = &swept.since(meadow.ticks, all) & &engine.bent(meadow, *id, all, BENT_M)?;
    let both = either.intersection(&both).count() as f64;
    let either = either.len() as f64;
    let overlap = if either > 0.0 { both / either } else { 0.0 };
    Ok(Verdict {
        at_s: Some(at_s),
        ..verdict(what, overlap >= at_least, overlap, at_least, "")
    })
}

fn state_hash(engine: &Engine, is: &str, as_written: bool) -> Verdict {
    let what = format!("the state hash is {is}");
    let none = |passed, reason| Verdict {
        passed,
        measured: None,
        limit: None,
        reason,
        ..verdict(what, true, 0.0, 0.0, "")
    };
    match engine.state_hash().map(|hash| format!("{hash:016x}")) {
        None => none(None, Some("only the cpu engine promises its bits".into())),
        Some(_) if !as_written => {
            let reason = "the run has other settings or inputs than the scene";
            none(None, Some(reason.into()))
        }
        Some(hash) => none(
            Some(hash == is),
            (hash != is).then(|| format!("this run's is {hash}")),
        ),
    }
}
