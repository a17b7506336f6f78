//! Plants are who they are, whatever the camera sees.

use std::collections::{BTreeMap, BTreeSet};

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::field::{Field, TileId};
use sward::gpu::Gpu;
use sward::render::{BladeDetail, Count, ListedPlant, PictureTarget, Transition, View};
use sward::run::{EngineChoice, Stage as Scene};
use sward::scene::{Form, parse_scene};

use super::counted::{KINDS, draw};
use super::{SIZE, Stage, hold};

/// Frames of the path: from above one side of the field to above another, always looking at its middle from
/// where all of it is in the picture.
const FRAMES: u32 = 30;

fn view_at(frame: u32) -> View {
    let share = f64::from(frame) / f64::from(FRAMES - 1);
    let eye = Vec3::new(9.0 * share, 11.0 - 2.0 * share, 9.0 - 5.0 * share);
    View::look_at(eye, Vec3::ZERO, 60.0)
}

/// The shader of the form that a seed has on the processor; `None` on bare ground.
fn form_of(field: &Field, tile: TileId, place: u32) -> Option<(u32, &'static str)> {
    let anchor = field.grid.anchor_of(tile, &field.ground);
    let kind = field.plant(&anchor, tile, place)?.species;
    let shader = match field.seeds.species[kind as usize].form {
        Form::Blade => "blades.wgsl",
        Form::Leaf => "leaves.wgsl",
        _ => "gravel.wgsl",
    };
    Some((kind, shader))
}

/// What is drawn of every triangle is the begin of its sequence: of the plants up to the last one that is
/// drawn none that grows is missing. Clusters are whole but for the last.
fn is_prefix(field: &Field, drawn: &[ListedPlant]) -> Result<usize, Failed> {
    let triangles = field.grid.triangles_per_tile();
    let listed: BTreeSet<(TileId, u32)> =
        drawn.iter().map(|plant| (plant.tile, plant.rank)).collect();
    hold(listed.len() == drawn.len(), "a plant is listed twice")?;
    let mut ends: BTreeMap<(TileId, u32), u32> = BTreeMap::new();
    for &(tile, rank) in &listed {
        let end = ends.entry((tile, rank % triangles)).or_default();
        *end = (*end).max(rank / triangles);
    }
    for (&(tile, within), &end) in &ends {
        for index in 0..end {
            let rank = index * triangles + within;
            let grows = form_of(field, tile, rank).is_some();
            hold(
                listed.contains(&(tile, rank)) == grows,
                format!("plant {index} of {end} on triangle {within} of tile {tile}"),
            )?;
        }
    }
    Ok(ends.len())
}

/// Over a path each frame draws a prefix of every triangle's plants, of the kinds that the processor says;
/// a plant that is drawn in two frames is of the same kind and thrives alike, to the bit. Where it stands
/// follows from its tile and number alone, and has the processor's bits (`gpu_parity`).
pub fn plants_are_the_same_on_a_camera_path(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, KINDS, 0)?;
    for (count, transition) in [
        (Count::Distance, Transition::Smooth),
        (Count::ProjectedArea { per_px: 0.2 }, Transition::Smooth),
        (Count::WorldArea { per_px: 0.2 }, Transition::Plain),
    ] {
        let detail = BladeDetail {
            full_m: 3.0,
            reach_m: 60.0,
            tuft: 1,
            count,
            transition,
            ..BladeDetail::default()
        };
        let mut known: BTreeMap<(TileId, u32), ListedPlant> = BTreeMap::new();
        let mut numbers = BTreeSet::new();
        for frame in 0..FRAMES {
            draw(gpu, &mut stage, &view_at(frame), detail)?;
            let drawn = stage.renderer.listed_plants(gpu)?;
            let field = &stage.meadow.field;
            let on = is_prefix(field, &drawn).map_err(|e| format!("{count:?}, {frame}: {e:?}"))?;
            hold(on > 100, format!("{on} triangles"))?;
            numbers.insert(drawn.len());
            for plant in drawn {
                let own = form_of(field, plant.tile, plant.rank);
                hold(
                    own == Some((plant.kind, plant.form)),
                    format!("{plant:?}: {own:?}"),
                )?;
                let before = known.insert((plant.tile, plant.rank), plant);
                hold(
                    before.is_none_or(|before| before == plant),
                    format!("{before:?} is {plant:?} in frame {frame}"),
                )?;
            }
        }
        println!(
            "{count:?}: {} plants in all, {numbers:?} in frames",
            known.len()
        );
        hold(numbers.len() > 5, "the path changes nothing")?;
    }
    Ok(())
}

/// One scene under two cameras, each drawn after every sub-step, has one state.
pub fn cameras_change_no_state(gpu: &Gpu) -> Result<(), Failed> {
    let text = "(terrain: (ground: Rolling(size_m: (12, 9), amplitude_m: 0.4, wavelength_m: 6)), \
        billboards: (density_per_m2: 6), bodies: [(name: \"ball\", shape: Ball(radius_m: 0.3), \
        position_m: (-2, 0.4, 0), above_ground: true, motion: Thrown(velocity_m_per_s: (3, 0, 0)))])";
    let loaded = parse_scene("two cameras", text, &[])?;
    let near = View::look_at(Vec3::new(0.5, 1.2, 1.5), Vec3::ZERO, 50.0);
    let away = View::look_at(
        Vec3::new(60.0, 40.0, -50.0),
        Vec3::new(90.0, 30.0, -80.0),
        20.0,
    );
    let mut hashes = Vec::new();
    for view in [near, away] {
        let format = PictureTarget::FORMAT;
        let mut scene = Scene::new(gpu, &loaded, EngineChoice::Cpu, format, SIZE)?;
        let target = PictureTarget::new(gpu, SIZE)?;
        for _ in 0..30 {
            scene.tick()?;
            scene.draw(gpu, &view, &target.view, true)?;
        }
        hashes.push(scene.engine().state_hash());
        hold(!scene.meadow().tiles.is_empty(), "nothing is awake")?;
    }
    hold(
        hashes[0].is_some() && hashes[0] == hashes[1],
        format!("{hashes:x?}"),
    )
}
