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
    #[arg(long, value_name = "DIR")]
    assets: Vec<PathBuf>,
}

/// Prints a line per scene. Invalid scenes are named on stderr.
pub fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let mut scenes: Vec<PathBuf> = Vec::new();
    if arguments.folders.is_empty() {
        scenes.extend(SCENES.iter().map(|scene| PathBuf::from(scene.name)));
    }
    for folder in &arguments.folders {
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
