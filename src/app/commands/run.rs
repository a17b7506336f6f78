//! `sward run`.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, ValueEnum};

use super::scene_file;
use crate::app::device::EngineArguments;
use crate::app::failure::exit_of_run;
use crate::app::progress::Progress;
use crate::app::{Failure, complain};
use crate::run::methods::{self, METHODS, NamedMethod};
use crate::run::report::{Adapter, Report, Scenario};
use crate::run::trace::Trace;
use crate::run::{Device, Exit, Frame, RunError, RunOptions, junit, run_scene, table};
use crate::scene::limits;

/// Run scenarios without a window and check their expectations
#[derive(Args, Debug)]
pub struct Arguments {
    /// Scene files, or names of the program's own scenes
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<PathBuf>,
    #[command(flatten)]
    engine: EngineArguments,
    /// Frames per second; the motion does not depend on it
    #[arg(
        long,
        value_name = "N",
        default_value_t = 60.0,
        allow_negative_numbers = true
    )]
    hz: f64,
    /// Length of a sub-step instead of the scene's
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    substep: Option<f64>,
    /// Seed of the grass instead of the scene's
    #[arg(long, value_name = "N")]
    seed: Option<u32>,
    /// Settings of the solver by name, instead of the scene's
    #[arg(long, value_name = "NAME", value_parser = method_names())]
    method: Option<String>,
    /// Also run this engine beside, and tell how far the poses differ
    #[arg(long, value_enum, value_name = "ENGINE")]
    against: Option<Truth>,
    /// Another folder in which assets are looked up; may be repeated
    #[arg(long, value_name = "DIR")]
    assets: Vec<PathBuf>,
    /// Write a CSV row of measures for every frame
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
    /// Also write the report into this folder, as report.json and report.txt
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also write the report as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
}

/// What a run can be compared with.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Truth {
    Reference,
}

fn method_names() -> PossibleValuesParser {
    let value = |method: &NamedMethod| PossibleValue::new(method.name).help(method.what);
    PossibleValuesParser::new(METHODS.iter().map(value))
}

/// Runs all scenes and prints the report.
pub fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let options = options(arguments)?;
    let device = arguments.engine.open()?;
    let adapter = device.gpu().map(Adapter::of);
    let mut report = Report::new(device.engine_name(), adapter, options.hz);
    let mut trace = open_trace(arguments)?;
    for scene in &arguments.scenes {
        let scenario = run_one(scene, arguments, &options, &device, &mut trace);
        if let Some(error) = &scenario.error {
            complain(error);
        }
        report.scenarios.push(scenario);
    }
    if let (Some(trace), Some(path)) = (trace, &arguments.trace) {
        trace.finish().map_err(|e| Failure::file(path, e))?;
    }
    write_files(&report, arguments)?;
    let printed = if arguments.json {
        print_json(&report, out)
    } else {
        table::write_table(&report, out)
    };
    match printed {
        // Whoever closed the pipe still gets the verdict as the exit code.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(report.exit()),
    }
}

fn options(arguments: &Arguments) -> Result<RunOptions, Failure> {
    if let Some(substep_s) = arguments.substep {
        let limit = limits::SUBSTEP;
        if !(limit.min..=limit.max).contains(&substep_s) {
            let text = format!("--substep {substep_s}: give {limit}");
            return Err(Failure::Usage(text));
        }
    }
    if !(1.0..=10_000.0).contains(&arguments.hz) {
        return Err(Failure::Usage(RunError::Rate(arguments.hz).to_string()));
    }
    Ok(RunOptions {
        hz: arguments.hz,
        substep_s: arguments.substep,
        seed: arguments.seed,
        method: arguments.method.as_deref().and_then(methods::method),
        against_reference: arguments.against.is_some(),
    })
}

type FileTrace = Trace<BufWriter<File>>;

fn open_trace(arguments: &Arguments) -> Result<Option<FileTrace>, Failure> {
    let Some(path) = &arguments.trace else {
        return Ok(None);
    };
    let file = File::create(path).map_err(|e| Failure::file(path, e))?;
    Ok(Some(Trace::new(BufWriter::new(file))))
}

/// Runs one scene; whatever goes wrong is part of the report, so that the others still run.
fn run_one(
    scene: &Path,
    arguments: &Arguments,
    options: &RunOptions,
    device: &Device,
    trace: &mut Option<FileTrace>,
) -> Scenario {
    let name = scene_file::name(scene);
    let loaded = match scene_file::load(scene, &arguments.assets) {
        Ok(loaded) => loaded,
        Err(error) => return Scenario::broken(name, error.to_string(), Exit::Invalid),
    };
    let bar = Progress::new(&name);
    let each_frame = |frame: &Frame<'_>| {
        bar.set(frame.done);
        if let Some(trace) = trace {
            trace.frame(&name, frame);
        }
    };
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        run_scene(&loaded, options, device, each_frame).map(|outcome| Scenario::of(&outcome))
    }));
    drop(bar);
    match outcome {
        Ok(Ok(scenario)) => scenario,
        Ok(Err(error)) => {
            let exit = exit_of_run(&error);
            Scenario::broken(name, error.to_string(), exit)
        }
        Err(_) => {
            let error = format!("{name}: internal error, see the message above");
            Scenario::broken(name, error, Exit::Internal)
        }
    }
}

fn print_json(report: &Report, out: &mut impl Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, report)?;
    writeln!(out)
}

fn write_files(report: &Report, arguments: &Arguments) -> Result<(), Failure> {
    if let Some(folder) = &arguments.out {
        fs::create_dir_all(folder).map_err(|e| Failure::file(folder, e))?;
        let mut json = Vec::new();
        print_json(report, &mut json)?;
        write_file(&folder.join("report.json"), &json)?;
        let mut text = Vec::new();
        table::write_table(report, &mut text)?;
        write_file(&folder.join("report.txt"), &text)?;
    }
    if let Some(file) = &arguments.junit {
        write_file(file, junit::junit(report).as_bytes())?;
    }
    Ok(())
}

fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    fs::write(path, bytes).map_err(|e| Failure::file(path, e))
}
