//! The bench of P15 section 3.2: plants listed by exact counts of triangles and by the 32 bins of
//! eq. 15, over the views of a flight.
//!
//! What is timed is the first stage of drawing alone: counting, listing and sorting the plants in
//! view, from its submission until the device is done. The two ways take turns, view by view and
//! round by round. The error of the density is that of the counts which triangles are given.

use std::time::Instant;

use serde::Serialize;

use super::flight::{FRAMES_PER_S, flight_view};
use super::machine::Machine;
use super::still_field::{DrawBenchError, StillField};
use super::terrain::hills;
use crate::base::statistics::median;
use crate::field::WindNow;
use crate::gpu::Gpu;
use crate::render::{BladeDetail, Count, Submission};
use crate::run::report::Adapter;
use crate::scene::Wind;
use crate::scene::assets::Assets;
use crate::terrain::height_grid;

/// Side of the terrain, in metres.
const SIDE_M: f32 = 1000.0;
/// Seconds of the flight whose views are taken: it is down between the 10th and the 20th.
const SECONDS: [u32; 6] = [6, 8, 10, 13, 16, 20];
/// Times that every view is listed, after one that is not timed.
const ROUNDS: usize = 5;
/// Picture in which plants are counted.
const PICTURE: [u32; 2] = [1920, 1080];
/// Plants per pixel of the rules by area: so many that triangles within some metres have all.
const PER_PX: f32 = 0.1;

/// Plants alone: with a companion each, the clusters that views near the ground may have do not fit into
/// the 128 MiB that a software adapter binds at once.
const TUFT: u32 = 1;

/// Results of the whole bench.
#[derive(Clone, Debug, Serialize)]
pub struct SubmissionBench {
    pub schema_version: u32,
    /// Version of sward.
    pub sward: &'static str,
    pub machine: Machine,
    pub adapter: Adapter,
    /// Views and rounds that the medians are over.
    pub views: usize,
    pub rounds: usize,
    pub rows: Vec<SubmissionRow>,
}

/// One rule of counting, submitted one way.
#[derive(Clone, Debug, Serialize)]
pub struct SubmissionRow {
    pub rule: &'static str,
    pub submission: &'static str,
    /// Milliseconds of the first stage, mean over the views of each one's median.
    pub ms: f64,
    /// Seeding triangles in view with a count above 0, and places that were looked at, per view.
    pub triangles: f64,
    pub places: f64,
    /// Plants that were found.
    pub plants: f64,
    /// Error of all plants together, and root mean square and largest error of the triangles of one
    /// plant and more, as shares of their exact counts.
    pub density_error: f64,
    pub triangle_error_rms: f64,
    pub triangle_error_most: f64,
}

/// Runs the bench; `progress` gets the share done.
///
/// # Errors
///
/// A device that cannot hold the plants in view.
pub fn bench_submission(
    gpu: &Gpu,
    mut progress: impl FnMut(f64),
) -> Result<SubmissionBench, DrawBenchError> {
    let machine = Machine::now();
    let mut rig = Rig::new(gpu)?;
    let rules = [
        ("distance", Count::Distance),
        ("eq. 1", Count::ProjectedArea { per_px: PER_PX }),
        ("eq. 2", Count::WorldArea { per_px: PER_PX }),
    ];
    let mut rows = Vec::new();
    for (done, (name, count)) in rules.into_iter().enumerate() {
        let share = rules.len() as f64;
        rows.extend(rig.rule(gpu, name, count, |part| {
            progress((done as f64 + part) / share);
        })?);
    }
    Ok(SubmissionBench {
        schema_version: 1,
        sward: env!("CARGO_PKG_VERSION"),
        machine,
        adapter: Adapter::of(gpu),
        views: SECONDS.len(),
        rounds: ROUNDS,
        rows,
    })
}

/// The field of the flight.
struct Rig(StillField);

/// The two ways of one view or of all.
const WAYS: [(&str, Submission); 2] = [("exact", Submission::Exact), ("bins", Submission::Bins)];

