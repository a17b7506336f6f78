//! The bench of the ground: what a flight costs the processor by the size of the terrain.
//!
//! Square terrains of the same hills are flown over on the same path, so that what can be seen of
//! plants is the same on all. Times are of one thread. Everything is done several times a frame from
//! the same start, of which the shortest counts.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::flight::{FLIGHT_S, FRAMES_PER_S, flight_view};
use super::machine::Machine;
use super::tiles::Limit;
use crate::base::statistics::median;
use crate::field::{Bounds, Field, FieldError};
use crate::render::{BladeDetail, TerrainDetail, View};
use crate::scene::assets::Assets;
use crate::scene::{Grass, Ground, Solver, Terrain};
use crate::terrain::bintree::{Bintree, Mesh, MeshChange, MeshDetail, MeshError, SeedCounts};
use crate::terrain::{TerrainError, height_grid};

/// Sides of the terrains, in metres: 1, 4, 20 and 80 km², the latter two less what keeps the
/// samples of all in the same places.
pub(super) const SIDES_M: [f32; 4] = [1000.0, 2000.0, 4470.0, 8940.0];
const SPACING_M: f32 = 5.0;
/// Picture in which errors are counted.
const PICTURE: [u32; 2] = [1920, 1080];
/// Times that a traversal is repeated.
const REPEATS: u32 = 3;
/// Longest mean traversal in the flight's worst second, and most that it may grow with the
/// terrain, that `--check` lets pass.
pub(super) const MOST_TRAVERSAL_MS: f64 = 2.0;
pub(super) const MOST_GROWTH: f64 = 1.25;

/// Results of the whole bench.
#[derive(Clone, Debug, Serialize)]
pub struct TerrainBench {
    pub schema_version: u32,
    /// Version of sward.
    pub sward: &'static str,
    pub machine: Machine,
    pub error_px: f32,
    pub budget: usize,
    pub reach_m: f32,
    /// The smallest terrain first.
    pub terrains: Vec<TerrainRow>,
    pub limits: Vec<Limit>,
}

