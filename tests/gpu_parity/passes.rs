//! One sweep of both engines from the same state: who is touched, and what becomes of them.
//!
//! A sub-step is cut into sweeps, each of which starts from what the one before left: rounding grows
//! with their number, and what is compared after all of them needs a limit that hides mistakes. So
//! the first sweep of every sub-step is compared alone; whole runs are in [`runs`](super::runs).

use libtest_mimic::Failed;
use sward::base::{Vec3, vec3};
use sward::field::Plant;
use sward::gpu::{GpuGrass, GpuState};
use sward::scene::Collider;
use sward::sim::cpu::poses;
use sward::sim::measure::GrassState;
use sward::sim::slab::Slab;
use sward::sim::work::{Contact, TileWork};
use sward::sim::{Grass, Meadow};

use super::Device;
use super::compare::{Difference, distance, ensure};
use super::meadows::{parade, rolling_ball};

/// How far rounding takes a node in a round, in metres: some ten operations (spring, direction,
/// ground, turn into the part, look-up, way out and back) on coordinates below 4 m, each rounded to
/// 2⁻²³·2 m on either side: 10·2·2.4e-7.
const ROUND_M: f64 = 4.8e-6;
/// How far a node may be off after a sweep from the same state, in metres. Lengths are laid out from
/// root to tip, so a node takes over the error of the one below and the tip has that of eight; the
/// second round starts from directions of segments 0.05 m long that are off by as much, which the
/// springs and the way out pass on undamped: twice.
const NODE_M: f64 = 2.0 * 8.0 * ROUND_M;
/// A plant is at an edge if the cpu engine itself moves a node by more than this where every body is
/// put aside by the rounding of a round: a segment that meets a face head on keeps a sideways run of
/// √(L² − rise²), which magnifies any error of the rise, and a decision (which face is nearer, whether
/// the strain is met, whether there is contact) goes to one side here and to the other there. What
/// such a plant does on the device proves nothing. An even pull of all nodes moves them by as much
/// themselves and, by the bounds above, by no more than `NODE_M`.
const EDGE_M: f64 = NODE_M;
/// Plants that may be at an edge, as a share of the touched ones. Head on are directions within 3.6°
/// of a face's normal, 0.2% of a half sphere for each node turned, of which a plant at a body's front
/// has some five.
const EDGE_SHARE: f64 = 2e-2;
/// Other plants that may be further off, as a share: an edge may lie between the places that were
/// tried. The product promises at most 0.1% of plants that end on another side.
const WRONG_SHARE: f64 = 1e-3;
/// A mistake that must not go unnoticed, in metres, and in every how many plants.
const MISTAKE_M: f32 = 1e-4;
const MISTAKEN: usize = 50;

/// What the sweeps compared.
struct Compared {
    nodes: Difference,
    /// Added to a node of every so many plants of the device.
    mistake_m: f32,
    touched: u64,
    edges: u64,
    /// Not at an edge, and touched on one side only or further off than rounding explains.
    wrong: u64,
}

fn slab_of<'a>(state: &'a impl GrassState<f32>, tile: &TileWork) -> Result<&'a Slab<f32>, Failed> {
    state
        .slab(tile.slab)
        .ok_or_else(|| format!("tile {} has no slab", tile.tile).into())
}

/// The same sweep on the cpu engine: from the state as it is, and with the bodies put aside.
struct Twins {
    plain: Grass<f32>,
    aside: Vec<Grass<f32>>,
}

impl Compared {
    fn with_mistake(mistake_m: f32) -> Self {
        Self {
            nodes: Difference::new("relaxed nodes", "m"),
            mistake_m,
            touched: 0,
            edges: 0,
            wrong: 0,
        }
    }

    fn add(&mut self, meadow: &Meadow, cpu: &Twins, gpu: &GpuState) -> Result<(), Failed> {
        for tile in &meadow.work.tiles {
            let (ours, theirs) = (slab_of(&cpu.plain, tile)?, slab_of(gpu, tile)?);
            let aside: Result<Vec<_>, _> = cpu.aside.iter().map(|g| slab_of(g, tile)).collect();
            let aside = aside?;
            for place in 0..ours.touched_at.len() {
                let off = |slab| off_m(meadow, [ours, slab], place, 0.0);
                let is_at_edge = || {
                    aside
                        .iter()
                        .any(|slab| off(slab).is_none_or(|m| m > EDGE_M))
                };
                self.add_plant(meadow, tile, [ours, theirs], place, is_at_edge);
            }
        }
        Ok(())
    }

    fn add_plant(
        &mut self,
        meadow: &Meadow,
        tile: &TileWork,
        slabs: [&Slab<f32>; 2],
        place: usize,
        is_at_edge: impl Fn() -> bool,
    ) {
        let now = meadow.work.now;
        if slabs.iter().all(|slab| slab.touched_at[place] != now) {
            return;
        }
        self.touched += 1;
        let mistake_m = if place.is_multiple_of(MISTAKEN) {
            self.mistake_m
        } else {
            0.0
        };
        match off_m(meadow, slabs, place, mistake_m) {
            Some(off) if off <= NODE_M => self.nodes.add(off, || {
                format!("tick {now} tile {} plant {place}", tile.tile)
            }),
            _ if is_at_edge() => self.edges += 1,
            _ => self.wrong += 1,
        }
    }

