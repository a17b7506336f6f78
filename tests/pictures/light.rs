//! What light volumes do to a picture.

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::bodies::Occluders;
use sward::gpu::Gpu;
use sward::render::light::{LightGrid, LightTexels, TraceProgress, Visibility, cell_lights};
use sward::render::{Picture, Sun};

use super::{ALL, Shown, Stage, WHOLE, difference, hold, mean};

/// A wall behind the place that `ALL` looks at.
const WALL: &str = "(terrain: (ground: Flat(size_m: (8, 8))), \
    light: Some((cell_m: 0.25, height_m: 2, slices: 6, rays: 128)), \
    bodies: [(name: \"wall\", shape: Box(size_m: (7, 5, 0.5)), position_m: (0, 2.5, -1), motion: Fixed)])";
const CLUMPS: &str = "(terrain: (ground: Flat(size_m: (8, 8))), grass: (species: []), \
    light: Some((cell_m: 1, slices: 2, rays: 64)), billboards: Some((density_per_m2: 30)))";
/// So low that the sun itself hardly lights anything.
const LOW: Sun = Sun {
    elevation_deg: 2.0,
    azimuth_deg: 0.0,
};

fn seen(stage: &Stage) -> Result<Visibility, Failed> {
    let light = stage.meadow.scene.light.ok_or("no light volumes")?;
    let grid = LightGrid::new(&light, &stage.meadow.field.ground);
    let occluders = Occluders::new(&stage.meadow.bodies)?;
    let sight = |from, along| occluders.sight(from, along);
    let progress = TraceProgress::default();
    let seen = Visibility::trace(grid, light.rays, light.seed, &sight, &progress);
    Ok(seen.ok_or("it ended early")?)
}

fn texels(stage: &Stage, sun: Sun) -> Result<LightTexels, Failed> {
    Ok(LightTexels::new(&seen(stage)?, &sun.daylight()))
}

/// Under an even sky grass at the foot of a wall is darkened by it more than grass some metres before it.
pub fn light_volumes_darken_what_sees_less_sky(gpu: &Gpu) -> Result<(), Failed> {
    let under_even_sky = |text: &str| -> Result<Picture, Failed> {
        let mut stage = Stage::new(gpu, text, 0)?;
        let seen = seen(&stage)?;
        let lights = cell_lights(&seen, |_| [2.0; 3]);
        let texels = LightTexels::of_lights(&seen, &lights);
        stage.renderer.set_light(gpu, Some(&texels))?;
        let shown = Shown { sun: LOW, ..ALL };
        let picture = stage.shoot(gpu, shown)?;
        let again = stage.shoot(gpu, shown)?;
        hold(picture == again, "two pictures of one frame differ")?;
        Ok(picture)
    };
    let open = WALL.split_once("bodies").ok_or("a wall")?.0.to_owned() + ")";
    let (walled, open) = (under_even_sky(WALL)?, under_even_sky(&open)?);
    let ratio = |part: [f64; 4]| {
        let (with, without) = (mean(&walled, part), mean(&open, part));
        with.iter().sum::<f64>() / without.iter().sum::<f64>()
    };
    // The eye is 2 m up and 3 m before the middle, and looks down by 34 degrees: the foot of the wall is a
    // little above the picture's middle, its lower edge 1.3 m before the eye. There the wall, 5 m high and
    // 2.5 m off, hides a quarter of the sky, at its foot half of it; most leaves lean to the sky.
    let (foot, front) = (ratio([0.3, 0.4, 0.7, 0.45]), ratio([0.3, 0.85, 0.7, 1.0]));
    println!("with the wall the foot has {foot:.3} of its light, the grass before it {front:.3}");
    hold(
        foot < front - 0.04 && front < 0.99,
        format!("the foot has {foot} of its light, the grass before it {front}"),
    )
}

/// A scene without volumes has a texel of each kind and the picture of before, also after another scene's
/// have gone.
pub fn no_light_volumes_cost_nothing(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, WALL, 0)?;
    let first = stage.shoot(gpu, ALL)?;
    hold(
        stage.renderer.light_bytes() == 29,
        "not one texel of each kind",
    )?;
    let texels = texels(&stage, ALL.sun)?;
    stage.renderer.set_light(gpu, Some(&texels))?;
    hold(
        stage.shoot(gpu, ALL)? != first,
        "light volumes change nothing",
    )?;
    // A byte of openness and three times four half floats per cell, four bytes per column.
    let columns = 33 * 33;
    let wanted = columns * 6 * (1 + 24) + columns * 4;
    let bytes = stage.renderer.light_bytes();
    hold(
        bytes == wanted,
        format!("{bytes} bytes in place of {wanted}"),
    )?;
    stage.renderer.set_light(gpu, None)?;
    hold(
        stage.shoot(gpu, ALL)? == first && stage.renderer.light_bytes() == 29,
        "light volumes stay after they have gone",
    )
}

/// Clumps have light under a sky behind them as under one before them, since a leaf lets a share of it
/// through and has a sheen; by how much a leaf is lit from both sides is compared with its formula on the
/// device.
pub fn both_sides_of_clumps_are_lit(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, CLUMPS, 0)?;
    let seen = seen(&stage)?;
    let mut shown = Shown { sun: LOW, ..ALL };
    shown.view.eye_in_world = Vec3::new(0.0, 0.6, 3.0);
    shown.view.forward = Vec3::new(0.0, 0.0, -1.0);
    let mut under = |side: f64| -> Result<Picture, Failed> {
        let sky = move |along: Vec3<f64>| [if along.z * side > 0.0 { 2.0 } else { 0.0 }; 3];
        let texels = LightTexels::of_lights(&seen, &cell_lights(&seen, sky));
        stage.renderer.set_light(gpu, Some(&texels))?;
        stage.shoot(gpu, shown)
    };
    let [before, behind, dark] = [under(1.0)?, under(-1.0)?, under(0.0)?];
    let light = |picture| mean(picture, [0.1, 0.6, 0.9, 0.9]).iter().sum::<f64>();
    let [front, back] = [&before, &behind].map(|picture| light(picture) - light(&dark));
    println!("{front:.1} steps under a sky in front, {back:.1} under one behind");
    let apart = difference(&before, &behind, WHOLE);
    hold(
        front.min(back) > 5.0 && apart > 0.5,
        format!("{front} steps in front, {back} behind, {apart} apart"),
    )
}

pub fn too_many_slices_are_refused(gpu: &Gpu) -> Result<(), Failed> {
    let limit = gpu.device.limits().max_texture_array_layers;
    let stage = Stage::new(gpu, CLUMPS, 0)?;
    stage.renderer.check_light(gpu, limit / 3)?;
    let refused = stage.renderer.check_light(gpu, limit / 3 + 1);
    let text = refused
        .err()
        .map(|error| error.to_string())
        .unwrap_or_default();
    let named = format!("light.slices is {}", limit / 3 + 1);
    hold(
        text.contains(&named) && text.contains(&format!("at most {limit}")),
        text,
    )
}
