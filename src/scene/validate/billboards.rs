//! Billboards: each value in its range, the maps alike, all of them together within budget.

use super::check::{Check, Key, at_most, name, ordered, within, within_each};
use super::covers_ground;
use crate::scene::assets::Assets;
use crate::scene::budget::FieldSize;
use crate::scene::{Billboards, ClumpKind, Messiness, Scene, limits};

pub(super) fn billboards(key: &Key, billboards: &Billboards) -> Check {
    within(
        &key.field("density_per_m2"),
        billboards.density_per_m2,
        &limits::BILLBOARD_DENSITY,
    )?;
    within_each(
        &key.field("nodes"),
        &billboards.nodes,
        &limits::BILLBOARD_NODES,
    )?;
    within(
        &key.field("draw_subdivision"),
        billboards.draw_subdivision,
        &limits::DRAW_SUBDIVISION,
    )?;
    let clumps = key.field("clumps");
    at_most(
        &clumps,
        billboards.clumps.len(),
        limits::CLUMPS,
        "kinds of clumps",
    )?;
    for (i, one) in billboards.clumps.iter().enumerate() {
        clump(&clumps.nth(i), one)?;
    }
    let shares: f32 = billboards.clumps.iter().map(|kind| kind.share).sum();
    if shares <= 0.0 {
        return clumps.fail("has no share above 0; give at least one kind a positive share");
    }
    match billboards.messiness {
        Messiness::Even(even) => within(&key.field("messiness"), even, &limits::FRACTION),
        Messiness::Map(_) => Ok(()),
    }
}

fn clump(key: &Key, clump: &ClumpKind) -> Check {
    name(&key.field("name"), &clump.name)?;
    within(&key.field("share"), clump.share, &limits::SHARE)?;
    ordered(&key.field("height_m"), clump.height_m, &limits::CLUMP_SIZE)?;
    ordered(&key.field("width_m"), clump.width_m, &limits::CLUMP_SIZE)?;
    within(
        &key.field("flexibility"),
        clump.flexibility,
        &limits::FLEXIBILITY,
    )?;
    within_each(&key.field("tint_rgb"), &clump.tint_rgb, &limits::TINT)
}

/// Counts the billboards of a field as if the extent were white everywhere.
pub(super) fn budget(scene: &Scene, field: &FieldSize) -> Check {
    let Some(billboards) = &scene.billboards else {
        return Ok(());
    };
    let key = Key::root().field("billboards").field("density_per_m2");
    let density = f64::from(billboards.density_per_m2);
    let on_triangle = 0.5 * density * f64::from(field.seeding_cell_m).powi(2);
    let triangles = u64::from(2 * field.tile_cells * field.tile_cells);
    let in_tile = triangles * on_triangle.ceil() as u64;
    let limit = limits::BILLBOARDS_PER_TILE;
    if in_tile > limit {
        let what = format!(
            "is {density}, which makes up to {in_tile} billboards in a tile, more than the limit of \
             {limit}; write less, or lower solver.tile_m or solver.seeding_cell_m"
        );
        return key.fail(what);
    }
    let all = on_triangle * field.seeding_triangles as f64;
    let limit = limits::BILLBOARDS;
    if all > limit as f64 {
        let what = format!(
            "is {density}, which makes {all:.0} billboards where the extent is white everywhere, more \
             than the limit of {limit}; write less, or make the ground smaller"
        );
        return key.fail(what);
    }
    Ok(())
}

/// The maps have the ground's proportions and, unless the scene lets them be resampled, one size.
pub(super) fn maps(scene: &Scene, assets: &Assets, samples: [u64; 2]) -> Check {
    let Some(billboards) = &scene.billboards else {
        return Ok(());
    };
    let key = Key::root().field("billboards");
    let mut first: Option<(&str, &str, [u32; 2])> = None;
    for (name, file) in billboards.maps() {
        let Some(size) = assets.cover_map_size(name, file) else {
            continue;
        };
        covers_ground(&key.field(name), size, samples)?;
        let Some((other, other_file, other_size)) = first else {
            first = Some((name, file, size));
            continue;
        };
        if size != other_size && !billboards.resample {
            let what = format!(
                "`{file}` has {} by {} texels, but `{other_file}` of billboards.{other} has {} by {}; \
                 make them alike, or write resample: true",
                size[0], size[1], other_size[0], other_size[1]
            );
            return key.field(name).fail(what);
        }
    }
    Ok(())
}
