//! What a picture shows of a meadow: where its bodies are between two ticks, which tiles are
//! awake, and the view a scene's camera has.

use std::collections::BTreeMap;

use crate::base::{Vec3, most};
use crate::field::{Bounds, TileId, TileState};
use crate::scene::Camera;
use crate::sim::Meadow;

use super::bodies::BodyInstance;
use super::camera::View;
use super::overlay::{TileMark, TileTone};

/// Lowest eye over the ground, in metres: blades that touch the eye hide everything.
const LEAST_EYE_M: f64 = 0.25;
/// Half the side of the square around the eye in which the boxes of resting tiles are shown, in
/// metres: farther off their edges run into each other.
const RESTING_SHOWN_M: f64 = 20.0;
/// Field of view of a scene without cameras, in degrees.
const DEFAULT_FOV_DEG: f32 = 45.0;

/// The pieces of all bodies, `between` 0 at the start of the last tick and 1 at its end.
pub fn bodies_at(meadow: &Meadow, between: f64) -> Vec<BodyInstance> {
    meadow
        .bodies
        .links()
        .iter()
        .filter(|link| link.from.is_finite() && link.to.is_finite())
        .map(|link| BodyInstance {
            shape: link.shape,
            world_from_body: link.from.lerp(link.to, between.clamp(0.0, 1.0)),
            rgb: link.rgb,
            coat: link.coat,
        })
        .collect()
}

/// Active tiles with their slabs, in the order of their ids, for an engine whose drawn nodes lie
/// by slab.
pub fn active_slabs(meadow: &Meadow) -> Vec<(TileId, u32)> {
    let tiles = &meadow.work.tiles;
    tiles.iter().map(|tile| (tile.tile, tile.slab)).collect()
}

/// Boxes around tiles, as high as what grows there: around all that are awake, as in figure 8 of O09, and
/// around resting ones within [`RESTING_SHOWN_M`] of an eye that is given.
pub fn tile_marks(meadow: &Meadow, resting_near: Option<Vec3<f64>>) -> Vec<TileMark> {
    let field = &meadow.field;
    let mut tones = BTreeMap::new();
    if let Some([x, _, z]) = resting_near.map(Vec3::to_f64) {
        let near = Bounds {
            low: [x - RESTING_SHOWN_M, f64::MIN, z - RESTING_SHOWN_M],
            high: [x + RESTING_SHOWN_M, f64::MAX, z + RESTING_SHOWN_M],
        };
        (field.octree).query(&field.grid, &field.ground, &near, 0.0, |tile| {
            tones.insert(tile, TileTone::Resting);
        });
    }
    tones.extend(
        meadow
            .tiles
            .iter()
            .map(|(tile, active)| match active.state {
                TileState::Colliding => (tile, TileTone::Colliding),
                TileState::Recovering => (tile, TileTone::Recovering),
            }),
    );
    let marks = tones.into_iter().map(|(tile, tone)| {
        let [low, high] = field.grid.tile_bounds(tile, &field.ground);
        let heights = field.grid.tile_heights(tile, &field.ground).map(f64::from);
        TileMark {
            low_in_world: [low[0], heights[0], low[1]],
            high_in_world: [high[0], heights[1] + field.farthest_m(), high[1]],
            tone,
        }
    });
    marks.collect()
}

/// The view of one of the scene's cameras; without one, a view that frames the bodies. The eye
/// stays over the ground.
pub fn scene_view(meadow: &Meadow, camera: Option<&Camera>) -> View {
    let view = match camera {
        Some(camera) => {
            let followed = camera
                .follow
                .as_deref()
                .and_then(|name| meadow.bodies.info_of(name))
                .map_or(Vec3::ZERO, |body| body.pose.place);
            View::look_at(
                followed + Vec3::of(camera.eye_m),
                followed + Vec3::of(camera.target_m),
                camera.fov_deg,
            )
        }
        None => framing_view(meadow),
    };
    let eye = view.eye_in_world;
    let ground = meadow.field.ground.height_in_world(eye.x, eye.z);
    View {
        eye_in_world: Vec3::new(eye.x, eye.y.max(ground + LEAST_EYE_M), eye.z),
        ..view
    }
}

