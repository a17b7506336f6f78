//! A scene on an engine, timed.

use std::time::Instant;

use serde::Serialize;

use crate::base::statistics::median;
use crate::run::engine::Engine;
use crate::run::scenario::{Device, RunError};
use crate::scene::assets::Assets;
use crate::scene::{Body, Collider, Ground, Mass, Motion, Scene, Shape, Solver, Terrain, Waypoint};
use crate::sim::Meadow;
use crate::sim::measure::Snapshot;

/// How wrong the timed results are.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Errors {
    /// Deepest node inside a body's true shape, in metres.
    pub max_penetration_m: f64,
    /// Largest change of a segment's length, as a share of it.
    pub max_strain: f64,
}

impl Errors {
    pub(super) fn add(&mut self, snapshot: &Snapshot) {
        let depths = snapshot.depths_m.iter().copied();
        self.max_penetration_m = depths.fold(self.max_penetration_m, f64::max);
        self.max_strain = self.max_strain.max(snapshot.max_strain);
    }
}

/// A meadow that is simulated in timed rounds.
pub(super) struct Rig {
    pub name: String,
    pub meadow: Meadow,
    engine: Engine,
    /// Milliseconds per sub-step of each round.
    pub rounds_ms: Vec<f64>,
    active_tiles: u64,
    ticks: u64,
    pub errors: Errors,
}

impl Rig {
    pub fn new(
        name: &str,
        scene: Scene,
        assets: &Assets,
        device: &Device,
    ) -> Result<Self, RunError> {
        let mut meadow = Meadow::new(scene, assets).map_err(|error| RunError::new(name, error))?;
        let engine = (device.engine(&mut meadow)).map_err(|error| RunError::new(name, error))?;
        Ok(Self {
            name: name.to_owned(),
            meadow,
            engine,
            rounds_ms: Vec::new(),
            active_tiles: 0,
            ticks: 0,
            errors: Errors::default(),
        })
    }

    /// Simulates sub-steps, waits until they are done, and gives the seconds that took.
    pub fn run(&mut self, ticks: u32, device: &Device) -> Result<f64, RunError> {
        let started = Instant::now();
        for _ in 0..ticks {
            let ticked = self.engine.tick(&mut self.meadow);
            ticked.map_err(|error| RunError::new(&self.name, error))?;
            self.active_tiles += self.meadow.tiles.len() as u64;
        }
        if let Some(gpu) = device.gpu() {
            gpu.wait()
                .map_err(|error| RunError::new(&self.name, error))?;
        }
        self.ticks += u64::from(ticks);
        Ok(started.elapsed().as_secs_f64())
    }

    /// A timed round; measuring its errors is not part of its time.
    pub fn round(&mut self, ticks: u32, device: &Device) -> Result<(), RunError> {
        let took_s = self.run(ticks, device)?;
        self.rounds_ms.push(took_s * 1e3 / f64::from(ticks));
        self.measure()
    }

    /// Takes the errors of this instant in.
    pub fn measure(&mut self) -> Result<(), RunError> {
        let snapshot = self.engine.snapshot(&self.meadow);
        self.errors
            .add(&snapshot.map_err(|error| RunError::new(&self.name, error))?);
        Ok(())
    }

    /// Forgets what was timed so far.
    pub fn start_over(&mut self) {
        self.rounds_ms.clear();
        self.active_tiles = 0;
        self.ticks = 0;
    }

    /// Mean number of active tiles over the timed sub-steps.
    pub fn mean_active_tiles(&self) -> f64 {
        self.active_tiles as f64 / self.ticks.max(1) as f64
    }

    pub fn median_ms(&self) -> f64 {
        median(&self.rounds_ms).unwrap_or(0.0)
    }

    pub fn min_ms(&self) -> f64 {
        self.rounds_ms.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Side of a circle's share of the meadow, in metres: tracks of two balls share no tile.
const CIRCLE_PITCH_M: f64 = 10.0;
/// Balls roll on circles of this radius, in metres.
const CIRCLE_M: f64 = 2.0;
/// Time for a circle, in seconds.
pub(super) const CIRCLE_S: f64 = 4.0;
pub(super) const BALL_RADIUS_M: f32 = 0.25;
/// Way points of a circle.
const CIRCLE_POINTS: u32 = 16;

/// A flat square meadow of tiles of 1 m, in which balls are led in circles: the number of active
/// tiles stays nearly the same all the time.
pub(super) fn circles(side_m: f32, balls: u32) -> Scene {
    let across = f64::from(balls).sqrt().ceil() as u32;
    let place = |n: u32| (f64::from(n) - 0.5 * f64::from(across - 1)) * CIRCLE_PITCH_M;
    Scene {
        terrain: Terrain {
            ground: Ground::Flat {
                size_m: [side_m; 2],
                spacing_m: 1.0,
            },
            ..Terrain::default()
        },
        solver: Solver {
            recovery_s: 1.0,
            tile_m: 1.0,
            seeding_cell_m: 0.5,
            ..Solver::default()
        },
        bodies: (0..balls)
            .map(|n| {
                let ball = Shape::Ball {
                    radius_m: BALL_RADIUS_M,
                };
                circling(n, ball, [place(n % across), place(n / across)], 0.0)
            })
            .collect(),
        ..Scene::default()
    }
}

/// A body that is led round a circle on the ground, which it begins at a share of its turn.
pub(super) fn circling(number: u32, shape: Shape, middle_m: [f64; 2], phase: f64) -> Body {
    let waypoints = (0..=CIRCLE_POINTS).map(|n| {
        let share = f64::from(n) / f64::from(CIRCLE_POINTS);
        let angle = (phase + share) * std::f64::consts::TAU;
        let [x, z] = [angle.cos(), angle.sin()].map(|c| c * CIRCLE_M);
        Waypoint {
            at_s: share * CIRCLE_S,
            position_m: [middle_m[0] + x, f64::from(BALL_RADIUS_M), middle_m[1] + z],
            rotation_deg: [0.0; 3],
        }
    });
    Body {
        name: format!("body {number:03}"),
        shape,
        position_m: [0.0; 3],
        above_ground: false,
        rotation_deg: [0.0; 3],
        motion: Motion::Path {
            waypoints: waypoints.collect(),
            repeat: true,
        },
        mass: Mass::default(),
        friction: 0.6,
        restitution: 0.0,
        damping: [0.0; 2],
        collider: Collider::Auto,
        rgb: [0.5; 3],
        coat: None,
    }
}
