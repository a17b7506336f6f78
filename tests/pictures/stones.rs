//! Stones that a body shoves aside.

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::gpu::Gpu;
use sward::render::{Picture, View};

use super::{ALL, Shown, Stage, WHOLE, difference, hold};

/// A ball is led along x over stones and taken away.
const STONES: &str = "(terrain: (ground: Rolling(size_m: (4, 4), amplitude_m: 0.1, wavelength_m: 3)), \
    grass: (density_per_m2: 500, species: [(form: Gravel, response: RESPONSE, height_m: (0.03, 0.06), \
        width_m: (0.02, 0.04), lean_deg: (0, 5), stiffness: (4000, 4000), tint_rgb: (2, 2, 2))]), \
    solver: (recovery_s: 0.5), \
    bodies: [(name: \"ball\", shape: Ball(radius_m: 0.15), above_ground: true, motion: Path(waypoints: [ \
        (at_s: 0, position_m: (-0.7, 0.15, 0)), (at_s: 0.5, position_m: (0.7, 0.15, 0))]))], \
    script: [(at_s: 0.5, action: Remove(body: \"ball\"))])";
/// Ticks, 120 a second: when the ball has just gone, when the stones are back and their tiles still awake,
/// and when those sleep.
const SHOVED: u32 = 61;
const BACK: u32 = 121;
const ASLEEP: u32 = 130;

/// From above, 1.3 m of the way across the picture.
fn above() -> Shown {
    Shown {
        bodies: false,
        view: View {
            eye_in_world: Vec3::new(0.0, 1.5, 0.3),
            forward: Vec3::new(0.0, -0.98058, -0.19612),
            fov_rad: 0.6,
        },
        ..ALL
    }
}

fn shot(gpu: &Gpu, response: &str, ticks: u32, active: bool) -> Result<(Picture, usize), Failed> {
    let scene = STONES.replace("RESPONSE", response);
    let mut stage = Stage::new(gpu, &scene, ticks)?;
    let awake = stage.nodes.tiles.len();
    let shown = Shown { active, ..above() };
    Ok((stage.shoot(gpu, shown)?, awake))
}

/// Where the ball passed stones lie elsewhere; no other pixel changes, and none when they are back.
pub fn stones_are_shoved_and_go_back(gpu: &Gpu) -> Result<(), Failed> {
    let (untouched, _) = shot(gpu, "Shoved", 0, true)?;
    let (shoved, awake) = shot(gpu, "Shoved", SHOVED, true)?;
    let passed = difference(&shoved, &untouched, [0.1, 0.42, 0.9, 0.58]);
    // The picture is 0.93 m high: its rows past a fifth and four fifths are 0.27 m and more from the way,
    // and a ball of 0.15 m shoves stones of 0.06 m no farther than 0.21 m from it.
    let beside = [[0.0, 0.0, 1.0, 0.2], [0.0, 0.8, 1.0, 1.0]]
        .map(|rows| difference(&shoved, &untouched, rows));
    hold(
        awake > 0 && passed > 4.0 && beside == [0.0; 2],
        format!("{awake} tiles; {passed} steps where the ball passed, {beside:?} beside"),
    )?;
    let (asleep, _) = shot(gpu, "Shoved", SHOVED, false)?;
    hold(asleep == untouched, "seeds are drawn elsewhere")?;
    let (back, awake) = shot(gpu, "Shoved", BACK, true)?;
    hold(
        awake > 0 && back == untouched,
        format!(
            "{awake} tiles; back they differ by {}",
            difference(&back, &untouched, WHOLE)
        ),
    )?;
    let (slept, awake) = shot(gpu, "Shoved", ASLEEP, true)?;
    hold(awake == 0 && slept == untouched, format!("{awake} tiles"))?;
    let (stays, _) = shot(gpu, "Stays", SHOVED, true)?;
    hold(stays == untouched, "stones that stay have moved")
}
