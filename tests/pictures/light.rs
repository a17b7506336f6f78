//! What light volumes do to a picture.

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::bodies::Occluders;
use sward::gpu::Gpu;
use sward::render::Sun;
use sward::render::light::{LightGrid, LightTexels, TraceProgress, Visibility, cell_lights};

use super::{ALL, Shown, Stage, WHOLE, difference, hold, mean};

/// A wall behind the place that `ALL` looks at, whose shadow falls away from the eye.
const WALL: &str = "(terrain: (ground: Flat(size_m: (8, 8))), \
    light: Some((cell_m: 0.25, height_m: 2, slices: 6, rays: 128)), \
    bodies: [(name: \"wall\", shape: Box(size_m: (7, 5, 0.5)), position_m: (0, 2.5, -1), motion: Fixed)])";
const CLUMPS: &str = "(terrain: (ground: Flat(size_m: (8, 8))), grass: (species: []), \
    light: Some((cell_m: 1, slices: 2, rays: 64)), billboards: Some((density_per_m2: 30)))";
/// Over the wall's foot, from the side of the eye.
const FRONT: Sun = Sun {
    elevation_deg: 50.0,
    azimuth_deg: 90.0,
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

/// Grass at the foot of a wall is darkened by it more than grass some metres before it.
pub fn light_volumes_darken_what_sees_less_sky(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, WALL, 0)?;
    let shown = Shown { sun: FRONT, ..ALL };
    let plain = stage.shoot(gpu, shown)?;
    let texels = texels(&stage, FRONT)?;
    stage.renderer.set_light(gpu, Some(&texels))?;
    let lit = stage.shoot(gpu, shown)?;
    hold(
        stage.shoot(gpu, shown)? == lit,
        "two pictures of one frame differ",
    )?;
    let ratio = |part: [f64; 4]| {
        let (with, without) = (mean(&lit, part), mean(&plain, part));
        with.iter().sum::<f64>() / without.iter().sum::<f64>()
    };
    // The eye is 2 m up and 3 m before the middle, and looks down by 34 degrees: the foot of the wall is a
    // little above the picture's middle, its lower edge 1.3 m before the eye.
    let (foot, front) = (ratio([0.3, 0.36, 0.7, 0.42]), ratio([0.3, 0.85, 0.7, 1.0]));
    hold(
        foot < front - 0.04,
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

/// Billboards under a sky that shines from one side alone: seen from the lit side and from the other they
/// have light, since a leaf lets a share of it through, and more on the lit one.
pub fn both_sides_of_clumps_are_lit(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, CLUMPS, 0)?;
    let seen = seen(&stage)?;
    let sky = |direction: Vec3<f64>| [if direction.z > 0.0 { 2.0 } else { 0.0 }; 3];
    let lights = cell_lights(&seen, sky);
    let texels = LightTexels::of_lights(&seen, &lights);
    // So low that the sun itself hardly lights anything.
    let sun = Sun {
        elevation_deg: 2.0,
        azimuth_deg: 0.0,
    };
    let mut from = |z: f64| -> Result<f64, Failed> {
        let mut shown = Shown { sun, ..ALL };
        shown.view.eye_in_world = Vec3::new(0.0, 0.6, 3.0 * z);
        shown.view.forward = Vec3::new(0.0, 0.0, -z);
        let part = [0.1, 0.5, 0.9, 0.9];
        stage.renderer.set_light(gpu, Some(&texels))?;
        let lit = stage.shoot(gpu, shown)?;
        let dark = LightTexels::of_lights(&seen, &cell_lights(&seen, |_| [0.0; 3]));
        stage.renderer.set_light(gpu, Some(&dark))?;
        let unlit = stage.shoot(gpu, shown)?;
        hold(difference(&lit, &unlit, WHOLE) > 0.0, "nothing changes")?;
        Ok(mean(&lit, part).iter().sum::<f64>() - mean(&unlit, part).iter().sum::<f64>())
    };
    let (lit, other) = (from(1.0)?, from(-1.0)?);
    hold(
        lit > 1.1 * other && other > 5.0,
        format!("the lit side gains {lit} steps, the other {other}"),
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
