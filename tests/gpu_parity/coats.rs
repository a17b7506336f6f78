//! Coats: counts and places of their plants, as the device has them, against Rust.

use std::collections::BTreeMap;

use libtest_mimic::Failed;
use sward::base::{Pose, Vec3};
use sward::field::coat::{CoatRanges, CoatTriangle, coat_triangles, drawn_count, grown};
use sward::field::count::{CountView, places};
use sward::gpu::{Gpu, PassTimer};
use sward::render::{
    CoatDetail, DrawnCoats, Exposure, FrameInput, GroundLook, PictureTarget, PlacedPlant, Renderer,
    Sun, View, bodies_at,
};
use sward::scene::parse_scene;
use sward::sim::Meadow;
use sward::terrain::ColourMap;

use super::Device;
use super::compare::{Difference, ensure};

const SIZE: [u32; 2] = [192, 128];
const COATS: &str = r#"(
    grass: (density_per_m2: 20),
    bodies: [
        (name: "a", shape: Box(size_m: (1, 0.5, 0.8)), position_m: (-1, 0.6, 0), rotation_deg: (20, 30, 10),
         motion: Fixed, coat: (per_m2: 2000, seed: 7)),
        (name: "b", shape: Ball(radius_m: 0.4), position_m: (0.5, 0.6, 0), motion: Fixed),
        (name: "c", shape: Ball(radius_m: 0.4), position_m: (0.5, 0.5, 0.6), rotation_deg: (0, 70, 0),
         motion: Fixed, coat: (form: Blade, per_m2: 5000, lean_deg: (0, 80), seed: 8)),
        (name: "d", shape: Compound(parts: [(shape: Box(size_m: (0.3, 0.3, 0.3))),
         (shape: Capsule(radius_m: 0.1, length_m: 0.5), position_m: (0, 0.4, 0))]),
         position_m: (-0.2, 0.3, 0.9), motion: Fixed, coat: (per_m2: 900, seed: 9)),
    ],
)"#;

fn view() -> View {
    View::look_at(Vec3::new(0.3, 1.9, 3.4), Vec3::new(-0.1, 0.5, 0.0), 50.0)
}

fn meadow() -> Result<Meadow, Failed> {
    let loaded = parse_scene("coats", COATS, &[])?;
    Ok(Meadow::new(loaded.scene, &loaded.assets)?)
}

/// A frame of every body, and what it drew of the coats.
fn drawn(gpu: &Gpu, meadow: &Meadow, per_px: f32) -> Result<DrawnCoats, Failed> {
    let mut renderer = Renderer::new(gpu, PictureTarget::FORMAT, SIZE)?;
    let (terrain, bodies) = (&meadow.scene.terrain, &meadow.bodies);
    let look = GroundLook {
        map: &ColourMap::of_patches(terrain, &meadow.field.ground),
        soil_rgb: terrain.soil_rgb,
    };
    renderer.set_scene(gpu, &meadow.field, &look, bodies.shapes(), bodies.coated())?;
    renderer.coat_detail = CoatDetail { per_px };
    let input = FrameInput {
        view: &view(),
        sun: Sun::default(),
        exposure: Exposure::default(),
        bodies: &bodies_at(meadow, 1.0),
        blades: None,
        marks: &[],
        time_s: 0.0,
    };
    let target = PictureTarget::new(gpu, SIZE)?;
    renderer.draw(gpu, &input, &target.view, &mut PassTimer::new(gpu, 8))?;
    Ok(renderer.drawn_coats(gpu)?.unwrap_or_default())
}

/// A coated body as Rust has it.
struct Coated {
    ranges: CoatRanges,
    triangles: Vec<CoatTriangle>,
    eye_from_body: Pose<f32>,
}

fn coated(meadow: &Meadow) -> Vec<Coated> {
    let bodies = bodies_at(meadow, 1.0);
    let of_body = bodies.iter().filter_map(|body| {
        let one = meadow.bodies.coated()[body.coat? as usize];
        let mesh = &meadow.bodies.shapes()[one.shape as usize].mesh;
        let place = Vec3::of_f32(view().from_eye(body.world_from_body.place));
        Some(Coated {
            ranges: CoatRanges::new(&one.coat, meadow.field.seeds.rounds),
            triangles: coat_triangles(
                &mesh.positions,
                &mesh.normals,
                &mesh.indices,
                one.coat.per_m2,
            ),
            eye_from_body: Pose {
                turn: body.world_from_body.turn.cast(),
                place,
            },
        })
    });
    of_body.collect()
}

/// Body, triangle and index.
type Which = (u32, u32, u32);

