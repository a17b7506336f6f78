//! The command line.

use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Parser, Subcommand};

use super::commands::{bench, blade_shape, list, render, replay, report, run, view};
use crate::scene::builtin::SCENES;

/// Responsive grass: bodies press real imprints into a meadow.
///
/// Without a command it opens the default meadow in a window. stdout carries the result only; logs
/// and progress go to stderr.
#[derive(Debug, Parser)]
#[command(name = "sward", version, after_help = EXIT_CODES)]
pub struct Cli {
    /// Say more on stderr.
    #[arg(short, long, global = true)]
    pub verbose: bool,
    /// `None` opens the window.
    #[command(subcommand)]
    pub command: Option<Command>,
}

const EXIT_CODES: &str = "\
Exit codes: 0 all well; 1 an expectation failed, a replay differed or a limit was exceeded; 2 \
usage; 3 a scene, recording or asset is invalid; 4 a needed adapter or feature is missing; 5 internal error.";

#[derive(Debug, Subcommand)]
pub enum Command {
    View(view::Arguments),
    Run(run::Arguments),
    Replay(replay::Arguments),
    Render(render::Arguments),
    Bench(bench::Arguments),
    Report(report::Arguments),
    BladeShape(blade_shape::Arguments),
    List(list::Arguments),
    /// Print the JSON schema of a scene
    Schema,
    /// Show the graphics adapters, their limits and features, and what these mean
    Doctor,
}

/// What to write instead, where a scene stands in the place of a command.
pub fn scene_for_command(error: &clap::Error) -> Option<String> {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
        return None;
    };
    let is_scene = Path::new(word).is_file() || SCENES.iter().any(|scene| scene.name == word);
    (error.kind() == ErrorKind::InvalidSubcommand && is_scene).then(|| {
        format!(
            "`{word}` is a scene and no command: `sward view {word}` opens it in a window, \
             `sward run {word}` runs it without one"
        )
    })
}
