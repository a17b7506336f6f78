//! What the truth is worth: the reference engine and the solver of blade shapes beside answers that
//! share no line of code with them.

use std::io::{self, Write};

use super::AccuracyError;
use super::rods::{Apart, WAYS, Way};
use crate::base::most;
use crate::field::blade_shape::descent::noise_floor;
use crate::field::blade_table::TableError;
use crate::scene::{Root, Solver, Species};
use crate::sim::reference::GRASS_STEPS;

/// Random starts of the descent on a blade's energy.
const STARTS: u32 = 2;

/// Distances from independent answers.
#[derive(Clone, Debug, Default)]
pub struct Independent {
    rods: Vec<(Way, Apart)>,
    /// Largest distance of a node, in blade lengths.
    shapes: f64,
}

impl Independent {
    /// Solves both; takes a few seconds.
    ///
    /// # Errors
    ///
    /// None is known; those of the scenes and of the solver are passed on.
    pub fn measure() -> Result<Self, AccuracyError> {
        let rods = WAYS.map(|way| Ok((way, way.measure(GRASS_STEPS)?)));
        Ok(Self {
            rods: rods.into_iter().collect::<Result<_, AccuracyError>>()?,
            shapes: shapes_apart()?,
        })
    }

    /// Writes them in Markdown.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(
            out,
            "## What the reference is worth\n\n\
             Beside blades of one segment whose tips a ball pushes, solved as rods on hinges by a \
             differential equation, without the grass's kernels. The engine converges on them at first \
             order; these are the distances at its own step, and the largest share of the bound that \
             the equation gives for a tip that is pushed for the first time.\n\n\
             | ball | rods met | by one alone | all the while, RMS, mm | pushed, RMS, mm | most, mm | of \
             the bound |\n|---|---|---|---|---|---|---|"
        )?;
        for (way, apart) in &self.rods {
            writeln!(
                out,
                "| {} | {} | {} | {:.3} | {:.3} | {:.3} | {:.0}% |",
                way.what,
                apart.met,
                apart.met_by_one,
                apart.rms_m * 1e3,
                apart.pushed_rms_m * 1e3,
                apart.pushed_most_m * 1e3,
                apart.share_of_bound * 100.0
            )?;
        }
        writeln!(
            out,
            "\nThe resting shape of blades of {} segments, from Newton's method and from a descent on \
             their energy: {:.1e} of a blade's length apart at most, over the ends of the default \
             kind's stiffness and lean and both roots.\n",
            Solver::default().segments,
            self.shapes
        )
    }
}

fn shapes_apart() -> Result<f64, TableError> {
    let kind = Species::default();
    let mut apart: f64 = 0.0;
    for root in [Root::Double, Root::Paper] {
        for k_prime in kind.stiffness.map(f64::from) {
            for lean_deg in kind.lean_deg.map(f64::from) {
                let segments = Solver::default().segments;
                let found = noise_floor(segments, k_prime, root, lean_deg.to_radians(), STARTS);
                apart = most(apart, found?);
            }
        }
    }
    Ok(apart)
}
