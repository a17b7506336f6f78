//! `sward bench popping`.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use super::bench::{Arguments, file_name, tell, write_limits, write_machine};
use crate::app::Failure;
use crate::app::progress::Progress;
use crate::gpu::Gpu;
use crate::run::Exit;
use crate::run::bench::{PoppingBench, bench_popping};

/// Runs the bench and prints its table.
pub(super) fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let gpu = Gpu::headless()?;
    let progress = Progress::new("bench popping");
    let bench = bench_popping(&gpu, |done| progress.set(done))?;
    drop(progress);
    let kept = bench.all_kept();
    tell(arguments, &bench, kept, out, write_csv, write_table)
}

fn write_table(bench: &PoppingBench, out: &mut impl Write) -> io::Result<()> {
    write_machine(&bench.machine, out)?;
    let [width, height] = bench.picture;
    writeln!(
        out,
        "\n{} frames of {width} x {height} on {} ({}); root mean squares in steps of 8 bits\n",
        bench.frames, bench.adapter.name, bench.adapter.driver
    )?;
    writeln!(
        out,
        "{:>9} {:>10} {:>12} {:>12} {:>7}",
        "square px", "motion", "pops smooth", "pops plain", "ratio"
    )?;
    for row in &bench.rows {
        writeln!(
            out,
            "{:>9} {:>10.3} {:>12.4} {:>12.4} {:>7.1}",
            row.square_px,
            row.motion,
            row.smooth_popping,
            row.plain_popping,
            row.ratio()
        )?;
    }
    writeln!(out)?;
    write_limits(&bench.limits, out)
}

/// Writes every row into `popping-ADAPTER.csv`.
fn write_csv(bench: &PoppingBench, folder: &Path) -> Result<(), Failure> {
    let mut text = String::from("square_px,motion,smooth_popping,plain_popping\n");
    for row in &bench.rows {
        text += &format!(
            "{},{:.5},{:.5},{:.5}\n",
            row.square_px, row.motion, row.smooth_popping, row.plain_popping
        );
    }
    let file = folder.join(format!("popping-{}.csv", file_name(&bench.adapter.name)));
    fs::write(&file, text).map_err(|error| Failure::file(&file, error))
}
