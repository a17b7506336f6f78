//! The library in another program: on its own device, and in its own tests.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]

use sward::gpu::Gpu;
use sward::render::{Picture, PictureTarget};
use sward::run::{CheckError, EngineChoice, Stage, check_scene};
use sward::scene::{Likes, parse_scene};

/// A ball is pressed into the grass in calm air, and taken away.
const PRESSED: &str = r#"(
    terrain: (ground: Flat(size_m: (4, 4))),
    wind: (strength: 0, gust: 0, flutter: 0),
    bodies: [(name: "ball", shape: Ball(radius_m: 0.3), position_m: (0, 0.25, 0), motion: Fixed)],
    script: [(at_s: 0.3, action: Remove(body: "ball"))],
    cameras: [(name: "above", eye_m: (0, 3, 0.6), target_m: (0, 0, 0))],
)"#;
/// The same without a ball.
const UNTOUCHED: &str = r#"(
    terrain: (ground: Flat(size_m: (4, 4))),
    wind: (strength: 0, gust: 0, flutter: 0),
    cameras: [(name: "above", eye_m: (0, 3, 0.6), target_m: (0, 0, 0))],
)"#;
const SIZE: [u32; 2] = [192, 128];

/// A device made without sward; `None` where there is no adapter.
fn own_device() -> Option<Gpu> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default())).ok()?;
    let (device, queue) =
        pollster::block_on(adapter.request_device(&Default::default())).expect("a device");
    Some(Gpu::from_parts(&adapter.get_info(), device, queue))
}

fn picture(gpu: &Gpu, text: &str, engine: EngineChoice) -> Picture {
    let scene = parse_scene("embedded", text, &[]).expect("a sound scene");
    let target = PictureTarget::new(gpu, SIZE).expect("a small picture");
    let mut stage =
        Stage::new(gpu, &scene, engine, PictureTarget::FORMAT, SIZE).expect("a small scene");
    for _ in 0..40 {
        stage.tick().expect("a sub-step");
    }
    let view = stage.camera(Some("above")).expect("a camera");
    stage
        .draw(gpu, &view, &target.view, false)
        .expect("a picture");
    target.read(gpu).expect("pixels")
}

/// Share of the pixels that differ, within a range of columns.
fn changed(a: &Picture, b: &Picture, columns: std::ops::Range<u32>) -> f64 {
    let texels = |picture: &Picture| -> Vec<[u8; 4]> {
        let all = picture.rgba8.chunks_exact(4).enumerate();
        all.filter(|(at, _)| columns.contains(&(*at as u32 % SIZE[0])))
            .map(|(_, texel)| [texel[0], texel[1], texel[2], texel[3]])
            .collect()
    };
    let (a, b) = (texels(a), texels(b));
    let differing = a.iter().zip(&b).filter(|(a, b)| a != b).count();
    differing as f64 / a.len() as f64
}

#[test]
fn a_picture_on_a_foreign_device_shows_where_a_body_pressed() {
    let Some(gpu) = own_device() else {
        let required = std::env::var_os("SWARD_REQUIRE_GPU").is_some_and(|value| value == "1");
        assert!(!required, "SWARD_REQUIRE_GPU=1, but there is no adapter");
        eprintln!("skipped: there is no graphics adapter");
        return;
    };
    for engine in [EngineChoice::Cpu, EngineChoice::Gpu] {
        let pressed = picture(&gpu, PRESSED, engine);
        let untouched = picture(&gpu, UNTOUCHED, engine);
        // The ball pressed 0.3 m about the middle of a picture that is 3.7 m wide.
        let middle = changed(&pressed, &untouched, 84..108);
        assert!(middle > 0.05, "{engine:?}: {middle} of the middle changed");
        // Grass that no body came near is drawn as before, pixel by pixel.
        assert_eq!(changed(&pressed, &untouched, 0..24), 0.0, "{engine:?}");
        assert_eq!(changed(&pressed, &untouched, 168..192), 0.0, "{engine:?}");
    }
}

#[test]
fn a_scene_is_a_test() -> Result<(), CheckError> {
    check_scene(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/ball_drop.ron"))?;
    Ok(())
}

/// Two kinds by the ground's colour, of which a ball presses some.
const COLOURED: &str = r#"(
    terrain: (ground: Rolling(size_m: (4, 4), amplitude_m: 0.1, wavelength_m: 3)),
    wind: (strength: 0, gust: 0, flutter: 0),
    grass: (species: [
        (name: "grass", likes: (hsv: (88, 0.5, 0.45))),
        (name: "leaves", form: Leaf, likes: (hsv: (55, 0.36, 0.54))),
    ]),
    bodies: [(name: "ball", shape: Ball(radius_m: 0.3), position_m: (0, 0.25, 0), motion: Fixed)],
    cameras: [(name: "above", eye_m: (0, 3, 0.6), target_m: (0, 0, 0))],
)"#;

