//! A scene as the command line names it: a file, or one of the program's own by name.

use std::io;
use std::path::{Path, PathBuf};

use crate::app::Failure;
use crate::scene::assets::{AssetSource, Folders, InOrder};
use crate::scene::builtin::{ASSETS, SCENES, load_builtin};
use crate::scene::{AssetError, LoadedScene, Problem, SceneError, load_scene, probably_meant};

/// Reads a scene. A file goes before a built-in scene of the same name.
///
/// # Errors
/// The scene's own, with file, line and key.
pub fn load(scene: &Path, assets: &[PathBuf]) -> Result<LoadedScene, SceneError> {
    if scene
        .extension()
        .is_some_and(|ending| ending == "recording")
        && scene.is_file()
    {
        return Err(no_scene(
            scene,
            "it is a recording, which `sward replay` runs",
        ));
    }
    if scene.is_dir() {
        return Err(no_scene(
            scene,
            "it is a folder; name the scenes in it, as in FOLDER/*.ron",
        ));
    }
    let by_name = scene.to_str().filter(|_| !scene.is_file());
    let built_in = by_name.and_then(load_builtin);
    built_in
        .unwrap_or_else(|| load_scene(scene, assets).map_err(|error| named_nowhere(scene, error)))
}

/// Checks the folders of `--assets`: one that is not there would be looked in for nothing.
///
/// # Errors
/// The first that is no folder.
pub fn check_folders(assets: &[PathBuf]) -> Result<(), Failure> {
    match assets.iter().find(|folder| !folder.is_dir()) {
        Some(folder) => {
            let what = if folder.exists() {
                "a file"
            } else {
                "not there"
            };
            let folder = folder.display();
            Err(Failure::Usage(format!(
                "--assets {folder}: it is {what}; give a folder"
            )))
        }
        None => Ok(()),
    }
}

fn no_scene(path: &Path, what: &str) -> SceneError {
    let problem = Problem::Unreadable(io::Error::other(what));
    SceneError::whole(&path.display().to_string(), problem)
}

/// Says of a missing file that no scene of the program has that name either.
fn named_nowhere(scene: &Path, mut error: SceneError) -> SceneError {
    if let Problem::Unreadable(reason) = &mut error.problem
        && reason.kind() == io::ErrorKind::NotFound
    {
        let own = SCENES.iter().map(|own| own.name);
        let hint = match scene.to_str().and_then(|name| probably_meant(name, own)) {
            Some(near) => format!("did you mean {near}?"),
            None => "see `sward list`".to_owned(),
        };
        let text = format!("{reason}; nor is it one of the program's own: {hint}");
        *reason = io::Error::new(io::ErrorKind::NotFound, text);
    }
    error
}

/// Reads a file that the scene of a path, or a built-in scene, has read before.
///
/// # Errors
/// A file that is gone or cannot be read.
pub fn read_asset(
    scene: Option<&Path>,
    assets: &[PathBuf],
    file: &str,
    limit: u64,
) -> Result<Vec<u8>, AssetError> {
    let own_folder = scene.map(|path| match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    });
    let folders = Folders::new(own_folder.into_iter().chain(assets.iter().cloned()));
    InOrder(&folders, &ASSETS).read(file, limit)
}

/// The name by which a scene is reported: the file's without folder and ending.
pub fn name(scene: &Path) -> String {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str());
    stem.to_string_lossy().into_owned()
}

/// A name of its own for each scene's files: where several have one name, the later ones get a
/// number.
pub fn distinct_names(scenes: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for scene in scenes {
        let plain = name(scene);
        let numbered = (2..).map(|number| format!("{plain}-{number}"));
        let mut wishes = std::iter::once(plain.clone()).chain(numbered);
        names.extend(wishes.find(|wish| !names.contains(wish)));
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_a_typing_error_is_told_of_its_likeness() {
        let of = |name: &str| {
            load(Path::new(name), &[])
                .map(|_| ())
                .expect_err("no scene")
        };
        let near = of("ball_rol").to_string();
        assert!(near.contains("did you mean ball_roll?"), "{near}");
        let far = of("nowhere_near").to_string();
        assert!(far.contains("see `sward list`"), "{far}");
    }

    #[test]
    fn scenes_of_one_name_are_numbered() {
        let scenes = ["a/roll.ron", "b/roll.ron", "roll", "still"].map(PathBuf::from);
        assert_eq!(
            distinct_names(&scenes),
            ["roll", "roll-2", "roll-3", "still"]
        );
    }
}
