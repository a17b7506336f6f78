//! Hours of a ball going round in the grass.

use sward::run::Device;
use sward::scene::Action;

use super::Measured;
use super::rig::{Rig, SECOND_TICKS, Setting, all_in_wind_pose, ensure};

/// A ball on a round of 8 s in the wind.
fn round(setting: &Setting) -> String {
    format!(
        "(duration_s: 100000, terrain: (ground: Flat(size_m: (2, 2))),
          grass: (density_per_m2: 24), bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.15), collider: {}, motion: Path(repeat: true,
             waypoints: [
                (at_s: 0, position_m: (-0.4, 0.15, -0.3)), (at_s: 2, position_m: (0.4, 0.15, -0.3)),
                (at_s: 4, position_m: (0.4, 0.15, 0.3)), (at_s: 6, position_m: (-0.4, 0.15, 0.3)),
                (at_s: 8, position_m: (-0.4, 0.15, -0.3))]))],
          solver: (tile_m: 2))",
        setting.collider()
    )
}

/// Half an hour on the processor, 20 s on a device.
pub fn short_form(setting: &Setting) -> Measured {
    go_round(setting, if on_device(setting) { 20 } else { 30 * 60 })
}

/// A day on the processor, ten minutes on a device.
pub fn day(setting: &Setting) -> Measured {
    go_round(
        setting,
        if on_device(setting) {
            10 * 60
        } else {
            24 * 3600
        },
    )
}

fn on_device(setting: &Setting) -> bool {
    matches!(setting.device, Device::Graphics(..))
}

/// A ball that goes round for a long time, and is then taken away. A method that rewrites its state
/// drifts; one that counts time in f32 stops telling one sub-step from the next after two hours.
fn go_round(setting: &Setting, seconds: u32) -> Measured {
    let mut rig = setting.rig(&round(setting))?;
    // After two rounds everything has been allocated that ever will be.
    rig.run_to(16 * SECOND_TICKS, SECOND_TICKS)?;
    let before = memory(&rig);
    // A prime number of sub-steps, so that every part of the round is looked at in turn.
    rig.run_to(seconds * SECOND_TICKS, 7919)?;
    let after = memory(&rig);
    ensure(before == after, || {
        format!("memory grew from {before:?} to {after:?}")
    })?;
    let body = "ball".to_owned();
    rig.meadow.act(&Action::Remove { body })?;
    let moved = rig
        .look()?
        .values()
        .filter(|plant| plant.offset_m() > 0.02)
        .count();
    rig.ticks(rig.meadow.recovery_ticks())?;
    let plants = rig.look()?;
    let back = all_in_wind_pose(&plants);
    ensure(moved > 0 && !plants.is_empty() && back, || {
        format!("{moved} plants moved at the end, all back in their wind pose: {back}")
    })?;
    rig.ticks(2)?;
    ensure(rig.meadow.tiles.is_empty(), || {
        "a tile does not come to rest".into()
    })?;
    rig.nothing_is_inside()?;
    Ok(format!(
        "{seconds} s in {} sub-steps, {} bytes of state from beginning to end, strain at most {:.4}",
        rig.meadow.ticks, before.state_bytes, rig.seen.strain
    ))
}

/// Everything that could grow with time.
#[derive(Debug, PartialEq)]
struct Memory {
    state_bytes: u64,
    slabs: u32,
    tiles: usize,
    shapes: usize,
    parts: usize,
    contacts: usize,
}

fn memory(rig: &Rig) -> Memory {
    let meadow = &rig.meadow;
    Memory {
        state_bytes: meadow.counters.state_bytes_peak,
        slabs: meadow.tiles.slabs.high_water(),
        tiles: meadow.tiles.peak,
        shapes: meadow.bodies.shapes().len(),
        parts: meadow.parts.parts.len(),
        contacts: meadow.work.contacts.capacity(),
    }
}
