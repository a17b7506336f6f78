//! The grass of the `cpu` engine: slabs in memory, passes over tiles on every core.
//!
//! A plant reads and writes nothing but its own state, so results do not depend on the number of
//! threads, on the order of tiles, or on which slab a tile has. Billboards are a second layer with
//! slabs of their own; a tile's slab number is the same in both.

mod billboards;
mod blades;

use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::base::{Real, Vec3};
use crate::scene::Solver;
use crate::scene::method::Recovery;

pub use billboards::{BillboardLayer, tile_of};
use blades::{Touched, respond, touched_plants};
pub use blades::{poses, segment_length};

use super::depth_cube::{COVER_MARGIN_M, DepthCube};
use super::meadow::Meadow;
use super::recover::fade_literally;
use super::relax::RelaxSettings;
use super::slab::Slab;
use super::solid::Solid;
use super::state_hash::StateHash;
use super::voxel_field::VoxelField;
use super::work::TileWork;

/// State and scratch of the grass in float `R`.
#[derive(Debug, Default)]
pub struct Grass<R: Real> {
    /// By slab number; `None` while no tile has it. Shared with checkpoints until written to.
    slabs: Vec<Option<Arc<Slab<R>>>>,
    /// The grown solid of every part in this engine's float.
    grown: Vec<Solid<R>>,
    /// Plants found touched by the last collide pass, per tile of the work.
    touched: Vec<Vec<Touched>>,
    /// The second layer; without slabs in a scene that has no billboards.
    billboards: BillboardLayer<R>,
    /// Plants that were pushed in the last sub-step.
    pub pushed: u64,
    /// Most rounds any plant took in the last sub-step, and since the start.
    pub rounds: u32,
    pub rounds_peak: u32,
    pub times: PassTimes,
    /// Kept by whoever asks for it, see [`Grass::chain_hash`].
    pub state_hash: StateHash,
}

/// A tile whose touched plants respond, with its slab taken out of the pool meanwhile.
type Job<'a, R> = (&'a TileWork, &'a [Touched], Arc<Slab<R>>);

/// Time spent in each pass since the start.
#[derive(Clone, Copy, Debug, Default)]
pub struct PassTimes {
    pub depth_cubes: Duration,
    pub collide: Duration,
    pub relax: Duration,
}

impl PassTimes {
    /// Milliseconds by the pass's name.
    pub fn in_ms(&self) -> Vec<(&'static str, f64)> {
        let ms = |d: Duration| d.as_secs_f64() * 1e3;
        vec![
            ("depth_cubes", ms(self.depth_cubes)),
            ("collide", ms(self.collide)),
            ("relax", ms(self.relax)),
        ]
    }
}

impl<R: Real> Grass<R> {
    pub fn new() -> Self {
        Self {
            slabs: Vec::new(),
            grown: Vec::new(),
            touched: Vec::new(),
            billboards: BillboardLayer::default(),
            pushed: 0,
            rounds: 0,
            rounds_peak: 0,
            times: PassTimes::default(),
            state_hash: StateHash::default(),
        }
    }

    /// Takes the tick that is done into the state hash.
    pub fn chain_hash(&mut self, meadow: &Meadow) {
        let mut hash = self.state_hash;
        hash.tick(meadow, self);
        self.state_hash = hash;
    }

    /// Gives woken tiles a wiped slab and frees those of tiles that rest.
    pub fn assign_slabs(&mut self, meadow: &Meadow) {
        let plants = meadow.field.grid.plants_per_tile() as usize;
        let segments = meadow.scene.solver.segments as usize;
        for &(_, slab) in &meadow.changes.rested {
            self.slabs[slab as usize] = None;
        }
        self.slabs
            .resize_with(meadow.tiles.slabs.high_water() as usize, || None);
        for &(_, slab) in &meadow.changes.woken {
            self.slabs[slab as usize] = Some(Arc::new(Slab::new(plants, segments)));
        }
        self.billboards.assign_slabs(meadow);
    }

    /// Draws the depth cubes, and samples the voxel fields, that are wanted for the first time.
    pub fn draw_depth_cubes(&mut self, meadow: &mut Meadow) {
        let start = Instant::now();
        let skin = f64::from(meadow.scene.solver.skin_m);
        let resolution = meadow.scene.solver.cube_resolution;
        for part in &meadow.parts.parts[self.grown.len()..] {
            self.grown.push(part.solid.grown_by(skin));
        }
        let undrawn = meadow.parts.undrawn();
        let parts = &meadow.parts;
        let drawn: Vec<(usize, DepthCube)> = undrawn
            .into_par_iter()
            .map(|index| (index, draw_cube(parts, index, &meadow.scene.solver)))
            .collect();
        for (index, cube) in drawn {
            meadow.parts.parts[index].cube = Some(cube);
        }
        for index in meadow.parts.unsampled() {
            let part = &mut meadow.parts.parts[index];
            part.voxels = Some(VoxelField::draw(&part.grown, resolution));
        }
        self.times.depth_cubes += start.elapsed();
    }