/// Looks down on the middle of all bodies from the side, from far enough to see them all.
fn framing_view(meadow: &Meadow) -> View {
    let places: Vec<Vec3<f64>> = meadow
        .bodies
        .info()
        .map(|body| body.pose.place)
        .filter(|place| place.is_finite())
        .collect();
    let ground = &meadow.field.ground;
    let on_ground = |x: f64, z: f64| Vec3::new(x, ground.height_in_world(x, z), z);
    let middle = match places.len() {
        0 => on_ground(ground.centre_m[0], ground.centre_m[1]),
        count => places.iter().fold(Vec3::ZERO, |sum, &place| sum + place) * (1.0 / count as f64),
    };
    let spread = places
        .iter()
        .map(|&place| (place - middle).length())
        .fold(1.5, most);
    // Half the field of view sees the spread at this distance.
    let away = spread / (0.5 * f64::from(DEFAULT_FOV_DEG)).to_radians().tan();
    let eye = middle + Vec3::new(0.35, 0.35, 0.87) * away;
    View::look_at(eye, middle, DEFAULT_FOV_DEG)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Body, Scene};

    fn meadow(bodies: Vec<Body>) -> Meadow {
        let scene = Scene {
            bodies,
            ..Scene::default()
        };
        Meadow::new(scene, &Default::default()).expect("a plain scene")
    }

    fn ball(name: &str, position_m: [f64; 3]) -> Body {
        ron::from_str(&format!(
            "(name: \"{name}\", shape: Ball(radius_m: 0.2), position_m: ({}, {}, {}))",
            position_m[0], position_m[1], position_m[2]
        ))
        .expect("a body")
    }

    #[test]
    fn the_view_of_a_scene_without_cameras_holds_every_body() {
        let meadow = meadow(vec![
            ball("a", [-4.0, 0.5, 1.0]),
            ball("b", [5.0, 0.5, -2.0]),
            ball("c", [0.0, 0.5, 6.0]),
        ]);
        let view = scene_view(&meadow, None);
        let frustum = view.frustum(1.0);
        for body in meadow.bodies.info() {
            let at = body.pose.place.to_f64();
            assert!(frustum.may_see(at, at), "{}", body.name);
        }
    }

    /// Boxes of figure 8: awake tiles alone, and as high as the tallest clumps.
    #[test]
    fn boxes_of_awake_tiles_hold_what_grows_there() {
        let scene = "(terrain: (ground: Flat(size_m: (8, 8))), grass: (species: []), \
            billboards: Some((density_per_m2: 30)), bodies: [(name: \"ball\", \
            shape: Ball(radius_m: 0.2), position_m: (0, 0.2, 0), motion: Fixed)])";
        let scene: Scene = ron::from_str(scene).expect("a scene");
        let mut meadow = Meadow::new(scene, &Default::default()).expect("a meadow");
        let mut grass = crate::sim::Grass::<f32>::new();
        for _ in 0..2 {
            crate::sim::tick(&mut meadow, &mut grass).expect("a sub-step");
        }
        let awake = tile_marks(&meadow, None);
        assert_eq!(awake.len(), meadow.work.tiles.len());
        assert!(awake.iter().all(|mark| mark.tone == TileTone::Colliding));
        let billboards = meadow.field.billboards.as_ref().expect("some");
        let tallest = billboards.all.iter().map(|one| one.height_m);
        let tallest = f64::from(tallest.fold(0.0, most));
        assert!(tallest > 0.4);
        let low = |mark: &TileMark| mark.high_in_world[1] - mark.low_in_world[1];
        assert!(awake.iter().all(|mark| low(mark) >= tallest));
        let all = tile_marks(&meadow, Some(Vec3::ZERO));
        assert_eq!(all.len() as u32, meadow.field.grid.tile_count());
    }

    #[test]
    fn a_camera_follows_its_body_and_stays_above_the_ground() {
        let meadow = meadow(vec![ball("a", [2.0, 0.5, 1.0])]);
        let camera = Camera {
            name: "under".into(),
            eye_m: [0.0, -3.0, 1.0],
            target_m: [0.0; 3],
            fov_deg: 40.0,
            follow: Some("a".into()),
        };
        let eye = scene_view(&meadow, Some(&camera)).eye_in_world;
        assert_eq!(eye.to_f64(), [2.0, LEAST_EYE_M, 2.0]);
    }
}
