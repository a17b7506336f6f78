//! The commands: one file each, with its arguments and what it prints.

pub mod bench;
mod bench_bodies;
mod bench_flight;
mod bench_light;
mod bench_popping;
mod bench_submission;
mod bench_terrain;
pub mod blade_shape;
mod bundle;
pub mod doctor;
mod follow;
pub mod list;
pub(super) mod outputs;
pub mod render;
pub mod replay;
pub mod report;
pub mod run;
pub(super) mod scene_file;
mod schema;
pub mod view;

use std::io;

use super::Failure;
use super::cli::Command;
use crate::run::Exit;

/// Runs one command.
///
/// # Errors
///
/// The command's own; each knows its exit code.
pub fn run(command: Option<Command>) -> Result<Exit, Failure> {
    let out = &mut io::stdout().lock();
    match command.unwrap_or_else(|| Command::View(view::Arguments::default())) {
        Command::View(arguments) => view::run(arguments, out),
        Command::Run(arguments) => run::run(&arguments, out),
        Command::Render(arguments) => render::run(&arguments, out),
        Command::Bench(arguments) => bench::run(&arguments, out),
        Command::Report(arguments) => report::run(&arguments, out),
        Command::BladeShape(arguments) => blade_shape::run(&arguments, out),
        Command::Replay(arguments) => replay::run(&arguments, out),
        Command::List(arguments) => list::run(&arguments, out),
        Command::Schema => schema::run(out),
        Command::Doctor => doctor::run(out),
    }
}
