//! One tick of both engines from the same state: who is touched, and what becomes of them.

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::field::Plant;
use sward::gpu::{GpuGrass, GpuState};
use sward::scene::Collider;
use sward::sim::cpu::poses;
use sward::sim::measure::GrassState;
use sward::sim::slab::Slab;
use sward::sim::work::TileWork;
use sward::sim::{Grass, Meadow};

use super::Device;
use super::compare::{Difference, distance, ensure};
use super::meadows::{parade, rolling_ball};

/// How far a node may be off after one tick from the same state, in metres. A round takes a node
/// through some ten operations (spring, direction, ground, turn into the part, look-up, way out and
/// back) on coordinates below 4 m, each rounded to 2⁻²³·2 m on either side: 10·2·2.4e-7 = 4.8e-6 m.
/// Lengths are laid out from root to tip, so a node takes over the error of the one below and the
/// tip has that of eight: 3.8e-5 m; the second round starts from directions of segments 0.05 m
/// long that are off by as much, which the springs and the way out pass on undamped: twice.
const NODE_M: f64 = 2.0 * 3.8e-5;
/// A segment of length L that is turned onto a face it meets head on keeps a sideways run of
/// √(L² − rise²), and an error e of the rise becomes up to √(2·L·e) of it: with L = 0.42/8 m and one
/// round's e = 4.8e-6 m that is 7.1e-4 m.
const HEAD_ON_M: f64 = 7.1e-4;
/// Share of plants that may be so far off. The run magnifies e beyond the limit above where it is
/// shorter than L/16, for directions within 3.6° of a face's normal: 0.2% of a half sphere for each
/// node turned, of which a plant at a body's front has some five.
const HEAD_ON_SHARE: f64 = 1e-2;
/// Plants that may be further off, as a share: ones at an edge of a decision (which face is nearer,
/// whether the strain is met, whether a silhouette's weight is one half) go to one side here and to
/// the other there. The product promises at most 0.1% of plants that end on another side. Every
/// sweep decides anew, so that the share is one of plants times the sweeps of their tile's bodies.
const EDGE_SHARE: f64 = 1e-3;

/// What a run of ticks compared.
struct Compared {
    nodes: Difference,
    touched: u64,
    /// Touched plants, each as often as it was swept.
    swept: u64,
    /// Touched on one side only.
    apart: u64,
    /// Off as far as a head-on segment may be.
    head_on: u64,
    /// Further off than rounding explains.
    edges: u64,
}

fn slab_of<'a>(state: &'a impl GrassState<f32>, tile: &TileWork) -> Result<&'a Slab<f32>, Failed> {
    state
        .slab(tile.slab)
        .ok_or_else(|| format!("tile {} has no slab", tile.tile).into())
}

impl Compared {
    fn new() -> Self {
        Self {
            nodes: Difference::new("relaxed nodes", "m"),
            touched: 0,
            swept: 0,
            apart: 0,
            head_on: 0,
            edges: 0,
        }
    }

    fn add(&mut self, meadow: &Meadow, cpu: &Grass<f32>, gpu: &GpuState) -> Result<(), Failed> {
        for tile in &meadow.work.tiles {
            let (ours, theirs) = (slab_of(cpu, tile)?, slab_of(gpu, tile)?);
            for place in 0..ours.touched_at.len() {
                self.add_plant(meadow, tile, [ours, theirs], place);
            }
        }
        Ok(())
    }

