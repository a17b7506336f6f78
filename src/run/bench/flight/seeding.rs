//! Figure 9 of P15: what the first stage of drawing costs the device by the size of clusters.
//!
//! What is timed is the first stage alone, from its submission until the device is done: counting the
//! triangles, deciding what grows and what is in sight, and listing the plants. Sizes take turns, view
//! by view and round by round; each view is done once before it is timed.

use std::time::Instant;

use serde::Serialize;

use crate::base::statistics::median;
use crate::gpu::Gpu;
use crate::render::BladeDetail;
use crate::run::bench::still_field::{DrawBenchError, StillField};

use super::ground::FlownGround;
use super::{FLIGHT_S, FRAMES_PER_S, flight_view};

/// Seeds of a cluster.
pub const CLUSTERS: [u32; 5] = [1, 2, 4, 8, 16];
/// The first stage does not depend on the picture's size; small ones save memory.
const PICTURE: [u32; 2] = [320, 180];

/// The first stage in one second of the flight, by [`CLUSTERS`].
#[derive(Clone, Copy, Debug, Serialize)]
pub struct SeedingRow {
    pub second: u32,
    /// Medians of the rounds.
    pub ms: [f64; CLUSTERS.len()],
    pub clusters: [u64; CLUSTERS.len()],
    pub plants: [u64; CLUSTERS.len()],
}

/// Times the view at the start of every second.
///
/// # Errors
///
/// A device that cannot hold the plants in view.
pub(super) fn bench_seeding(
    gpu: &Gpu,
    ground: &FlownGround,
    detail: BladeDetail,
    rounds: u32,
    mut progress: impl FnMut(f64),
) -> Result<Vec<SeedingRow>, DrawBenchError> {
    let mut fields = Vec::new();
    for cluster in CLUSTERS {
        fields.push(ground.field(gpu, cluster, PICTURE)?);
    }
    let mut rows = Vec::new();
    for second in 0..FLIGHT_S {
        rows.push(row(gpu, &mut fields, detail, second, rounds)?);
        progress(f64::from(second + 1) / f64::from(FLIGHT_S));
    }
    Ok(rows)
}

fn row(
    gpu: &Gpu,
    fields: &mut [StillField],
    detail: BladeDetail,
    second: u32,
    rounds: u32,
) -> Result<SeedingRow, DrawBenchError> {
    let mut row = SeedingRow {
        second,
        ms: [0.0; CLUSTERS.len()],
        clusters: [0; CLUSTERS.len()],
        plants: [0; CLUSTERS.len()],
    };
    let mut times_ms = vec![Vec::new(); CLUSTERS.len()];
    for round in 0..=rounds {
        for (size, still) in fields.iter_mut().enumerate() {
            let view = flight_view(&still.field.ground, second * FRAMES_PER_S);
            let (renderer, timer, input) = still.frame(&view, detail);
            renderer.prepare(gpu, &input)?;
            gpu.wait()?;
            let started = Instant::now();
            renderer.sort_plants(gpu, timer)?;
            gpu.wait()?;
            if round > 0 {
                times_ms[size].push(started.elapsed().as_secs_f64() * 1e3);
                continue;
            }
            row.clusters[size] = renderer.seeded_triangles(gpu)?.clusters;
            let drawn = renderer.drawn_plants(gpu)?;
            row.plants[size] = drawn.iter().map(|form| form.plants).sum();
        }
    }
    for (ms, times) in row.ms.iter_mut().zip(&times_ms) {
        *ms = median(times).unwrap_or(0.0);
    }
    Ok(row)
}

/// How many times as much clusters of one seed cost as those of another size, over the whole flight;
/// `size` is a place in [`CLUSTERS`].
pub(super) fn saved(rows: &[SeedingRow], size: usize) -> f64 {
    let sum = |size: usize| rows.iter().map(|row| row.ms[size]).sum::<f64>();
    sum(0) / sum(size)
}