/// Why a terrain cannot be flown over.
#[derive(Debug, thiserror::Error)]
pub enum TerrainBenchError {
    #[error(transparent)]
    Terrain(#[from] TerrainError),
    #[error(transparent)]
    Field(#[from] FieldError),
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// One terrain's flight.
#[derive(Clone, Debug, Serialize)]
pub struct TerrainRow {
    pub km2: f64,
    pub samples: u64,
    /// Time to build the bounds of error, in seconds, and their bytes with the mesh's.
    pub build_s: f64,
    pub bytes: u64,
    /// Splitting and merging.
    pub mesh_ms: Cost,
    /// Listing the mesh's triangles in view.
    pub list_ms: Cost,
    /// The traversal down to tiles, which is what drawing needs.
    pub tiles_ms: Cost,
    /// The traversal down to seeding triangles.
    pub seeds_ms: Cost,
    /// Culling of tiles through the octree, for comparison.
    pub octree_ms: Cost,
    /// Largest numbers of any frame.
    pub triangles: u64,
    pub triangles_in_view: u64,
    pub tiles: u64,
    pub octree_tiles: u64,
    pub seeds: u64,
    /// Triangles that were dropped, with all below them, because their slope hides them.
    pub hidden_subtrees: u64,
    /// Largest error left, in pixels, and frames in which the budget bound.
    pub worst_px: f64,
    pub bound_frames: u64,
}

/// Milliseconds a frame.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Cost {
    pub median: f64,
    /// Mean of the flight's worst second.
    pub worst_second: f64,
}

impl Cost {
    pub(super) fn of(frames_ms: &[f64]) -> Self {
        let seconds = frames_ms.chunks(FRAMES_PER_S as usize);
        let means = seconds.map(|second| second.iter().sum::<f64>() / second.len() as f64);
        Self {
            median: median(frames_ms).unwrap_or(0.0),
            worst_second: means.fold(0.0, f64::max),
        }
    }
}

impl TerrainBench {
    pub fn all_kept(&self) -> bool {
        self.limits.iter().all(|limit| limit.kept)
    }
}

/// Runs the bench; `progress` gets the share done.
///
/// # Errors
///
/// A terrain that cannot be laid out.
pub fn bench_terrain(mut progress: impl FnMut(f64)) -> Result<TerrainBench, TerrainBenchError> {
    let machine = Machine::now();
    let mut terrains = Vec::new();
    for (done, side_m) in SIDES_M.into_iter().enumerate() {
        let count = SIDES_M.len() as f64;
        terrains.push(fly_over(side_m, |share| {
            progress((done as f64 + share) / count);
        })?);
    }
    let detail = TerrainDetail::default();
    Ok(TerrainBench {
        schema_version: 1,
        sward: env!("CARGO_PKG_VERSION"),
        machine,
        error_px: detail.error_px,
        budget: detail.budget,
        reach_m: BladeDetail::default().reach_m,
        limits: limits(&terrains),
        terrains,
    })
}

pub(super) fn hills(side_m: f32) -> Terrain {
    Terrain {
        ground: Ground::Rolling {
            size_m: [side_m; 2],
            spacing_m: SPACING_M,
            amplitude_m: 60.0,
            wavelength_m: 700.0,
            octaves: 8,
            seed: 11,
        },
        ..Terrain::default()
    }
}

fn fly_over(side_m: f32, mut progress: impl FnMut(f64)) -> Result<TerrainRow, TerrainBenchError> {
    let ground = height_grid(&hills(side_m), &Assets::default())?;
    let samples = ground.heights_m.len() as u64;
    let field = Field::new(ground, &Grass::default(), &Solver::default())?;
    let started = Instant::now();
    black_box(Bintree::new(Arc::clone(&field.ground)));
    let build_s = started.elapsed().as_secs_f64();

    let frames = FLIGHT_S * FRAMES_PER_S;
    let mut flight = Flight::new(&field);
    for frame in 0..frames {
        flight.frame(frame)?;
        progress(f64::from(frame + 1) / f64::from(frames));
    }
    let [mesh, list, tiles, seeds, octree] = flight.times_ms.each_ref().map(|ms| Cost::of(ms));
    Ok(TerrainRow {
        km2: f64::from(side_m) * f64::from(side_m) * 1e-6,
        samples,
        build_s,
        bytes: (field.bintree.bytes() + flight.mesh.bytes()) as u64,
        mesh_ms: mesh,
        list_ms: list,
        tiles_ms: tiles,
        seeds_ms: seeds,
        octree_ms: octree,
        ..flight.most
    })
}

/// A flight as far as it has come.
struct Flight<'a> {
    field: &'a Field,
    mesh: Mesh,
    /// Mesh, list, tiles, seeds, octree: frame by frame.
    times_ms: [Vec<f64>; 5],
    most: TerrainRow,
}

impl<'a> Flight<'a> {
    fn new(field: &'a Field) -> Self {
        Self {
            field,
            mesh: Mesh::new(&field.bintree),
            times_ms: Default::default(),
            most: TerrainRow {
                km2: 0.0,
                samples: 0,
                build_s: 0.0,
                bytes: 0,
                mesh_ms: Cost::default(),
                list_ms: Cost::default(),
                tiles_ms: Cost::default(),
                seeds_ms: Cost::default(),
                octree_ms: Cost::default(),
                triangles: 0,
                triangles_in_view: 0,
                tiles: 0,
                octree_tiles: 0,
                seeds: 0,
                hidden_subtrees: 0,
                worst_px: 0.0,
                bound_frames: 0,
            },
        }
    }

