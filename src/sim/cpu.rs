//! The grass of the `cpu` engine: slabs in memory, passes over tiles on every core.
//!
//! A plant reads and writes nothing but its own state, so results do not depend on the number of
//! threads, on the order of tiles, or on which slab a tile has.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::base::{Real, Vec3};
use crate::field::grid::ground_in_anchor;
use crate::field::{Field, Nodes, Plant, wind_pose};
use crate::scene::Solver;
use crate::scene::method::Recovery;

use super::collide::{self, Movable};
use super::contact::Touch;
use super::depth_cube::{COVER_MARGIN_M, DepthCube};
use super::fault::Fault;
use super::meadow::Meadow;
use super::recover::{Fading, fade_literally, is_back, recovering_pose};
use super::relax::{self, Ground, Place, RelaxSettings};
use super::slab::Slab;
use super::solid::Solid;
use super::state_hash::StateHash;
use super::voxel_field::VoxelField;
use super::work::{TileWork, Work};

/// State and scratch of the grass in float `R`.
#[derive(Debug, Default)]
pub struct Grass<R: Real> {
    /// By slab number; `None` while no tile has it. Shared with checkpoints until written to.
    slabs: Vec<Option<Arc<Slab<R>>>>,
    /// The grown solid of every part in this engine's float.
    grown: Vec<Solid<R>>,
    /// Plants found touched by the last collide pass, per tile of the work.
    touched: Vec<Vec<Touched>>,
    /// Plants that were pushed in the last sub-step.
    pub pushed: u64,
    /// Most rounds any plant took in the last sub-step, and since the start.
    pub rounds: u32,
    pub rounds_peak: u32,
    pub times: PassTimes,
    /// Kept by whoever asks for it, see [`Grass::chain_hash`].
    pub state_hash: StateHash,
}

/// A plant to respond: its place in the tile and the sweeps it needs, 0 if it is merely held.
#[derive(Clone, Copy, Debug)]
struct Touched {
    place: u32,
    sweeps: u32,
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
        let results: Vec<(u64, u32)> = jobs
            .par_iter_mut()
            .map(|(tile, touched, slab)| {
                let slab = Arc::make_mut(slab);
                respond(meadow, grown, tile, touched, slab, &settings)
            })
            .collect();
        for (tile, _, slab) in jobs {
            self.slabs[tile.slab as usize] = Some(slab);
        }
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
        let step_over_t = R::of(meadow.step_over_t());
        let (now, segments) = (meadow.work.now, meadow.field.table.segments as usize);
        self.slabs.par_iter_mut().flatten().for_each(|slab| {
            let slab = Arc::make_mut(slab);
            let plants = slab
                .touched_at
                .iter()
                .zip(slab.offsets.chunks_mut(segments));
            for (&touched_at, offsets) in plants {
                if touched_at != 0 && touched_at != now {
                    fade_literally(offsets, now - touched_at, step_over_t);
                }
            }
        });
    }

    /// Every slab by its number.
    pub(super) fn slabs(&self) -> &[Option<Arc<Slab<R>>>] {
        &self.slabs
    }

    pub(super) fn set_slabs(&mut self, slabs: Vec<Option<Arc<Slab<R>>>>) {
        self.slabs = slabs;
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
    DepthCube {
        sampling: solver.method.sampling,
        push: solver.method.push,
        ..DepthCube::draw(&part.grown, solver.cube_resolution, covered)
    }
}

/// A plant's wind pose and its pose of now.
pub fn poses<R: Real>(
    field: &Field,
    work: &Work,
    fading: &Fading<R>,
    tile: &TileWork,
    plant: &Plant,
    slab: &Slab<R>,
    place: u32,
) -> (Nodes<R>, Nodes<R>) {
    let segments = field.table.segments as usize;
    let wind = wind_pose(plant, &field.table, work.wind.bend(&tile.anchor, plant));
    let mut touched_at = slab.touched_at[place as usize];
    if touched_at == 0 {
        return (wind, wind);
    }
    if fading.planted.is(Fault::TimerPerTile) {
        touched_at = slab.touched_at.iter().copied().max().unwrap_or(0);
    }
    let first = place as usize * segments;
    let pose = recovering_pose(
        &wind,
        &slab.offsets[first..first + segments],
        work.now - touched_at,
        fading,
        segment_length(plant, segments),
    );
    (wind, pose)
}

/// Whether a plant was touched in the sub-step before this one.
fn was_touched(work: &Work, touched_at: u32) -> bool {
    touched_at != 0 && work.now - touched_at == 1
}

