//! What `sward run` reports: one object for all scenarios, as JSON for programs.
//!
//! The keys are a contract. A value that was not measured is null.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::gpu::{AdapterReport, Gpu};

use super::against::AgainstReference;
use super::exit::Exit;
use super::judge::Verdict;
use super::scenario::Outcome;
use super::spring_clamp::SpringClamp;

/// Rises when a key changes its meaning or goes; new keys may come without.
pub const SCHEMA_VERSION: u32 = 1;

/// The report of a whole run.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    pub schema_version: u32,
    /// Version of sward.
    pub sward: &'static str,
    /// Name of the engine.
    pub engine: &'static str,
    /// What the engine ran on; null for the CPU.
    pub adapter: Option<Adapter>,
    /// Frames per second at which scenarios were run.
    pub hz: f64,
    pub scenarios: Vec<Scenario>,
}

/// A graphics adapter.
#[derive(Clone, Debug, Serialize)]
pub struct Adapter {
    pub name: String,
    pub driver: String,
    pub backend: String,
}

impl Adapter {
    /// What a device runs on.
    pub fn of(gpu: &Gpu) -> Self {
        let AdapterReport {
            name,
            driver,
            backend,
            ..
        } = gpu.adapter.clone();
        Self {
            name,
            driver,
            backend,
        }
    }
}

/// One scenario.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Scenario {
    pub name: String,
    pub passed: bool,
    /// Why it could not be run; null if it was.
    pub error: Option<String>,
    pub seconds_simulated: f64,
    /// Sub-steps.
    pub ticks: u64,
    /// Wall-clock seconds of the run, measuring included, setting up not.
    pub wall_s: f64,
    pub expectations: Vec<Expectation>,
    pub metrics: Metrics,
    /// Median milliseconds per sub-step and pass.
    pub pass_ms: BTreeMap<String, f64>,
    /// Hash of bodies and grass over all ticks, 16 hexadecimal digits; null where the engine does not
    /// promise its bits.
    pub state_hash: Option<String>,
    /// What each body's parts were tested by, in the order of names.
    pub colliders: Vec<Collider>,
    /// What the stability clamp does to the literal springs; null for other springs.
    pub literal_springs: Option<SpringClamp>,
    /// What the distance from the reference is worth; null without a comparison. No scenario fails by
    /// it.
    pub against_reference: Option<AgainstReference>,
    /// The exit code of a scenario that could not be run.
    #[serde(skip)]
    pub broken: Option<Exit>,
}

/// What came of one expectation.
#[derive(Clone, Debug, Serialize)]
pub struct Expectation {
    pub what: String,
    /// Null if it does not apply to the engine.
    pub passed: Option<bool>,
    pub measured: Option<f64>,
    pub limit: Option<f64>,
    pub unit: &'static str,
    /// Simulated seconds; null for what speaks of the whole run.
    pub at: Option<f64>,
    /// Why it does not apply or could not be measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Numbers over the whole scenario. Penetration is measured against the bodies' true shapes.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Metrics {
    pub max_penetration_m: f64,
    pub p999_penetration_m: f64,
    pub rms_penetration_m: f64,
    /// Largest depth of a node of a plant that no body pushed or held in the sub-step.
    pub max_missed_penetration_m: f64,
    /// Largest distance by which a plant was pushed past the surface, with the body where it came
    /// closest in the sub-step.
    pub over_push_m: f64,
    /// The same as `max_penetration_m` for the middles of segments whose ends are outside.
    pub max_middle_penetration_m: f64,
    /// Largest change of a segment's length, as a share of it.
    pub max_length_strain: f64,
    /// Largest distance of a node from its wind pose.
    pub max_offset_m: f64,
    /// Largest move of a node of a held plant in a frame without wind in which no body moved; null
    /// without such a frame.
    pub jitter_m_per_frame: Option<f64>,
    /// Times after release at which the weight of a plant's offset had fallen to a half, a tenth
    /// and a hundredth; null if no plant was followed so long.
    pub recovery_half_s: Option<f64>,
    pub recovery_tenth_s: Option<f64>,
    pub recovery_hundredth_s: Option<f64>,
    /// The same of the distance of that plant's tip from its wind pose.
    pub tip_recovery_s: [Option<f64>; 3],
    /// Overlap of the imprint with the reference engine's; null without a comparison.
    pub imprint_iou: Option<f64>,
    /// Plants that ended on another side of a body than the reference's; null without a comparison.
    pub side_flips: Option<u64>,
    /// World x and z of their roots, in metres.
    pub flipped_roots_m: Vec<[f64; 2]>,
    /// Plants touched in either run; null without a comparison, like the two that follow.
    pub compared_plants: Option<u64>,
    /// Root mean square distance of the nodes of touched plants on the same side from the
    /// reference's, over all frames.
    pub pose_rms_m: Option<f64>,
    /// The distance that 95% of the plants and frames do not exceed.
    pub pose_p95_m: Option<f64>,
    /// Nodes that lay on the ground inside a body, summed over frames.
    pub pinched_vertices: u64,
    /// Plants whose root lay inside a body that pushed or held them, at most at the end of a frame.
    pub buried_plants: u64,
    pub tiles_total: u64,
    pub tiles_active_peak: u64,
    pub plants_simulated_peak: u64,
    /// Billboards of the scene, resting ones included.
    pub billboards: u64,
    pub state_bytes_peak: u64,
    /// Plants with a value that is not finite, summed over frames.
    pub nan_count: u64,
    /// Bodies taken out because their state was not finite.
    pub quarantined: Vec<String>,
    /// Sub-steps times bodies that needed more sweeps than the solver allows.
    pub capped_sweeps: u64,
    /// Tiles that could not wake because all state was in use, summed over sub-steps.
    pub refused_tiles: u64,
}

