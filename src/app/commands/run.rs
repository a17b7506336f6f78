//! `sward run`.

mod printer;
mod refuse;

use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, ValueEnum};
use printer::{Printer, print_json};

use super::bundle::{Bundle, Contents, End, recording_name, text_of};
use super::follow::Follower;
use super::outputs::{FileTrace, ResultFile, finish_trace, make_folder, refuse_one_file_for_two};
use super::scene_file;
use crate::app::device::EngineArguments;
use crate::app::failure::exit_of_run;
use crate::app::progress::Progress;
use crate::app::values::{number, whole};
use crate::app::{Failure, complain};
use crate::run::methods::{self, METHODS, NamedMethod};
use crate::run::report::{Adapter, Report, Scenario};
use crate::run::{
    Device, Exit, Outcome, Recorder, RunError, RunOptions, junit, run_watched, table,
};
use crate::scene::{LoadedScene, limits};

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
        allow_negative_numbers = true,
        value_parser = number
    )]
    hz: f64,
    /// Length of a sub-step instead of the scene's
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = number)]
    substep: Option<f64>,
    /// Seed of the grass instead of the scene's
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        value_parser = |text: &str| whole(text, 0, u32::MAX)
    )]
    seed: Option<u32>,
    /// Settings of the solver by name, instead of the scene's; one that has a sub-step of its own
    /// goes without --substep
    #[arg(long, value_name = "NAME", value_parser = method_names())]
    method: Option<String>,
    /// Also run this engine beside, with the blades and sub-step of the scene, and tell how far the poses
    /// differ and what of that is within limits; no scenario fails by it
    #[arg(long, value_enum, value_name = "ENGINE")]
    against: Option<Truth>,
    /// Another folder in which assets are looked up; may be repeated
    #[arg(long, value_name = "DIR")]
    assets: Vec<PathBuf>,
    /// Write a CSV row of measures for every sub-step
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
    /// Record the runs for `replay`: one scene into a file that ends in .recording, or any into a
    /// folder
    #[arg(long, value_name = "DIR|FILE")]
    record: Option<PathBuf>,
    /// Also write the report into this folder, as report.json and report.txt; a scenario that fails
    /// leaves a folder of its name in it, with all it takes to see it fail again
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

/// The names of methods as values of an option.
pub(super) fn method_names() -> PossibleValuesParser {
    let value = |method: &NamedMethod| PossibleValue::new(method.name).help(method.what);
    PossibleValuesParser::new(METHODS.iter().map(value))
}

/// Runs all scenes and prints the report.
pub fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let options = options(arguments)?;
    refuse::what_cannot_be_recorded(arguments)?;
    refuse::what_would_be_ignored(arguments, &options)?;
    scene_file::check_folders(&arguments.assets)?;
    let names = scene_file::distinct_names(&arguments.scenes);
    let mut outputs = Outputs::open(arguments, &names)?;
    let device = arguments.engine.open()?;
    refuse::unknown_to_gpu(&device, options.method)?;
    let adapter = device.gpu().map(Adapter::of);
    let mut report = Report::new(device.engine_name(), adapter, options.hz);
    let recordings = std::mem::take(&mut outputs.recordings);
    let mut printer = Printer::new(out, arguments.json);
    for ((scene, name), recording) in arguments.scenes.iter().zip(&names).zip(recordings) {
        let mut batch = Batch {
            arguments,
            options: &options,
            device: &device,
            trace: outputs.trace.as_mut(),
            blank: Report {
                scenarios: Vec::new(),
                ..report.clone()
            },
        };
        let scenario = batch.scenario(scene, name, recording);
        if let Some(error) = &scenario.error {
            complain(error);
        }
        printer.scenario(&scenario);
        report.scenarios.push(scenario);
    }
    outputs.finish(&report, arguments)?;
    printer.finish(&report)?;
    Ok(report.exit())
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
        ..RunOptions::default()
    })
}

/// Every file the run is to write, opened before it.
struct Outputs {
    trace: Option<FileTrace>,
    /// One per scene, where recordings are wanted.
    recordings: Vec<Option<ResultFile>>,
    json: Option<ResultFile>,
    text: Option<ResultFile>,
    junit: Option<ResultFile>,
}

impl Outputs {
    fn open(arguments: &Arguments, names: &[String]) -> Result<Self, Failure> {
        refuse_one_file_for_two(
            &[
                ("--trace", arguments.trace.as_deref()),
                ("--junit", arguments.junit.as_deref()),
                ("--record", arguments.record.as_deref()),
                (
                    "--out",
                    arguments
                        .out
                        .as_deref()
                        .map(|f| f.join("report.json"))
                        .as_deref(),
                ),
                (
                    "--out",
                    arguments
                        .out
                        .as_deref()
                        .map(|f| f.join("report.txt"))
                        .as_deref(),
                ),
            ],
            &arguments.scenes,
        )?;
        if let Some(folder) = &arguments.out {
            make_folder(folder)?;
        }
        let open = |path: Option<PathBuf>| path.as_deref().map(ResultFile::create).transpose();
        let in_out = |file: &str| arguments.out.as_ref().map(|folder| folder.join(file));
        Ok(Self {
            trace: open(arguments.trace.clone())?.map(ResultFile::into_trace),
            recordings: open_recordings(arguments, names)?,
            json: open(in_out("report.json"))?,
            text: open(in_out("report.txt"))?,
            junit: open(arguments.junit.clone())?,
        })
    }

    fn finish(self, report: &Report, arguments: &Arguments) -> Result<(), Failure> {
        finish_trace(self.trace, arguments.trace.as_deref())?;
        if let Some(file) = self.json {
            let mut json = Vec::new();
            print_json(report, &mut json)?;
            file.write(&json)?;
        }
        if let Some(file) = self.text {
            let mut text = Vec::new();
            table::write_table(report, &mut text)?;
            file.write(&text)?;
        }
        match self.junit {
            Some(file) => file.write(junit::junit(report).as_bytes()),
            None => Ok(()),
        }
    }
}