/// A plant's wind pose of now, and the pose that bodies meet in this sub-step: the one it was left
/// in if it was touched in the sub-step before, wherever the wind has gone since, else its pose of
/// now.
fn poses_before<R: Real>(
    field: &Field,
    work: &Work,
    fading: &Fading<R>,
    tile: &TileWork,
    plant: &Plant,
    slab: &Slab<R>,
    place: u32,
) -> (Nodes<R>, Nodes<R>) {
    if !was_touched(work, slab.touched_at[place as usize]) {
        return poses(field, work, fading, tile, plant, slab, place);
    }
    let segments = field.table.segments as usize;
    let mut pose = wind_pose(
        plant,
        &field.table,
        work.wind_before.bend(&tile.anchor, plant),
    );
    let offsets = &slab.offsets[place as usize * segments..][..segments];
    for (node, &offset) in pose[1..].iter_mut().zip(offsets) {
        *node += offset;
    }
    let wind = wind_pose(plant, &field.table, work.wind.bend(&tile.anchor, plant));
    (wind, pose)
}

/// Rest length of a plant's segments, in metres.
pub fn segment_length<R: Real>(plant: &Plant, segments: usize) -> R {
    R::of_f32(plant.height_m) * R::of(1.0 / segments as f64)
}

fn touches_of<'a, R: Real>(
    meadow: &'a Meadow,
    grown: &'a [Solid<R>],
    tile: &TileWork,
) -> Vec<Touch<'a, R>> {
    meadow
        .work
        .contacts_of(tile)
        .iter()
        .enumerate()
        .map(|(number, contact)| {
            let part = contact.part as usize;
            Touch::new(number, contact, &meadow.parts.parts[part], &grown[part])
        })
        .collect()
}

fn touched_plants<R: Real>(
    meadow: &Meadow,
    grown: &[Solid<R>],
    tile: &TileWork,
    slab: &Slab<R>,
) -> Vec<Touched> {
    let field = &meadow.field;
    let segments = field.table.segments as usize;
    let fading = Fading::new(meadow);
    let touches = touches_of(meadow, grown, tile);
    let mut found = Vec::new();
    for place in 0..field.grid.plants_per_tile() {
        let Some(plant) = field.responding_plant(&tile.anchor, tile.tile, place) else {
            continue;
        };
        let reach = R::of_f32(plant.height_m);
        let sweeps = relax::sweeps_for(&touches, Vec3::of_f32(plant.root_in_anchor), reach);
        if sweeps == 0 {
            continue;
        }
        let (_, pose) = poses_before(field, &meadow.work, &fading, tile, &plant, slab, place);
        let before = was_touched(&meadow.work, slab.touched_at[place as usize]);
        let pinned = |p: Vec3<R>| {
            before
                && p.y - ground_in_anchor(&field.ground, &tile.anchor, p.x, p.z)
                    <= R::of(collide::PINNED_M)
        };
        if collide::touched(
            Movable::of_blade(&pose, segments),
            &touches,
            sweeps,
            reach,
            pinned,
        ) {
            found.push(Touched { place, sweeps });
        } else if before {
            let let_go = || poses(field, &meadow.work, &fading, tile, &plant, slab, place).1;
            if collide::held(Movable::of_blade(&pose, segments), &touches, reach)
                || collide::in_the_way(Movable::of_blade(&let_go(), segments), &touches, reach)
            {
                found.push(Touched { place, sweeps: 0 });
            }
        }
    }
    found
}

fn respond<R: Real>(
    meadow: &Meadow,
    grown: &[Solid<R>],
    tile: &TileWork,
    touched: &[Touched],
    slab: &mut Slab<R>,
    settings: &RelaxSettings<R>,
) -> (u64, u32) {
    let field = &meadow.field;
    let segments = field.table.segments as usize;
    let fading = Fading::new(meadow);
    let touches = touches_of(meadow, grown, tile);
    let mut rounds_peak = 0;
    for &Touched { place, sweeps } in touched {
        let Some(plant) = field.plant(&tile.anchor, tile.tile, place) else {
            continue;
        };
        let (wind, mut pose) =
            poses_before(field, &meadow.work, &fading, tile, &plant, slab, place);
        let first = place as usize * segments;
        let surroundings = Place {
            ground: Ground {
                heights: &field.ground,
                anchor: &tile.anchor,
            },
            wind: &wind,
            segments,
            length: segment_length(&plant, segments),
        };
        let age = meadow.work.now - slab.touched_at[place as usize];
        // What is back in the wind pose has no memory of faces, whenever its tile gave its slab
        // back.
        if is_back(age, meadow.step_over_t() as f32) {
            slab.faces[first..first + segments].fill(0);
        }
        let rounds = relax::respond(
            &mut pose,
            &mut slab.faces[first..first + segments],
            &touches,
            sweeps,
            R::of_f32(plant.height_m),
            &surroundings,
            settings,
        );
        rounds_peak = rounds_peak.max(rounds);
        for j in 0..segments {
            slab.offsets[first + j] = pose[j + 1] - wind[j + 1];
        }
        slab.touched_at[place as usize] = meadow.work.now;
    }
    (touched.len() as u64, rounds_peak)
}
