//! `sward view`, which is also `sward` alone.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use super::outputs::make_folder;
use super::render::size;
use super::scene_file;
use crate::app::device::EngineArguments;
use crate::app::values::{count, density};
use crate::app::{Failure, window};
use crate::render::Count;
use crate::run::Exit;

/// Open a scene in a window; without a display, run it and write a picture
#[derive(Args, Debug)]
pub struct Arguments {
    /// A scene file, or the name of one of the program's own scenes; by default the meadow
    #[arg(value_name = "SCENE")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    engine: EngineArguments,
    /// Another folder in which assets are looked up; may be repeated
    #[arg(long, value_name = "DIR")]
    assets: Vec<PathBuf>,
    /// Size of the window in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    size: [u32; 2],
    /// Draw this many times as many plants, 0.1 to 4; above 1 blades get more companions, other plants
    /// stay as many
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = density)]
    density: f32,
    /// What decides how many plants are drawn: distance, or P15's projected (eq. 1) or world (eq. 2) area of a
    /// seeding triangle, with plants per pixel after a comma
    #[arg(long, value_name = "RULE[,PER_PX]", default_value = "distance", value_parser = count)]
    count: Count,
    /// Folder for pictures: those saved with F12, and the one written without a display; by default
    /// the current folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Default for Arguments {
    fn default() -> Self {
        Self {
            scene: None,
            engine: EngineArguments::default(),
            assets: Vec::new(),
            size: [1280, 720],
            density: 1.0,
            count: Count::Distance,
            out: None,
        }
    }
}

/// Opens the window.
pub fn run(arguments: Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    scene_file::check_folders(&arguments.assets)?;
    if let Some(folder) = &arguments.out {
        make_folder(folder)?;
    }
    let options = window::Options {
        scene: arguments.scene,
        assets: arguments.assets,
        engine: arguments.engine.choice()?,
        size: arguments.size,
        density: arguments.density,
        count: arguments.count,
        out: arguments.out.unwrap_or_else(|| PathBuf::from(".")),
    };
    window::open(&options, out)
}