/// What the grass tested a body by.
#[derive(Clone, Debug, Serialize)]
pub struct Collider {
    pub body: String,
    pub cube_parts: u32,
    pub analytic_parts: u32,
}

impl Report {
    pub fn new(engine: &'static str, adapter: Option<Adapter>, hz: f64) -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            sward: env!("CARGO_PKG_VERSION"),
            engine,
            adapter,
            hz,
            scenarios: Vec::new(),
        }
    }

    /// The exit code of the run.
    pub fn exit(&self) -> Exit {
        Exit::of_all(self.scenarios.iter().map(Scenario::exit))
    }
}

impl Scenario {
    /// Reports a scenario that ran.
    pub fn of(outcome: &Outcome) -> Self {
        let meadow = &outcome.meadow;
        let colliders = outcome.watch.colliders.iter();
        Self {
            name: outcome.name.clone(),
            passed: outcome.passed(),
            error: None,
            seconds_simulated: meadow.time_s(),
            ticks: u64::from(meadow.ticks),
            wall_s: outcome.wall_s,
            expectations: outcome.verdicts.iter().map(Expectation::of).collect(),
            metrics: Metrics::of(outcome),
            pass_ms: outcome.pass_ms.clone(),
            state_hash: outcome.engine.state_hash().map(|h| format!("{h:016x}")),
            colliders: colliders
                .map(|(body, &(cube_parts, analytic_parts))| Collider {
                    body: body.clone(),
                    cube_parts,
                    analytic_parts,
                })
                .collect(),
            literal_springs: SpringClamp::of(&meadow.scene.solver),
            against_reference: (outcome.difference.as_ref())
                .map(|d| AgainstReference::of(d, meadow.scene.solver.substep_s)),
            broken: None,
        }
    }

    /// Reports a scenario that could not be run.
    pub fn broken(name: String, error: String, exit: Exit) -> Self {
        Self {
            name,
            error: Some(error),
            broken: Some(exit),
            ..Self::default()
        }
    }

    /// The exit code this scenario alone would have.
    pub fn exit(&self) -> Exit {
        let judged = if self.passed { Exit::Ok } else { Exit::Failed };
        self.broken.unwrap_or(judged)
    }
}

impl Expectation {
    pub(super) fn of(verdict: &Verdict) -> Self {
        Self {
            what: verdict.what.clone(),
            passed: verdict.passed,
            measured: verdict.measured,
            limit: verdict.limit,
            unit: verdict.unit,
            at: verdict.at_s,
            reason: verdict.reason.clone(),
        }
    }
}