    fn add_plant(
        &mut self,
        meadow: &Meadow,
        tile: &TileWork,
        [ours, theirs]: [&Slab<f32>; 2],
        place: usize,
    ) {
        let now = meadow.work.now;
        let here = ours.touched_at[place] == now;
        let there = theirs.touched_at[place] == now;
        if !here && !there {
            return;
        }
        self.touched += 1;
        let contacts =
            &meadow.work.contacts[tile.contacts.start as usize..tile.contacts.end as usize];
        let sweeps = contacts.iter().map(|contact| contact.sweeps).max();
        self.swept += u64::from(sweeps.unwrap_or(1));
        if here != there {
            self.apart += 1;
            return;
        }
        let segments = meadow.field.table.segments as usize;
        let nodes = place * segments..(place + 1) * segments;
        let off = nodes
            .clone()
            .map(|n| distance(ours.offsets[n].to_f32(), theirs.offsets[n].to_f32()))
            .fold(0.0, f64::max);
        if off > HEAD_ON_M {
            self.edges += 1;
        } else if off > NODE_M {
            self.head_on += 1;
        } else {
            self.nodes.add(off, || {
                format!("tick {now} tile {} plant {place}", tile.tile)
            });
        }
    }

    fn check(&self) -> Result<(), Failed> {
        let text = format!(
            "{} plants touched in {} sweeps, {} on one side only, {} at an edge, {} head on",
            self.touched, self.swept, self.apart, self.edges, self.head_on
        );
        println!("{text}");
        let share = |count: u64| count as f64 / self.swept.max(1) as f64;
        let decided = share(self.apart + self.edges) <= EDGE_SHARE;
        let turned = share(self.head_on) <= HEAD_ON_SHARE;
        ensure(self.touched > 1000 && decided && turned, || text)?;
        self.nodes.check(NODE_M)
    }
}

/// Runs a meadow on the CPU; in every tick the device starts from the CPU's state before it.
fn compare_ticks(
    device: &Device,
    mut meadow: Meadow,
    ticks: std::ops::Range<u32>,
) -> Result<Compared, Failed> {
    let mut cpu = Grass::<f32>::new();
    let mut gpu = GpuGrass::new(&device.gpu, &device.kernels, &mut meadow)?;
    let mut compared = Compared::new();
    while meadow.ticks < ticks.end {
        let compares = meadow.ticks >= ticks.start;
        if compares {
            gpu.upload(&meadow, &cpu)?;
        }
        meadow.script()?;
        meadow.move_bodies();
        meadow.broad_phase();
        cpu.assign_slabs(&meadow);
        if compares {
            gpu.assign_slabs(&meadow)?;
            gpu.draw_depth_cubes(&meadow)?;
            gpu.collide(&meadow)?;
            gpu.relax();
            gpu.submit();
        }
        cpu.draw_depth_cubes(&mut meadow);
        cpu.collide(&meadow);
        cpu.relax(&meadow);
        if compares {
            compared.add(&meadow, &cpu, &gpu.read_state(&meadow)?)?;
        }
    }
    Ok(compared)
}

pub fn a_tick_agrees_with_cubes(device: &Device) -> Result<(), Failed> {
    compare_ticks(device, rolling_ball(Collider::Cube)?, 60..150)?.check()
}

pub fn a_tick_agrees_with_closed_forms(device: &Device) -> Result<(), Failed> {
    compare_ticks(device, rolling_ball(Collider::Analytic)?, 60..150)?.check()
}

pub fn every_kind_of_solid_agrees(device: &Device) -> Result<(), Failed> {
    for collider in ["cube", "analytic"] {
        println!("{collider}:");
        compare_ticks(device, parade(collider)?, 30..60)?.check()?;
    }
    Ok(())
}

