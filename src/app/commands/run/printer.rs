//! What `sward run` prints.

use std::io::{self, Write};

use crate::app::Failure;
use crate::run::report::{Report, Scenario};
use crate::run::table;

/// Prints scenarios as they end, or all of them at the end where JSON is asked for.
pub struct Printer<'a, W> {
    out: &'a mut W,
    json: bool,
    /// What went wrong first; nothing is printed after it, and the other scenarios still run.
    failed: Option<io::Error>,
}

impl<'a, W: Write> Printer<'a, W> {
    pub fn new(out: &'a mut W, json: bool) -> Self {
        Self {
            out,
            json,
            failed: None,
        }
    }

    /// A scenario that has ended.
    pub fn scenario(&mut self, scenario: &Scenario) {
        if !self.json && self.failed.is_none() {
            self.failed = table::write_scenario(scenario, self.out).err();
        }
    }

    /// The end of the run.
    ///
    /// # Errors
    ///
    /// Those of stdout, a closed pipe excepted.
    pub fn finish(mut self, report: &Report) -> Result<(), Failure> {
        if self.failed.is_none() {
            let printed = match self.json {
                true => print_json(report, self.out),
                false => table::write_count(report, self.out),
            };
            self.failed = printed.err();
        }
        match self.failed {
            // Whoever closed the pipe still gets the verdict as the exit code.
            Some(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error.into()),
            _ => Ok(()),
        }
    }
}

/// Prints the whole report as JSON.
///
/// # Errors
///
/// The writer's.
pub fn print_json(report: &Report, out: &mut impl Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, report)?;
    writeln!(out)
}