impl Metrics {
    fn of(outcome: &Outcome) -> Self {
        let (watch, meadow) = (&outcome.watch, &outcome.meadow);
        let difference = outcome.difference.as_ref();
        let [half, tenth, hundredth] = watch.release.weight_s();
        Self {
            max_penetration_m: watch.max_penetration_m(),
            p999_penetration_m: watch.p999_penetration_m(),
            rms_penetration_m: watch.rms_penetration_m(),
            max_missed_penetration_m: watch.missed_m,
            over_push_m: watch.over_push_m,
            max_middle_penetration_m: watch.max_middle_m,
            max_length_strain: watch.max_strain,
            max_offset_m: watch.max_offset_m,
            jitter_m_per_frame: watch.jitter.largest_m(),
            recovery_half_s: half,
            recovery_tenth_s: tenth,
            recovery_hundredth_s: hundredth,
            tip_recovery_s: watch.release.tip_s(),
            imprint_iou: difference.and_then(|d| d.imprint_iou),
            side_flips: difference.map(|d| d.side_flips),
            flipped_roots_m: difference.map_or_else(Vec::new, |d| d.flipped_roots_m.clone()),
            compared_plants: difference.map(|d| d.touched_plants),
            pose_rms_m: difference.map(|d| d.pose_rms_m),
            pose_p95_m: difference.map(|d| d.pose_p95_m),
            pinched_vertices: watch.pinched,
            buried_plants: watch.buried,
            tiles_total: u64::from(meadow.field.grid.tile_count()),
            tiles_active_peak: meadow.tiles.peak as u64,
            plants_simulated_peak: meadow.counters.plants_peak,
            billboards: meadow
                .field
                .billboards
                .as_ref()
                .map_or(0, |b| b.all.len() as u64),
            state_bytes_peak: meadow.counters.state_bytes_peak,
            nan_count: watch.not_finite,
            quarantined: meadow.bodies.quarantined().to_vec(),
            capped_sweeps: meadow.counters.capped_sweeps,
            refused_tiles: meadow.counters.refused_tiles,
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A report with one scenario that ran and one that did not.
    pub fn sample() -> Report {
        let mut report = Report::new("cpu", None, 60.0);
        report.scenarios.push(Scenario {
            name: "ball & roll".into(),
            passed: false,
            seconds_simulated: 4.0,
            ticks: 480,
            wall_s: 0.5,
            expectations: vec![
                Expectation {
                    what: "plants lean at least 40 °".into(),
                    passed: Some(false),
                    measured: Some(12.25),
                    limit: Some(40.0),
                    unit: "°",
                    at: Some(2.0),
                    reason: None,
                },
                Expectation {
                    what: "the state hash is 00".into(),
                    passed: None,
                    measured: None,
                    limit: None,
                    unit: "",
                    at: None,
                    reason: Some("only the cpu engine promises its bits".into()),
                },
            ],
            pass_ms: BTreeMap::from([("collide".into(), 0.25)]),
            state_hash: Some("00ff".into()),
            colliders: vec![Collider {
                body: "ball".into(),
                cube_parts: 1,
                analytic_parts: 0,
            }],
            ..Scenario::default()
        });
        let broken = Scenario::broken("gone".into(), "no such <file>".into(), Exit::Invalid);
        report.scenarios.push(broken);
        report
    }

    fn keys(value: &serde_json::Value) -> Vec<&str> {
        let object = value.as_object().expect("an object");
        object.keys().map(String::as_str).collect()
    }

    #[test]
    fn the_keys_are_those_of_the_contract() {
        let json = serde_json::to_value(sample()).expect("plain data");
        let mut top = keys(&json);
        top.sort_unstable();
        let want = [
            "adapter",
            "engine",
            "hz",
            "scenarios",
            "schema_version",
            "sward",
        ];
        assert_eq!(top, want);
        let scenario = &json["scenarios"][0];
        for key in [
            "name",
            "passed",
            "seconds_simulated",
            "ticks",
            "expectations",
            "metrics",
            "pass_ms",
            "state_hash",
        ] {
            assert!(scenario.get(key).is_some(), "{key}");
        }
        for key in ["what", "passed", "measured", "limit", "unit", "at"] {
            assert!(scenario["expectations"][0].get(key).is_some(), "{key}");
        }
        assert!(scenario["expectations"][0].get("reason").is_none());
        assert!(scenario["expectations"][1]["passed"].is_null());
        assert!(scenario["expectations"][1]["reason"].is_string());
        let mut metrics = keys(&scenario["metrics"]);
        metrics.sort_unstable();
        let want = [
            "billboards",
            "buried_plants",
            "capped_sweeps",
            "compared_plants",
            "flipped_roots_m",
            "imprint_iou",
            "jitter_m_per_frame",
            "max_length_strain",
            "max_middle_penetration_m",
            "max_missed_penetration_m",
            "max_offset_m",
            "max_penetration_m",
            "nan_count",
            "over_push_m",
            "p999_penetration_m",
            "pinched_vertices",
            "plants_simulated_peak",
            "pose_p95_m",
            "pose_rms_m",
            "quarantined",
            "recovery_half_s",
            "recovery_hundredth_s",
            "recovery_tenth_s",
            "refused_tiles",
            "rms_penetration_m",
            "side_flips",
            "state_bytes_peak",
            "tiles_active_peak",
            "tiles_total",
            "tip_recovery_s",
        ];
        assert_eq!(metrics, want);
        assert_eq!(json["schema_version"], 1);
        assert!(json["adapter"].is_null());
    }

    #[test]
    fn the_gravest_scenario_decides_the_exit_code() {
        let mut report = sample();
        assert_eq!(report.exit(), Exit::Invalid);
        report.scenarios.truncate(1);
        assert_eq!(report.exit(), Exit::Failed);
        report.scenarios[0].passed = true;
        assert_eq!(report.exit(), Exit::Ok);
    }
}
