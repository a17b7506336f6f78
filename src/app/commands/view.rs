//! `sward view`, which is also `sward` alone.

use std::io::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::app::{Failure, window};
use crate::run::{EngineChoice, Exit};

/// Longest side of a window, in pixels.
const MOST_PIXELS: u32 = 16_384;

/// Open a scene in a window; without a display, run it and write a picture
#[derive(Args, Debug)]
pub struct Arguments {
    /// A scene file, or the name of one of the program's own scenes; by default the meadow
    #[arg(value_name = "SCENE")]
    scene: Option<PathBuf>,
    /// What simulates the grass; by default the gpu on a hardware adapter, else the cpu
    #[arg(long, value_enum)]
    engine: Option<EngineName>,
    /// Another folder in which assets are looked up; may be repeated
    #[arg(long, value_name = "DIR")]
    assets: Vec<PathBuf>,
    /// Size of the window in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size)]
    size: [u32; 2],
    /// Folder for pictures saved with F12
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum EngineName {
    Cpu,
    Gpu,
}

impl Default for Arguments {
    fn default() -> Self {
        Self {
            scene: None,
            engine: None,
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
        engine: match arguments.engine {
            None => EngineChoice::Auto,
            Some(EngineName::Cpu) => EngineChoice::Cpu,
            Some(EngineName::Gpu) => EngineChoice::Gpu,
        },
        size: arguments.size,
        out: arguments.out,
    };
    window::open(&options, out)
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let wanted = format!("give WIDTHxHEIGHT, each 1 to {MOST_PIXELS}, such as 1280x720");
    let (width, height) = text.split_once('x').ok_or_else(|| wanted.clone())?;
    let side = |text: &str| match text.parse() {
        Ok(pixels @ 1..=MOST_PIXELS) => Ok(pixels),
        _ => Err(wanted.clone()),
    };
    Ok([side(width)?, side(height)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_numbers_of_pixels() {
        assert_eq!(parse_size("640x400"), Ok([640, 400]));
        for wrong in [
            "640", "0x400", "640x", "-1x5", "640X400", "20000x1", "1e3x5",
        ] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
    }
}
