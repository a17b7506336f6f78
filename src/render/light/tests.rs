use super::*;
use crate::base::Vec3;
use crate::bodies::{Bodies, Occluders, Sight};
use crate::render::error::RenderError;
use crate::scene::Scene;
use crate::terrain::height_grid;

const RAYS: u32 = 256;
const UP: Vec3<f32> = Vec3::new(0.0, 1.0, 0.0);
/// Radiance of a uniform sky.
const SKY: [f64; 3] = [0.2, 0.5, 1.5];

/// Directions of `RAYS` within any part of a turn are that part of them, but for so many: twice van der
/// Corput's discrepancy, of which count × D* ≤ log2(count) / 3 + 1, since a part has two ends.
fn miscounted() -> f64 {
    2.0 * (f64::from(RAYS).log2() / 3.0 + 1.0)
}

fn scene(keys: &str) -> Scene {
    let text = format!("(terrain: (ground: Flat(size_m: (6, 4))), {keys})");
    ron::from_str(&text).expect("a scene")
}

const LIGHT: &str = "light: Some((cell_m: 0.5, height_m: 2, slices: 5, rays: 256))";

fn seen(scene: &Scene, sight: &SightOf<'_>) -> Visibility {
    let light = scene.light.expect("the key");
    let ground = height_grid(&scene.terrain, &Default::default()).expect("flat");
    let grid = LightGrid::new(&light, &ground);
    let progress = TraceProgress::default();
    let visibility = Visibility::trace(grid, light.rays, light.seed, sight, &progress);
    visibility.expect("nobody ends it")
}

/// What the cells of a scene see past its own ground and bodies.
fn seen_in(scene: &Scene) -> Visibility {
    let ground = height_grid(&scene.terrain, &Default::default()).expect("flat");
    let bodies = Bodies::new(scene, &Default::default(), &ground).expect("plain bodies");
    let occluders = Occluders::new(&bodies).expect("a ground");
    seen(scene, &|from, along| occluders.sight(from, along))
}

fn texels(visibility: &Visibility) -> LightTexels {
    LightTexels::of_lights(visibility, &cell_lights(visibility, |_| SKY))
}

/// Nothing stands over a level ground, and no direction points down: all are open, without tolerance.
#[test]
fn an_open_field_sees_the_whole_sky_and_a_uniform_one_gives_pi_l() {
    let visibility = seen_in(&scene(LIGHT));
    for light in cell_lights(&visibility, |_| SKY) {
        assert_eq!(light.openness, 1.0);
        let lit = light.on(UP);
        for (colour, radiance) in SKY.into_iter().enumerate() {
            // E = π L, and `on` gives E / π: heights of directions have their mean exactly, to rounding.
            assert!((f64::from(lit[colour]) - radiance).abs() < 1e-6 * radiance);
        }
    }
}

/// Under the same sky all that lean from the vertical alike are lit alike: E / π = L (1 + cos) / 2. What is
/// left of the level part of `lean` is the sum of cos over a turn of directions, whose variation is 4,
/// weighted by sines, which fall: 4 times the discrepancy of half an end, by Koksma and Abel.
#[test]
fn normals_that_lean_alike_are_lit_alike() {
    let visibility = seen_in(&scene(LIGHT));
    let light = cell_lights(&visibility, |_| [1.0; 3])[0];
    let most = 4.0 * (0.5 * miscounted()) / f64::from(RAYS);
    for n in 0..12_u8 {
        let azimuth = f32::from(n) / 12.0 * std::f32::consts::TAU;
        for cos in [0.0_f32, 0.3, 0.8] {
            let level = (1.0 - cos * cos).sqrt();
            let normal = Vec3::new(level * azimuth.cos(), cos, level * azimuth.sin());
            let off = f64::from(light.on(normal)[1]) - f64::from(0.5 + 0.5 * cos);
            assert!(off.abs() <= most, "{normal:?}: {off} of {most}");
        }
    }
}

/// A cell 0.05 m before a wall sees half the sky: but for directions over the wall and past its ends,
/// shares (d / h) / 2 and 2 × (2 d / w) / 2 of the half at most, and for how directions fall on its sides.
#[test]
fn the_foot_of_a_wall_sees_half_the_sky() {
    let wall = "bodies: [(name: \"wall\", shape: Box(size_m: (60, 40, 1)), \
        position_m: (0, 0, -1.55), motion: Fixed)]";
    let visibility = seen_in(&scene(&format!("{LIGHT}, {wall}")));
    let lights = texels(&visibility);
    let light = lights.at([0.0, 0.0, -1.0]);
    let (distance, height, width) = (0.05, 20.0, 60.0);
    let past = 0.5 * distance / height + 2.0 * distance / width;
    // A texel of the openness is a byte.
    let most = past + miscounted() / f64::from(RAYS) + 0.5 / 255.0;
    let off = f64::from(light.openness) - 0.5;
    assert!(off.abs() <= most, "{off} of {most}");
    // The light on the ground is halved as well: weights rise with the direction's number, so that by Abel
    // twice as many may be off. A half float is right to 2⁻¹¹.
    let lit = f64::from(light.on(UP)[2]) / SKY[2] - 0.5;
    let most = past + 2.0 * miscounted() / f64::from(RAYS) + 0.001;
    assert!(lit.abs() <= most, "{lit} of {most}");
    // A leaf that looks away from the wall gets more than one that looks at it.
    let [away, at_it] = [1.0, -1.0].map(|z| light.on(Vec3::new(0.0, 0.0, z))[2]);
    assert!(away > at_it + 0.2, "{away} {at_it}");
    // Three metres away the wall still hides nearly half; a leaf over the top of the volume has its light.
    let far = lights.at([0.0, 0.0, 2.0]).openness;
    assert!(far > light.openness, "{far}");
    assert_eq!(lights.at([0.0, 50.0, 2.0]), lights.at([0.0, 2.0, 2.0]));
}

