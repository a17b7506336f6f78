//! The program: command line, window, panels.

mod cli;
mod commands;
mod device;
mod failure;
mod light_up;
mod progress;
mod values;
mod window;

use std::fmt::Display;
use std::io::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use clap::Parser;

pub use failure::Failure;

use crate::run::Exit;

/// Runs the program with this process's arguments.
///
/// stdout carries the result, stderr logs and progress. A reader that closes stdout early ends the
/// program quietly.
pub fn main() -> ExitCode {
    let arguments = match cli::Cli::try_parse() {
        Ok(arguments) => arguments,
        Err(help_or_error) => {
            match cli::scene_for_command(&help_or_error) {
                Some(advice) => complain(&advice),
                // Nobody reads a help text that cannot be printed.
                None => _ = help_or_error.print(),
            }
            return if help_or_error.use_stderr() {
                Exit::Usage.into()
            } else {
                Exit::Ok.into()
            };
        }
    };
    start_log(arguments.verbose);
    // A panic is a fault of the program, which has a code of its own; its hook has printed it.
    let outcome = catch_unwind(AssertUnwindSafe(|| commands::run(arguments.command)));
    match outcome {
        Ok(Ok(exit)) => exit.into(),
        Ok(Err(failure)) => {
            if !failure.is_closed_pipe() {
                complain(&failure);
            }
            failure.exit().into()
        }
        Err(_) => Exit::Internal.into(),
    }
}

/// Says on stderr what went wrong. Where stderr is closed the exit code has to do.
fn complain(problem: &dyn Display) {
    let _ = writeln!(io::stderr(), "sward: {problem}");
}

fn start_log(verbose: bool) {
    let level = if verbose { "info" } else { "warn" };
    let default = env_logger::Env::default().default_filter_or(level);
    env_logger::Builder::from_env(default).init();
}