fn stage_of(gpu: &Gpu, text: &str, engine: EngineChoice) -> Stage {
    let scene = parse_scene("embedded", text, &[]).expect("a sound scene");
    Stage::new(gpu, &scene, engine, PictureTarget::FORMAT, SIZE).expect("a small scene")
}

/// The kind of every seed; `None` on bare ground.
fn kinds(stage: &Stage) -> Vec<Option<u32>> {
    let field = &stage.meadow().field;
    let of_tile = |tile| {
        let anchor = field.grid.anchor_of(tile, &field.ground);
        let places = 0..field.grid.plants_per_tile();
        places.map(move |place| field.plant(&anchor, tile, place).map(|plant| plant.species))
    };
    (0..field.grid.tile_count()).flat_map(of_tile).collect()
}

fn shoot(gpu: &Gpu, stage: &mut Stage) -> Picture {
    let target = PictureTarget::new(gpu, SIZE).expect("a small picture");
    let view = stage.camera(Some("above")).expect("a camera");
    (stage.draw(gpu, &view, &target.view, false)).expect("a picture");
    target.read(gpu).expect("pixels")
}

/// With another reference colour every seed is of the kind that it has in a scene laid out with that
/// colour, on the processor and in the device's picture. Bent plants come to rest, and are pushed anew.
#[test]
fn a_meadow_recoloured_while_it_runs_is_that_of_a_fresh_scene() {
    let Some(gpu) = own_device() else {
        let required = std::env::var_os("SWARD_REQUIRE_GPU").is_some_and(|value| value == "1");
        assert!(!required, "SWARD_REQUIRE_GPU=1, but there is no adapter");
        eprintln!("skipped: there is no graphics adapter");
        return;
    };
    let ends = [EngineChoice::Cpu, EngineChoice::Gpu].map(|engine| {
        let mut stage = stage_of(&gpu, COLOURED, engine);
        let before = kinds(&stage);
        for _ in 0..20 {
            stage.tick().expect("a sub-step");
        }
        assert!(
            !stage.meadow().tiles.is_empty(),
            "{engine:?}: no tile is awake"
        );
        let likes = Likes {
            hsv: [60.0, 0.4, 0.5],
            ..Likes::default()
        };
        (stage.set_likes(&gpu, 0, likes)).expect("a colour within its range");
        assert!(stage.meadow().tiles.is_empty(), "{engine:?}");
        let text = COLOURED.replace("(88, 0.5, 0.45)", "(60, 0.4, 0.5)");
        let mut fresh = stage_of(&gpu, &text, engine);
        assert!(kinds(&stage) == kinds(&fresh), "{engine:?}: other kinds");
        assert!(kinds(&stage) != before, "{engine:?}: nothing has changed");
        let [now, wanted] = [&mut stage, &mut fresh].map(|stage| shoot(&gpu, stage));
        assert_eq!(changed(&now, &wanted, 0..SIZE[0]), 0.0, "{engine:?}");
        for _ in 0..20 {
            stage.tick().expect("a sub-step");
        }
        assert!(!stage.meadow().tiles.is_empty(), "{engine:?}: no tile woke");
        let pressed = shoot(&gpu, &mut stage);
        assert!(changed(&pressed, &now, 0..SIZE[0]) > 0.0, "{engine:?}");
        pressed
    });
    // The engines' poses may differ by 0.1 mm, which is less than a hundredth of a pixel here.
    let apart = changed(&ends[0], &ends[1], 0..SIZE[0]);
    assert!(apart < 0.01, "{apart} of the pixels differ between engines");
}

#[test]
fn colours_that_cannot_be_liked_are_refused() {
    let Some(gpu) = own_device() else {
        return;
    };
    let mut stage = stage_of(&gpu, COLOURED, EngineChoice::Cpu);
    let before = kinds(&stage);
    let outside = Likes {
        hsv: [60.0, 1.5, 0.5],
        ..Likes::default()
    };
    let error = stage
        .set_likes(&gpu, 1, outside)
        .expect_err("saturation 1.5");
    assert!(error.to_string().contains("hsv"), "{error}");
    let error = stage.set_likes(&gpu, 2, Likes::default());
    let error = error.expect_err("two kinds").to_string();
    assert!(error.contains("the scene has 2"), "{error}");
    assert!(kinds(&stage) == before);
    let mut alike = stage_of(&gpu, UNTOUCHED, EngineChoice::Cpu);
    let error = alike.set_likes(&gpu, 0, Likes::default());
    let error = error.expect_err("no likes").to_string();
    assert!(error.contains("have no `likes`"), "{error}");
}