/// Cells inside a body see nothing, and have what those around it have: its surface is not darkened by
/// what it hides.
#[test]
fn cells_in_a_body_take_the_light_around_it() {
    let block = "bodies: [(name: \"block\", shape: Box(size_m: (1.2, 0.8, 1.2)), \
        position_m: (0, 0.3, 0), motion: Fixed)]";
    let visibility = seen_in(&scene(&format!("{LIGHT}, {block}")));
    let lights = cell_lights(&visibility, |_| SKY);
    let inside: Vec<usize> = (0..visibility.grid.cells())
        .filter(|&cell| visibility.is_inside(cell))
        .collect();
    // Columns at -0.5, 0 and 0.5 along both sides, slices at 0 and 0.5.
    assert_eq!(inside.len(), 18);
    assert!(inside.iter().all(|&cell| lights[cell].openness > 0.3));
}

/// The worst that two bands make of one small light: 3/4 of it to its front, nothing to its back.
#[test]
fn a_small_light_keeps_three_quarters() {
    let visibility = seen(&scene(LIGHT), &|_, _| Sight::Open);
    let one = sky_directions(RAYS, 1)[77];
    let sky = |direction: Vec3<f64>| [f64::from(u8::from(direction == one)); 3];
    let light = cell_lights(&visibility, sky)[0];
    let [front, back] = [1.0, -1.0].map(|sign| {
        let [x, y, z] = one.to_f32();
        light.on(Vec3::new(sign * x, sign * y, sign * z))[0]
    });
    // E₀ / π of a direction's part of the half sphere, 2π over their number.
    let whole = 2.0 / RAYS as f32;
    assert!((front / whole - 0.75).abs() < 1e-5, "{front}");
    assert_eq!(back, 0.0);
}

/// The file's bytes give the same bits; of another scene, broken or cut they give a sentence.
#[test]
fn bytes_come_back_or_say_what_is_wrong() {
    let visibility = seen(
        &scene(LIGHT),
        &|from, along| match along[0] < from[0] / 9.0 {
            true => Sight::Blocked,
            false => Sight::Open,
        },
    );
    let grid = visibility.grid.clone();
    let read = |bytes: &[u8], key| Visibility::from_bytes(bytes, key, grid.clone(), RAYS, 1);
    let bytes = visibility.to_bytes(7);
    assert_eq!(bytes.len(), Visibility::file_bytes(&grid, RAYS));
    assert_eq!(read(&bytes, 7), Ok(visibility));
    assert!(read(&bytes, 8).is_err_and(|text| text.contains("another scene")));
    assert!(read(&bytes[..bytes.len() - 8], 7).is_err_and(|text| text.contains("in place of")));
    for place in [0, 9, 40, bytes.len() - 1] {
        let mut broken = bytes.clone();
        broken[place] ^= 4;
        let told = read(&broken, 7);
        assert!(told.is_err_and(|text| text.contains("hash")), "{place}");
    }
}

#[test]
fn keys_follow_what_the_cells_see() {
    let ground = height_grid(&scene(LIGHT).terrain, &Default::default()).expect("flat");
    let light = scene(LIGHT).light.expect("the key");
    let grid = LightGrid::new(&light, &ground);
    let key = Visibility::key(&grid, 256, 1, 5);
    assert_eq!(Visibility::key(&grid, 256, 1, 5), key);
    let mut finer = light;
    finer.slices += 1;
    let finer = LightGrid::new(&finer, &ground);
    for other in [
        Visibility::key(&grid, 255, 1, 5),
        Visibility::key(&grid, 256, 2, 5),
        Visibility::key(&grid, 256, 1, 6),
        Visibility::key(&finer, 256, 1, 5),
    ] {
        assert_ne!(other, key);
    }
}

#[test]
fn more_slices_than_layers_are_refused_with_key_value_and_limit() {
    assert!(check_layers(85, 256).is_ok());
    let error = check_layers(86, 256).expect_err("258 layers");
    assert!(matches!(error, RenderError::LightLayers { most: 85, .. }));
    let text = error.to_string();
    for word in [
        "light.slices is 86",
        "258 layers",
        "at most 256",
        "85 or less",
    ] {
        assert!(text.contains(word), "{text}");
    }
}
