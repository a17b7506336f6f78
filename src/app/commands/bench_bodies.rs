//! `sward bench bodies`.

use std::fmt::Write as _;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use super::bench::{Arguments, file_name, tell, write_limits, write_machine};
use crate::app::Failure;
use crate::app::progress::Progress;
use crate::run::Exit;
use crate::run::bench::bodies::BodiesRow;
use crate::run::bench::{BodiesBench, bench_bodies};

/// Runs the bench and prints its tables.
pub(super) fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let device = arguments.engine.open()?;
    let progress = Progress::new("bench bodies");
    let bench = bench_bodies(&device, |done| progress.set(done))?;
    drop(progress);
    let kept = bench.all_kept();
    tell(arguments, &bench, kept, out, write_csv, write_tables)
}

fn write_tables(bench: &BodiesBench, out: &mut impl Write) -> io::Result<()> {
    write_machine(&bench.machine, out)?;
    write!(out, "\n{} engine", bench.engine)?;
    if let Some(adapter) = &bench.adapter {
        write!(out, " on {} ({})", adapter.name, adapter.driver)?;
    }
    writeln!(out)?;
    for (grass, rows) in [("Blades", &bench.blades), ("Billboards", &bench.billboards)] {
        writeln!(out, "\n{grass}")?;
        write_rows(rows, out)?;
    }
    writeln!(out)?;
    write_limits(&bench.limits, out)
}

fn write_rows(rows: &[BodiesRow], out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{:>7} {:>5} {:>8} {:>10} {:>10} {:>4} {:>7} {:>12} {:>8}",
        "bodies", "met", "active", "median ms", "least ms", "n", "ratio", "depth mm", "strain"
    )?;
    for row in rows {
        writeln!(
            out,
            "{:>7} {:>5} {:>8.1} {:>10.4} {:>10.4} {:>4} {:>7.2} {:>12.3} {:>8.4}",
            row.bodies,
            row.met,
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

/// Writes every row into `bodies-ENGINE-ADAPTER.csv`.
fn write_csv(bench: &BodiesBench, folder: &Path) -> Result<(), Failure> {
    let mut text = String::from(
        "grass,bodies,met,active_tiles,tick_ms_median,tick_ms_min,n,ratio,max_penetration_m,\
         max_strain,load_average\n",
    );
    let load = bench.machine.load_average;
    for (grass, rows) in [("blades", &bench.blades), ("billboards", &bench.billboards)] {
        for row in rows {
            // Writing into a text cannot fail.
            let _ = writeln!(
                text,
                "{grass},{},{},{},{},{},{},{},{},{},{}",
                row.bodies,
                row.met,
                row.active_tiles_mean,
                row.tick_ms_median,
                row.tick_ms_min,
                row.rounds,
                row.ratio,
                row.errors.max_penetration_m,
                row.errors.max_strain,
                load.map_or_else(String::new, |load| load.to_string())
            );
        }
    }
    let device = match &bench.adapter {
        Some(adapter) => file_name(&adapter.name),
        None => file_name(bench.machine.cpu.as_deref().unwrap_or("cpu")),
    };
    let file = folder.join(format!("bodies-{}-{device}.csv", bench.engine));
    fs::write(&file, text).map_err(|error| Failure::file(&file, error))
}
