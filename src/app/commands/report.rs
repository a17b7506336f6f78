//! `sward report`.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::outputs::make_folder;
use super::scene_file;
use crate::app::Failure;
use crate::app::progress::Progress;
use crate::gpu::{Gpu, GpuError};
use crate::run::accuracy::{
    self, COST_SCENE, Dropped, Plan, Planned, Report, Store, Stored, cost_methods, error_plot,
    scenes, summary_plot, write_markdown,
};
use crate::run::methods::{self, NamedMethod};
use crate::run::{Device, Exit};
use crate::scene::{LoadedScene, Problem, SceneError, builtin};

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
    /// List the scenes and methods of the report and do nothing else
    #[arg(long)]
    list: bool,
    #[arg(long, value_name = "SCENE", help = scene_help())]
    scene: Vec<PathBuf>,
    /// Only these methods, see --list; may be repeated
    #[arg(long, value_name = "NAME", value_parser = super::run::method_names())]
    method: Vec<String>,
    /// The report's own scenes and the ends of every curve: minutes instead of hours
    #[arg(long)]
    quick: bool,
    /// Leave the graphics adapter alone; rounding is not measured then
    #[arg(long)]
    no_gpu: bool,
    /// Also write points.csv, accuracy.md and plots as SVG into this folder; refused where it has
    /// points of an earlier report that this one does not ask for
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Keep the points that the folder already has, as after an interrupted report; those of another
    /// program, scene or adapter are measured again
    #[arg(long, requires = "out")]
    resume: bool,
}

/// File of the measured points.
const POINTS: &str = "points.csv";
/// Most methods of a scene that a message names.
const MOST_NAMED: usize = 4;
/// File of the report.
const MARKDOWN: &str = "accuracy.md";

/// Runs the report and prints it.
pub fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let What::Accuracy(arguments) = &arguments.what;
    if arguments.list {
        list(out)?;
        return Ok(Exit::Ok);
    }
    if arguments.quick && !arguments.scene.is_empty() && !arguments.method.is_empty() {
        let text = "--quick chooses scenes and methods, and both are given by --scene and --method: \
                    leave --quick out";
        return Err(Failure::Usage(text.into()));
    }
    let plan = plan(arguments)?;
    let mut stored = Stored::default();
    if let Some(folder) = &arguments.out {
        make_folder(folder)?;
        stored = stored_points(&folder.join(POINTS), &plan)?;
    }
    let device = if arguments.no_gpu {
        None
    } else {
        any_adapter()?
    };
    let mut store = open_store(arguments, &plan, stored, device.as_ref())?;
    let progress = Progress::new("report accuracy");
    let report = accuracy::run(&plan, &mut store, device.as_ref(), |done| {
        progress.set(done)
    })?;
    drop(progress);
    let mut markdown = Vec::new();
    write_markdown(&report, arguments.out.is_some(), &mut markdown)?;
    if let Some(folder) = &arguments.out {
        write_files(&report, &markdown, folder)?;
    }
    out.write_all(&markdown)?;
    Ok(Exit::Ok)
}

fn scene_help() -> String {
    format!(
        "Only these scenes: the report's own ({}), the program's (see `sward list`), or files; may be \
         repeated",
        own_scenes()
    )
}

fn own_scenes() -> String {
    let names: Vec<&str> = scenes::SCENES.iter().map(|scene| scene.name).collect();
    names.join(", ")
}

