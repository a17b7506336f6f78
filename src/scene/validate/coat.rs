//! Coats: each in its ranges, and all of them together within what a frame may list.

use super::check::{Check, Invalid, Key, ordered, within, within_each};
use crate::scene::assets::{Assets, bodies_with_keys};
use crate::scene::coat::CoatedSurface;
use crate::scene::{Coat, Scene, Shape, limits};

pub(super) fn coat(key: &Key, coat: &Coat) -> Check {
    within(&key.field("per_m2"), coat.per_m2, &limits::COAT_DENSITY)?;
    ordered(&key.field("height_m"), coat.height_m, &limits::PLANT_HEIGHT)?;
    ordered(&key.field("width_m"), coat.width_m, &limits::PLANT_WIDTH)?;
    within_each(&key.field("rgb"), &coat.rgb, &limits::FRACTION)?;
    ordered(&key.field("lean_deg"), coat.lean_deg, &limits::ROOT_LEAN)
}

/// Counts the plants of every coat of the scene, spawned bodies included. Meshes that are not among the
/// assets count as nothing.
pub(super) fn budget(scene: &Scene, assets: &Assets) -> Result<(), Invalid> {
    let (mut plants, mut triangles) = (0.0, 0);
    for (key, body) in bodies_with_keys(scene) {
        let Some(coat) = &body.coat else {
            continue;
        };
        let surface = match &body.shape {
            Shape::Mesh { file, scale, .. } => match assets.meshes.get(file) {
                Some(mesh) => CoatedSurface::of_mesh(&mesh.positions, &mesh.triangles, *scale),
                None => continue,
            },
            shape => CoatedSurface::of(shape),
        };
        let own = surface.area_m2 * f64::from(coat.per_m2);
        plants += own;
        triangles += surface.triangles;
        let key = Key::of(format!("{key}.coat"));
        let limit = limits::COAT_PLANTS;
        if plants > limit as f64 {
            let what = format!(
                "is {}, which grows {own:.0} plants on {:.3} m2 and makes {plants:.0} on the bodies up \
                 to this one, more than the limit of {limit}; write less, or coat fewer bodies",
                coat.per_m2, surface.area_m2
            );
            return key.field("per_m2").fail(what);
        }
        let limit = limits::COAT_TRIANGLES;
        if triangles > limit {
            let what = format!(
                "grows on {} triangles, which makes {triangles} under the coats up to this one, more \
                 than the limit of {limit}; use a coarser mesh, or coat fewer bodies",
                surface.triangles
            );
            return key.fail(what);
        }
    }
    Ok(())
}
