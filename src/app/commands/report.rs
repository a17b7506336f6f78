//! `sward report`.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::scene_file;
use crate::app::Failure;
use crate::app::progress::Progress;
use crate::gpu::{Gpu, GpuError};
use crate::run::accuracy::{
    self, COST_SCENE, Plan, Planned, Report, Store, cost_methods, error_plot, scenes, summary_plot,
    write_markdown,
};
use crate::run::methods::{self, NamedMethod};
use crate::run::{Device, Exit};
use crate::scene::{LoadedScene, builtin};

/// Measure what the methods are worth
#[derive(Args, Debug)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Accuracy(Accuracy),
}

/// Error of every method against its time, beside the reference engine
///
/// Prints a report in Markdown. Without --quick it runs every method on the report's own scenes and
/// on the program's, which takes hours.
#[derive(Args, Debug)]
struct Accuracy {
    /// Only these scenes: the report's own, the program's, or files; may be repeated
    #[arg(long, value_name = "SCENE")]
    scene: Vec<PathBuf>,
    /// Only these methods; may be repeated
    #[arg(long, value_name = "NAME", value_parser = super::run::method_names())]
    method: Vec<String>,
    /// The report's own scenes and the ends of every curve: minutes instead of hours
    #[arg(long)]
    quick: bool,
    /// Leave the graphics adapter alone; rounding is not measured then
    #[arg(long)]
    no_gpu: bool,
    /// Also write points.csv, accuracy.md and plots as SVG into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Keep the points that the folder already has, as after an interrupted report
    #[arg(long, requires = "out")]
    resume: bool,
}

/// File of the measured points.
const POINTS: &str = "points.csv";
/// File of the report.
const MARKDOWN: &str = "accuracy.md";

/// Runs the report and prints it.
pub fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let What::Accuracy(arguments) = &arguments.what;
    let plan = plan(arguments)?;
    let mut store = open_store(arguments)?;
    let device = if arguments.no_gpu {
        None
    } else {
        any_adapter()?
    };
    let progress = Progress::new("report accuracy");
    let report = accuracy::run(&plan, &mut store, device.as_ref(), |done| {
        progress.set(done)
    })?;
    drop(progress);
    let mut markdown = Vec::new();
    write_markdown(&report, &mut markdown)?;
    if let Some(folder) = &arguments.out {
        write_files(&report, &markdown, folder)?;
    }
    out.write_all(&markdown)?;
    Ok(Exit::Ok)
}

fn plan(arguments: &Accuracy) -> Result<Plan, Failure> {
    let asked: Vec<&'static NamedMethod> = arguments
        .method
        .iter()
        .filter_map(|name| methods::method(name))
        .collect();
    let methods = match (asked.is_empty(), arguments.quick) {
        (false, _) => asked,
        (true, true) => accuracy::quick_methods(),
        (true, false) => accuracy::all_methods(),
    };
    let mut plan = Plan {
        blades: arguments.method.is_empty(),
        ..Plan::default()
    };
    if !arguments.scene.is_empty() {
        for scene in &arguments.scene {
            plan.scenes.push(Planned::new(load(scene)?, &methods));
        }
        return Ok(plan);
    }
    for scene in scenes::SCENES {
        plan.scenes.push(Planned::new(scene.load()?, &methods));
    }
    if !arguments.quick {
        for scene in builtin::SCENES {
            plan.scenes
                .push(Planned::new(load(Path::new(scene.name))?, &methods));
        }
    } else if arguments.method.is_empty() {
        let timed = load(Path::new(COST_SCENE))?;
        plan.scenes.push(Planned::new(timed, &cost_methods()));
    }
    Ok(plan)
}

fn load(scene: &Path) -> Result<LoadedScene, Failure> {
    let own = scene.to_str().and_then(scenes::scene);
    Ok(match own {
        Some(own) => own.load()?,
        None => scene_file::load(scene, &[])?,
    })
}

/// Opens every file that will be written, so that none is refused after hours.
fn open_store(arguments: &Accuracy) -> Result<Store, Failure> {
    let Some(folder) = &arguments.out else {
        return Ok(Store::in_memory());
    };
    fs::create_dir_all(folder).map_err(|error| Failure::file(folder, error))?;
    let markdown = folder.join(MARKDOWN);
    (File::options().append(true).create(true).open(&markdown))
        .map_err(|error| Failure::file(&markdown, error))?;
    let points = folder.join(POINTS);
    let opened = Store::open(&points, arguments.resume);
    let store = opened.map_err(|error| Failure::file(&points, error))?;
    if store.broken_lines > 0 {
        log::warn!(
            "{}: {} lines are no whole points; they are measured again",
            points.display(),
            store.broken_lines
        );
    }
    Ok(store)
}

/// Any adapter, a software one too: rounding does not depend on its speed.
fn any_adapter() -> Result<Option<Device>, Failure> {
    match Gpu::headless() {
        Ok(gpu) => Ok(Some(Device::graphics(gpu)?)),
        Err(GpuError::NoAdapter { reason } | GpuError::NoDevice { reason, .. }) => {
            log::info!("no usable graphics adapter ({reason}): rounding is not measured");
            Ok(None)
        }
        Err(error) => Err(error.into()),
    }
}

fn write_files(report: &Report, markdown: &[u8], folder: &Path) -> Result<(), Failure> {
    write_file(&folder.join(MARKDOWN), markdown)?;
    for scene in &report.scenes {
        let plot = error_plot(scene)?;
        write_file(&folder.join(format!("{}.svg", scene.name)), plot.as_bytes())?;
    }
    let plot = summary_plot(report)?;
    write_file(&folder.join("all-scenes.svg"), plot.as_bytes())
}

fn write_file(path: &Path, content: &[u8]) -> Result<(), Failure> {
    fs::write(path, content).map_err(|error| Failure::file(path, error))
}
