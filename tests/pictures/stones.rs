//! Stones that a body shoves aside.

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::gpu::Gpu;
use sward::render::{Picture, View};
use sward::scene::Scene;
use sward::sim::{Grass, Meadow, measure, tick};

use super::{ALL, Shown, Stage, WHOLE, difference, hold};

/// A ball is led along x over red stones and taken away.
const STONES: &str = "(terrain: (ground: Rolling(size_m: (4, 4), amplitude_m: 0.1, wavelength_m: 3)), \
    grass: (density_per_m2: DENSITY, species: [(form: Gravel, response: RESPONSE, height_m: (0.03, 0.06), \
        width_m: (0.02, 0.04), lean_deg: (0, 5), stiffness: (4000, 4000), flexibility: 0, tint_rgb: (2, 0.3, 0.3))]), \
    solver: (recovery_s: RECOVERY_S), \
    bodies: [(name: \"ball\", shape: Ball(radius_m: 0.15), above_ground: true, motion: Path(waypoints: [ \
        (at_s: 0, position_m: (-0.7, 0.15, 0)), (at_s: 0.5, position_m: (0.7, 0.15, 0))]))], \
    script: [(at_s: 0.5, action: Remove(body: \"ball\"))])";
/// Ticks, 120 a second: when the ball has just gone, when the stones are back and their tiles still awake,
/// and when those sleep.
const SHOVED: u32 = 61;
const BACK: u32 = 120;
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

fn scene(density: &str, response: &str, recovery_s: &str) -> String {
    STONES
        .replace("DENSITY", density)
        .replace("RESPONSE", response)
        .replace("RECOVERY_S", recovery_s)
}

fn shot(gpu: &Gpu, response: &str, ticks: u32, active: bool) -> Result<(Picture, usize), Failed> {
    let scene = scene("500", response, "0.5");
    let mut stage = Stage::new(gpu, &scene, ticks)?;
    let awake = stage.nodes.tiles.len();
    let shown = Shown { active, ..above() };
    Ok((stage.shoot(gpu, shown)?, awake))
}

/// Where the ball passed stones lie elsewhere; no other pixel changes, and none when they are back.
pub fn stones_go_back(gpu: &Gpu) -> Result<(), Failed> {
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

/// Where the stones that were shoved by 40 mm and more grew, and where they lie by the tips of their centre
/// lines, in the world and on the ground.
fn shoved_places(text: &str) -> Result<Vec<[Vec3<f64>; 2]>, Failed> {
    let scene: Scene = ron::from_str(text)?;
    let mut meadow = Meadow::new(scene, &Default::default())?;
    let mut grass = Grass::<f32>::new();
    for _ in 0..SHOVED {
        tick(&mut meadow, &mut grass)?;
    }
    let on_ground = |x, z| Vec3::new(x, meadow.field.ground.height_in_world(x, z), z);
    let tiles = meadow.work.tiles.iter();
    let stones = tiles
        .filter_map(|tile| Some(measure::standing(&meadow, tile, grass.slab(tile.slab)?)))
        .flatten();
    let places = stones.filter_map(|stone| {
        let [x, z] = stone.root_in_world();
        let [dx, _, dz] = (*stone.nodes.last()? - *stone.wind.last()?).to_f64();
        (dx.hypot(dz) > 0.04).then(|| [on_ground(x, z), on_ground(x + dx, z + dz)])
    });
    Ok(places.collect())
}

/// Whether a red stone is in the picture at a place; none where that is not in the picture.
fn shows_stone(picture: &Picture, view: &View, in_world: Vec3<f64>) -> Option<bool> {
    let (width, height) = (f64::from(picture.width), f64::from(picture.height));
    let from_eye = glam::Vec3::from(view.from_eye(in_world)).extend(1.0);
    let clip = view.clip_from_eye((width / height) as f32) * from_eye;
    let x = width * f64::from(0.5 + 0.5 * clip.x / clip.w);
    let y = height * f64::from(0.5 - 0.5 * clip.y / clip.w);
    let inside = x >= 0.0 && y >= 0.0 && x < width && y < height;
    let at = 4 * (y as usize * picture.width as usize + x as usize);
    inside.then(|| f64::from(picture.rgba8[at]) > 1.4 * f64::from(picture.rgba8[at + 1]))
}

/// Stones so few that hardly one hides another lie where the tips of their centre lines were pushed to, and
/// no longer where they grew. A stone's half lengths are up to 30, 20 and 24 mm, times up to 1.25.
pub fn stones_lie_where_shoved(gpu: &Gpu) -> Result<(), Failed> {
    let text = scene("120", "Shoved", "8");
    let shown = Shown {
        shadows: false,
        ..above()
    };
    let untouched = Stage::new(gpu, &text, 0)?.shoot(gpu, shown)?;
    let shoved = Stage::new(gpu, &text, SHOVED)?.shoot(gpu, shown)?;
    // A stone at its old and its new place, before and after.
    let (mut stones, mut shows) = (0, [0; 4]);
    for [old, new] in shoved_places(&text)? {
        let at = |picture, place| shows_stone(picture, &shown.view, place);
        let seen = [
            at(&untouched, old),
            at(&untouched, new),
            at(&shoved, old),
            at(&shoved, new),
        ];
        if seen.iter().all(Option::is_some) {
            stones += 1;
            for (count, seen) in shows.iter_mut().zip(seen) {
                *count += u32::from(seen == Some(true));
            }
        }
    }
    let what = format!("{stones} stones; old and new places before, then after: {shows:?}");
    println!("{what}");
    let [grew, free, left, lies] = shows;
    let (most, few) = (stones * 9 / 10, stones * 3 / 10);
    hold(
        stones >= 10 && grew >= most && free <= few && left <= few && lies >= most,
        what,
    )
}
