//! Checks a scene's values: each in its range, together within budget, names known and unique.
//!
//! The checks walk the scene in the order of its keys and stop at the first that fails.

mod billboards;
mod body;
mod check;
mod coat;
mod expect;
mod light;
mod meadow;
mod script;

pub use check::Invalid;

use std::collections::HashSet;

use check::{Check, Key, at_most, name, within, within_each};

use super::assets::{Assets, bodies_with_keys};
use super::budget::{FieldSize, field_size, ground_samples};
use super::extent::extents;
use super::{Camera, Ground, Scene, Shape, limits};

/// Checks all that can be checked without reading assets.
///
/// # Errors
/// The first key that breaks a limit, with its value and the limit.
pub fn validate(scene: &Scene) -> Result<(), Invalid> {
    let root = Key::root();
    within(
        &root.field("duration_s"),
        scene.duration_s,
        &limits::DURATION,
    )?;
    meadow::terrain(&root.field("terrain"), &scene.terrain)?;
    meadow::grass(&root.field("grass"), &scene.grass)?;
    if let Some(cover) = &scene.billboards {
        billboards::billboards(&root.field("billboards"), cover)?;
    }
    meadow::wind(&root.field("wind"), &scene.wind)?;
    meadow::solver(&root.field("solver"), &scene.solver)?;
    if let Some(volumes) = &scene.light {
        light::light(&root.field("light"), volumes)?;
    }
    if let Some(samples) = ground_samples(&scene.terrain.ground) {
        let field = size(scene, samples)?;
        billboards::budget(scene, &field)?;
        light::budget(scene, &field)?;
    }
    bodies(scene)?;
    coat::budget(scene, &Assets::default())?;
    script::script(&root.field("script"), scene)?;
    cameras(&root.field("cameras"), scene)?;
    expect::expectations(&root.field("expect"), scene)
}

/// Checks what depends on a scene's assets: the field a height map makes, the size of meshes, and
/// places that must lie on the ground.
///
/// # Errors
/// As [`validate`].
pub fn validate_assets(scene: &Scene, assets: &Assets) -> Result<(), Invalid> {
    let samples = match &scene.terrain.ground {
        Ground::HeightMap { file, .. } => assets
            .height_maps
            .get(file)
            .map(|map| [map.columns.into(), map.rows.into()]),
        ground => ground_samples(ground),
    };
    if let Some(samples) = samples {
        base_map(scene, assets, samples)?;
        billboards::maps(scene, assets, samples)?;
        let field = size(scene, samples)?;
        billboards::budget(scene, &field)?;
        light::budget(scene, &field)?;
        expect::on_the_ground(&Key::root().field("expect"), scene, &field)?;
    }
    for (key, body) in bodies_with_keys(scene) {
        if let Shape::Mesh { file, scale, .. } = &body.shape
            && let Some(mesh) = assets.meshes.get(file)
        {
            let [length, ..] = extents(&mesh.positions).map(|e| e * f64::from(*scale));
            let range = &limits::BODY_LENGTH;
            if !(range.min..=range.max).contains(&length) {
                let what = format!(
                    "is {scale}, which makes `{file}` about {length} m long; a body is {range} long"
                );
                return Err(Invalid {
                    key: format!("{key}.shape.scale"),
                    what,
                });
            }
        }
    }
    coat::budget(scene, assets)
}

fn base_map(scene: &Scene, assets: &Assets, samples: [u64; 2]) -> Check {
    let file = scene.terrain.base_map.as_ref();
    let Some(map) = file.and_then(|file| assets.base_maps.get(file)) else {
        return Ok(());
    };
    let key = Key::root().field("terrain").field("base_map");
    covers_ground(&key, [map.columns, map.rows], samples)
}

/// A map covers the ground with square texels: its sides have the ground's proportions, to half a texel.
fn covers_ground(key: &Key, [columns, rows]: [u32; 2], samples: [u64; 2]) -> Check {
    let [wide, deep] = samples.map(|n| n.saturating_sub(1) as f64);
    let wanted = f64::from(columns) * deep / wide;
    if (wanted - f64::from(rows)).abs() > 0.5 {
        let what = format!(
            "has {columns} by {rows} texels, but the ground is {wide} by {deep} squares; for {columns} \
             columns it needs {} rows",
            wanted.round().max(2.0)
        );
        return key.clone().fail(what);
    }
    Ok(())
}

fn size(scene: &Scene, samples: [u64; 2]) -> Result<FieldSize, Invalid> {
    field_size(&scene.terrain.ground, samples, &scene.grass, &scene.solver).map_err(|over| {
        Invalid {
            key: over.key.to_owned(),
            what: over.what,
        }
    })
}

fn bodies(scene: &Scene) -> Check {
    let mut names = HashSet::new();
    let count = bodies_with_keys(scene).count();
    at_most(
        &Key::root().field("bodies"),
        count,
        limits::BODIES,
        "bodies, spawned ones included",
    )?;
    for (key, one) in bodies_with_keys(scene) {
        let key = Key::of(key);
        body::body(&key, one)?;
        if !names.insert(one.name.as_str()) {
            let what = format!(
                "is \"{}\", which another body has; give each its own",
                one.name
            );
            return key.field("name").fail(what);
        }
    }
    Ok(())
}

fn cameras(key: &Key, scene: &Scene) -> Check {
    at_most(key, scene.cameras.len(), limits::CAMERAS, "cameras")?;
    let mut names = HashSet::new();
    for (i, one) in scene.cameras.iter().enumerate() {
        let key = key.nth(i);
        camera(&key, one)?;
        if !names.insert(one.name.as_str()) {
            let what = format!(
                "is \"{}\", which another camera has; give each its own",
                one.name
            );
            return key.field("name").fail(what);
        }
        if let Some(body) = &one.follow {
            script::known(&key.field("follow"), body, scene)?;
        }
    }
    Ok(())
}

fn camera(key: &Key, camera: &Camera) -> Check {
    name(&key.field("name"), &camera.name)?;
    within_each(&key.field("eye_m"), &camera.eye_m, &limits::PLACE)?;
    within_each(&key.field("target_m"), &camera.target_m, &limits::PLACE)?;
    within(
        &key.field("fov_deg"),
        camera.fov_deg,
        &limits::FIELD_OF_VIEW,
    )?;
    let apart = (0..3).any(|i| (camera.eye_m[i] - camera.target_m[i]).abs() > 1e-3);
    if !apart {
        let what =
            "is where eye_m is; a camera needs a direction, so move one by over a millimetre";
        return key.field("target_m").fail(what);
    }
    Ok(())
}
