//! The bench of tiles: what a meadow costs by the number of its tiles, in total and active.
//!
//! Every row has the error of its results beside the time. Rows of one table are timed in turns,
//! round by round, so that a machine that gets slower does not favour one of them; the first round
//! is left out.

use serde::Serialize;

use super::machine::{Machine, peak_memory_bytes};
use super::rig::{Errors, Rig, circles};
use crate::base::statistics::{fit_line, median};
use crate::run::report::Adapter;
use crate::run::scenario::{Device, RunError};
use crate::scene::LoadedScene;
use crate::scene::assets::Assets;

/// Sub-steps of a round.
const ROUND_TICKS: u32 = 24;
/// Rounds that are timed, after one that is not.
const ROUNDS: u32 = 11;
/// Sides of the square meadows whose sizes are compared, in tiles.
const SIDES: [u32; 4] = [32, 64, 128, 256];
/// Side of the meadow in which the number of balls grows, in tiles.
const ROOMY_SIDE: u32 = 128;
const BALLS: [u32; 6] = [1, 2, 4, 8, 16, 32];
/// Bytes of a process's memory, slowest speed and largest ratio that `--check` lets pass.
const MOST_MEMORY_BYTES: u64 = 300_000_000;
const LEAST_REAL_TIME: f64 = 1.0;
const MOST_RATIO: f64 = 1.2;

/// Results of the whole bench.
#[derive(Clone, Debug, Serialize)]
pub struct TilesBench {
    pub schema_version: u32,
    /// Version of sward.
    pub sward: &'static str,
    pub machine: Machine,
    pub engine: &'static str,
    /// What the engine ran on; null for the CPU.
    pub adapter: Option<Adapter>,
    pub million_blades: MillionBlades,
    /// The same work in meadows of different sizes, the smallest first.
    pub total_tiles: Vec<Row>,
    /// More and more work in one meadow.
    pub active_tiles: Vec<Row>,
    /// Cost of a sub-step over the number of active tiles.
    pub line: Option<CostLine>,
    pub limits: Vec<Limit>,
}

/// One ball rolls through a large meadow.
#[derive(Clone, Debug, Serialize)]
pub struct MillionBlades {
    pub blades: u64,
    pub total_tiles: u64,
    /// Largest number of tiles active at once.
    pub active_tiles_peak: u64,
    pub seconds_simulated: f64,
    /// Sub-steps that were timed; the first one is not.
    pub ticks: u64,
    pub seconds_per_second: f64,
    pub tick_ms_median: f64,
    pub tick_ms_min: f64,
    /// Largest memory of the process, renderer and assets of the program included; null where the
    /// system does not say.
    pub peak_memory_bytes: Option<u64>,
    pub state_bytes_peak: u64,
    pub errors: Errors,
}

/// One meadow of a table.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub total_tiles: u64,
    pub balls: u32,
    pub active_tiles_mean: f64,
    pub tick_ms_median: f64,
    pub tick_ms_min: f64,
    pub rounds: usize,
    /// Median relative to that of the table's first row.
    pub ratio: f64,
    pub errors: Errors,
}

/// A straight line through cost and active tiles.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CostLine {
    /// Milliseconds of a sub-step without active tiles.
    pub fixed_ms: f64,
    /// Milliseconds per active tile and sub-step.
    pub ms_per_tile: f64,
    pub r_squared: f64,
}

/// A promise, and what was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Limit {
    pub what: &'static str,
    pub measured: f64,
    pub limit: f64,
    pub unit: &'static str,
    pub kept: bool,
}

impl TilesBench {
    pub fn all_kept(&self) -> bool {
        self.limits.iter().all(|limit| limit.kept)
    }
}

/// Runs the bench. `million` is the scene of the first part; `progress` gets the share done.
///
/// # Errors
///
/// A meadow larger than the device can hold.
pub fn bench_tiles(
    million: &LoadedScene,
    device: &Device,
    mut progress: impl FnMut(f64),
) -> Result<TilesBench, RunError> {
    let machine = Machine::now();
    // First, since a process's peak of memory never falls.
    let million_blades = million_blades(million, device, |done| progress(0.3 * done))?;
    let sizes = SIDES.map(|side| (side, 1));
    let total_tiles = table(&sizes, device, |done| progress(0.3 + 0.2 * done))?;
    let balls = BALLS.map(|balls| (ROOMY_SIDE, balls));
    let active_tiles = table(&balls, device, |done| progress(0.5 + 0.5 * done))?;
    let points: Vec<(f64, f64)> = active_tiles
        .iter()
        .map(|row| (row.active_tiles_mean, row.tick_ms_median))
        .collect();
    Ok(TilesBench {
        schema_version: 1,
        sward: env!("CARGO_PKG_VERSION"),
        machine,
        engine: device.engine_name(),
        adapter: device.gpu().map(Adapter::of),
        limits: limits(&million_blades, &total_tiles),
        million_blades,
        total_tiles,
        active_tiles,
        line: fit_line(&points).map(|line| CostLine {
            fixed_ms: line.fixed,
            ms_per_tile: line.slope,
            r_squared: line.r_squared,
        }),
    })
}

