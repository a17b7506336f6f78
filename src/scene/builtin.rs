//! The scenes that come with the program: the same files as in `scenes`, with their assets, so
//! that they run from any folder.

use super::assets::Embedded;
use super::error::SceneError;
use super::load::{LoadedScene, parse_scene_with};

/// Name of the scene that is shown when none is asked for.
pub const DEFAULT_SCENE: &str = "meadow";

/// A scene in the program.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// The file's name without its ending.
    pub name: &'static str,
    /// The text of the file.
    pub source: &'static str,
}

macro_rules! builtin {
    ($($name:literal),* $(,)?) => {
        &[$(Builtin {
            name: $name,
            source: include_str!(concat!("../../scenes/", $name, ".ron")),
        }),*]
    };
}

/// Every scene in the program, sorted by name.
pub const SCENES: &[Builtin] = builtin![
    "ball_drop",
    "ball_roll",
    "boulders",
    "country",
    "heath",
    "hills",
    "hundred_bodies",
    "meadow",
    "meadow_60k",
    "mesh_drop",
    "million_blades",
    "still",
    "topiary",
    "vehicle",
];

/// Every asset of these scenes, by the path they give.
pub const ASSETS: Embedded<'static> = Embedded(&[
    (
        "assets/chair.gltf",
        include_bytes!("../../scenes/assets/chair.gltf"),
    ),
    (
        "assets/clumps_direction.png",
        include_bytes!("../../scenes/assets/clumps_direction.png"),
    ),
    (
        "assets/clumps_extent.png",
        include_bytes!("../../scenes/assets/clumps_extent.png"),
    ),
    (
        "assets/clumps_messiness.png",
        include_bytes!("../../scenes/assets/clumps_messiness.png"),
    ),
    (
        "assets/heath.png",
        include_bytes!("../../scenes/assets/heath.png"),
    ),
    (
        "assets/horseshoe.obj",
        include_bytes!("../../scenes/assets/horseshoe.obj"),
    ),
]);

/// Reads one of the program's own scenes; `None` if there is none of this name.
///
/// # Errors
/// A shipped scene that breaks a limit, which the tests rule out.
pub fn load_builtin(name: &str) -> Option<Result<LoadedScene, SceneError>> {
    let found = SCENES.iter().find(|scene| scene.name == name)?;
    Some(parse_scene_with(found.name, found.source, &ASSETS))
}

#[cfg(test)]
mod shipped_maps;
#[cfg(test)]
mod shipped_meshes;

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::{Expectation, load_scene, parse_scene_with, scene_files, to_ron};

    fn folder() -> std::path::PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
    }

    #[test]
    fn every_file_is_built_in_and_loads_alike() {
        let files = scene_files(&folder()).expect("the scenes folder");
        let names: Vec<_> = SCENES.iter().map(|s| s.name.to_owned()).collect();
        let mut loaded_names = Vec::new();
        for file in files {
            let from_file = load_scene(&file, &[]).unwrap_or_else(|e| panic!("{e}"));
            let built_in = load_builtin(&from_file.name).expect("a scene of this name");
            let built_in = built_in.unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(built_in.scene, from_file.scene);
            assert_eq!(built_in.assets.meshes, from_file.assets.meshes);
            assert_eq!(built_in.assets.base_maps, from_file.assets.base_maps);
            loaded_names.push(from_file.name);
        }
        assert_eq!(loaded_names, names);
        assert!(names.iter().any(|n| n == DEFAULT_SCENE));
        assert!(load_builtin("no such scene").is_none());
    }

    #[test]
    fn every_scene_survives_being_written() {
        for built_in in SCENES {
            let loaded = load_builtin(built_in.name)
                .expect("it is there")
                .expect("valid");
            let text = to_ron(&loaded.scene).expect("a scene can be written");
            let again = parse_scene_with(built_in.name, &text, &ASSETS);
            let again = again.unwrap_or_else(|e| panic!("{e}\n{text}"));
            assert_eq!(again.scene, loaded.scene, "{}", built_in.name);
        }
    }

    #[test]
    fn every_scene_says_what_it_is_and_can_fail() {
        for built_in in SCENES {
            let scene = load_builtin(built_in.name)
                .expect("it is there")
                .expect("valid")
                .scene;
            assert!(scene.description.len() > 20, "{}", built_in.name);
            assert!(!scene.cameras.is_empty(), "{}", built_in.name);
            let responds = |e: &Expectation| {
                matches!(
                    e,
                    Expectation::Lean {
                        at_least_deg: Some(_),
                        ..
                    } | Expectation::Offset {
                        at_least_m: Some(_),
                        ..
                    } | Expectation::Imprint { .. }
                )
            };
            assert!(scene.expect.iter().any(responds), "{}", built_in.name);
        }
    }
}
