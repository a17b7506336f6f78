//! `sward list`.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::app::Failure;
use crate::run::Exit;
use crate::scene::{load_scene, scene_files};

/// List scenes with their descriptions
#[derive(Args, Debug)]
pub struct Arguments {
    /// Folders to look in
    #[arg(value_name = "FOLDER", default_value = "scenes")]
    folders: Vec<PathBuf>,
    /// Another folder in which scenes' assets are looked up; may be repeated
    #[arg(long, value_name = "DIR")]
    assets: Vec<PathBuf>,
}

/// Prints a line per scene. Invalid scenes are named on stderr.
pub fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let mut exits = Vec::new();
    for folder in &arguments.folders {
        for file in scene_files(folder)? {
            exits.push(list_one(&file, &arguments.assets, out)?);
        }
    }
    Ok(Exit::of_all(exits))
}

fn list_one(file: &Path, assets: &[PathBuf], out: &mut impl Write) -> Result<Exit, Failure> {
    match load_scene(file, assets) {
        Ok(loaded) => {
            let about = loaded.scene.description.split_whitespace();
            let about = about.collect::<Vec<_>>().join(" ");
            writeln!(out, "{}\t{about}", file.display())?;
            Ok(Exit::Ok)
        }
        Err(error) => {
            eprintln!("sward: {error}");
            Ok(Exit::Invalid)
        }
    }
}
