//! Whole runs on both engines, each from its own state.

use libtest_mimic::Failed;
use sward::gpu::{Dispatches, GpuGrass, GpuState};
use sward::run::accuracy::scenes::SCENES;
use sward::scene::{Collider, LoadedScene};
use sward::sim::fault::{Fault, Planted};
use sward::sim::measure::{self, GrassState, Standing};
use sward::sim::{Checkpoint, Grass, Meadow};

use super::Device;
use super::compare::ensure;
use super::meadows::{rolling_ball, shoved_stones, still};

/// Promised: root mean square of the nodes' differences, and the share of plants that slid to the
/// other side of the body.
const RMS_M: f64 = 1e-4;
const FLIPPED_SHARE: f64 = 1e-3;
/// A plant is on another side if its tip stands further from its twin's than any rounding or a whole
/// texel of the ball's cube (0.3 m / 64) explains.
const FLIPPED_M: f64 = 0.02;

/// Every plant of the active tiles, tile after tile.
fn plants(meadow: &Meadow, state: &impl GrassState<f32>) -> Vec<Standing<f32>> {
    let tiles = meadow.work.tiles.iter();
    tiles
        .filter_map(|tile| Some(measure::standing(meadow, tile, state.slab(tile.slab)?)))
        .flatten()
        .collect()
}

#[derive(Default)]
struct Tracks {
    squares: f64,
    nodes: u64,
    plants: u64,
    flipped: u64,
    worst_m: f64,
}

impl Tracks {
    fn add(&mut self, ours: &[Standing<f32>], theirs: &[Standing<f32>]) -> Result<(), Failed> {
        ensure(ours.len() == theirs.len(), || {
            format!("{} plants against {}", ours.len(), theirs.len())
        })?;
        for (a, b) in ours.iter().zip(theirs) {
            if a.touched_at == 0 && b.touched_at == 0 {
                continue;
            }
            self.plants += 1;
            let off: Vec<f64> = a
                .nodes
                .iter()
                .zip(&b.nodes)
                .map(|(&a, &b)| f64::from((a - b).length()))
                .collect();
            let most = off.iter().copied().fold(0.0, f64::max);
            if most > FLIPPED_M {
                self.flipped += 1;
                continue;
            }
            self.worst_m = self.worst_m.max(most);
            self.squares += off.iter().map(|d| d * d).sum::<f64>();
            self.nodes += off.len() as u64;
        }
        Ok(())
    }

    fn check(&self) -> Result<(), Failed> {
        let rms = (self.squares / self.nodes.max(1) as f64).sqrt();
        let share = self.flipped as f64 / self.plants.max(1) as f64;
        let text = format!(
            "rms {rms:.2e} m (limit {RMS_M:.0e}), max {:.2e} m over {} plants; {} on another side \
             ({share:.2e}, limit {FLIPPED_SHARE:.0e})",
            self.worst_m, self.plants, self.flipped
        );
        println!("{text}");
        ensure(
            self.plants > 1000 && rms <= RMS_M && share <= FLIPPED_SHARE,
            || text,
        )
    }
}

/// The recovery and 0.2 s after the ball was taken away, in seconds.
const RESTING_S: f64 = 4.8;

/// Runs the rolling ball on both engines until it is gone and the grass rests again.
fn compare_tracks(device: &Device, collider: Collider) -> Result<(), Failed> {
    let (mut here, mut there) = (rolling_ball(collider)?, rolling_ball(collider)?);
    let mut cpu = Grass::<f32>::new();
    let mut gpu = GpuGrass::new(&device.gpu, &device.kernels, &mut there)?;
    let mut tracks = Tracks::default();
    let ticks = (here.scene.duration_s / here.scene.solver.substep_s).round() as u32;
    while here.ticks < ticks {
        sward::sim::tick(&mut here, &mut cpu)?;
        sward::gpu::tick(&mut there, &mut gpu)?;
        if here.ticks % 30 == 0 {
            let state: GpuState = gpu.read_state(&there)?;
            tracks.add(&plants(&here, &cpu), &plants(&there, &state))?;
            let snapshot = measure::snapshot(&there, &state);
            ensure(snapshot.not_finite == 0, || {
                format!(
                    "tick {}: {} plants not finite",
                    here.ticks, snapshot.not_finite
                )
            })?;
            for (engine, seen) in [("cpu", measure::snapshot(&here, &cpu)), ("gpu", snapshot)] {
                let (worst, strain) = (seen.worst, seen.max_strain);
                ensure(worst.depth_m <= worst.limit_m && strain <= 0.02, || {
                    format!("{engine}, tick {}: {worst:?}, strain {strain}", here.ticks)
                })?;
            }
        }
        if here.time_s() >= RESTING_S {
            ensure(here.tiles.is_empty() && there.tiles.is_empty(), || {
                format!("tiles are active at {} s", here.time_s())
            })?;
        }
    }
    ensure(there.tiles.is_empty(), || {
        format!("{} tiles still active", there.tiles.len())
    })?;
    for (name, ms) in gpu.timer.medians_ms() {
        println!("{name}: {ms:.3} ms per tick");
    }
    println!(
        "{:?}, most rounds {}",
        gpu.dispatches,
        gpu.read_counts()?.rounds_peak
    );
    tracks.check()
}

