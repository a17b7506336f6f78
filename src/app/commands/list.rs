//! `sward list`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;

use super::scene_file;
use crate::app::{Failure, complain};
use crate::run::Exit;
use crate::scene::builtin::SCENES;
use crate::scene::{LoadedScene, SceneError, scene_files};

/// List scenes with their descriptions
#[derive(Args, Debug)]
pub struct Arguments {
    /// Folders to look in; without one, the program's own scenes are listed, which other commands
    /// take by name
    #[arg(value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// Another folder in which scenes' assets are looked up; may be repeated
    #[arg(long, value_name = "DIR", requires = "folders")]
    assets: Vec<PathBuf>,
}

/// Prints a line per scene. Invalid scenes are named on stderr.
pub fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    scene_file::check_folders(&arguments.assets)?;
    let mut scenes: Vec<PathBuf> = Vec::new();
    if arguments.folders.is_empty() {
        scenes.extend(SCENES.iter().map(|scene| PathBuf::from(scene.name)));
    }
    for folder in &arguments.folders {
        if !folder.is_dir() {
            let what = if folder.exists() {
                "a file"
            } else {
                "not there"
            };
            let folder = folder.display();
            return Err(Failure::UnknownScene(format!(
                "{folder}: it is {what}; give a folder of scenes, or none for the program's own"
            )));
        }
        scenes.extend(scene_files(folder)?);
    }
    let mut exits = Vec::new();
    for scene in &scenes {
        let loaded = scene_file::load(scene, &arguments.assets);
        exits.push(write_line(&scene.display().to_string(), loaded, out)?);
    }
    Ok(Exit::of_all(exits))
}

fn write_line(
    name: &str,
    loaded: Result<LoadedScene, SceneError>,
    out: &mut impl Write,
) -> io::Result<Exit> {
    match loaded {
        Ok(loaded) => {
            let words: Vec<&str> = loaded.scene.description.split_whitespace().collect();
            writeln!(out, "{name:<16}  {}", words.join(" "))?;
            Ok(Exit::Ok)
        }
        Err(error) => {
            complain(&error);
            Ok(Exit::Invalid)
        }
    }
}
