//! Laws of pictures: what hides what, what casts a shadow, what the same input gives. Trials need a
//! graphics adapter: without one they are ignored, and with `SWARD_REQUIRE_GPU=1` the missing
//! adapter fails.

use std::sync::Arc;

use libtest_mimic::{Arguments, Failed, Trial};
use sward::base::Vec3;
use sward::gpu::{Gpu, PassTimer};
use sward::render::{
    ActiveBillboards, ActiveNodes, BladeDetail, BladesInput, Exposure, FrameInput, GroundLook,
    Picture, PictureTarget, Renderer, Sun, View, bodies_at,
};
use sward::scene::Scene;
use sward::sim::{Grass, Meadow, tick};
use sward::terrain::ColourMap;

#[path = "pictures/canopy.rs"]
mod canopy;
#[path = "pictures/clumps.rs"]
mod clumps;
#[path = "pictures/coats.rs"]
mod coats;
#[path = "pictures/counted.rs"]
mod counted;
#[path = "pictures/engines.rs"]
mod engines;
#[path = "pictures/ground.rs"]
mod ground;
#[path = "pictures/identity.rs"]
mod identity;
#[path = "pictures/light.rs"]
mod light;
#[path = "pictures/refined.rs"]
mod refined;
#[path = "pictures/refused.rs"]
mod refused;
#[path = "pictures/stones.rs"]
mod stones;
#[path = "pictures/waking.rs"]
mod waking;

type Check = fn(&Gpu) -> Result<(), Failed>;

const CHECKS: &[(&str, Check)] = &[
    (
        "the_same_frame_is_the_same_picture",
        the_same_frame_is_the_same_picture,
    ),
    ("blades_hide_the_ground", blades_hide_the_ground),
    ("a_body_hides_and_shades", a_body_hides_and_shades),
    ("waking_changes_no_pixel", waking::waking_changes_no_pixel),
    ("plants_cast_shadows", plants_cast_shadows),
    ("pressed_grass_shows", pressed_grass_shows),
    (
        "a_coarser_ground_looks_like_the_full_one",
        ground::a_coarser_ground_looks_like_the_full_one,
    ),
    (
        "ground_far_off_looks_like_its_plants",
        canopy::ground_far_off_looks_like_its_plants,
    ),
    (
        "plants_are_sorted_by_form",
        counted::plants_are_sorted_by_form,
    ),
    (
        "plants_are_the_same_on_a_camera_path",
        identity::plants_are_the_same_on_a_camera_path,
    ),
    ("cameras_change_no_state", identity::cameras_change_no_state),
    (
        "density_follows_the_equations",
        counted::density_follows_the_equations,
    ),
    (
        "density_is_a_factor_of_the_prefix",
        counted::density_is_a_factor_of_the_prefix,
    ),
    ("clumps_are_drawn", clumps::clumps_are_drawn),
    ("no_clumps_cost_nothing", clumps::no_clumps_cost_nothing),
    ("waking_changes_no_clump", refined::waking_changes_no_clump),
    (
        "a_clump_that_is_back_is_its_quad",
        refined::a_clump_that_is_back_is_its_quad,
    ),
    (
        "refined_forms_in_the_wind_are_quads",
        refined::refined_forms_in_the_wind_are_quads,
    ),
    ("measure_forms_of_clumps", refined::forms_are_timed),
    ("both_engines_draw_alike", engines::both_engines_draw_alike),
    (
        "sixty_thousand_clumps_fit",
        engines::sixty_thousand_clumps_fit,
    ),
    ("pressed_clumps_show", refined::pressed_clumps_show),
    (
        "hidden_clumps_change_nothing",
        refined::hidden_clumps_change_nothing,
    ),
    ("coats_grow_outwards", coats::coats_grow_outwards),
    ("coats_grow_on_faces", coats::coats_grow_on_faces),
    ("no_coats_cost_nothing", coats::no_coats_cost_nothing),
    (
        "light_volumes_darken_what_sees_less_sky",
        light::light_volumes_darken_what_sees_less_sky,
    ),
    (
        "no_light_volumes_cost_nothing",
        light::no_light_volumes_cost_nothing,
    ),
    (
        "both_sides_of_clumps_are_lit",
        light::both_sides_of_clumps_are_lit,
    ),
    (
        "too_many_slices_are_refused",
        light::too_many_slices_are_refused,
    ),
    ("stones_go_back", stones::stones_go_back),
    ("stones_lie_where_shoved", stones::stones_lie_where_shoved),
    (
        "what_cannot_be_drawn_is_refused",
        refused::what_cannot_be_drawn_is_refused,
    ),
];