pub fn a_rolled_track_agrees_with_cubes(device: &Device) -> Result<(), Failed> {
    compare_tracks(device, Collider::Cube)
}

pub fn a_rolled_track_agrees_with_closed_forms(device: &Device) -> Result<(), Failed> {
    compare_tracks(device, Collider::Analytic)
}

/// Stones are pushed by the kernels that push grass.
pub fn shoved_stones_agree(device: &Device) -> Result<(), Failed> {
    let (mut here, mut there) = (shoved_stones()?, shoved_stones()?);
    let mut cpu = Grass::<f32>::new();
    let mut gpu = GpuGrass::new(&device.gpu, &device.kernels, &mut there)?;
    let mut tracks = Tracks::default();
    for now in 1..=120 {
        sward::sim::tick(&mut here, &mut cpu)?;
        sward::gpu::tick(&mut there, &mut gpu)?;
        if now % 15 == 0 {
            let state: GpuState = gpu.read_state(&there)?;
            tracks.add(&plants(&here, &cpu), &plants(&there, &state))?;
        }
    }
    tracks.check()
}

pub fn a_still_meadow_dispatches_nothing(device: &Device) -> Result<(), Failed> {
    let mut meadow = still()?;
    let mut gpu = GpuGrass::new(&device.gpu, &device.kernels, &mut meadow)?;
    for _ in 0..30 {
        sward::gpu::tick(&mut meadow, &mut gpu)?;
        gpu.recover()?;
    }
    ensure(gpu.dispatches == Dispatches::default(), || {
        format!("{:?}", gpu.dispatches)
    })?;
    ensure(meadow.state_bytes() == 0, || {
        format!("{} bytes of state", meadow.state_bytes())
    })
}

/// Tiles beyond the slabs are refused and counted; those that have one go on as if alone.
pub fn a_full_device_refuses_and_counts(device: &Device) -> Result<(), Failed> {
    let mut meadow = rolling_ball(Collider::Analytic)?;
    let mut gpu = GpuGrass::new(&device.gpu, &device.kernels, &mut meadow)?;
    meadow.tiles.slabs.lower_limit(5);
    for _ in 0..120 {
        sward::gpu::tick(&mut meadow, &mut gpu)?;
    }
    let refused = meadow.counters.refused_tiles;
    ensure(refused > 0 && meadow.tiles.len() == 5, || {
        format!("{refused} refused, {} active", meadow.tiles.len())
    })?;
    let state = gpu.read_state(&meadow)?;
    let snapshot = measure::snapshot(&meadow, &state);
    let slabs = meadow
        .work
        .tiles
        .iter()
        .filter_map(|tile| state.slab(tile.slab));
    let pushed = slabs
        .flat_map(|slab| &slab.touched_at)
        .filter(|&&at| at > 0)
        .count();
    ensure(snapshot.not_finite == 0 && pushed > 0, || {
        format!("{} not finite, {pushed} pushed", snapshot.not_finite)
    })
}

/// Hundreds of sweeps in one dispatch, where the default takes turns: a driver either runs them all,
/// and the result is that of the turns, or the kernels tell that it did not.
pub fn a_driver_that_cuts_loops_short_is_told_of(device: &Device) -> Result<(), Failed> {
    let plate = SCENES.iter().find(|scene| scene.name == "plate");
    let mut loaded = plate.ok_or("the report has no plate")?.load()?;
    told_or_equal(device, &loaded)?;
    // Loops over a single segment look the same whether they were cut short or not.
    loaded.scene.solver.segments = 1;
    loaded.scene.solver.method.sweep_share = 0.001;
    loaded.scene.solver.rounds = [32, 32];
    loaded.scene.grass.density_per_m2 *= 4.0;
    told_or_equal(device, &loaded)
}