    fn frame(&mut self, frame: u32) -> Result<(), MeshError> {
        let (field, tree) = (self.field, &self.field.bintree);
        let view = flight_view(&field.ground, frame);
        let aspect = PICTURE[0] as f32 / PICTURE[1] as f32;
        let viewpoint = view.viewpoint(aspect, PICTURE[1]);
        let (wanted, reach_m) = (TerrainDetail::default(), BladeDetail::default().reach_m);
        let detail = MeshDetail {
            error_px: wanted.error_px,
            budget: wanted.budget,
            held_m: reach_m + 2.0 * field.grid.tile_m() + field.reach_m,
            canopy_m: field.reach_m,
        };
        let before = std::mem::replace(&mut self.mesh, Mesh::new(tree));
        let (mut change, mut mesh_ms) = (MeshChange::default(), f64::INFINITY);
        for _ in 0..REPEATS {
            self.mesh.clone_from(&before);
            let started = Instant::now();
            change = self.mesh.update(tree, &viewpoint, &detail)?;
            mesh_ms = mesh_ms.min(started.elapsed().as_secs_f64() * 1e3);
        }

        let mut in_view = 0;
        let list_ms = shortest_ms(|| {
            in_view = self
                .mesh
                .in_view(tree, &viewpoint, detail.canopy_m)
                .corners
                .len()
                / 3;
        });
        let mut tiles = 0;
        let tiles_ms = shortest_ms(|| tiles = field.tiles_in_view(&viewpoint, reach_m).len());
        let mut seeds = SeedCounts::default();
        let seeds_ms = shortest_ms(|| {
            seeds = field.triangles_in_view(&viewpoint, reach_m, |id| {
                black_box(id);
            });
        });
        let mut octree_tiles = 0;
        let octree_ms =
            shortest_ms(|| octree_tiles = cull_by_octree(field, &view, aspect, reach_m));
        let times = [mesh_ms, list_ms, tiles_ms, seeds_ms, octree_ms];
        for (all, ms) in self.times_ms.iter_mut().zip(times) {
            all.push(ms);
        }
        let most = &mut self.most;
        most.triangles = most.triangles.max(change.triangles as u64);
        most.triangles_in_view = most.triangles_in_view.max(in_view as u64);
        most.tiles = most.tiles.max(tiles as u64);
        most.octree_tiles = most.octree_tiles.max(octree_tiles);
        most.seeds = most.seeds.max(seeds.found);
        most.hidden_subtrees = most.hidden_subtrees.max(seeds.hidden);
        most.worst_px = most.worst_px.max(f64::from(change.worst_px));
        most.bound_frames += u64::from(change.is_bound);
        Ok(())
    }
}

pub(super) fn shortest_ms(mut work: impl FnMut()) -> f64 {
    let mut shortest = f64::INFINITY;
    for _ in 0..REPEATS {
        let started = Instant::now();
        work();
        shortest = shortest.min(started.elapsed().as_secs_f64() * 1e3);
    }
    shortest
}

/// Tiles in view as the octree finds them: those of a cube around the eye, each then tried alone.
fn cull_by_octree(field: &Field, view: &View, aspect: f32, reach_m: f32) -> u64 {
    let (grid, ground) = (&field.grid, &field.ground);
    let frustum = view.frustum(aspect);
    let eye = view.eye_in_world.to_f64();
    let (reach, tall) = (f64::from(reach_m), f64::from(field.reach_m));
    let around = Bounds {
        low: eye.map(|x| x - reach),
        high: eye.map(|x| x + reach),
    };
    let mut count = 0;
    field.near(&around, |tile| {
        let [low, high] = grid.tile_bounds(tile, ground);
        let heights = grid.tile_heights(tile, ground).map(f64::from);
        let low = [low[0] - tall, heights[0] - 0.5 * tall, low[1] - tall];
        let high = [high[0] + tall, heights[1] + tall, high[1] + tall];
        let away = [0, 1, 2].map(|a| eye[a].clamp(low[a], high[a]) - eye[a]);
        let is_near = away.iter().map(|d| d * d).sum::<f64>() < reach * reach;
        count += u64::from(is_near && frustum.may_see(low, high));
    });
    count
}

fn limits(terrains: &[TerrainRow]) -> Vec<Limit> {
    let cost = |row: &TerrainRow| row.tiles_ms.worst_second;
    let worst_ms = terrains.iter().map(cost).fold(0.0, f64::max);
    let first_ms = terrains.first().map_or(1.0, cost);
    let growth = worst_ms / first_ms;
    vec![
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
    ]
}
