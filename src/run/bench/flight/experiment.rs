//! The experiment of P15 section 4: a flight over 20 km², with its frame time, its load and the time
//! of seeding by the size of clusters (figures 7 to 9).
//!
//! Frames are drawn one after the other, each until the device is done with it; those of a second
//! count with their mean. Each is drawn with plants and without.

use std::time::Instant;

use serde::Serialize;

use crate::gpu::Gpu;
use crate::render::{BladeDetail, Count, FrameInput, PictureTarget};
use crate::run::bench::machine::{Machine, peak_memory_bytes};
use crate::run::bench::still_field::{DrawBenchError, StillField};
use crate::run::bench::terrain::{MOST_GROWTH, MOST_TRAVERSAL_MS, SIDES_M, TerrainBenchError};
use crate::run::bench::tiles::Limit;
use crate::run::report::Adapter;

use super::ground::{FlownGround, FlownMap};
use super::seeding::{CLUSTERS, SeedingRow, bench_seeding, saved};
use super::traversal::{Traversal, traversal_ms, traversal_over};
use super::{FLIGHT_S, FRAMES_PER_S, flight_view};

/// Side of the terrain, in metres: 20 km² less what keeps its hills' samples where other sizes have
/// them.
const SIDE_M: f32 = SIDES_M[2];
/// Seeds of a cluster in the flight, as in P15, and its place in [`CLUSTERS`].
const CLUSTER: u32 = CLUSTERS[EIGHT];
const EIGHT: usize = 3;
/// Picture of P15, in pixels.
const WHOLE_PICTURE: [u32; 2] = [1920, 1080];
/// Most memory of the process, the picture's textures left out, that `--check` lets pass.
const MOST_MEMORY_BYTES: u64 = 400_000_000;

/// What is flown.
#[derive(Clone, Debug, Default)]
pub struct FlightRequest {
    /// Few frames of a small picture, and two terrains.
    pub is_quick: bool,
    /// The ground; `None` for hills of 20 km² sampled at 5 m.
    pub map: Option<FlownMap>,
    /// What decides how many plants are drawn; `None` for their distance.
    pub count: Option<Count>,
}

/// Why the flight cannot be flown.
#[derive(Debug, thiserror::Error)]
pub enum FlightError {
    #[error(transparent)]
    Draw(#[from] DrawBenchError),
    #[error(transparent)]
    Terrain(#[from] TerrainBenchError),
}

/// Results of the whole bench.
#[derive(Clone, Debug, Serialize)]
pub struct FlightBench {
    pub schema_version: u32,
    /// Version of sward.
    pub sward: &'static str,
    pub machine: Machine,
    pub adapter: Adapter,
    /// The height map's name, or the hills.
    pub ground: String,
    pub km2: f64,
    pub picture: [u32; 2],
    /// Frames of every second that were drawn, of [`FRAMES_PER_S`].
    pub frames_per_s: u32,
    pub reach_m: f32,
    pub seconds: Vec<FlightSecond>,
    pub seeding: Vec<SeedingRow>,
    /// How many times as much seeds that lie alone cost as clusters of every size.
    pub saved: Vec<f64>,
    pub traversals: Vec<Traversal>,
    /// Largest memory of the process when the flight was over, and the picture's textures, which a
    /// software adapter keeps in it.
    pub peak_memory_bytes: Option<u64>,
    pub picture_bytes: u64,
    pub limits: Vec<Limit>,
}

/// Means over a second of the flight.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct FlightSecond {
    pub second: u32,
    pub frame_ms: f64,
    pub frame_ms_without_plants: f64,
    /// Of the processor, down to tiles.
    pub traversal_ms: f64,
    /// Clusters that the first stage looked at, those of them on bare soil, and those drawn.
    pub clusters: f64,
    pub bare: f64,
    pub drawn: f64,
    pub plants: f64,
    /// Of the plants.
    pub triangles: f64,
}

impl FlightBench {
    /// Whether the picture or the frames are fewer than on graphics hardware.
    pub fn is_reduced(&self) -> bool {
        self.picture != WHOLE_PICTURE || self.frames_per_s != FRAMES_PER_S
    }