/// Prints what `--scene` and `--method` take.
fn list(out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "Scenes of the report, for --scene:")?;
    for scene in scenes::SCENES {
        writeln!(out, "  {:<20} {}", scene.name, scene.what)?;
    }
    writeln!(
        out,
        "The program's own scenes are taken too (see `sward list`), and scene files.\n\n\
         Methods, for --method (* left out by --quick):"
    )?;
    let quick = accuracy::quick_methods();
    for method in accuracy::all_methods() {
        let in_quick = quick.iter().any(|quick| quick.name == method.name);
        let mark = if in_quick { ' ' } else { '*' };
        writeln!(out, "{mark} {:<20} {}", method.name, method.what)?;
    }
    Ok(())
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
    let program = match &arguments.out {
        Some(_) => accuracy::hash_of_this_program().map_err(unknown_program)?,
        None => 0,
    };
    let mut plan = Plan {
        blades: arguments.method.is_empty(),
        program,
        quick: arguments.quick,
        ..Plan::default()
    };
    if !arguments.scene.is_empty() {
        for scene in &arguments.scene {
            plan.scenes.push(Planned::new(load(scene)?, &methods));
        }
        one_of_each_name(&plan)?;
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

fn unknown_program(error: io::Error) -> Failure {
    let text = "the program's own file cannot be read, so that points of another program could not be \
                told from its own";
    Failure::Internal(format!("{text}: {error}"))
}

/// Points and plots are named after their scene.
fn one_of_each_name(plan: &Plan) -> Result<(), Failure> {
    let names: Vec<&str> = plan.scenes.iter().map(|s| s.loaded.name.as_str()).collect();
    let twice = names
        .iter()
        .enumerate()
        .find(|(n, name)| names[..*n].contains(name));
    match twice {
        Some((_, name)) => Err(Failure::Usage(format!(
            "--scene: two scenes are named `{name}`; give each once, and rename one of two files of \
             one name"
        ))),
        None => Ok(()),
    }
}

fn load(scene: &Path) -> Result<LoadedScene, Failure> {
    let own = scene.to_str().and_then(scenes::scene);
    Ok(match own {
        Some(own) => own.load()?,
        None => scene_file::load(scene, &[]).map_err(named_nowhere)?,
    })
}

/// Says of a scene that is not there what the report's own are.
fn named_nowhere(error: SceneError) -> Failure {
    match &error.problem {
        Problem::Unreadable(reason) if reason.kind() == io::ErrorKind::NotFound => {
            Failure::UnknownScene(format!("{error}; the report's own are {}", own_scenes()))
        }
        _ => error.into(),
    }
}

/// What the folder has, if this report keeps or measures all of it: whoever asks for less may have
/// forgotten that hours of work lie there.
fn stored_points(points: &Path, plan: &Plan) -> Result<Stored, Failure> {
    let stored = Stored::read(points).map_err(|error| match error.kind() {
        io::ErrorKind::InvalidData => Failure::Usage(format!(
            "--out: {} is there, but {error}; take another --out",
            points.display()
        )),
        _ => Failure::file(points, error),
    })?;
    let left_out = stored.left_out_by(plan);
    if left_out.is_empty() {
        return Ok(stored);
    }
    let count: usize = left_out.values().map(BTreeSet::len).sum();
    let scenes: Vec<String> = left_out.iter().map(lost_of_scene).collect();
    Err(Failure::Usage(format!(
        "--out: {} has {count} points that this report leaves out and would overwrite: {}. Ask for \
         them too (--resume keeps what is measured), or take another --out",
        points.display(),
        scenes.join("; ")
    )))
}

fn lost_of_scene((scene, methods): (&String, &BTreeSet<String>)) -> String {
    let named: Vec<&str> = methods.iter().map(String::as_str).collect();
    match named.get(MOST_NAMED..) {
        Some(more @ [_, ..]) => format!(
            "`{scene}` ({} and {} more)",
            named[..MOST_NAMED].join(", "),
            more.len()
        ),
        _ => format!("`{scene}` ({})", named.join(", ")),
    }
}

/// Opens every file that will be written, so that none is refused after hours.
fn open_store(
    arguments: &Accuracy,
    plan: &Plan,
    mut stored: Stored,
    device: Option<&Device>,
) -> Result<Store, Failure> {
    let Some(folder) = &arguments.out else {
        return Ok(Store::in_memory());
    };
    let markdown = folder.join(MARKDOWN);
    (File::options().append(true).create(true).open(&markdown))
        .map_err(|error| Failure::file(&markdown, error))?;
    let points = folder.join(POINTS);
    if arguments.resume {
        let dropped = stored.keep(&plan.keys(device), &plan.program_name());
        warn_of(&dropped, stored.broken_lines, &points, plan);
    } else {
        stored = Stored::default();
    }
    Store::create(&points, stored).map_err(|error| Failure::file(&points, error))
}

/// Says what of an earlier report does not hold any more.
fn warn_of(dropped: &Dropped, broken_lines: usize, points: &Path, plan: &Plan) {
    let points = points.display();
    for (program, count) in &dropped.of_programs {
        let made_by = match program.as_str() {
            "" => "an older sward",
            program => program,
        };
        log::warn!(
            "{points}: {count} points are of another program ({made_by}; this is {}), whose kernels \
             and times may differ; they are measured again",
            plan.program_name()
        );
    }
    if dropped.of_other_input > 0 {
        let count = dropped.of_other_input;
        log::warn!(
            "{points}: {count} points are of another scene, setting or adapter; they are measured again"
        );
    }
    if broken_lines > 0 {
        log::warn!("{points}: {broken_lines} lines are no whole points; they are measured again");
    }
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
