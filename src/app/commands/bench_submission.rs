//! `sward bench submission`.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use super::bench::{Arguments, file_name, tell, write_machine};
use crate::app::Failure;
use crate::app::progress::Progress;
use crate::gpu::Gpu;
use crate::run::Exit;
use crate::run::bench::{SubmissionBench, bench_submission};

/// Runs the bench and prints its table.
pub(super) fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let gpu = Gpu::headless()?;
    let progress = Progress::new("bench submission");
    let bench = bench_submission(&gpu, |done| progress.set(done))?;
    drop(progress);
    tell(arguments, &bench, true, out, write_csv, write_table)
}

fn write_table(bench: &SubmissionBench, out: &mut impl Write) -> io::Result<()> {
    write_machine(&bench.machine, out)?;
    writeln!(
        out,
        "\nfirst stage of drawing on {} ({}); means of {} views, medians of {} rounds\n",
        bench.adapter.name, bench.adapter.driver, bench.views, bench.rounds
    )?;
    writeln!(
        out,
        "{:<9} {:<6} {:>9} {:>10} {:>9} {:>9} {:>9} {:>10} {:>10}",
        "rule", "way", "ms", "triangles", "places", "plants", "all", "rms", "most"
    )?;
    for row in &bench.rows {
        writeln!(
            out,
            "{:<9} {:<6} {:>9.3} {:>10.0} {:>9.0} {:>9.0} {:>+8.3}% {:>9.3}% {:>9.3}%",
            row.rule,
            row.submission,
            row.ms,
            row.triangles,
            row.places,
            row.plants,
            100.0 * row.density_error,
            100.0 * row.triangle_error_rms,
            100.0 * row.triangle_error_most
        )?;
    }
    Ok(())
}

/// Writes every row into `submission-ADAPTER.csv`.
fn write_csv(bench: &SubmissionBench, folder: &Path) -> Result<(), Failure> {
    let mut text = String::from(
        "rule,submission,ms,triangles,places,plants,density_error,triangle_error_rms,\
         triangle_error_most,load_average\n",
    );
    let load = bench.machine.load_average;
    for row in &bench.rows {
        text += &format!(
            "{},{},{:.4},{:.1},{:.1},{:.1},{:.6},{:.6},{:.6},{}\n",
            row.rule,
            row.submission,
            row.ms,
            row.triangles,
            row.places,
            row.plants,
            row.density_error,
            row.triangle_error_rms,
            row.triangle_error_most,
            load.map_or_else(String::new, |load| load.to_string())
        );
    }
    let file = folder.join(format!("submission-{}.csv", file_name(&bench.adapter.name)));
    fs::write(&file, text).map_err(|error| Failure::file(&file, error))
}
