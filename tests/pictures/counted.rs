//! The device's lists of plants against the same choices made on the processor.

use std::collections::BTreeMap;

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::field::count::{Bins, CountView, by_projected_area, by_world_area, rounding, shown};
use sward::field::{Field, TileId};
use sward::gpu::{Gpu, PassTimer};
use sward::render::{BladeDetail, BladesInput, Count, Exposure, FrameInput, Submission, Sun, View};
use sward::scene::Form;

use super::{SIZE, Stage, hold};

/// Two kinds on lush and dry ground, and stones on what is drier.
pub const KINDS: &str =
    "(terrain: (ground: Rolling(size_m: (7, 6), amplitude_m: 0.3, wavelength_m: 4)),
    grass: (density_per_m2: 90, cluster: 2, species: [
        (name: \"a\", likes: Some((hsv: (88, 0.5, 0.45)))),
        (name: \"b\", form: Leaf, likes: Some((hsv: (75, 0.43, 0.5)))),
        (name: \"c\", form: Gravel, response: Stays, likes: Some((hsv: (55, 0.36, 0.54))))]))";
/// From where the whole field is in the picture, and nothing is near the end of sight.
const EYE_M: [f64; 3] = [0.0, 11.0, 9.0];
/// Plants smaller than this share of their size are left out.
const LEAST_SHOWN: f32 = 0.005;

/// Corners of a seeding triangle from the eye: the right angle, then the ends of the legs.
fn corners(field: &Field, cell: [u32; 2], half: u32, eye: Vec3<f64>) -> [Vec3<f32>; 3] {
    let even = (cell[0] + cell[1]).is_multiple_of(2);
    let at_end = [even != (half == 1), half == 1];
    let corner = |flips: [bool; 2]| {
        let [x, z] = [0, 1].map(|a| {
            let whole = cell[a] + u32::from(at_end[a] != flips[a]);
            let low = field.ground.corner_in_world()[a];
            low + f64::from(whole) * f64::from(field.grid.cell_m)
        });
        let y = field.ground.height_in_world(x, z);
        Vec3::of_f32((Vec3::new(x, y, z) - eye).to_f32())
    };
    [[false, false], [true, false], [false, true]].map(corner)
}

/// Plants and companions of each form that a rule draws, and what the equation expects of all
/// triangles together.
fn expected(field: &Field, view: &View, detail: BladeDetail) -> (BTreeMap<&'static str, u64>, f64) {
    let grid = &field.grid;
    let count_view = CountView {
        right: Vec3::of_f32(view.right().to_f32()),
        up: Vec3::of_f32(view.up().to_f32()),
        forward: Vec3::of_f32(view.forward.to_f32()),
        pixel_rad: view.pixel_rad(SIZE[1]),
    };
    let most = (grid.plants_per_triangle() * detail.tuft) as f32 * detail.density;
    let (mut plants, mut mean) = (BTreeMap::new(), 0.0);
    let mut add = |tile: TileId, rank: u32| {
        let place = rank % grid.plants_per_tile();
        let seed = grid.seed_place(tile, place);
        let count = match detail.count {
            Count::Distance => most,
            Count::ProjectedArea { per_px } => {
                let corners = corners(field, seed.cell, seed.half, view.eye_in_world);
                by_projected_area(corners, &count_view, per_px * detail.density, most)
            }
            Count::WorldArea { per_px } => {
                let corners = corners(field, seed.cell, seed.half, view.eye_in_world);
                by_world_area(corners, &count_view, per_px * detail.density, most)
            }
        };
        let count = match detail.submission {
            Submission::Exact => count,
            Submission::Bins => Bins::up_to(most).binned(count),
        };
        let index = rank / grid.triangles_per_tile();
        if index == 0 {
            mean += f64::from(count);
        }
        let part = rounding(&field.seeds, grid.triangle(&seed));
        if shown(count, part, index) < LEAST_SHOWN {
            return;
        }
        let anchor = grid.anchor_of(tile, &field.ground);
        let Some(plant) = field.plant(&anchor, tile, place) else {
            return;
        };
        let form = field.seeds.species[plant.species as usize].form;
        let name = match form {
            Form::Blade => "blades.wgsl",
            Form::Leaf => "leaves.wgsl",
            _ => "gravel.wgsl",
        };
        if form == Form::Blade || rank < grid.plants_per_tile() {
            *plants.entry(name).or_insert(0) += 1;
        }
    };
    for tile in 0..grid.tile_count() {
        let copies = (detail.tuft as f32 * detail.density).ceil() as u32;
        for rank in 0..grid.plants_per_tile() * copies {
            add(tile, rank);
        }
    }
    (plants, mean)
}

/// Draws the field's plants at rest.
pub fn draw(gpu: &Gpu, stage: &mut Stage, view: &View, detail: BladeDetail) -> Result<(), Failed> {
    let input = FrameInput {
        view,
        sun: Sun::default(),
        exposure: Exposure::default(),
        bodies: &[],
        blades: Some(BladesInput {
            field: &stage.meadow.field,
            wind: &stage.meadow.work.wind,
            active: &[],
            active_nodes: &stage.nodes.nodes,
            billboards: None,
            detail,
        }),
        marks: &[],
        time_s: 0.0,
    };
    let mut timer = PassTimer::new(gpu, 8);
    let target = &stage.target.view;
    Ok(stage.renderer.draw(gpu, &input, target, &mut timer)?)
}

fn drawn(
    gpu: &Gpu,
    stage: &mut Stage,
    view: &View,
    detail: BladeDetail,
) -> Result<BTreeMap<&'static str, u64>, Failed> {
    draw(gpu, stage, view, detail)?;
    let counts = stage.renderer.drawn_plants(gpu)?;
    let some = counts.iter().filter(|one| one.plants > 0);
    Ok(some.map(|one| (one.form, one.plants)).collect())
}

/// As many plants as a rule draws are in their form's list. Counts of triangles follow
/// from areas in single precision, which may round one in some thousands another way.
pub fn plants_are_sorted_by_form(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, KINDS, 0)?;
    let eye = Vec3::of(EYE_M);
    let view = View::look_at(eye, Vec3::ZERO, 60.0);
    for submission in [Submission::Exact, Submission::Bins] {
        for count in [
            Count::Distance,
            Count::ProjectedArea { per_px: 1.5 },
            Count::WorldArea { per_px: 1.5 },
        ] {
            let detail = BladeDetail {
                full_m: 40.0,
                reach_m: 60.0,
                tuft: 2,
                count,
                submission,
                ..BladeDetail::default()
            };
            let (want, _) = expected(&stage.meadow.field, &view, detail);
            let got = drawn(gpu, &mut stage, &view, detail)?;
            println!("{submission:?}, {count:?}: {got:?}");
            compare(&got, &want, count).map_err(|text| format!("{submission:?}, {text}"))?;
        }
    }
    Ok(())
}

/// Every rule draws as many times the plants as the density says.
pub fn density_is_a_factor_of_the_prefix(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, KINDS, 0)?;
    let view = View::look_at(Vec3::of(EYE_M), Vec3::ZERO, 60.0);
    for count in [Count::Distance, Count::ProjectedArea { per_px: 4.0 }] {
        for density in [0.4, 0.7, 1.5] {
            let detail = BladeDetail {
                full_m: 40.0,
                reach_m: 60.0,
                tuft: 2,
                count,
                density,
                ..BladeDetail::default()
            };
            let (want, _) = expected(&stage.meadow.field, &view, detail);
            let got = drawn(gpu, &mut stage, &view, detail)?;
            println!("{density} times, {count:?}: {got:?}");
            compare(&got, &want, count).map_err(|text| format!("{density} times, {text}"))?;
        }
    }
    Ok(())
}

fn compare(
    got: &BTreeMap<&'static str, u64>,
    want: &BTreeMap<&'static str, u64>,
    count: Count,
) -> Result<(), String> {
    if want.len() != 3 || !got.keys().eq(want.keys()) {
        return Err(format!("{count:?}: {got:?} for {want:?}"));
    }
    for (form, &plants) in want {
        let off = got[form].abs_diff(plants);
        let few = match count {
            Count::Distance => 0,
            _ => 1 + plants / 1000,
        };
        if off > few || plants <= 100 {
            return Err(format!("{count:?}, {form}: {} for {plants}", got[form]));
        }
    }
    Ok(())
}

/// Eq. 1 and 2: the plants drawn of one kind are as many as the equations say, within 2%.
pub fn density_follows_the_equations(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(
        gpu,
        "(terrain: (ground: Rolling(size_m: (14, 14), amplitude_m: 0.3, wavelength_m: 5)),
          grass: (density_per_m2: 250))",
        0,
    )?;
    for eye in [[0.0, 16.0, 14.0], [3.0, 21.0, -11.0]] {
        let view = View::look_at(Vec3::of(eye), Vec3::ZERO, 60.0);
        for per_px in [1.0, 3.0] {
            for count in [Count::ProjectedArea { per_px }, Count::WorldArea { per_px }] {
                let detail = BladeDetail {
                    full_m: 40.0,
                    reach_m: 60.0,
                    tuft: 1,
                    count,
                    ..BladeDetail::default()
                };
                let (_, mean) = expected(&stage.meadow.field, &view, detail);
                let got = drawn(gpu, &mut stage, &view, detail)?;
                let plants: u64 = got.values().sum();
                let off = plants as f64 / mean - 1.0;
                println!(
                    "{count:?}: {plants} plants for {mean:.0}, {:+.2}%",
                    100.0 * off
                );
                hold(
                    plants > 1000 && off.abs() < 0.02,
                    format!("{count:?}: {plants} plants for {mean}"),
                )?;
            }
        }
    }
    Ok(())
}