impl Rig {
    fn new(gpu: &Gpu) -> Result<Self, DrawBenchError> {
        let terrain = hills(SIDE_M);
        let ground = height_grid(&terrain, &Assets::default())?;
        let wind = WindNow::at(&Wind::default(), 0.0, 1.0, 1.0);
        Ok(Self(StillField::new(gpu, &terrain, ground, wind, PICTURE)?))
    }

    /// Both ways of submitting by one rule.
    fn rule(
        &mut self,
        gpu: &Gpu,
        rule: &'static str,
        count: Count,
        mut progress: impl FnMut(f64),
    ) -> Result<[SubmissionRow; 2], DrawBenchError> {
        let mut sums = WAYS.map(|_| Sum::default());
        for (done, second) in SECONDS.into_iter().enumerate() {
            let mut times_ms = WAYS.map(|_| Vec::new());
            let mut exact = Vec::new();
            for round in 0..=ROUNDS {
                for (way, (_, submission)) in WAYS.into_iter().enumerate() {
                    self.prepare(gpu, second, count, submission)?;
                    let started = Instant::now();
                    self.0.renderer.sort_plants(gpu, &mut self.0.timer)?;
                    gpu.wait()?;
                    if round > 0 {
                        times_ms[way].push(started.elapsed().as_secs_f64() * 1e3);
                        continue;
                    }
                    let seeded = self.0.renderer.seeded_triangles(gpu)?;
                    let drawn = self.0.renderer.drawn_plants(gpu)?;
                    sums[way].plants += drawn.iter().map(|form| form.plants as f64).sum::<f64>();
                    sums[way].places += seeded.clusters as f64;
                    if way == 0 {
                        exact.clone_from(&seeded.counts);
                    }
                    sums[way].compare(&seeded.counts, &exact);
                }
            }
            for (sum, times_ms) in sums.iter_mut().zip(&times_ms) {
                sum.ms += median(times_ms).unwrap_or(0.0);
            }
            progress((done + 1) as f64 / SECONDS.len() as f64);
        }
        Ok([0, 1].map(|way| sums[way].row(rule, WAYS[way].0)))
    }

    fn prepare(
        &mut self,
        gpu: &Gpu,
        second: u32,
        count: Count,
        submission: Submission,
    ) -> Result<(), DrawBenchError> {
        let view = flight_view(&self.0.field.ground, second * FRAMES_PER_S);
        let detail = BladeDetail {
            count,
            submission,
            tuft: TUFT,
            ..BladeDetail::default()
        };
        let (renderer, _, input) = self.0.frame(&view, detail);
        Ok(renderer.prepare(gpu, &input)?)
    }
}

/// Sums over the views.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    ms: f64,
    plants: f64,
    places: f64,
    triangles: f64,
    count: f64,
    exact: f64,
    squares: f64,
    compared: f64,
    most: f64,
}

impl Sum {
    /// Takes in the counts of a view's triangles, beside the exact ones.
    fn compare(&mut self, counts: &[f32], exact: &[f32]) {
        for (&count, &exact) in counts.iter().zip(exact) {
            let (count, exact) = (f64::from(count), f64::from(exact));
            self.triangles += f64::from(u8::from(exact > 0.0));
            self.count += count;
            self.exact += exact;
            if exact >= 1.0 {
                let off = count / exact - 1.0;
                self.squares += off * off;
                self.compared += 1.0;
                self.most = self.most.max(off.abs());
            }
        }
    }

    fn row(&self, rule: &'static str, submission: &'static str) -> SubmissionRow {
        let views = SECONDS.len() as f64;
        SubmissionRow {
            rule,
            submission,
            ms: self.ms / views,
            triangles: self.triangles / views,
            places: self.places / views,
            plants: self.plants / views,
            density_error: self.count / self.exact.max(1.0) - 1.0,
            triangle_error_rms: (self.squares / self.compared.max(1.0)).sqrt(),
            triangle_error_most: self.most,
        }
    }
}
