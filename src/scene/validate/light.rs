//! Light volumes: each value in its range, all of them together within budget.

use super::check::{Check, Key, within};
use crate::scene::budget::FieldSize;
use crate::scene::{LightVolumes, Scene, limits};

pub(super) fn light(key: &Key, light: &LightVolumes) -> Check {
    within(&key.field("cell_m"), light.cell_m, &limits::LIGHT_CELL)?;
    within(
        &key.field("height_m"),
        light.height_m,
        &limits::LIGHT_HEIGHT,
    )?;
    within(&key.field("slices"), light.slices, &limits::LIGHT_SLICES)?;
    within(&key.field("rays"), light.rays, &limits::LIGHT_RAYS)
}

/// Counts the cells over a ground, and their rays.
pub(super) fn budget(scene: &Scene, field: &FieldSize) -> Check {
    let Some(light) = &scene.light else {
        return Ok(());
    };
    let key = Key::root().field("light");
    let [wide, deep] = light.columns(field.size_m);
    let cell_m = light.cell_m;
    let limit = limits::LIGHT_COLUMNS;
    if wide.max(deep) > limit {
        let what = format!(
            "is {cell_m} m, which makes {wide} by {deep} columns, more than the limit of {limit} along a \
             side; write more"
        );
        return key.field("cell_m").fail(what);
    }
    let (cells, limit) = (wide * deep * u64::from(light.slices), limits::LIGHT_CELLS);
    if cells > limit {
        let what = format!(
            "is {cell_m} m, which makes {cells} cells in {} slices, more than the limit of {limit}; write \
             more, or lower slices",
            light.slices
        );
        return key.field("cell_m").fail(what);
    }
    let (all, limit) = (cells * u64::from(light.rays), limits::LIGHT_ALL_RAYS);
    if all > limit {
        let what = format!(
            "is {}, which makes {all} rays of {cells} cells, more than the limit of {limit}; write less, \
             or make cell_m larger",
            light.rays
        );
        return key.field("rays").fail(what);
    }
    Ok(())
}