fn million_blades(
    loaded: &LoadedScene,
    device: &Device,
    mut progress: impl FnMut(f64),
) -> Result<MillionBlades, RunError> {
    let mut rig = Rig::new(&loaded.name, loaded.scene.clone(), &loaded.assets, device)?;
    let substep_s = rig.meadow.scene.solver.substep_s;
    let ticks = (loaded.scene.duration_s / substep_s).round() as u64;
    let mut ticks_ms = Vec::new();
    for tick in 0..ticks {
        let took_s = rig.run(1, device)?;
        if tick > 0 {
            ticks_ms.push(took_s * 1e3);
        }
        rig.measure()?;
        progress((tick + 1) as f64 / ticks as f64);
    }
    let grid = &rig.meadow.field.grid;
    let seconds_simulated = ticks_ms.len() as f64 * substep_s;
    Ok(MillionBlades {
        blades: u64::from(grid.tile_count()) * u64::from(grid.plants_per_tile()),
        total_tiles: u64::from(grid.tile_count()),
        active_tiles_peak: rig.meadow.tiles.peak as u64,
        seconds_simulated,
        ticks: ticks_ms.len() as u64,
        seconds_per_second: seconds_simulated * 1e3 / ticks_ms.iter().sum::<f64>(),
        tick_ms_median: median(&ticks_ms).unwrap_or(0.0),
        tick_ms_min: ticks_ms.iter().copied().fold(f64::INFINITY, f64::min),
        peak_memory_bytes: peak_memory_bytes(),
        state_bytes_peak: rig.meadow.counters.state_bytes_peak,
        errors: rig.errors,
    })
}

/// Times meadows of these sides (in tiles) and numbers of balls in turns.
fn table(
    meadows: &[(u32, u32)],
    device: &Device,
    mut progress: impl FnMut(f64),
) -> Result<Vec<Row>, RunError> {
    let mut rigs = Vec::new();
    for &(side, balls) in meadows {
        let name = format!("{balls} balls on {} tiles", side * side);
        let scene = circles(side as f32, balls);
        let mut rig = Rig::new(&name, scene, &Assets::default(), device)?;
        // From then on as many tiles come to rest as wake.
        let settled = rig.meadow.recovery_ticks() + ROUND_TICKS;
        rig.run(settled, device)?;
        rig.start_over();
        rigs.push(rig);
    }
    for round in 0..=ROUNDS {
        for rig in &mut rigs {
            rig.round(ROUND_TICKS, device)?;
            if round == 0 {
                rig.start_over();
            }
        }
        progress(f64::from(round + 1) / f64::from(ROUNDS + 1));
    }
    let first_ms = rigs.first().map_or(1.0, Rig::median_ms);
    Ok(rigs
        .iter()
        .zip(meadows)
        .map(|(rig, &(_, balls))| Row {
            total_tiles: u64::from(rig.meadow.field.grid.tile_count()),
            balls,
            active_tiles_mean: rig.mean_active_tiles(),
            tick_ms_median: rig.median_ms(),
            tick_ms_min: rig.min_ms(),
            rounds: rig.rounds_ms.len(),
            ratio: rig.median_ms() / first_ms,
            errors: rig.errors,
        })
        .collect())
}

fn limits(million: &MillionBlades, total_tiles: &[Row]) -> Vec<Limit> {
    let speed = million.seconds_per_second;
    let mut limits = vec![Limit {
        what: "a million blades run faster than real time",
        measured: speed,
        limit: LEAST_REAL_TIME,
        unit: "simulated seconds per second",
        kept: speed > LEAST_REAL_TIME,
    }];
    if let Some(bytes) = million.peak_memory_bytes {
        limits.push(Limit {
            what: "a million blades take less memory than",
            measured: bytes as f64,
            limit: MOST_MEMORY_BYTES as f64,
            unit: "bytes",
            kept: bytes < MOST_MEMORY_BYTES,
        });
    }
    let ratio = total_tiles.iter().map(|row| row.ratio).fold(1.0, f64::max);
    limits.push(Limit {
        what: "cost does not grow with the meadow by more than",
        measured: ratio,
        limit: MOST_RATIO,
        unit: "times the smallest meadow's",
        kept: ratio <= MOST_RATIO,
    });
    limits
}
