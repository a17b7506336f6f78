//! A scene as the command line names it: a file, or one of the program's own by name.

use std::path::{Path, PathBuf};

use crate::scene::builtin::load_builtin;
use crate::scene::{LoadedScene, SceneError, load_scene};

/// Reads a scene. A file goes before a built-in scene of the same name.
///
/// # Errors
///
/// The scene's own, with file, line and key.
pub fn load(scene: &Path, assets: &[PathBuf]) -> Result<LoadedScene, SceneError> {
    let by_name = scene.to_str().filter(|_| !scene.is_file());
    let built_in = by_name.and_then(load_builtin);
    built_in.unwrap_or_else(|| load_scene(scene, assets))
}

/// The name by which a scene is reported: the file's without folder and ending.
pub fn name(scene: &Path) -> String {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str());
    stem.to_string_lossy().into_owned()
}