/// Goldens and laws alike keep to small pictures: the software rasteriser pays per pixel.
const SIZE: [u32; 2] = [192, 128];

/// A scene with a ball that rests on the ground at the origin, after some ticks.
struct Stage {
    meadow: Meadow,
    nodes: ActiveNodes,
    billboards: ActiveBillboards,
    renderer: Renderer,
    target: PictureTarget,
    /// Milliseconds of the last picture's passes.
    pass_ms: Vec<(&'static str, f64)>,
}

impl Stage {
    fn new(gpu: &Gpu, scene: &str, ticks: u32) -> Result<Self, Failed> {
        let scene: Scene = ron::from_str(scene)?;
        let mut meadow = Meadow::new(scene, &Default::default())?;
        let mut grass = Grass::<f32>::new();
        for _ in 0..ticks {
            tick(&mut meadow, &mut grass)?;
        }
        let mut nodes = ActiveNodes::new(gpu)?;
        nodes.copy(gpu, &meadow, &grass)?;
        let mut billboards = ActiveBillboards::new(gpu)?;
        billboards.copy(gpu, &meadow, &grass)?;
        let renderer = Renderer::new(gpu, PictureTarget::FORMAT, SIZE)?;
        let mut stage = Self {
            meadow,
            nodes,
            billboards,
            renderer,
            target: PictureTarget::new(gpu, SIZE)?,
            pass_ms: Vec::new(),
        };
        stage.show(gpu)?;
        Ok(stage)
    }

    /// Gives the renderer this stage's scene.
    fn show(&mut self, gpu: &Gpu) -> Result<(), Failed> {
        let terrain = &self.meadow.scene.terrain;
        let field = &self.meadow.field;
        let look = GroundLook {
            map: &ColourMap::of_patches(terrain, &field.ground),
            soil_rgb: terrain.soil_rgb,
        };
        let bodies = &self.meadow.bodies;
        let (shapes, coats) = (bodies.shapes(), bodies.coated());
        Ok(self.renderer.set_scene(gpu, field, &look, shapes, coats)?)
    }