fn open_recordings(
    arguments: &Arguments,
    names: &[String],
) -> Result<Vec<Option<ResultFile>>, Failure> {
    let Some(path) = &arguments.record else {
        return Ok(names.iter().map(|_| None).collect());
    };
    let is_file = path.extension().is_some_and(|ending| ending == "recording");
    if is_file && names.len() > 1 {
        let text = format!(
            "--record {} is one file for {} scenes: give a folder",
            path.display(),
            names.len()
        );
        return Err(Failure::Usage(text));
    }
    if !is_file && path.extension().is_some() && !path.is_dir() {
        let text = format!(
            "--record {}: a recording's name ends in .recording; a new folder's name has no ending",
            path.display()
        );
        return Err(Failure::Usage(text));
    }
    if !is_file {
        make_folder(path)?;
    }
    let file_of = |name: &String| match is_file {
        true => path.clone(),
        false => path.join(recording_name(name)),
    };
    let files = names.iter().map(file_of);
    files
        .map(|file| ResultFile::create(&file).map(Some))
        .collect()
}

/// What the scenarios of a command share.
struct Batch<'a> {
    arguments: &'a Arguments,
    options: &'a RunOptions,
    device: &'a Device,
    trace: Option<&'a mut FileTrace>,
    /// A report without scenarios.
    blank: Report,
}

impl Batch<'_> {
    /// Runs one scene; whatever goes wrong is part of the report, so that the others still run.
    fn scenario(&mut self, scene: &Path, own_name: &str, record: Option<ResultFile>) -> Scenario {
        let name = scene_file::name(scene);
        let loaded = match scene_file::load(scene, &self.arguments.assets) {
            Ok(loaded) => loaded,
            Err(error) => return Scenario::broken(name, error.to_string(), Exit::Invalid),
        };
        let folder = self.arguments.out.as_ref().map(|out| out.join(own_name));
        let bundle = folder.map(|folder| Bundle::open(folder, own_name));
        let mut bundle = match bundle.transpose() {
            Ok(bundle) => bundle,
            Err(error) => return Scenario::broken(name, error.to_string(), error.exit()),
        };
        let recorder = match (Recorder::new(&loaded, self.options), &record) {
            (Ok(recorder), _) if record.is_some() || bundle.is_some() => {
                // What the reference does cannot be replayed.
                Some(recorder).filter(|_| !matches!(self.device, Device::Reference))
            }
            (Err(error), Some(_)) => {
                return Scenario::broken(name.clone(), format!("{name}: {error}"), Exit::Usage);
            }
            _ => None,
        };
        let mut follower = Follower {
            name: &name,
            bar: Progress::new(&name),
            trace: self.trace.as_deref_mut(),
            frames: bundle.as_mut().map(|bundle| &mut bundle.trace),
            recorder,
            verifier: None,
            ticks: 0,
        };
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            run_watched(&loaded, self.options, self.device, &mut follower)
        }));
        let recorder = follower.recorder.take();
        let ticks = follower.ticks;
        drop(follower);
        let (scenario, end) = judged(&name, ticks, outcome);
        let kept = Kept {
            own_name,
            loaded: &loaded,
            recorder,
        };
        match self.keep(&kept, record, bundle, &scenario, end) {
            Ok(()) => scenario,
            Err(error) => Scenario::broken(name, error.to_string(), error.exit()),
        }
    }

    /// Writes what is to stay of a run.
    fn keep(
        &self,
        kept: &Kept<'_>,
        record: Option<ResultFile>,
        bundle: Option<Bundle>,
        scenario: &Scenario,
        end: End,
    ) -> Result<(), Failure> {
        let recording = kept.recorder.as_ref().map(Recorder::recording);
        if let (Some(file), Some(recording)) = (record, recording) {
            file.write(&text_of(recording)?)?;
        }
        let Some(bundle) = bundle else {
            return Ok(());
        };
        if scenario.passed {
            return bundle.discard();
        }
        let mut report = self.blank.clone();
        report.scenarios.push(scenario.clone());
        let contents = Contents {
            name: kept.own_name,
            loaded: kept.loaded,
            report: &report,
            recording,
            device: self.device,
            options: self.options,
            asset_dirs: &self.arguments.assets,
        };
        let folder = bundle.fill(&contents, end)?;
        let (name, folder) = (&scenario.name, folder.display());
        complain(&format!("{name} failed; see {folder}"));
        Ok(())
    }
}

/// What is known of a run besides its outcome.
struct Kept<'a> {
    /// Name of its files.
    own_name: &'a str,
    loaded: &'a LoadedScene,
    recorder: Option<Recorder>,
}

/// The report of a run, and how it ended after so many whole sub-steps.
fn judged(
    name: &str,
    ticks: u32,
    outcome: std::thread::Result<Result<Outcome, RunError>>,
) -> (Scenario, End) {
    let (error, exit) = match outcome {
        Ok(Ok(outcome)) => {
            for body in outcome.meadow.bodies.quarantined() {
                complain(&format!(
                    "{name}: `{body}` was taken out: its place or motion is no finite number"
                ));
            }
            return (Scenario::of(&outcome), End::Whole(Box::new(outcome)));
        }
        Ok(Err(error)) => (error.to_string(), exit_of_run(&error)),
        Err(_) => (
            format!("{name}: internal error, see the message above"),
            Exit::Internal,
        ),
    };
    let scenario = Scenario::broken(name.to_owned(), error.clone(), exit);
    (scenario, End::BrokenOff { ticks, error })
}
