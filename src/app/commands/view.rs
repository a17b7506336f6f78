//! `sward view`, which is also `sward` alone.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use super::render::size;
use crate::app::device::EngineArguments;
use crate::app::{Failure, window};
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
    /// Folder for pictures saved with F12
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
}

impl Default for Arguments {
    fn default() -> Self {
        Self {
            scene: None,
            engine: EngineArguments::default(),
            assets: Vec::new(),
            size: [1280, 720],
            out: PathBuf::from("."),
        }
    }
}

/// Opens the window.
pub fn run(arguments: Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let options = window::Options {
        scene: arguments.scene,
        assets: arguments.assets,
        engine: arguments.engine.choice()?,
        size: arguments.size,
        out: arguments.out,
    };
    window::open(&options, out)
}
