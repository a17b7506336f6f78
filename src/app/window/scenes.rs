//! The scenes to choose from: the program's own, and the files of a folder.

use std::path::{Path, PathBuf};

use crate::app::commands::scene_file;
use crate::scene::builtin::{DEFAULT_SCENE, SCENES, load_builtin};
use crate::scene::{LoadedScene, SceneError, load_scene, scene_files};

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq)]
enum Origin {
    Program(&'static str),
    File(PathBuf),
}

/// A line of the menu.
#[derive(Clone, Debug)]
pub struct SceneEntry {
    pub name: String,
    /// The scene's own words, or what is wrong with it.
    pub description: Result<String, String>,
    origin: Origin,
}

/// The menu.
#[derive(Clone, Debug)]
pub struct SceneList {
    pub entries: Vec<SceneEntry>,
    pub current: usize,
    assets: Vec<PathBuf>,
}

impl SceneList {
    /// The program's scenes and those of the folder of `scene`, or of `scenes` in the current
    /// folder. Copies of the program's own scenes are listed once.
    ///
    /// # Errors
    /// A folder of `scene` that cannot be listed.
    pub fn new(scene: Option<&Path>, assets: &[PathBuf]) -> Result<Self, SceneError> {
        let mut list = Self {
            entries: SCENES.iter().map(SceneEntry::of_program).collect(),
            current: 0,
            assets: assets.to_vec(),
        };
        let file = scene.filter(|scene| is_file_name(scene));
        let beside = file.map(|file| match file.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
            _ => PathBuf::from("."),
        });
        let own = Path::new("scenes");
        let folder = beside.or_else(|| own.is_dir().then(|| own.to_path_buf()));
        if let Some(folder) = folder {
            for path in scene_files(&folder)? {
                // The folder is the asked file's own, which may be written in another way.
                let asked_for = file.filter(|file| file.file_name() == path.file_name());
                list.add_file(asked_for.unwrap_or(&path), asked_for.is_some());
            }
        }
        let wanted = match (scene, file) {
            (_, Some(file)) => Origin::File(file.to_path_buf()),
            (Some(name), None) => program_scene(&name.to_string_lossy()),
            (None, None) => program_scene(DEFAULT_SCENE),
        };
        let place = list.entries.iter().position(|e| e.origin == wanted);
        list.current = place.unwrap_or_else(|| {
            list.entries.push(SceneEntry::of_file(
                scene.unwrap_or(Path::new(DEFAULT_SCENE)),
                &list.assets,
            ));
            list.entries.len() - 1
        });
        Ok(list)
    }

    /// Reads the current scene anew.
    ///
    /// # Errors
    /// The scene's own, with file, line and key.
    pub fn load(&self) -> Result<LoadedScene, SceneError> {
        match &self.entries[self.current].origin {
            Origin::Program(name) => match load_builtin(name) {
                Some(loaded) => loaded,
                None => load_scene(Path::new(name), &self.assets),
            },
            Origin::File(path) => scene_file::load(path, &self.assets),
        }
    }

    /// The line `by` places down from the current one, around the list's ends.
    pub fn line(&self, by: isize) -> usize {
        let count = self.entries.len() as isize;
        (self.current as isize + by).rem_euclid(count) as usize
    }

    /// Adds a file. Of a scene that the program has too there is one line: the program's, or the file's where
    /// that was asked for.
    fn add_file(&mut self, path: &Path, asked_for: bool) {
        let entry = SceneEntry::of_file(path, &self.assets);
        let known = |e: &SceneEntry| {
            e.name == entry.name
                && e.description == entry.description
                && matches!(e.origin, Origin::Program(_))
        };
        match self.entries.iter().position(known) {
            Some(same) if asked_for => self.entries[same] = entry,
            Some(_) => {}
            None => self.entries.push(entry),
        }
    }
}

impl SceneEntry {
    fn of_program(scene: &crate::scene::builtin::Builtin) -> Self {
        let loaded = load_builtin(scene.name).map(|loaded| loaded.map_err(|e| e.to_string()));
        Self {
            name: scene.name.to_owned(),
            description: loaded
                .unwrap_or_else(|| Err("not in the program".into()))
                .map(|loaded| one_line(&loaded)),
            origin: Origin::Program(scene.name),
        }
    }

    fn of_file(path: &Path, assets: &[PathBuf]) -> Self {
        let loaded = load_scene(path, assets).map_err(|error| error.to_string());
        let stem = path.file_stem().unwrap_or(path.as_os_str());
        Self {
            name: stem.to_string_lossy().into_owned(),
            description: loaded.map(|loaded| one_line(&loaded)),
            origin: Origin::File(path.to_path_buf()),
        }
    }
}

/// Whether an argument means a file; else it is a name of one of the program's scenes.
fn is_file_name(scene: &Path) -> bool {
    let known = |name: &str| SCENES.iter().any(|scene| scene.name == name);
    scene.is_file() || !scene.to_str().is_some_and(known)
}

fn program_scene(name: &str) -> Origin {
    let found = SCENES.iter().find(|scene| scene.name == name);
    Origin::Program(found.map_or(DEFAULT_SCENE, |scene| scene.name))
}

fn one_line(loaded: &LoadedScene) -> String {
    let words: Vec<&str> = loaded.scene.description.split_whitespace().collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_scene_the_default_one_is_current() {
        let list = SceneList::new(None, &[]).expect("the scenes folder");
        assert_eq!(list.entries[list.current].name, DEFAULT_SCENE);
        assert_eq!(list.load().expect("a shipped scene").name, DEFAULT_SCENE);
    }

    #[test]
    fn the_list_goes_around() {
        let mut list = SceneList::new(Some(Path::new("still")), &[]).expect("the scenes folder");
        let start = list.current;
        list.current = list.line(-1);
        assert_ne!(list.current, start);
        assert_eq!(list.line(list.entries.len() as isize + 1), start);
    }

    #[test]
    fn a_file_takes_the_line_of_the_program_s_scene_that_it_holds() {
        let file = Path::new("scenes/still.ron");
        let list = SceneList::new(Some(file), &[]).expect("the scenes folder");
        let lines = list.entries.iter().filter(|entry| entry.name == "still");
        assert_eq!(lines.count(), 1);
        assert_eq!(
            list.entries[list.current].origin,
            Origin::File(file.to_path_buf())
        );
    }

    #[test]
    fn a_missing_file_is_in_the_list_with_its_error() {
        let list = SceneList::new(Some(Path::new("missing.ron")), &[]);
        let list = list.expect("the current folder can be listed");
        assert!(list.entries[list.current].description.is_err());
        assert!(list.load().is_err());
    }
}
