//! The resting shape of blades: what the table of shapes errs by and costs, and what the number of
//! segments and the root's stiffness do to a blade of one material.
//!
//! A pose error beside the reference cannot tell either: with another root or another lean the
//! reference would have another blade too. So tables are compared with the direct solver of the same
//! blade, and blades of few segments with one of 64.

use std::io::{self, Write};
use std::time::Instant;

use crate::base::statistics::median;
use crate::field::BladeTable;
use crate::field::blade_shape::{self, ShapeError, stiffness_for_segments};
use crate::field::blade_table::{TableError, TableErrors};
use crate::scene::{Grass, Root, Solver, Species};

/// Entries along stiffness and lean.
const ENTRIES: [[u32; 2]; 5] = [[16, 8], [32, 16], [64, 32], [128, 64], [256, 128]];
/// Leans from the vertical that a kind of plant may have, in degrees.
const LEANS_DEG: [[f32; 2]; 4] = [[2.0, 16.0], [5.0, 5.0], [0.0, 16.0], [0.0, 0.0]];
const ROOTS: [Root; 2] = [Root::Double, Root::Paper];
/// Segments of the blades that are compared with one of [`FINE_SEGMENTS`], which they divide.
const SEGMENTS: [u32; 4] = [2, 4, 8, 16];
const FINE_SEGMENTS: u32 = 64;
/// Stiffnesses and leans at which they are, along each range.
const SAMPLES: u32 = 17;
/// A table is built so often to be timed.
const BUILDS: usize = 3;

/// What was found of the shapes.
#[derive(Clone, Debug, Default)]
pub struct Blades {
    tables: Vec<TableRow>,
    segments: Vec<SegmentsRow>,
}

/// A table of shapes against the direct solver.
#[derive(Clone, Copy, Debug)]
struct TableRow {
    root: Root,
    lean_deg: [f32; 2],
    entries: [u32; 2],
    errors: TableErrors,
    bytes: usize,
    build_ms: f64,
}

/// A blade of some segments against one of many, of the same material.
#[derive(Clone, Copy, Debug)]
struct SegmentsRow {
    root: Root,
    segments: u32,
    errors: TableErrors,
}

impl Blades {
    /// Builds and measures every table; takes some seconds.
    ///
    /// # Errors
    ///
    /// None is known; the solver's are passed on.
    pub fn measure() -> Result<Self, TableError> {
        let mut blades = Self::default();
        for root in ROOTS {
            for lean_deg in LEANS_DEG {
                for entries in ENTRIES {
                    blades.tables.push(table_row(root, lean_deg, entries)?);
                }
            }
        }
        for root in ROOTS {
            for segments in SEGMENTS {
                let errors = segment_errors(root, segments)?;
                blades.segments.push(SegmentsRow {
                    root,
                    segments,
                    errors,
                });
            }
        }
        Ok(blades)
    }

    /// Writes both tables in Markdown.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let [low, high] = Species::default().stiffness;
        let usual = Solver::default();
        writeln!(
            out,
            "## The table of resting blades\n\n\
             Against the direct solver of the same blade of {} segments, k′ from {low} to {high}: \
             distances of nodes in blade lengths, over nine points in every cell of the table; the \
             root mean square is over plants. A scene that does not say gets 128 × 64, and 256 × 128 for \
             blades of which some hardly lean.\n\n\
             | root | lean, ° | entries | max, L | RMS, L | bytes | build, ms |\n\
             |---|---|---|---|---|---|---|",
            usual.segments
        )?;
        for row in &self.tables {
            let ([from, to], [across, along]) = (row.lean_deg, row.entries);
            writeln!(
                out,
                "| {} | {from} … {to} | {across} × {along} | {:.1e} | {:.1e} | {} | {:.1} |",
                words(row.root),
                row.errors.max,
                row.errors.rms,
                row.bytes,
                row.build_ms
            )?;
        }
        writeln!(
            out,
            "\n## Segments and root of a resting blade\n\n\
             Against a blade of {FINE_SEGMENTS} segments of the same material with root 2k′, k′ from \
             {low} to {high}, lean {} … {}°: what few segments err by.\n\n\
             | segments | root | max, L | RMS, L |\n|---|---|---|---|",
            Species::default().lean_deg[0],
            Species::default().lean_deg[1]
        )?;
        for row in &self.segments {
            writeln!(
                out,
                "| {} | {} | {:.1e} | {:.1e} |",
                row.segments,
                words(row.root),
                row.errors.max,
                row.errors.rms
            )?;
        }
        writeln!(out)
    }
}