    fn shoot(&mut self, gpu: &Gpu, shown: Shown) -> Result<Picture, Failed> {
        let bodies = bodies_at(&self.meadow, 1.0);
        let active = &self.nodes.tiles[..];
        let input = FrameInput {
            view: &shown.view,
            sun: shown.sun,
            exposure: Exposure::default(),
            bodies: if shown.bodies { &bodies } else { &[] },
            blades: shown.blades.then_some(BladesInput {
                field: &self.meadow.field,
                wind: &self.meadow.work.wind,
                active: if shown.active { active } else { &[] },
                active_nodes: &self.nodes.nodes,
                billboards: shown.active.then(|| self.billboards.drawn()),
                detail: BladeDetail {
                    full_m: shown.full_m,
                    reach_m: shown.reach_m,
                    tuft: shown.tuft,
                    shadows: shown.shadows,
                    drops_hidden: shown.drops_hidden,
                    ..BladeDetail::default()
                },
            }),
            marks: &[],
            time_s: 0.0,
        };
        let mut timer = PassTimer::new(gpu, 8);
        self.renderer
            .draw(gpu, &input, &self.target.view, &mut timer)?;
        gpu.wait()?;
        timer.collect(gpu);
        self.pass_ms = timer.medians_ms();
        Ok(self.target.read(gpu)?)
    }
}

/// What a picture shows.
#[derive(Clone, Copy)]
struct Shown {
    view: View,
    bodies: bool,
    blades: bool,
    /// Take the plants of active tiles from their nodes.
    active: bool,
    sun: Sun,
    full_m: f32,
    reach_m: f32,
    tuft: u32,
    shadows: bool,
    drops_hidden: bool,
}

const ALL: Shown = Shown {
    view: View {
        eye_in_world: Vec3 {
            x: 0.0,
            y: 2.0,
            z: 3.0,
        },
        forward: Vec3 {
            x: 0.0,
            y: -0.5547,
            z: -0.83205,
        },
        fov_rad: 0.8,
    },
    bodies: true,
    blades: true,
    active: true,
    sun: Sun {
        elevation_deg: 34.0,
        azimuth_deg: 215.0,
    },
    // So far that everything in these pictures is drawn in full.
    full_m: 12.0,
    reach_m: 40.0,
    tuft: 1,
    shadows: true,
    drops_hidden: true,
};

const BALL: &str = "(bodies: [(name: \"ball\", shape: Ball(radius_m: 0.4), \
    position_m: (0.0, 0.4, 0.0), rgb: (0.8, 0.05, 0.05))])";

/// Mean red, green and blue of a rectangle, as shares of the picture's sides.
fn mean(picture: &Picture, [left, top, right, bottom]: [f64; 4]) -> [f64; 3] {
    let at = |share: f64, side: u32| (share * f64::from(side)) as usize;
    let (width, height) = (picture.width, picture.height);
    let mut sum = [0.0; 3];
    let mut count = 0.0;
    for y in at(top, height)..at(bottom, height) {
        for x in at(left, width)..at(right, width) {
            let texel = &picture.rgba8[(y * width as usize + x) * 4..][..3];
            for (total, &byte) in sum.iter_mut().zip(texel) {
                *total += f64::from(byte);
            }
            count += 1.0;
        }
    }
    sum.map(|total| total / count)
}

/// Root mean square difference of two pictures in a rectangle, in steps of 8 bits.
fn difference(a: &Picture, b: &Picture, [left, top, right, bottom]: [f64; 4]) -> f64 {
    let at = |share: f64, side: u32| (share * f64::from(side)) as usize;
    let columns = at(left, a.width) * 4..at(right, a.width) * 4;
    let (mut sum, mut count) = (0.0, 0.0);
    for y in at(top, a.height)..at(bottom, a.height) {
        let row = y * a.width as usize * 4;
        for x in columns.clone() {
            let apart = f64::from(a.rgba8[row + x]) - f64::from(b.rgba8[row + x]);
            sum += apart * apart;
            count += 1.0;
        }
    }
    f64::sqrt(sum / count)
}

const WHOLE: [f64; 4] = [0.0, 0.0, 1.0, 1.0];

fn hold(condition: bool, what: impl Into<String>) -> Result<(), Failed> {
    if condition {
        Ok(())
    } else {
        Err(what.into().into())
    }
}

fn the_same_frame_is_the_same_picture(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, BALL, 3)?;
    let first = stage.shoot(gpu, ALL)?;
    let second = stage.shoot(gpu, ALL)?;
    hold(first == second, "two pictures of one frame differ")
}

fn blades_hide_the_ground(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, "()", 0)?;
    let with = stage.shoot(gpu, ALL)?;
    let counts = stage.renderer.blade_counts();
    hold(counts.blades > 1000, format!("{counts:?}"))?;
    let without = stage.shoot(
        gpu,
        Shown {
            blades: false,
            ..ALL
        },
    )?;
    hold(
        stage.renderer.blade_counts().blades == 0,
        "blades are counted that were left out",
    )?;
    let changed = difference(&with, &without, WHOLE);
    hold(changed > 5.0, format!("blades change {changed} steps"))?;
    // Level, the upper half is sky, and no blade reaches up to the eye.
    let mut level = ALL;
    level.view.forward = Vec3::new(0.0, 0.0, -1.0);
    let with = stage.shoot(gpu, level)?;
    level.blades = false;
    let without = stage.shoot(gpu, level)?;
    let sky = [0.0, 0.0, 1.0, 0.4];
    let changed = difference(&with, &without, sky);
    hold(
        changed == 0.0,
        format!("blades change the sky by {changed}"),
    )
}

fn a_body_hides_and_shades(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, BALL, 0)?;
    let bare = Shown {
        blades: false,
        ..ALL
    };
    let with = stage.shoot(gpu, bare)?;
    let without = stage.shoot(
        gpu,
        Shown {
            bodies: false,
            ..bare
        },
    )?;
    // Looking at the origin from (0, 2, 3): the ball's middle, 0.4 m up, is a little above the
    // picture's.
    let ball = mean(&with, [0.46, 0.36, 0.54, 0.44]);
    hold(
        ball[0] > 1.2 * ball[1],
        format!("the red ball's middle is {ball:?}"),
    )?;
    // The sun stands at 215°, 34° high: the shadow of the ball's middle falls 0.4 / tan 34° =
    // 0.59 m away, at (0.49, 0.34).
    let view = bare.view;
    let clip = view.clip_from_eye(1.5)
        * glam::Vec3::from(view.from_eye(Vec3::new(0.49, 0.0, 0.34))).extend(1.0);
    let (x, y) = (
        f64::from(0.5 + 0.5 * clip.x / clip.w),
        f64::from(0.5 - 0.5 * clip.y / clip.w),
    );
    let spot = [x - 0.02, y - 0.02, x + 0.02, y + 0.02];
    let (shaded, lit) = (mean(&with, spot), mean(&without, spot));
    hold(
        shaded[1] < 0.75 * lit[1],
        format!("ground in the shadow {shaded:?}, without the ball {lit:?}"),
    )
}

