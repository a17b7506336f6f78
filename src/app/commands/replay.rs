//! `sward replay`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::follow::Follower;
use super::outputs::{ResultFile, finish_trace, refuse_one_file_for_two};
use super::scene_file;
use crate::app::Failure;
use crate::app::device::EngineArguments;
use crate::app::progress::Progress;
use crate::run::recording::{Difference, Hashed};
use crate::run::report::{Adapter, Report, Scenario};
use crate::run::{Device, EngineChoice, Exit, Recording, Verifier, run_watched, table};

/// Run a recording again
#[derive(Args, Debug)]
pub struct Arguments {
    /// A file written by `run --record`, or from a bundle
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Compare every tick with the recorded one and name the first that differs; what the scene
    /// expects does not count
    #[arg(long)]
    verify: bool,
    #[command(flatten)]
    engine: EngineArguments,
    /// Another folder in which assets are looked up; may be repeated
    #[arg(long, value_name = "DIR")]
    assets: Vec<PathBuf>,
    /// Write a CSV row of measures for every sub-step
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

/// The report of a run, and how it compares with the recording.
#[derive(Serialize)]
struct Replayed<'a> {
    #[serde(flatten)]
    report: &'a Report,
    /// Null without `--verify`.
    replay: Option<Comparison>,
}

#[derive(Serialize)]
struct Comparison {
    /// What the recorded hashes cover.
    hashed: Hashed,
    ticks_recorded: u32,
    ticks_compared: u32,
    equal: bool,
    /// Null where all ticks are equal.
    first_difference: Option<FirstDifference>,
}

#[derive(Serialize)]
struct FirstDifference {
    tick: u32,
    time_s: f64,
    /// Lower halves of the state hashes, 8 hexadecimal digits.
    recorded: String,
    found: String,
}

/// Runs the recording and prints the report.
pub fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let choice = arguments.engine.choice()?;
    if arguments.verify && choice == EngineChoice::Gpu {
        let text = "--verify compares the bits of the cpu engine: leave --engine gpu and \
                    --require-gpu out";
        return Err(Failure::Usage(text.into()));
    }
    if choice == EngineChoice::Reference {
        let text = "the reference engine makes sub-steps of its own, which no recording has: take \
                    --engine cpu or gpu, or `sward run --engine reference` of the scene";
        return Err(Failure::Usage(text.into()));
    }
    scene_file::check_folders(&arguments.assets)?;
    let read = std::slice::from_ref(&arguments.file);
    refuse_one_file_for_two(&[("--trace", arguments.trace.as_deref())], read)?;
    let mut trace = match &arguments.trace {
        Some(path) => Some(ResultFile::create(path)?.into_trace()),
        None => None,
    };
    let (recording, loaded) = Recording::read(&arguments.file, &arguments.assets)?;
    if recording.sward != env!("CARGO_PKG_VERSION") {
        log::warn!(
            "recorded by sward {}, replayed by {}: the bits may differ",
            recording.sward,
            env!("CARGO_PKG_VERSION")
        );
    }
    let device = match choice {
        EngineChoice::Auto if arguments.verify => Device::Processor,
        _ => arguments.engine.open()?,
    };
    let mut follower = Follower {
        name: &loaded.name,
        bar: Progress::new(&loaded.name),
        trace: trace.as_mut(),
        frames: None,
        recorder: None,
        verifier: arguments.verify.then(|| Verifier::new(&recording)),
        ticks: 0,
    };
    let outcome = run_watched(&loaded, &recording.options(), &device, &mut follower)?;
    let verified = follower.verifier.take().map(|v| compare(&recording, &v));
    drop(follower);
    finish_trace(trace, arguments.trace.as_deref())?;
    let adapter = device.gpu().map(Adapter::of);
    let mut report = Report::new(device.engine_name(), adapter, recording.hz);
    report.scenarios.push(Scenario::of(&outcome));
    let exit = match &verified {
        Some(comparison) if comparison.equal => Exit::Ok,
        Some(_) => Exit::Failed,
        None => report.exit(),
    };
    let replayed = Replayed {
        report: &report,
        replay: verified,
    };
    match print(&replayed, arguments.json, out) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(exit),
    }
}

fn compare(recording: &Recording, verifier: &Verifier<'_>) -> Comparison {
    let first = verifier.first_difference();
    Comparison {
        hashed: recording.hashed,
        ticks_recorded: recording.hashes.len() as u32,
        ticks_compared: verifier.compared(),
        equal: first.is_none() && verifier.compared() as usize == recording.hashes.len(),
        first_difference: first.map(|difference| {
            let Difference {
                tick,
                time_s,
                recorded,
                found,
            } = difference;
            FirstDifference {
                tick,
                time_s,
                recorded: format!("{recorded:08x}"),
                found: format!("{found:08x}"),
            }
        }),
    }
}

fn print(replayed: &Replayed<'_>, json: bool, out: &mut impl Write) -> io::Result<()> {
    if json {
        serde_json::to_writer_pretty(&mut *out, replayed)?;
        return writeln!(out);
    }
    match &replayed.replay {
        Some(comparison) => write_comparison(comparison, replayed.report, out),
        None => table::write_table(replayed.report, out),
    }
}

/// Says whether the ticks are equal, which is all that was asked. What the scene expects is judged by
/// `run`, and by `replay` alone.
fn write_comparison(
    comparison: &Comparison,
    report: &Report,
    out: &mut impl Write,
) -> io::Result<()> {
    let covered = match comparison.hashed {
        Hashed::GrassAndBodies => "grass and bodies",
        Hashed::Bodies => "bodies alone",
    };
    let names: Vec<&str> = report.scenarios.iter().map(|s| s.name.as_str()).collect();
    let name = names.join(", ");
    let (compared, recorded) = (comparison.ticks_compared, comparison.ticks_recorded);
    match &comparison.first_difference {
        Some(first) => writeln!(
            out,
            "{name}: DIFFERS from the recording ({covered})\nreplay: tick {} at {:.6} s is the first \
             that differs: {} was recorded, {} found",
            first.tick, first.time_s, first.recorded, first.found
        )?,
        None if comparison.equal => writeln!(
            out,
            "{name}: as recorded\nreplay: {compared} of {recorded} ticks compared, all equal ({covered})"
        )?,
        None => writeln!(
            out,
            "{name}: CUT SHORT\nreplay: {compared} of {recorded} ticks compared, all equal ({covered})"
        )?,
    }
    let expectations = report.scenarios.iter().flat_map(|s| &s.expectations);
    let missed = expectations.filter(|e| e.passed == Some(false)).count();
    if missed > 0 {
        writeln!(
            out,
            "not judged by --verify: {missed} of the scene's expectations do not hold; `sward replay` \
             without it tells which"
        )?;
    }
    Ok(())
}
