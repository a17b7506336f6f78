//! `sward bench terrain`.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use super::bench::{Arguments, file_name, tell, write_limits, write_machine};
use crate::app::Failure;
use crate::app::progress::Progress;
use crate::run::Exit;
use crate::run::bench::terrain::TerrainRow;
use crate::run::bench::{TerrainBench, bench_terrain};

/// Runs the bench and prints its table.
pub(super) fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let progress = Progress::new("bench terrain");
    let bench = bench_terrain(|done| progress.set(done))?;
    drop(progress);
    let kept = bench.all_kept();
    tell(arguments, &bench, kept, out, write_csv, write_tables)
}

fn write_tables(bench: &TerrainBench, out: &mut impl Write) -> io::Result<()> {
    write_machine(&bench.machine, out)?;
    writeln!(
        out,
        "\none thread; error {} px, budget {} triangles, plants within {} m\n",
        bench.error_px, bench.budget, bench.reach_m
    )?;
    writeln!(out, "ms a frame, mean of the flight's worst second")?;
    writeln!(
        out,
        "{:>6} {:>12} {:>8} {:>9} {:>9} {:>8} {:>9}",
        "km2", "split/merge", "listing", "tiles", "triangles", "octree", "build s"
    )?;
    for row in &bench.terrains {
        writeln!(
            out,
            "{:>6.1} {:>12.3} {:>8.3} {:>9.3} {:>9.3} {:>8.3} {:>9.3}",
            row.km2,
            row.mesh_ms.worst_second,
            row.list_ms.worst_second,
            row.tiles_ms.worst_second,
            row.seeds_ms.worst_second,
            row.octree_ms.worst_second,
            row.build_s
        )?;
    }
    writeln!(out, "\nMost of any frame")?;
    writeln!(
        out,
        "{:>6} {:>9} {:>8} {:>7} {:>8} {:>9} {:>8} {:>6} {:>9}",
        "km2", "mesh", "in view", "tiles", "octree", "seeding", "error px", "bound", "MB"
    )?;
    for row in &bench.terrains {
        writeln!(
            out,
            "{:>6.1} {:>9} {:>8} {:>7} {:>8} {:>9} {:>8.3} {:>6} {:>9.1}",
            row.km2,
            row.triangles,
            row.triangles_in_view,
            row.tiles,
            row.octree_tiles,
            row.seeds,
            row.worst_px,
            row.bound_frames,
            row.bytes as f64 * 1e-6
        )?;
    }
    writeln!(out)?;
    write_limits(&bench.limits, out)
}

/// Writes every terrain into `terrain-PROCESSOR.csv`.
fn write_csv(bench: &TerrainBench, folder: &Path) -> Result<(), Failure> {
    let mut text = String::from(
        "km2,samples,split_merge_ms_median,split_merge_ms_worst_second,listing_ms_median,\
         listing_ms_worst_second,traversal_ms_median,traversal_ms_worst_second,\
         triangle_traversal_ms_median,triangle_traversal_ms_worst_second,octree_ms_median,\
         octree_ms_worst_second,triangles,triangles_in_view,tiles,octree_tiles,seeding_triangles,\
         error_px,bound_frames,bytes,build_s\n",
    );
    for row in &bench.terrains {
        text += &csv_line(row);
    }
    let runs_on = bench.machine.cpu.as_deref().unwrap_or("unknown");
    let file = folder.join(format!("terrain-{}.csv", file_name(runs_on)));
    fs::write(&file, text).map_err(|error| Failure::file(&file, error))
}

fn csv_line(row: &TerrainRow) -> String {
    let costs = [
        row.mesh_ms,
        row.list_ms,
        row.tiles_ms,
        row.seeds_ms,
        row.octree_ms,
    ];
    let costs: Vec<String> = costs
        .iter()
        .map(|cost| format!("{:.4},{:.4}", cost.median, cost.worst_second))
        .collect();
    format!(
        "{:.3},{},{},{},{},{},{},{},{},{},{},{:.3}\n",
        row.km2,
        row.samples,
        costs.join(","),
        row.triangles,
        row.triangles_in_view,
        row.tiles,
        row.octree_tiles,
        row.seeds,
        row.worst_px,
        row.bound_frames,
        row.bytes,
        row.build_s
    )
}
