//! `sward blade-shape`.

use std::io::{self, Write};

use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::app::Failure;
use crate::app::values::{number, whole};
use crate::field::blade_shape::{self, BladeShape};
use crate::run::Exit;
use crate::scene::Root;

/// Find the static shape of one blade (P15 eq. 12)
#[derive(Args, Debug)]
pub struct Arguments {
    /// Rigid segments of the blade, 1 to 64
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        value_parser = |text: &str| whole(text, 1, 64)
    )]
    segments: u32,
    /// Spring constant over segment weight and length, k′
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = number)]
    stiffness: f64,
    /// Stiffness of the root hinge: that of the others, as in the paper, or twice that, which
    /// agrees with a continuous beam and is what scenes have unless they say otherwise
    #[arg(long, value_enum, default_value = "k")]
    root: RootStiffness,
    /// Lean of the root from the vertical, in degrees, 0 to 180
    #[arg(
        long,
        value_name = "DEGREES",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_parser = number
    )]
    lean: f64,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum RootStiffness {
    #[value(name = "k")]
    Single,
    #[value(name = "2k")]
    Double,
}

/// The result as JSON.
#[derive(Serialize)]
struct Json<'a> {
    angles_rad: &'a [f64],
    nodes: &'a [[f64; 2]],
    energy: f64,
    iterations: u32,
    residual: f64,
}

/// Prints the shape.
pub fn run(arguments: &Arguments, out: &mut impl Write) -> Result<Exit, Failure> {
    let root = match arguments.root {
        RootStiffness::Single => Root::Paper,
        RootStiffness::Double => Root::Double,
    };
    let lean_deg = arguments.lean;
    if !(0.0..=180.0).contains(&lean_deg) {
        let text = format!("--lean {lean_deg}: give 0 to 180 degrees from the vertical");
        return Err(Failure::Usage(text));
    }
    let lean_rad = lean_deg.to_radians();
    let shape = blade_shape::solve(arguments.segments, arguments.stiffness, root, lean_rad)?;
    if arguments.json {
        let json = Json {
            angles_rad: &shape.angles_rad,
            nodes: &shape.nodes,
            energy: shape.energy,
            iterations: shape.iterations,
            residual: shape.residual,
        };
        serde_json::to_writer(&mut *out, &json)?;
        writeln!(out)?;
    } else {
        let critical = blade_shape::critical_stiffness(arguments.segments, root)?;
        write_table(&shape, critical, out)?;
    }
    Ok(Exit::Ok)
}

fn write_table(shape: &BladeShape<f64>, critical: f64, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "node   angle below (deg)   x / length      y / length")?;
    for (node, [x, y]) in shape.nodes.iter().enumerate() {
        let below = node.checked_sub(1).and_then(|j| shape.angles_rad.get(j));
        let angle = below.map_or(String::new(), |a| format!("{:.6}", a.to_degrees()));
        writeln!(out, "{node:>4}   {angle:>17}   {x:>13.10}   {y:>13.10}")?;
    }
    writeln!(out, "energy {:.10} m g l", shape.energy)?;
    writeln!(
        out,
        "{} steps, residual {:.1e} of k′π + N²/2",
        shape.iterations, shape.residual
    )?;
    writeln!(out, "upright without lean above k′ = {critical:.10}")
}
