//! `sward bench light`.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use super::bench::{Arguments, file_name, tell, write_machine};
use super::scene_file;
use crate::app::Failure;
use crate::app::progress::Progress;
use crate::gpu::Gpu;
use crate::run::Exit;
use crate::run::bench::{LightBench, bench_light};

/// The scene that is lit.
const BOULDERS: &str = "boulders";

/// Runs the bench and prints its table.
pub(super) fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let loaded = scene_file::load(Path::new(BOULDERS), &[])?;
    let gpu = Gpu::headless()?;
    let progress = Progress::new("bench light");
    let bench = bench_light(&gpu, &loaded, |done| progress.set(done))?;
    drop(progress);
    tell(arguments, &bench, true, out, write_csv, write_table)
}

fn write_table(bench: &LightBench, out: &mut impl Write) -> io::Result<()> {
    write_machine(&bench.machine, out)?;
    let ([wide, deep], [width, height]) = (bench.columns, bench.picture);
    writeln!(
        out,
        "\n{} on {} ({})\n",
        bench.scene, bench.adapter.name, bench.adapter.driver
    )?;
    writeln!(
        out,
        "volumes of {wide} x {deep} columns with {} slices, {} rays a cell: {:.2} MB on the device, a file \
         of {:.2} MB",
        bench.slices,
        bench.rays,
        bench.device_bytes as f64 * 1e-6,
        bench.file_bytes as f64 * 1e-6
    )?;
    let cached = match bench.cached_ms {
        Some(ms) => format!("{ms:.1} ms"),
        None => "not kept".to_owned(),
    };
    writeln!(
        out,
        "worked out in {:.1} ms, from the cache {cached}, under another sun {:.1} ms",
        bench.traced_ms, bench.relit_ms
    )?;
    writeln!(
        out,
        "a picture of {width} x {height}, median of {}: {:.1} ms with volumes, {:.1} ms without ({:+.1}%)",
        bench.rounds,
        bench.lit_ms,
        bench.plain_ms,
        100.0 * (bench.lit_ms / bench.plain_ms - 1.0)
    )
}

/// Writes the numbers into `light-ADAPTER.csv`.
fn write_csv(bench: &LightBench, folder: &Path) -> Result<(), Failure> {
    let optional = |number: Option<f64>| number.map_or_else(String::new, |n| format!("{n:.3}"));
    let text = format!(
        "columns_x,columns_z,slices,rays,traced_ms,cached_ms,relit_ms,file_bytes,device_bytes,lit_ms,\
         plain_ms,load_average\n{},{},{},{},{:.3},{},{:.3},{},{},{:.3},{:.3},{}\n",
        bench.columns[0],
        bench.columns[1],
        bench.slices,
        bench.rays,
        bench.traced_ms,
        optional(bench.cached_ms),
        bench.relit_ms,
        bench.file_bytes,
        bench.device_bytes,
        bench.lit_ms,
        bench.plain_ms,
        optional(bench.machine.load_average)
    );
    let file = folder.join(format!("light-{}.csv", file_name(&bench.adapter.name)));
    fs::write(&file, text).map_err(|error| Failure::file(&file, error))
}