fn words(root: Root) -> &'static str {
    match root {
        Root::Double => "2k′",
        Root::Paper => "k′ (P15)",
    }
}

fn table_row(root: Root, lean_deg: [f32; 2], entries: [u32; 2]) -> Result<TableRow, TableError> {
    let grass = Grass {
        species: vec![Species {
            lean_deg,
            ..Species::default()
        }],
        ..Grass::default()
    };
    let mut times_ms = Vec::new();
    for _ in 0..BUILDS {
        let started = Instant::now();
        BladeTable::new(&grass, Solver::default().segments, root, Some(entries))?;
        times_ms.push(started.elapsed().as_secs_f64() * 1e3);
    }
    let table = BladeTable::new(&grass, Solver::default().segments, root, Some(entries))?;
    Ok(TableRow {
        root,
        lean_deg,
        entries,
        errors: table.errors()?,
        bytes: std::mem::size_of_val(table.directions.as_slice()),
        build_ms: median(&times_ms).unwrap_or(0.0),
    })
}

/// Distances of a blade's nodes from those at the same arc length in the fine one.
fn segment_errors(root: Root, segments: u32) -> Result<TableErrors, ShapeError> {
    let kind = Species::default();
    let between =
        |[low, high]: [f64; 2], n: u32| low + (high - low) * f64::from(n) / f64::from(SAMPLES - 1);
    let log2_k = kind.stiffness.map(|k| libm::log2(f64::from(k)));
    let lean_rad = kind.lean_deg.map(|lean| f64::from(lean).to_radians());
    let every = (FINE_SEGMENTS / segments) as usize;
    let mut errors = TableErrors::default();
    let mut squares = 0.0;
    let mut nodes = 0;
    for sample in 0..SAMPLES * SAMPLES {
        let k_prime = libm::exp2(between(log2_k, sample % SAMPLES));
        let lean = between(lean_rad, sample / SAMPLES);
        let shape = |segments, root| {
            let k_prime = stiffness_for_segments(k_prime, segments);
            blade_shape::solve::<f64>(segments, k_prime, root, lean)
        };
        let (coarse, fine) = (shape(segments, root)?, shape(FINE_SEGMENTS, Root::Double)?);
        let pairs = coarse.nodes.iter().zip(fine.nodes.iter().step_by(every));
        for (a, b) in pairs.skip(1) {
            let gap = libm::hypot(a[0] - b[0], a[1] - b[1]);
            errors.max = errors.max.max(gap);
            squares += gap * gap;
            nodes += 1;
        }
    }
    errors.rms = (squares / f64::from(nodes)).sqrt();
    Ok(errors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_double_root_is_nearer_to_a_continuous_beam_and_converges_at_second_order() {
        let error = |root, segments| segment_errors(root, segments).expect("valid").rms;
        for segments in [4, 8, 16] {
            assert!(error(Root::Double, segments) < 0.25 * error(Root::Paper, segments));
        }
        // Of second order but for the error of the fine blade itself, a sixteenth at 16 segments.
        let ratio = error(Root::Double, 8) / error(Root::Double, 16);
        assert!((3.0..6.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_finer_table_has_a_smaller_error_whatever_the_root_and_the_lean() {
        for root in ROOTS {
            for lean_deg in LEANS_DEG {
                let [coarse, fine] = [[16, 8], [64, 32]]
                    .map(|entries| table_row(root, lean_deg, entries).expect("valid").errors);
                assert!(
                    fine.max < coarse.max && fine.rms < coarse.rms,
                    "{root:?} {lean_deg:?}"
                );
                assert!(fine.rms <= fine.max);
            }
        }
    }
}
