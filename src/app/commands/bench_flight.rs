//! `sward bench flight`.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;

use super::bench::{Arguments, file_name, tell, write_limits, write_machine};
use crate::app::Failure;
use crate::app::progress::Progress;
use crate::app::values::count;
use crate::gpu::Gpu;
use crate::render::Count;
use crate::run::Exit;
use crate::run::bench::flight::FRAMES_PER_S;
use crate::run::bench::flight::ground::FlownMap;
use crate::run::bench::flight::plot::{frame_time_plot, load_plot, seeding_plot};
use crate::run::bench::flight::seeding::CLUSTERS;
use crate::run::bench::{FlightBench, FlightRequest, bench_flight};
use crate::scene::assets::{Folders, read_height_map};

/// What the flight alone takes.
#[derive(Args, Debug)]
pub struct FlightArguments {
    /// Of `flight`: few frames of a small picture
    #[arg(long)]
    quick: bool,
    /// Of `flight`: a 16-bit grey PNG as the ground, in place of hills
    #[arg(long, value_name = "FILE")]
    height_map: Option<PathBuf>,
    /// Of `flight`: distance of the height map's texels, in metres
    #[arg(
        long,
        value_name = "METRES",
        default_value_t = 5.0,
        requires = "height_map"
    )]
    spacing: f32,
    /// Of `flight`: height of white above black, in metres
    #[arg(
        long,
        value_name = "METRES",
        default_value_t = 100.0,
        requires = "height_map"
    )]
    height: f32,
    /// Of `flight`: what decides how many plants are drawn, as for `render`
    #[arg(long, value_name = "RULE[,PER_PX]", value_parser = count)]
    count: Option<Count>,
}

impl FlightArguments {
    /// Whether any was given.
    pub(super) fn is_given(&self) -> bool {
        self.quick || self.height_map.is_some() || self.count.is_some()
    }

    fn map(&self) -> Result<Option<FlownMap>, Failure> {
        let Some(path) = &self.height_map else {
            return Ok(None);
        };
        if let Err(error) = fs::metadata(path) {
            let path = path.display();
            let text =
                format!("cannot read `{path}`: {error}; --height-map takes a 16-bit grey PNG");
            return Err(Failure::BadGround(text));
        }
        // A bare name has an empty parent, which names no folder.
        let parent = path
            .parent()
            .filter(|parent| !parent.as_os_str().is_empty());
        let folder = parent.unwrap_or(Path::new(".")).to_path_buf();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let map = read_height_map(&name, &Folders::new([folder]))?;
        Ok(Some(FlownMap {
            name: name.into_owned(),
            map,
            spacing_m: self.spacing,
            height_m: self.height,
        }))
    }
}

/// Runs the bench and prints its tables.
pub(super) fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let request = FlightRequest {
        is_quick: arguments.flight.quick,
        map: arguments.flight.map()?,
        count: arguments.flight.count,
    };
    let gpu = Gpu::headless()?;
    let progress = Progress::new("bench flight");
    let bench = bench_flight(&gpu, &request, |done| progress.set(done))?;
    drop(progress);
    let kept = bench.all_kept();
    tell(arguments, &bench, kept, out, write_files, write_tables)
}

fn write_tables(bench: &FlightBench, out: &mut impl Write) -> io::Result<()> {
    write_machine(&bench.machine, out)?;
    let [width, height] = bench.picture;
    writeln!(
        out,
        "\n{} ({}), {width} x {height}, {} frames of every second; {} of {:.1} km2, plants within {} m\n",
        bench.adapter.name,
        bench.adapter.driver,
        bench.frames_per_s,
        bench.ground,
        bench.km2,
        bench.reach_m
    )?;
    if bench.is_reduced() {
        writeln!(
            out,
            "reduced for this adapter or by --quick: P15 draws 1920 x 1080; here all of {FRAMES_PER_S} frames \
             of a second would be drawn on graphics hardware\n"
        )?;
    }
    writeln!(
        out,
        "{:>6} {:>10} {:>10} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10}",
        "second",
        "frame ms",
        "no plants",
        "traversal",
        "clusters",
        "bare",
        "drawn",
        "plants",
        "triangles"
    )?;
    for second in &bench.seconds {
        writeln!(
            out,
            "{:>6} {:>10.2} {:>10.2} {:>9.3} {:>9.0} {:>9.0} {:>9.0} {:>9.0} {:>10.0}",
            second.second,
            second.frame_ms,
            second.frame_ms_without_plants,
            second.traversal_ms,
            second.clusters,
            second.bare,
            second.drawn,
            second.plants,
            second.triangles
        )?;
    }
    write_seeding(bench, out)?;
    writeln!(
        out,
        "\nTraversal, ms a frame: median, mean of the worst second"
    )?;
    for one in &bench.traversals {
        let (median, worst) = (one.ms.median, one.ms.worst_second);
        writeln!(out, "{:>6.1} km2 {median:>8.3} {worst:>8.3}", one.km2)?;
    }
    if let Some(bytes) = bench.peak_memory_bytes {
        writeln!(
            out,
            "\nmost memory of the process {:.1} MB; the picture's textures {:.1} MB; none per resting plant",
            bytes as f64 * 1e-6,
            bench.picture_bytes as f64 * 1e-6
        )?;
    }
    writeln!(out)?;
    write_limits(&bench.limits, out)
}

fn write_seeding(bench: &FlightBench, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "\nSeeding on the device by the size of clusters, ms summed over the flight"
    )?;
    for (size, cluster) in CLUSTERS.iter().enumerate() {
        let sum: f64 = bench.seeding.iter().map(|row| row.ms[size]).sum();
        let plants: u64 = bench.seeding.iter().map(|row| row.plants[size]).sum();
        let saved = bench.saved[size];
        writeln!(
            out,
            "{cluster:>6} {sum:>10.1} ms {plants:>9} plants; {saved:.2} times less than alone"
        )?;
    }
    Ok(())
}

/// Writes `flight-GROUND-ADAPTER.csv` and the plots beside it.
fn write_files(bench: &FlightBench, folder: &Path) -> Result<(), Failure> {
    let stem = format!(
        "flight-{}-{}",
        file_name(&bench.ground),
        file_name(&bench.adapter.name)
    );
    let file = |what: &str, text: String| {
        let file = folder.join(format!("{stem}{what}"));
        fs::write(&file, text).map_err(|error| Failure::file(&file, error))
    };
    file(".csv", csv(bench))?;
    file("-frame-time.svg", frame_time_plot(bench)?)?;
    file("-load.svg", load_plot(bench)?)?;
    file("-seeding.svg", seeding_plot(bench)?)
}

fn csv(bench: &FlightBench) -> String {
    let mut text = String::from(
        "second,frame_ms,frame_ms_without_plants,traversal_ms,clusters,bare,drawn,plants,triangles",
    );
    for cluster in CLUSTERS {
        text += &format!(",seeding_ms_{cluster}");
    }
    text += ",load_average\n";
    let load = bench.machine.load_average;
    let load = load.map_or_else(String::new, |load| load.to_string());
    for (second, seeding) in bench.seconds.iter().zip(&bench.seeding) {
        text += &format!(
            "{},{:.3},{:.3},{:.4},{:.1},{:.1},{:.1},{:.1},{:.1}",
            second.second,
            second.frame_ms,
            second.frame_ms_without_plants,
            second.traversal_ms,
            second.clusters,
            second.bare,
            second.drawn,
            second.plants,
            second.triangles
        );
        for ms in seeding.ms {
            text += &format!(",{ms:.3}");
        }
        text += &format!(",{load}\n");
    }
    text
}