    /// Finds the plants that a body touches.
    pub fn collide(&mut self, meadow: &Meadow) {
        let start = Instant::now();
        let tiles = &meadow.work.tiles;
        self.touched.clear();
        self.touched.resize_with(tiles.len(), Vec::new);
        let (slabs, grown) = (&self.slabs, &self.grown);
        self.touched
            .par_iter_mut()
            .zip(tiles)
            .filter(|(_, tile)| !tile.contacts.is_empty())
            .for_each(|(touched, tile)| {
                if let Some(slab) = &slabs[tile.slab as usize] {
                    *touched = touched_plants(meadow, grown, tile, slab);
                }
            });
        self.billboards.collide(meadow, grown);
        self.times.collide += start.elapsed();
    }

    /// Pushes the touched plants out, restores their shape and stores their offsets.
    pub fn relax(&mut self, meadow: &Meadow) {
        let start = Instant::now();
        let settings = RelaxSettings {
            planted: meadow.planted,
            ..RelaxSettings::new(&meadow.scene.solver)
        };
        let grown = &self.grown;
        let mut jobs: Vec<Job<R>> = meadow
            .work
            .tiles
            .iter()
            .zip(&self.touched)
            .filter(|(_, touched)| !touched.is_empty())
            .filter_map(|(tile, touched)| {
                Some((tile, &touched[..], self.slabs[tile.slab as usize].take()?))
            })
            .collect();
        let mut results: Vec<(u64, u32)> = jobs
            .par_iter_mut()
            .map(|(tile, touched, slab)| {
                let slab = Arc::make_mut(slab);
                respond(meadow, grown, tile, touched, slab, &settings)
            })
            .collect();
        for (tile, _, slab) in jobs {
            self.slabs[tile.slab as usize] = Some(slab);
        }
        results.push(self.billboards.relax(meadow, grown));
        self.pushed = results.iter().map(|r| r.0).sum();
        self.rounds = results.iter().map(|r| r.1).max().unwrap_or(0);
        self.rounds_peak = self.rounds_peak.max(self.rounds);
        if meadow.scene.solver.method.recovery == Recovery::Literal {
            self.fade_literally(meadow);
        }
        self.times.relax += start.elapsed();
    }

    /// Rewrites the offset of every plant that was not touched in this sub-step.
    fn fade_literally(&mut self, meadow: &Meadow) {
        fade_slabs(
            &mut self.slabs,
            meadow.field.table.segments as usize,
            meadow,
        );
        if let Some(weave) = &meadow.weave {
            fade_slabs(self.billboards.slabs_mut(), weave.grid.movable(), meadow);
        }
    }

    /// Every slab by its number.
    pub(super) fn slabs(&self) -> &[Option<Arc<Slab<R>>>] {
        &self.slabs
    }

    pub(super) fn set_slabs(&mut self, slabs: Vec<Option<Arc<Slab<R>>>>) {
        self.slabs = slabs;
    }

    /// The second layer.
    pub fn billboards(&self) -> &BillboardLayer<R> {
        &self.billboards
    }

    pub(super) fn billboards_mut(&mut self) -> &mut BillboardLayer<R> {
        &mut self.billboards
    }

    /// The state of a slab in use.
    pub fn slab(&self, slab: u32) -> Option<&Slab<R>> {
        self.slabs.get(slab as usize)?.as_deref()
    }
}

fn draw_cube(parts: &super::parts::Parts, index: usize, solver: &Solver) -> DepthCube {
    let part = &parts.parts[index];
    let siblings: Vec<_> = parts.siblings(index).collect();
    let covered = |point: Vec3<f32>| {
        let in_body = part.pose.point(Vec3::of(point.to_f64()));
        siblings
            .iter()
            .any(|other| other.solid.depth(other.pose.inverse_point(in_body)) > COVER_MARGIN_M)
    };
    let mut cube = DepthCube::draw(&part.grown, solver.cube_resolution, covered);
    cube.sampling = solver.method.sampling;
    cube.push = solver.method.push;
    cube
}

/// Rewrites the offsets of all that was touched before this sub-step; `nodes` are those of each.
fn fade_slabs<R: Real>(slabs: &mut [Option<Arc<Slab<R>>>], nodes: usize, meadow: &Meadow) {
    let step_over_t = R::of(meadow.step_over_t());
    let now = meadow.work.now;
    slabs.par_iter_mut().flatten().for_each(|slab| {
        let slab = Arc::make_mut(slab);
        let each = slab
            .touched_at
            .iter()
            .zip(slab.offsets.chunks_mut(nodes.max(1)));
        for (&touched_at, offsets) in each {
            if touched_at != 0 && touched_at != now {
                fade_literally(offsets, now - touched_at, step_over_t);
            }
        }
    });
}
