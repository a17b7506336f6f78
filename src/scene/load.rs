//! Reads scenes and the assets they name: text to [`Scene`], checked, with its meshes and heights.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use ron::Options;
use ron::extensions::Extensions;
use ron::ser::PrettyConfig;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::assets::{AssetSource, Assets, Folders, Noted, read_assets};
use super::error::{Problem, SceneError};
use super::limits::{SCENE_BYTES, SCENE_DEPTH};
use super::positions::Positions;
use super::validate::{Invalid, validate, validate_assets};
use super::{Scene, syntax};

/// A scene that passed every check, with everything it needs.
#[derive(Clone, Debug)]
pub struct LoadedScene {
    /// The file's name without its ending.
    pub name: String,
    /// The file, if it came from one.
    pub path: Option<PathBuf>,
    /// The text as read.
    pub source: String,
    pub scene: Scene,
    pub assets: Assets,
}

impl LoadedScene {
    /// An error about a key of this scene that shows only later, such as a mesh that cannot be
    /// split into convex parts; it points at the key in the text.
    pub fn error_at(&self, key: &str, what: String) -> SceneError {
        let file = match &self.path {
            Some(path) => path.display().to_string(),
            None => self.name.clone(),
        };
        let position = Positions::scan(&self.source).of_key(key);
        SceneError::new(&file, position, key, Problem::Value(what))
    }
}

/// Reads a scene file. Assets are looked up in the file's folder, then in `asset_dirs` in order.
///
/// # Errors
/// A file that cannot be read, is no scene, breaks a limit of [`super::limits`], or names an asset
/// that cannot be used.
pub fn load_scene(path: &Path, asset_dirs: &[PathBuf]) -> Result<LoadedScene, SceneError> {
    let file = path.display().to_string();
    let source = read_text(path, SCENE_BYTES)?;
    let own_folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    };
    let folders = Folders::new(std::iter::once(own_folder).chain(asset_dirs.iter().cloned()));
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut loaded = parse(&name, &file, source, &folders)?;
    loaded.path = Some(path.to_path_buf());
    Ok(loaded)
}

/// Reads a scene from a text. Assets are looked up in `folders` in order.
///
/// # Errors
/// As [`load_scene`]; errors give `name` as the file.
pub fn parse_scene(
    name: &str,
    source: &str,
    folders: &[PathBuf],
) -> Result<LoadedScene, SceneError> {
    let folders = Folders::new(folders.iter().cloned());
    parse(name, name, source.to_owned(), &folders)
}

/// Reads a scene from a text, with assets from wherever the caller has them.
///
/// # Errors
/// As [`load_scene`]; errors give `name` as the file.
pub fn parse_scene_with(
    name: &str,
    source: &str,
    assets: &dyn AssetSource,
) -> Result<LoadedScene, SceneError> {
    parse(name, name, source.to_owned(), assets)
}

/// Reads a value of the scene language other than a whole scene; `file` is named in errors.
///
/// # Errors
/// Text that is no such value, with line, column and key.
pub fn parse_value<T: DeserializeOwned>(file: &str, source: &str) -> Result<T, SceneError> {
    let read = options().from_str(source);
    read.map_err(|e| syntax::explain(file, source, &e))
}

/// Writes a value so that [`parse_value`] reads back an equal one. Long texts stay as they are.
///
/// # Errors
/// None is known for what sward writes; the writer's own are passed on.
pub fn value_to_ron<T: Serialize>(value: &T) -> Result<String, ron::Error> {
    let config = PrettyConfig::default()
        .struct_names(false)
        .escape_strings(false);
    options().to_string_pretty(value, config)
}