    fn check(&self) -> Result<(), Failed> {
        let text = format!(
            "{} plants touched, {} off at an edge, {} off elsewhere",
            self.touched, self.edges, self.wrong
        );
        println!("{text}");
        let share = |count: u64| count as f64 / self.touched.max(1) as f64;
        let holds = share(self.wrong) <= WRONG_SHARE && share(self.edges) <= EDGE_SHARE;
        ensure(self.touched > 1000 && holds, || text)?;
        self.nodes.check(NODE_M)
    }
}

/// Largest distance between the nodes of a plant in two slabs, the second one's last node put aside by
/// `aside_m`; `None` where only one was touched in this tick.
fn off_m(meadow: &Meadow, [a, b]: [&Slab<f32>; 2], place: usize, aside_m: f32) -> Option<f64> {
    let is_touched = |slab: &Slab<f32>| slab.touched_at[place] == meadow.work.now;
    if is_touched(a) != is_touched(b) {
        return None;
    }
    let segments = meadow.field.table.segments as usize;
    let (first, last) = (place * segments, (place + 1) * segments - 1);
    let off = (first..=last).map(|n| {
        let aside = vec3(if n == last { aside_m } else { 0.0 }, 0.0, 0.0);
        distance(a.offsets[n].to_f32(), (b.offsets[n] + aside).to_f32())
    });
    Some(off.fold(0.0, f64::max))
}

/// The first sweeps of a sub-step's contacts, as contacts of one sweep, with the bodies put aside.
fn first_sweeps(contacts: &[Contact], aside: Vec3<f64>) -> Vec<Contact> {
    let first = |contact: &Contact| {
        let mut contact = contact.clone();
        contact.to = contact
            .from
            .lerp(contact.to, 1.0 / f64::from(contact.sweeps));
        contact.sweeps = 1;
        contact.from.place += aside;
        contact.to.place += aside;
        contact
    };
    contacts.iter().map(first).collect()
}

/// The contacts' first sweeps on the cpu engine.
fn twins(meadow: &mut Meadow, before: &Grass<f32>, contacts: &[Contact]) -> Twins {
    let mut swept = |aside| {
        meadow.work.contacts = first_sweeps(contacts, aside);
        let mut grass = Grass::<f32>::new();
        grass.take_over(meadow, before);
        grass.draw_depth_cubes(meadow);
        grass.collide(meadow);
        grass.relax(meadow);
        grass
    };
    let axes = [
        vec3(ROUND_M, 0.0, 0.0),
        vec3(0.0, ROUND_M, 0.0),
        vec3(0.0, 0.0, ROUND_M),
    ];
    Twins {
        aside: axes
            .iter()
            .flat_map(|&axis| [axis, -axis])
            .map(&mut swept)
            .collect(),
        plain: swept(Vec3::ZERO),
    }
}

/// Runs a meadow on the CPU; in every tick the device does the first sweep from the CPU's state before
/// it. The differences must be those of rounding, and must not be with a mistake.
fn compare_sweeps(
    device: &Device,
    mut meadow: Meadow,
    ticks: std::ops::Range<u32>,
) -> Result<(), Failed> {
    let mut cpu = Grass::<f32>::new();
    let mut gpu = GpuGrass::new(&device.gpu, &device.kernels, &mut meadow)?;
    let mut compared = [0.0, MISTAKE_M].map(Compared::with_mistake);
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
            let contacts = meadow.work.contacts.clone();
            let twins = twins(&mut meadow, &cpu, &contacts);
            gpu.assign_slabs(&meadow)?;
            gpu.draw_depth_cubes(&meadow)?;
            gpu.collide(&meadow)?;
            gpu.relax();
            gpu.submit();
            let state = gpu.read_state(&meadow)?;
            for compared in &mut compared {
                compared.add(&meadow, &twins, &state)?;
            }
            meadow.work.contacts = contacts;
        }
        cpu.draw_depth_cubes(&mut meadow);
        cpu.collide(&meadow);
        cpu.relax(&meadow);
    }
    let [plain, mistaken] = compared;
    plain.check()?;
    ensure(mistaken.check().is_err(), || {
        format!("{MISTAKE_M} m in every {MISTAKEN}th plant go unnoticed")
    })
}

pub fn a_sweep_agrees_with_cubes(device: &Device) -> Result<(), Failed> {
    compare_sweeps(device, rolling_ball(Collider::Cube)?, 60..150)
}

pub fn a_sweep_agrees_with_closed_forms(device: &Device) -> Result<(), Failed> {
    compare_sweeps(device, rolling_ball(Collider::Analytic)?, 60..150)
}

/// Bend springs so stiff that a whole step would raise their energy, which both engines make smaller or
/// leave out. Both decide that on energies of their own rounding, so that a step may be halved once more
/// on one side; such a plant is at an edge, or within the limit.
pub fn stiff_springs_agree(device: &Device) -> Result<(), Failed> {
    for rate_per_s in [30.0, 300.0] {
        println!("{rate_per_s} /s:");
        let mut meadow = rolling_ball(Collider::Analytic)?;
        meadow.scene.solver.spring_rate_per_s = rate_per_s;
        compare_sweeps(device, meadow, 60..120)?;
    }
    Ok(())
}

pub fn every_kind_of_solid_agrees(device: &Device) -> Result<(), Failed> {
    for collider in ["cube", "analytic"] {
        println!("{collider}:");
        compare_sweeps(device, parade(collider)?, 30..60)?;
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