fn by_which(drawn: &DrawnCoats) -> BTreeMap<Which, PlacedPlant> {
    let plants = drawn.plants.iter();
    plants
        .map(|plant| ((plant.body, plant.triangle, plant.index), *plant))
        .collect()
}

/// Counts of eq. 1: corners are up to 150 pixels from the middle, with some 8 roundings of 2⁻²⁴ each, so
/// 7e-5 px; times sides of up to 100 px, and 0.3 plants per pixel, that is 0.004 plants of a triangle.
/// Then, for the device's own counts, which plants are placed is equal. Roots: a turn and a sum of
/// lengths up to 4 m, 12 roundings of 2.4e-7 m. Directions: the sines' polynomial is within 2.5e-7 on
/// either side, four of them, and a dozen roundings of 6e-8. Heights as products of two such numbers.
/// A normal so near to where [`Vec3::across`] takes another axis that rounding decides is left out.
pub fn coats_are_equal(device: &Device) -> Result<(), Failed> {
    let meadow = meadow()?;
    let per_px = 0.3;
    let drawn = drawn(&device.gpu, &meadow, per_px)?;
    let view = view();
    let count_view = CountView {
        right: Vec3::of_f32(view.right().to_f32()),
        up: Vec3::of_f32(view.up().to_f32()),
        forward: Vec3::of_f32(view.forward.to_f32()),
        pixel_rad: view.pixel_rad(SIZE[1]),
    };
    let mut counts = Difference::new("counts of coats", "plants");
    let mut roots = Difference::new("roots of coats", "m");
    let mut ways = Difference::new("directions of coats", "");
    let mut heights = Difference::new("heights of coats", "m");
    let on_device = by_which(&drawn);
    ensure(on_device.len() == drawn.plants.len(), || {
        "a plant twice".into()
    })?;
    let mut found = drawn.counts.iter();
    let mut expected = 0;
    for (body, coated) in coated(&meadow).iter().enumerate() {
        for (t, on) in coated.triangles.iter().enumerate() {
            let Some(&count) = found.next() else {
                return Err("too few triangles on the device".into());
            };
            let want = drawn_count(on, coated.eye_from_body, &count_view, per_px, 1.0);
            counts.add(f64::from((count - want).abs()), || {
                format!("body {body} triangle {t}")
            });
            let rounding = coated.ranges.rounding(t as u32);
            for index in 0..places(count, rounding) {
                expected += 1;
                let place = || format!("body {body} triangle {t} plant {index}");
                let which = (body as u32, t as u32, index);
                let plant = on_device
                    .get(&which)
                    .ok_or_else(|| format!("no {}", place()))?;
                let twin = coated.ranges.plant(on, t as u32, index);
                ensure(plant.shade == twin.shade, || format!("{plant:?}\n{twin:?}"))?;
                let turn = coated.eye_from_body.turn;
                let apart = |a: [f32; 3], b: Vec3<f32>| f64::from((Vec3::of_f32(a) - b).length());
                let root = coated.eye_from_body.point(twin.root);
                roots.add(apart(plant.root_from_eye, root), place);
                if (twin.normal.x.abs() - 0.5).abs() > 1e-5 {
                    ways.add(apart(plant.direction, turn.rotate(twin.direction)), place);
                }
                ways.add(apart(plant.normal, turn.rotate(twin.normal)), place);
                let height_m = twin.height_m * grown(count, rounding, index).max(0.005);
                heights.add(f64::from((plant.height_m - height_m).abs()), place);
            }
        }
    }
    ensure(found.next().is_none(), || {
        "too many triangles on the device".into()
    })?;
    ensure(expected == drawn.plants.len(), || {
        format!("{expected} plants expected, {} drawn", drawn.plants.len())
    })?;
    counts.check(0.004)?;
    roots.check(3e-6)?;
    ways.check(2e-6)?;
    heights.check(1e-6)
}

/// Fewer plants per pixel are a prefix of more, and none moves: to the last bit.
pub fn fewer_plants_of_coats_stay(device: &Device) -> Result<(), Failed> {
    let meadow = meadow()?;
    let [few, many] = [0.05, 1.0].map(|per_px| drawn(&device.gpu, &meadow, per_px));
    let (few, many) = (by_which(&few?), by_which(&many?));
    ensure(few.len() > 100 && many.len() > 2 * few.len(), || {
        format!("{} and {} plants", few.len(), many.len())
    })?;
    for (which, plant) in &few {
        let same = many.get(which).is_some_and(|other| {
            other.root_from_eye == plant.root_from_eye
                && other.direction == plant.direction
                && other.shade == plant.shade
        });
        ensure(same, || format!("{plant:?} moves"))?;
    }
    Ok(())
}