fn told_or_equal(device: &Device, loaded: &LoadedScene) -> Result<(), Failed> {
    let first_tick = |planted| -> Result<(Vec<Standing<f32>>, u32), Failed> {
        let mut meadow = Meadow::new(loaded.scene.clone(), &loaded.assets)?;
        meadow.planted = planted;
        let mut gpu = GpuGrass::new(&device.gpu, &device.kernels, &mut meadow)?;
        sward::gpu::tick(&mut meadow, &mut gpu)?;
        let turns = gpu.dispatches.relax as u32;
        let state = gpu.read_state(&meadow);
        // What waits for nothing knows it as well, once the device was waited for.
        gpu.submit();
        let late = gpu.check_late();
        ensure(late.is_err() == state.is_err(), || {
            format!("late: {late:?}")
        })?;
        Ok((plants(&meadow, &state?), turns))
    };
    let (in_turns, turns) = first_tick(Planted::NONE)?;
    ensure(turns > 1, || format!("{turns} turns prove nothing"))?;
    match first_tick(Planted::plant(Fault::OneTurn)) {
        Err(error) => {
            let text = error.message().unwrap_or_default().to_owned();
            println!("{text}");
            ensure(text.contains("has ended loops"), || text.clone())
        }
        Ok((at_once, _)) => {
            let mut tracks = Tracks::default();
            tracks.add(&at_once, &in_turns)?;
            // Turns hand whole nodes on, so that no bit changes.
            let equal = tracks.flipped == 0 && tracks.worst_m == 0.0;
            ensure(tracks.plants > 10 && equal, || {
                format!(
                    "{} plants, {} m, {} flipped",
                    tracks.plants, tracks.worst_m, tracks.flipped
                )
            })
        }
    }
}

/// Where the ball is in the grass: saved, gone on from, restored there and on another engine.
pub fn a_restored_collision_goes_on_with_the_same_bits(device: &Device) -> Result<(), Failed> {
    const SAVED: u32 = 60;
    const COMPARED: u32 = 150;
    let mut meadow = rolling_ball(Collider::Cube)?;
    let mut gpu = GpuGrass::new(&device.gpu, &device.kernels, &mut meadow)?;
    let run_to = |meadow: &mut Meadow, gpu: &mut GpuGrass, ticks: u32| -> Result<(), Failed> {
        while meadow.ticks < ticks {
            sward::gpu::tick(meadow, gpu)?;
        }
        Ok(())
    };
    run_to(&mut meadow, &mut gpu, SAVED)?;
    let mut kept = Grass::<f32>::new();
    kept.take_over(&meadow, &gpu.read_state(&meadow)?);
    let checkpoint = Checkpoint::save(&meadow, &kept);
    ensure(!meadow.work.contacts.is_empty(), || {
        "nothing collides".into()
    })?;

    run_to(&mut meadow, &mut gpu, COMPARED)?;
    let tiles: Vec<u32> = meadow.work.tiles.iter().map(|tile| tile.slab).collect();
    let first = gpu.read_state(&meadow)?;
    let mut fresh = GpuGrass::new(&device.gpu, &device.kernels, &mut meadow)?;
    for (which, gpu) in [("the same", &mut gpu), ("another", &mut fresh)] {
        checkpoint.restore(&mut meadow, &mut kept);
        ensure(meadow.ticks == SAVED, || format!("tick {}", meadow.ticks))?;
        gpu.upload(&meadow, &kept)?;
        run_to(&mut meadow, gpu, COMPARED)?;
        let again = gpu.read_state(&meadow)?;
        let slabs: Vec<u32> = meadow.work.tiles.iter().map(|tile| tile.slab).collect();
        let differ = tiles
            .iter()
            .filter(|&&slab| first.slab(slab) != again.slab(slab))
            .count();
        ensure(slabs == tiles && differ == 0, || {
            format!("{which} engine: {differ} of {} slabs differ", tiles.len())
        })?;
    }
    Ok(())
}