/// Shadows of plants darken ground and what lies behind them, lighten nothing, fall away from the sun
/// and end where it is too low.
fn plants_cast_shadows(gpu: &Gpu) -> Result<(), Failed> {
    let scene = "(terrain: (ground: Flat(size_m: (6, 6))), grass: (density_per_m2: 3, \
        species: [(height_m: (0.3, 0.4), width_m: (0.02, 0.03), stiffness: (4000, 5000), \
        lean_deg: (2, 3))]))";
    let mut stage = Stage::new(gpu, scene, 0)?;
    let mut darker = |sun: Sun| -> Result<(f64, f64), Failed> {
        let lit = |shadows: bool| Shown {
            sun,
            shadows,
            ..ALL
        };
        let with = stage.shoot(gpu, lit(true))?;
        let without = stage.shoot(gpu, lit(false))?;
        let changes = with.rgba8.iter().zip(&without.rgba8);
        let changes = changes.map(|(&a, &b)| f64::from(b) - f64::from(a));
        let least = changes.clone().fold(0.0, f64::min);
        Ok((changes.sum::<f64>() / with.rgba8.len() as f64, least))
    };
    let [high, slant, low] = [80.0, 34.0, 2.0].map(|elevation_deg| {
        darker(Sun {
            elevation_deg,
            ..ALL.sun
        })
    });
    let ((high, high_least), (slant, slant_least), (low, low_least)) = (high?, slant?, low?);
    println!(
        "darker by {high:.3} steps with the sun at 80 degrees, {slant:.3} at 34, {low:.3} at 2"
    );
    // A high sun's shadows are short.
    hold(
        low == 0.0 && high > 0.02 && slant > 2.0 * high,
        format!("{high} {slant} {low}"),
    )?;
    let least = high_least.min(slant_least).min(low_least);
    hold(least >= -1.0, format!("a shadow lightens by {least}"))
}

fn pressed_grass_shows(gpu: &Gpu) -> Result<(), Failed> {
    let scene = "(bodies: [(name: \"ball\", shape: Ball(radius_m: 0.4), \
        position_m: (0.0, 0.3, 0.0), motion: Fixed)])";
    let mut stage = Stage::new(gpu, scene, 3)?;
    let hidden = Shown {
        bodies: false,
        ..ALL
    };
    let pressed = stage.shoot(gpu, hidden)?;
    let upright = stage.shoot(
        gpu,
        Shown {
            active: false,
            ..hidden
        },
    )?;
    // Grass within 0.4 m of the origin is pressed; more than 1.2 m away nothing has moved.
    let near = difference(&pressed, &upright, [0.4, 0.35, 0.6, 0.6]);
    let far = difference(&pressed, &upright, [0.0, 0.35, 0.15, 0.6]);
    hold(
        near > 10.0 && far < 0.01,
        format!("near the press {near} steps, far from it {far}"),
    )
}

fn main() {
    let arguments = Arguments::from_args();
    let required = std::env::var_os("SWARD_REQUIRE_GPU").is_some_and(|v| v == "1");
    let gpu = Arc::new(Gpu::headless());
    let missing = matches!(&*gpu, Err(sward::gpu::GpuError::NoAdapter { .. }));
    let trials = CHECKS
        .iter()
        .map(|&(name, check)| {
            let gpu = Arc::clone(&gpu);
            let run = move || match &*gpu {
                Ok(gpu) => check(gpu),
                Err(error) => Err(error.to_string().into()),
            };
            let is_asked_for = name.starts_with("measure_");
            Trial::test(name, run).with_ignored_flag(is_asked_for || (missing && !required))
        })
        .collect();
    libtest_mimic::run(&arguments, trials).exit();
}
