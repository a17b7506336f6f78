//! What billboards do to a picture.

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::gpu::Gpu;

use super::{ALL, Shown, Stage, WHOLE, difference, hold};

const BARE: &str = "(terrain: (ground: Flat(size_m: (8, 8))), grass: (species: []))";
const CLUMPS: &str = "(terrain: (ground: Flat(size_m: (8, 8))), grass: (species: []), \
    billboards: Some((density_per_m2: 30)))";

/// Billboards hide the ground, in few draws, and no sky: none of them reaches up to the eye.
pub fn clumps_are_drawn(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, CLUMPS, 0)?;
    let with = stage.shoot(gpu, ALL)?;
    let counts = stage.renderer.billboard_counts().unwrap_or_default();
    // All of 8 m by 8 m at 30 per square metre are 1920; the view sees a part. A draw is a run of tiles
    // of one row.
    hold(
        (100..=1920).contains(&counts.billboards) && (1..=16).contains(&counts.draws),
        format!("{counts:?}"),
    )?;
    hold(
        stage.shoot(gpu, ALL)? == with,
        "two pictures of one frame differ",
    )?;
    let shown = Shown {
        blades: false,
        ..ALL
    };
    let without = stage.shoot(gpu, shown)?;
    let none = stage.renderer.billboard_counts().unwrap_or_default();
    hold(
        none.billboards == 0,
        "billboards are counted that were left out",
    )?;
    let changed = difference(&with, &without, WHOLE);
    hold(changed > 5.0, format!("billboards change {changed} steps"))?;
    let mut level = ALL;
    level.view.forward = Vec3::new(0.0, 0.0, -1.0);
    let with = stage.shoot(gpu, level)?;
    level.blades = false;
    let without = stage.shoot(gpu, level)?;
    let changed = difference(&with, &without, [0.0, 0.0, 1.0, 0.4]);
    hold(
        changed == 0.0,
        format!("billboards change the sky by {changed}"),
    )
}

/// A scene without billboards has no pipeline and no buffer for them, nor after another one has gone, and
/// its picture is the same.
pub fn no_clumps_cost_nothing(gpu: &Gpu) -> Result<(), Failed> {
    let mut bare = Stage::new(gpu, BARE, 0)?;
    let first = bare.shoot(gpu, ALL)?;
    hold(
        bare.renderer.billboard_counts().is_none(),
        "a scene without billboards has a layer of them",
    )?;
    let mut other = Stage::new(gpu, CLUMPS, 0)?;
    let clumps = other.shoot(gpu, ALL)?;
    hold(clumps != first, "billboards change nothing")?;
    std::mem::swap(&mut other.renderer, &mut bare.renderer);
    bare.show(gpu)?;
    hold(
        bare.shoot(gpu, ALL)? == first && bare.renderer.billboard_counts().is_none(),
        "billboards stay after their scene",
    )
}