/// A drawn node is the wind pose plus the share t³ of an offset below 1 m, laid out again from the
/// root: to the wind pose's 5.3e-6 m come three roundings of the share (3·2⁻²⁴) on either side
/// and eight of the laying out, which turn with segments of 0.4/8 m: an error e of a node turns the
/// segment above by e over its own length, so that it arrives there undamped but not larger:
/// 5.3e-6 + 8·(5.3e-6/8 + 2·2⁻²³) = 1.3e-5 m.
pub fn drawn_nodes_agree(device: &Device) -> Result<(), Failed> {
    let mut meadow = rolling_ball(Collider::Analytic)?;
    let mut cpu = Grass::<f32>::new();
    let mut gpu = GpuGrass::new(&device.gpu, &device.kernels, &mut meadow)?;
    let mut difference = Difference::new("drawn nodes", "m");
    while meadow.ticks < 240 {
        sward::sim::tick(&mut meadow, &mut cpu)?;
        if meadow.ticks % 40 != 0 {
            continue;
        }
        gpu.upload(&meadow, &cpu)?;
        gpu.recover()?;
        let rows = gpu.read_drawn(&meadow)?;
        compare_drawn(&meadow, &cpu, &rows, &mut difference)?;
    }
    difference.check(1.3e-5)
}

fn compare_drawn(
    meadow: &Meadow,
    cpu: &Grass<f32>,
    rows: &[[f32; 4]],
    difference: &mut Difference,
) -> Result<(), Failed> {
    let field = &meadow.field;
    let segments = field.table.segments as usize;
    let fading = sward::sim::recover::Fading::<f32>::new(meadow);
    let plants = field.grid.plants_per_tile();
    let per_tile = plants as usize * (segments + 1);
    for (tile, rows) in meadow.work.tiles.iter().zip(rows.chunks_exact(per_tile)) {
        let slab = slab_of(cpu, tile)?;
        for (place, rows) in (0..plants).zip(rows.chunks_exact(segments + 1)) {
            let plant: Option<Plant> = field.plant(&tile.anchor, tile.tile, place);
            ensure((rows[0][3] == 1.0) == plant.is_some(), || {
                format!("tile {} place {place}: {:?}", tile.tile, rows[0])
            })?;
            let Some(plant) = plant else {
                continue;
            };
            let (_, nodes) = poses(field, &meadow.work, &fading, tile, &plant, slab, place);
            for (j, (row, node)) in rows.iter().zip(&nodes).enumerate() {
                difference.add(distance([row[0], row[1], row[2]], node.to_f32()), || {
                    format!(
                        "tick {} tile {} plant {place} node {j}",
                        meadow.ticks, tile.tile
                    )
                });
            }
        }
    }
    Ok(())
}

/// What is uploaded comes back bit for bit, also after the state has grown for more slabs.
pub fn state_survives_upload_and_growth(device: &Device) -> Result<(), Failed> {
    let mut meadow = rolling_ball(Collider::Analytic)?;
    let mut cpu = Grass::<f32>::new();
    let mut gpu = GpuGrass::new(&device.gpu, &device.kernels, &mut meadow)?;
    while meadow.ticks < 60 {
        sward::sim::tick(&mut meadow, &mut cpu)?;
    }
    gpu.upload(&meadow, &cpu)?;
    let slabs = meadow.tiles.slabs.high_water();
    let before: Vec<_> = meadow.work.tiles.iter().map(|tile| tile.slab).collect();
    // The ball goes on without grass of its own, so that slabs are handed out.
    while meadow.tiles.slabs.high_water() < 2 * slabs + 1 && meadow.ticks < 300 {
        meadow.script()?;
        meadow.move_bodies();
        meadow.broad_phase();
        cpu.assign_slabs(&meadow);
        gpu.assign_slabs(&meadow)?;
        gpu.submit();
    }
    ensure(meadow.tiles.slabs.high_water() > slabs, || {
        "no slab was handed out".into()
    })?;
    let state = gpu.read_state(&meadow)?;
    let mut kept = 0;
    for tile in &meadow.work.tiles {
        let (ours, theirs) = (slab_of(&cpu, tile)?, slab_of(&state, tile)?);
        ensure(ours == theirs, || format!("slab {} has changed", tile.slab))?;
        let moved = ours.offsets.iter().any(|&offset| offset != Vec3::ZERO);
        kept += u32::from(moved && before.contains(&tile.slab));
    }
    ensure(kept > 0, || "no slab with a state was compared".into())
}