/// The scene files (`*.ron`) of a folder, sorted by name.
///
/// # Errors
/// A folder that cannot be listed.
pub fn scene_files(folder: &Path) -> Result<Vec<PathBuf>, SceneError> {
    let unreadable = |e| SceneError::whole(&folder.display().to_string(), Problem::Unreadable(e));
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.extension().is_some_and(|e| e == "ron") && path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Writes a scene as text that [`parse_scene`] reads back to an equal one.
///
/// # Errors
/// None is known for a scene; the writer's own are passed on.
pub fn to_ron(scene: &Scene) -> Result<String, ron::Error> {
    options().to_string_pretty(scene, PrettyConfig::default().struct_names(false))
}

fn options() -> Options {
    Options::default()
        .with_default_extension(
            Extensions::IMPLICIT_SOME
                | Extensions::UNWRAP_NEWTYPES
                | Extensions::UNWRAP_VARIANT_NEWTYPES,
        )
        .with_recursion_limit(SCENE_DEPTH)
}

/// Reads a text file of at most `limit` bytes, which is known before anything is read.
///
/// # Errors
/// A file that cannot be read, is too long, or no UTF-8.
pub fn read_text(path: &Path, limit: u64) -> Result<String, SceneError> {
    let file = &path.display().to_string();
    let unreadable = |e| SceneError::whole(file, Problem::Unreadable(e));
    let about = fs::metadata(path).map_err(unreadable)?;
    if !about.is_file() {
        let kind = std::io::Error::other("it is no regular file");
        return Err(unreadable(kind));
    }
    let too_large = |bytes| SceneError::whole(file, Problem::TooLarge { bytes, limit });
    if about.len() > limit {
        return Err(too_large(about.len()));
    }
    let mut bytes = Vec::new();
    let opened = fs::File::open(path).map_err(unreadable)?;
    // The file may have grown since it was measured.
    let read = opened.take(limit.saturating_add(1)).read_to_end(&mut bytes);
    let length = read.map_err(unreadable)? as u64;
    if length > limit {
        return Err(too_large(length));
    }
    String::from_utf8(bytes).map_err(|e| {
        let valid = String::from_utf8_lossy(&e.as_bytes()[..e.utf8_error().valid_up_to()]);
        let position = Positions::scan(&valid).position(valid.len());
        SceneError::new(file, position, "", Problem::NotText)
    })
}

fn parse(
    name: &str,
    file: &str,
    source: String,
    assets: &dyn AssetSource,
) -> Result<LoadedScene, SceneError> {
    if source.len() as u64 > SCENE_BYTES {
        let (bytes, limit) = (source.len() as u64, SCENE_BYTES);
        return Err(SceneError::whole(file, Problem::TooLarge { bytes, limit }));
    }
    let scene: Scene = options()
        .from_str(&source)
        .map_err(|e| syntax::explain(file, &source, &e))?;
    let at = |key: &str, problem| {
        SceneError::new(file, Positions::scan(&source).of_key(key), key, problem)
    };
    let invalid = |i: Invalid| at(&i.key, Problem::Value(i.what));
    validate(&scene).map_err(invalid)?;
    let noted = Noted::new(assets);
    let read = read_assets(&scene, &noted);
    let mut assets = read.map_err(|(key, e)| at(&key, Problem::Asset(e)))?;
    assets.file_hashes = noted.hashes();
    validate_assets(&scene, &assets).map_err(invalid)?;
    Ok(LoadedScene {
        name: name.to_owned(),
        path: None,
        source,
        scene,
        assets,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_scene_is_a_pair_of_brackets() {
        let loaded = parse_scene("least", "()", &[]).expect("every key has a default");
        assert_eq!(loaded.scene, Scene::default());
        assert_eq!(loaded.name, "least");
        let named = parse_scene("named", "Scene(duration_s: 2)", &[]).expect("the name is allowed");
        assert_eq!(named.scene.duration_s, 2.0);
    }

    #[test]
    fn later_errors_point_into_the_text() {
        let source = "(\n  solver: (tile_m: 2),\n)";
        let loaded = parse_scene("late", source, &[]).expect("valid");
        let error = loaded.error_at("solver.tile_m", "is too large here".to_owned());
        assert_eq!(
            error.to_string(),
            "late:2:20: solver.tile_m: is too large here"
        );
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = load_scene(Path::new("/no/such/scene.ron"), &[]).expect_err("it is not there");
        let text = error.to_string();
        assert!(
            text.starts_with("/no/such/scene.ron: the file cannot be read:"),
            "{text}"
        );
        assert!(scene_files(Path::new("/no/such")).is_err());
    }

    #[test]
    fn text_that_is_too_long_is_refused_unread() {
        let long = " ".repeat(SCENE_BYTES as usize + 1);
        let text = parse_scene("long", &long, &[])
            .expect_err("too long")
            .to_string();
        assert!(
            text.contains("1048577") && text.contains("1048576"),
            "{text}"
        );
    }
}
