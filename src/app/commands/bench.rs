//! `sward bench`.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::bench_flight::FlightArguments;
use super::outputs::make_folder;
use super::{
    bench_bodies, bench_flight, bench_light, bench_popping, bench_submission, bench_terrain,
    scene_file,
};
use crate::app::Failure;
use crate::app::device::EngineArguments;
use crate::app::progress::Progress;
use crate::run::Exit;
use crate::run::bench::tiles::{Limit, Row};
use crate::run::bench::{Machine, TilesBench, bench_tiles};

/// Measure speed, with the error beside it
#[derive(Args, Debug)]
pub struct Arguments {
    /// What is measured
    #[arg(value_enum)]
    what: Bench,
    #[command(flatten)]
    pub(super) engine: EngineArguments,
    /// Print the results as JSON
    #[arg(long)]
    pub(super) json: bool,
    /// Also write a CSV file per adapter into this folder
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// End with exit code 1 if a promise is not kept
    #[arg(long)]
    pub(super) check: bool,
    #[command(flatten)]
    pub(super) flight: FlightArguments,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Bench {
    /// Cost by the number of tiles, in total and active
    Tiles,
    /// Cost by the number of bodies on the same active tiles, of blades and of billboards
    Bodies,
    /// Cost of the ground and of finding the plants in view, by the terrain's size; on the
    /// processor alone
    Terrain,
    /// Plants in view listed by exact counts and by 32 bins: time and error of the density; needs a
    /// graphics adapter
    Submission,
    /// How much pictures of a slow camera change because plants come and go; needs a graphics adapter
    Popping,
    /// The flight of P15 section 4 over 20 km²: time of a frame, load, seeding by the size of clusters;
    /// needs a graphics adapter
    Flight,
    /// Light volumes of `boulders`: time to work them out, memory, time of a picture with them and without;
    /// needs a graphics adapter
    Light,
}

impl Bench {
    /// As it is given on the command line.
    fn name(self) -> String {
        let value = self.to_possible_value();
        value.map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// Scene of a million blades.
const MILLION: &str = "million_blades";

/// Runs the bench and prints its tables.
pub fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let runs_an_engine = matches!(arguments.what, Bench::Tiles | Bench::Bodies);
    if !runs_an_engine && arguments.engine.is_chosen() {
        let text = format!(
            "bench {} runs no engine: leave --engine and --require-gpu out",
            arguments.what.name()
        );
        return Err(Failure::Usage(text));
    }
    if !matches!(arguments.what, Bench::Flight) && arguments.flight.is_given() {
        let text = "only bench flight takes --quick, --count and --height-map: leave them out";
        return Err(Failure::Usage(text.into()));
    }
    // A place that cannot be written to is told before time is spent on measuring.
    if let Some(folder) = &arguments.out {
        make_folder(folder)?;
    }
    match arguments.what {
        Bench::Tiles => run_tiles(arguments, out),
        Bench::Bodies => bench_bodies::run(arguments, out),
        Bench::Terrain => bench_terrain::run(arguments, out),
        Bench::Flight => bench_flight::run(arguments, out),
        Bench::Light => bench_light::run(arguments, out),
        Bench::Popping => bench_popping::run(arguments, out),
        Bench::Submission => bench_submission::run(arguments, out),
    }
}

fn run_tiles(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let device = arguments.engine.open()?;
    let million = scene_file::load(Path::new(MILLION), &[])?;
    let progress = Progress::new("bench tiles");
    let bench = bench_tiles(&million, &device, |done| progress.set(done))?;
    drop(progress);
    let kept = bench.all_kept();
    tell(arguments, &bench, kept, out, write_csv, write_tables)
}

/// Files a bench where that is asked for and prints it. `kept` says whether it is within its limits.
pub(super) fn tell<B: Serialize, W: Write>(
    arguments: &Arguments,
    bench: &B,
    kept: bool,
    out: &mut W,
    write_csv: impl FnOnce(&B, &Path) -> Result<(), Failure>,
    write_tables: impl FnOnce(&B, &mut W) -> io::Result<()>,
) -> Result<Exit, Failure> {
    if let Some(folder) = &arguments.out {
        write_csv(bench, folder)?;
    }
    if arguments.json {
        serde_json::to_writer_pretty(&mut *out, bench)?;
        writeln!(out)?;
    } else {
        write_tables(bench, out)?;
    }
    let failed = arguments.check && !kept;
    Ok(if failed { Exit::Failed } else { Exit::Ok })
}

pub(super) fn write_machine(machine: &Machine, out: &mut impl Write) -> io::Result<()> {
    write!(
        out,
        "{}, {} threads",
        machine.cpu.as_deref().unwrap_or("unknown processor"),
        machine.threads
    )?;
    if let Some(load) = machine.load_average {
        write!(out, ", load average {load:.2}")?;
    }
    Ok(())
}

pub(super) fn write_limits(limits: &[Limit], out: &mut impl Write) -> io::Result<()> {
    for limit in limits {
        let verdict = if limit.kept { "ok  " } else { "MISS" };
        writeln!(
            out,
            "{verdict}  {}: {:.4} of {} {}",
            limit.what, limit.measured, limit.limit, limit.unit
        )?;
    }
    Ok(())
}

fn write_tables(bench: &TilesBench, out: &mut impl Write) -> io::Result<()> {
    write_machine(&bench.machine, out)?;
    write!(out, "\n{} engine", bench.engine)?;
    if let Some(adapter) = &bench.adapter {
        write!(out, " on {} ({})", adapter.name, adapter.driver)?;
    }
    writeln!(out, "\n")?;
    write_million(bench, out)?;
    writeln!(out, "\nThe same work in larger meadows")?;
    write_rows(&bench.total_tiles, out)?;
    writeln!(out, "\nMore work in one meadow")?;
    write_rows(&bench.active_tiles, out)?;
    if let Some(line) = &bench.line {
        writeln!(
            out,
            "ms per sub-step = {:.4} + {:.5} per active tile, R² {:.4}",
            line.fixed_ms, line.ms_per_tile, line.r_squared
        )?;
    }
    writeln!(out)?;
    write_limits(&bench.limits, out)
}

fn write_million(bench: &TilesBench, out: &mut impl Write) -> io::Result<()> {
    let million = &bench.million_blades;
    writeln!(
        out,
        "{} blades on {} tiles, one rolling ball, at most {} tiles active\n  \
         {:.2} simulated seconds per second ({:.2} s, {} sub-steps; median {:.4} ms, least {:.4})",
        million.blades,
        million.total_tiles,
        million.active_tiles_peak,
        million.seconds_per_second,
        million.seconds_simulated,
        million.ticks,
        million.tick_ms_median,
        million.tick_ms_min,
    )?;
    let memory = match million.peak_memory_bytes {
        Some(bytes) => format!("{:.1} MB", bytes as f64 * 1e-6),
        None => "unknown".to_owned(),
    };
    writeln!(
        out,
        "  peak memory of the process {memory}, grass state {} bytes\n  \
         penetration {:.3} mm at most, strain {:.4} at most",
        million.state_bytes_peak,
        million.errors.max_penetration_m * 1e3,
        million.errors.max_strain
    )
}

fn write_rows(rows: &[Row], out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{:>8} {:>6} {:>8} {:>10} {:>10} {:>4} {:>7} {:>12} {:>8}",
        "tiles", "balls", "active", "median ms", "least ms", "n", "ratio", "depth mm", "strain"
    )?;
    for row in rows {
        writeln!(
            out,
            "{:>8} {:>6} {:>8.1} {:>10.4} {:>10.4} {:>4} {:>7.3} {:>12.3} {:>8.4}",
            row.total_tiles,
            row.balls,
            row.active_tiles_mean,
            row.tick_ms_median,
            row.tick_ms_min,
            row.rounds,
            row.ratio,
            row.errors.max_penetration_m * 1e3,
            row.errors.max_strain
        )?;
    }
    Ok(())
}

/// Writes every row into `tiles-ENGINE-ADAPTER.csv`.
fn write_csv(bench: &TilesBench, folder: &Path) -> Result<(), Failure> {
    let million = &bench.million_blades;
    let mut text = String::from(
        "table,total_tiles,balls,active_tiles,tick_ms_median,tick_ms_min,n,ratio,\
         max_penetration_m,max_strain\n",
    );
    text += &format!(
        "million_blades,{},1,{},{},{},{},,{},{}\n",
        million.total_tiles,
        million.active_tiles_peak,
        million.tick_ms_median,
        million.tick_ms_min,
        million.ticks,
        million.errors.max_penetration_m,
        million.errors.max_strain
    );
    let tables = [
        ("total_tiles", &bench.total_tiles),
        ("active_tiles", &bench.active_tiles),
    ];
    for (table, row) in tables
        .iter()
        .flat_map(|(t, rows)| rows.iter().map(move |r| (t, r)))
    {
        text += &format!(
            "{table},{},{},{},{},{},{},{},{},{}\n",
            row.total_tiles,
            row.balls,
            row.active_tiles_mean,
            row.tick_ms_median,
            row.tick_ms_min,
            row.rounds,
            row.ratio,
            row.errors.max_penetration_m,
            row.errors.max_strain
        );
    }
    let adapter = bench.adapter.as_ref().map(|adapter| adapter.name.as_str());
    let runs_on = adapter
        .or(bench.machine.cpu.as_deref())
        .unwrap_or("unknown");
    let file = folder.join(format!("tiles-{}-{}.csv", bench.engine, file_name(runs_on)));
    fs::write(&file, text).map_err(|error| Failure::file(&file, error))
}

/// A name with nothing in it that a file system might refuse.
pub(super) fn file_name(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric());
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    words.join("-").to_lowercase()
}