    pub fn all_kept(&self) -> bool {
        self.limits.iter().all(|limit| limit.kept)
    }
}

/// Size of the picture, frames drawn of every second and timed rounds of seeding: as in P15 on graphics
/// hardware. A rasteriser on the processor would take an hour for that; it draws a quarter of the width
/// and a fifth of the frames, so that the whole bench is done in minutes.
fn effort(gpu: &Gpu, is_quick: bool) -> ([u32; 2], u32, u32) {
    match (is_quick, gpu.adapter.is_software) {
        (true, _) => ([320, 180], 1, 1),
        (false, true) => ([480, 270], 2, 3),
        (false, false) => (WHOLE_PICTURE, FRAMES_PER_S, 5),
    }
}

/// Runs the bench; `progress` gets the share done.
///
/// # Errors
///
/// A ground that cannot be laid out, a device that cannot hold the plants in view.
pub fn bench_flight(
    gpu: &Gpu,
    request: &FlightRequest,
    mut progress: impl FnMut(f64),
) -> Result<FlightBench, FlightError> {
    let machine = Machine::now();
    let (picture, frames_per_s, rounds) = effort(gpu, request.is_quick);
    let detail = BladeDetail {
        count: request.count.unwrap_or(Count::Distance),
        ..BladeDetail::of_device(gpu)
    };
    let ground = FlownGround::new(SIDE_M, request.map.as_ref()).map_err(DrawBenchError::from)?;
    let still = ground.field(gpu, CLUSTER, picture)?;
    let mut flight = Flight {
        target: PictureTarget::new(gpu, picture).map_err(DrawBenchError::from)?,
        still,
        detail,
        picture,
    };
    let mut seconds = Vec::new();
    for second in 0..FLIGHT_S {
        seconds.push(flight.second(gpu, second, frames_per_s)?);
        progress(0.6 * f64::from(second + 1) / f64::from(FLIGHT_S));
    }
    // Before other fields are laid out.
    let peak_memory_bytes = peak_memory_bytes();
    let picture_bytes = flight.still.renderer.picture_bytes();
    drop(flight);
    let seeding = bench_seeding(gpu, &ground, detail, rounds, |part| {
        progress(0.6 + 0.35 * part);
    })?;
    let sides = if request.is_quick {
        &SIDES_M[..2]
    } else {
        &SIDES_M[..]
    };
    let aspect = picture[0] as f32 / picture[1] as f32;
    let traversals = (sides.iter())
        .map(|&side_m| traversal_over(side_m, aspect))
        .collect::<Result<Vec<_>, _>>()?;
    let [width_m, depth_m] = ground.grid.size_m();
    let mut bench = FlightBench {
        schema_version: 1,
        sward: env!("CARGO_PKG_VERSION"),
        machine,
        adapter: Adapter::of(gpu),
        ground: (request.map.as_ref()).map_or_else(|| "hills".into(), |map| map.name.clone()),
        km2: width_m * depth_m * 1e-6,
        picture,
        frames_per_s,
        reach_m: detail.reach_m,
        saved: (0..CLUSTERS.len())
            .map(|size| saved(&seeding, size))
            .collect(),
        seconds,
        seeding,
        traversals,
        peak_memory_bytes,
        picture_bytes,
        limits: Vec::new(),
    };
    bench.limits = limits(&bench);
    Ok(bench)
}

/// The field of the flight and what it is drawn into.
struct Flight {
    still: StillField,
    target: PictureTarget,
    detail: BladeDetail,
    picture: [u32; 2],
}

impl Flight {
    fn second(
        &mut self,
        gpu: &Gpu,
        second: u32,
        frames_per_s: u32,
    ) -> Result<FlightSecond, DrawBenchError> {
        let mut sum = FlightSecond::default();
        for n in 0..frames_per_s {
            let frame = second * FRAMES_PER_S + n * (FRAMES_PER_S / frames_per_s);
            self.add_frame(gpu, frame, &mut sum)?;
        }
        let share = 1.0 / f64::from(frames_per_s);
        Ok(FlightSecond {
            second,
            frame_ms: sum.frame_ms * share,
            frame_ms_without_plants: sum.frame_ms_without_plants * share,
            traversal_ms: sum.traversal_ms * share,
            clusters: sum.clusters * share,
            bare: sum.bare * share,
            drawn: sum.drawn * share,
            plants: sum.plants * share,
            triangles: sum.triangles * share,
        })
    }

    fn add_frame(
        &mut self,
        gpu: &Gpu,
        frame: u32,
        sum: &mut FlightSecond,
    ) -> Result<(), DrawBenchError> {
        let field = &self.still.field;
        let aspect = self.picture[0] as f32 / self.picture[1] as f32;
        sum.traversal_ms += traversal_ms(field, frame, aspect, self.detail.reach_m).0;
        let view = flight_view(&field.ground, frame);
        let (renderer, timer, input) = self.still.frame(&view, self.detail);
        let mut timed_ms = |input: &FrameInput<'_>| -> Result<f64, DrawBenchError> {
            let started = Instant::now();
            renderer.draw(gpu, input, &self.target.view, timer)?;
            gpu.wait()?;
            Ok(started.elapsed().as_secs_f64() * 1e3)
        };
        let without = FrameInput {
            blades: None,
            ..input
        };
        sum.frame_ms_without_plants += timed_ms(&without)?;
        sum.frame_ms += timed_ms(&input)?;
        let clusters = renderer.seeded_clusters(gpu)?;
        sum.clusters += clusters.submitted as f64;
        sum.bare += clusters.bare as f64;
        sum.drawn += clusters.drawn as f64;
        for form in renderer.drawn_plants(gpu)? {
            sum.plants += form.plants as f64;
            sum.triangles += form.triangles as f64;
        }
        Ok(())
    }
}

fn limits(bench: &FlightBench) -> Vec<Limit> {
    let cost = |one: &Traversal| one.ms.worst_second;
    let worst_ms = bench.traversals.iter().map(cost).fold(0.0, f64::max);
    let growth = worst_ms / bench.traversals.first().map_or(1.0, cost);
    let mut limits = vec![
        Limit {
            what: "the traversal takes in the flight's worst second at most",
            measured: worst_ms,
            limit: MOST_TRAVERSAL_MS,
            unit: "ms a frame",
            kept: worst_ms <= MOST_TRAVERSAL_MS,
        },
        Limit {
            what: "the traversal does not grow with the terrain by more than",
            measured: growth,
            limit: MOST_GROWTH,
            unit: "times the smallest terrain's",
            kept: growth <= MOST_GROWTH,
        },
        Limit {
            what: "seeds in clusters of 8 cost the device less than alone, by a factor above",
            measured: bench.saved[EIGHT],
            limit: 1.0,
            unit: "",
            kept: bench.saved[EIGHT] > 1.0,
        },
    ];
    if let Some(bytes) = bench.peak_memory_bytes {
        let beside = bytes.saturating_sub(bench.picture_bytes);
        limits.push(Limit {
            what: "the process takes beside the picture's textures at most",
            measured: beside as f64 * 1e-6,
            limit: MOST_MEMORY_BYTES as f64 * 1e-6,
            unit: "MB",
            kept: beside <= MOST_MEMORY_BYTES,
        });
    }
    limits
}
