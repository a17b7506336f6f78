//! The bench of bodies: what a sub-step costs by the number of bodies on the same active tiles.
//!
//! Bodies of four shapes are led round one circle, behind each other. Grass takes as long to rise as a body
//! takes to come round, so that one body keeps the same tiles awake as hundreds do. Meadows are timed in
//! turns, round by round; the first round is left out.

use std::collections::BTreeSet;

use serde::Serialize;

use super::machine::Machine;
use super::rig::{BALL_RADIUS_M, CIRCLE_S, Errors, Rig, circling};
use super::tiles::Limit;
use crate::run::report::Adapter;
use crate::run::scenario::{Device, RunError};
use crate::scene::assets::Assets;
use crate::scene::{Billboards, Ground, Scene, Shape, Solver, Terrain};

/// Numbers of bodies.
const BODIES: [u32; 10] = [1, 2, 4, 8, 16, 32, 64, 128, 256, 512];
/// Sub-steps of a round, and rounds that are timed.
const ROUND_TICKS: u32 = 12;
const ROUNDS: u32 = 5;
/// Side of the meadow, in metres: tiles beyond the circle stay asleep.
const SIDE_M: f32 = 24.0;
/// Billboards per m², in the meadow that has them in place of blades.
const BILLBOARDS_PER_M2: f32 = 36.0;
/// How many bodies `--check` judges, and how many times the cost of one it lets them take.
const JUDGED: u32 = 128;
const MOST_RATIO: f64 = 20.0;

/// Results of the whole bench.
#[derive(Clone, Debug, Serialize)]
pub struct BodiesBench {
    pub schema_version: u32,
    /// Version of sward.
    pub sward: &'static str,
    pub machine: Machine,
    pub engine: &'static str,
    /// What the engine ran on; null for the CPU.
    pub adapter: Option<Adapter>,
    pub blades: Vec<BodiesRow>,
    pub billboards: Vec<BodiesRow>,
    pub limits: Vec<Limit>,
}

/// A meadow with so many bodies.
#[derive(Clone, Debug, Serialize)]
pub struct BodiesRow {
    pub bodies: u32,
    pub active_tiles_mean: f64,
    /// Bodies that were near a tile's plants in the last sub-step; each of them is tested.
    pub met: usize,
    pub tick_ms_median: f64,
    pub tick_ms_min: f64,
    pub rounds: usize,
    /// Median relative to that of one body.
    pub ratio: f64,
    pub errors: Errors,
}

impl BodiesBench {
    pub fn all_kept(&self) -> bool {
        self.limits.iter().all(|limit| limit.kept)
    }
}

/// Runs the bench; `progress` gets the share done.
///
/// # Errors
/// A meadow larger than the device can hold.
pub fn bench_bodies(
    device: &Device,
    mut progress: impl FnMut(f64),
) -> Result<BodiesBench, RunError> {
    let machine = Machine::now();
    let blades = table(device, false, |done| progress(0.5 * done))?;
    let billboards = table(device, true, |done| progress(0.5 + 0.5 * done))?;
    let limits = [
        ("blades: 128 bodies cost at most", &blades),
        ("billboards: 128 bodies cost at most", &billboards),
    ];
    Ok(BodiesBench {
        schema_version: 1,
        sward: env!("CARGO_PKG_VERSION"),
        machine,
        engine: device.engine_name(),
        adapter: device.gpu().map(Adapter::of),
        limits: limits.map(|(what, rows)| limit(what, rows)).into(),
        blades,
        billboards,
    })
}

fn limit(what: &'static str, rows: &[BodiesRow]) -> Limit {
    let judged = rows.iter().find(|row| row.bodies == JUDGED);
    let measured = judged.map_or(f64::INFINITY, |row| row.ratio);
    Limit {
        what,
        measured,
        limit: MOST_RATIO,
        unit: "times one body's",
        kept: measured <= MOST_RATIO,
    }
}

fn table(
    device: &Device,
    has_billboards: bool,
    mut progress: impl FnMut(f64),
) -> Result<Vec<BodiesRow>, RunError> {
    let mut rigs = Vec::new();
    for (done, bodies) in BODIES.into_iter().enumerate() {
        let name = format!("{bodies} bodies");
        let mut rig = Rig::new(
            &name,
            ring(bodies, has_billboards),
            &Assets::default(),
            device,
        )?;
        // By then every tile of the circle is awake: each body has come to where the next one began.
        let once_round = (CIRCLE_S / rig.meadow.scene.solver.substep_s).round() as u32;
        rig.run(once_round.div_ceil(bodies), device)?;
        rigs.push(rig);
        progress(0.6 * (done + 1) as f64 / BODIES.len() as f64);
    }
    for round in 0..=ROUNDS {
        for rig in &mut rigs {
            rig.round(ROUND_TICKS, device)?;
            if round == 0 {
                rig.start_over();
            }
        }
        progress(0.6 + 0.4 * f64::from(round + 1) / f64::from(ROUNDS + 1));
    }
    let one_ms = rigs.first().map_or(1.0, Rig::median_ms);
    let row = |(rig, bodies): (&Rig, u32)| BodiesRow {
        bodies,
        active_tiles_mean: rig.mean_active_tiles(),
        met: met(rig),
        tick_ms_median: rig.median_ms(),
        tick_ms_min: rig.min_ms(),
        rounds: rig.rounds_ms.len(),
        ratio: rig.median_ms() / one_ms,
        errors: rig.errors,
    };
    Ok(rigs.iter().zip(BODIES).map(row).collect())
}

/// Bodies that are on the list of some tile.
fn met(rig: &Rig) -> usize {
    let work = &rig.meadow.work;
    let of_tiles = work.tiles.iter().flat_map(|tile| work.contacts_of(tile));
    let bodies: BTreeSet<_> = of_tiles.map(|contact| contact.body).collect();
    bodies.len()
}

/// Bodies behind each other on a circle.
fn ring(bodies: u32, has_billboards: bool) -> Scene {
    let plain = Scene::default();
    let mut scene = Scene {
        terrain: Terrain {
            ground: Ground::Flat {
                size_m: [SIDE_M; 2],
                spacing_m: 1.0,
            },
            ..Terrain::default()
        },
        solver: Solver {
            recovery_s: CIRCLE_S,
            tile_m: 1.0,
            seeding_cell_m: 0.5,
            ..Solver::default()
        },
        bodies: (0..bodies)
            .map(|n| circling(n, shape(n), [0.0; 2], f64::from(n) / f64::from(bodies)))
            .collect(),
        ..plain
    };
    if has_billboards {
        scene.grass.species.clear();
        scene.billboards = Some(Billboards {
            density_per_m2: BILLBOARDS_PER_M2,
            ..Billboards::default()
        });
    }
    scene
}

/// A shape within a ball of [`BALL_RADIUS_M`].
fn shape(number: u32) -> Shape {
    let radius_m = BALL_RADIUS_M;
    match number % 4 {
        0 => Shape::Ball { radius_m },
        1 => Shape::Box {
            size_m: [radius_m; 3],
        },
        2 => Shape::Capsule {
            radius_m: 0.4 * radius_m,
            length_m: radius_m,
        },
        _ => Shape::Cylinder {
            radius_m: 0.6 * radius_m,
            height_m: radius_m,
        },
    }
}
