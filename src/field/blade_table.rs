//! Resting blade shapes for every plant of a meadow: a table over stiffness and lean.
//!
//! A plant draws log k′ and its lean evenly between its kind's limits, so both axes are even in
//! what is drawn: a plant's random fraction turns into a place in the table by one multiplication
//! and one addition, without a logarithm. Entries are the directions (sin θ_j, cos θ_j) of the
//! segments. Between entries they are mixed bilinearly and come out slightly too short, so whoever
//! follows them from root to tip makes them unit vectors first.
//!
//! Source: P15 section 2.3, which keeps the solutions of eq. 12 over k′ in a texture. Deviations:
//! directions instead of end points; a second axis for the lean, without which the slope of the
//! shape is infinite at the critical stiffness.
//!
//! Limits: stated by [`BladeTable::max_error`]; 1.9e-4 of a blade's length for the default kind of
//! grass. A kind whose stiffness range holds the critical value and whose lean starts at 0 is off
//! by several percent there.

use thiserror::Error;

use super::blade_shape::{self, STIFFNESS_RANGE, ShapeError, stiffness_for_segments};
use crate::base::Real;
use crate::scene::{Grass, Root, Species};

/// Largest lean of a root, in degrees: level with the ground.
pub const MAX_LEAN_DEG: f32 = 90.0;

/// Directions of blade segments over stiffness and lean.
#[derive(Clone, Debug)]
pub struct BladeTable {
    pub segments: u32,
    /// log₂ k′, for eight segments.
    pub log2_k: Axis,
    /// The root's lean, in radians.
    pub lean_rad: Axis,
    /// Where each kind of the grass draws from, in the order of its list.
    pub species: Vec<SpeciesRange>,
    /// [sin θ, cos θ] of segment j at
    /// (lean entry · stiffness entries + stiffness entry) · segments + j.
    pub directions: Vec<[f32; 2]>,
    root: Root,
}

/// Evenly spaced entries from `min` to `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    pub min: f64,
    pub max: f64,
    /// At least 2.
    pub entries: u32,
}

/// The part of the table that a kind of plant draws from, as fractions 0…1 of the two axes:
/// [smallest, largest].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeciesRange {
    pub stiffness: [f32; 2],
    pub lean: [f32; 2],
}

/// A place between four entries.
#[derive(Clone, Copy, Debug)]
pub struct Place<R> {
    /// Index of the first segment of the entry with the smaller stiffness and lean.
    first: usize,
    /// Fractions 0…1 of the way to the next entry.
    stiffness: R,
    lean: R,
}

/// Why a grass has no table.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TableError {
    #[error(
        "species \"{species}\": {key} [{low}, {high}] is no range: give the smaller number first, \
         both from {smallest:e} to {largest:e}"
    )]
    Range {
        species: String,
        key: &'static str,
        low: f32,
        high: f32,
        smallest: f64,
        largest: f64,
    },
    #[error(transparent)]
    Shape(#[from] ShapeError),
}

impl Axis {
    fn over(ranges: &[[f64; 2]], entries: u32) -> Self {
        Self {
            min: ranges.iter().map(|r| r[0]).fold(f64::INFINITY, f64::min),
            max: ranges
                .iter()
                .map(|r| r[1])
                .fold(f64::NEG_INFINITY, f64::max),
            entries: entries.max(2),
        }
    }

    /// Entries per unit of the axis; 0 where the axis has no length.
    pub fn step_inverse(&self) -> f64 {
        if self.max > self.min {
            f64::from(self.entries - 1) / (self.max - self.min)
        } else {
            0.0
        }
    }

    /// The value at a fraction 0…1 of the axis.
    pub fn value(&self, fraction: f64) -> f64 {
        self.min + (self.max - self.min) * fraction
    }

    /// The fraction 0…1 of the axis at which a value lies.
    pub fn fraction(&self, value: f64) -> f32 {
        ((value - self.min) * self.step_inverse() / f64::from(self.entries - 1)) as f32
    }
}

impl BladeTable {
    /// Solves every entry: `entries` along log₂ k′ and the lean, at least 2 each. A grass without
    /// species gets the table of the default kind, so that a table always has entries.
    ///
    /// # Errors
    ///
    /// A kind's range that is not a range, or a count or stiffness that the solver refuses.
    pub fn new(
        grass: &Grass,
        segments: u32,
        root: Root,
        entries: [u32; 2],
    ) -> Result<Self, TableError> {
        let default_kind = [Species::default()];
        let kinds = if grass.species.is_empty() {
            &default_kind[..]
        } else {
            &grass.species[..]
        };
        let log2_ks = kinds
            .iter()
            .map(log2_k_range)
            .collect::<Result<Vec<_>, _>>()?;
        let leans = kinds
            .iter()
            .map(lean_range_rad)
            .collect::<Result<Vec<_>, _>>()?;
        let log2_k = Axis::over(&log2_ks, entries[0]);
        let lean_rad = Axis::over(&leans, entries[1]);
        let species = log2_ks.iter().zip(&leans).map(|(k, lean)| SpeciesRange {
            stiffness: k.map(|end| log2_k.fraction(end)),
            lean: lean.map(|end| lean_rad.fraction(end)),
        });
        let mut table = Self {
            segments,
            log2_k,
            lean_rad,
            species: species.collect(),
            directions: Vec::new(),
            root,
        };
        table.fill()?;
        Ok(table)
    }

    fn fill(&mut self) -> Result<(), ShapeError> {
        for lean in 0..self.lean_rad.entries {
            for stiffness in 0..self.log2_k.entries {
                let shape = self.solve_at(
                    f64::from(stiffness) / f64::from(self.log2_k.entries - 1),
                    f64::from(lean) / f64::from(self.lean_rad.entries - 1),
                )?;
                let direction = |&a: &f64| [libm::sin(a) as f32, libm::cos(a) as f32];
                self.directions
                    .extend(shape.angles_rad.iter().map(direction));
            }
        }
        Ok(())
    }

    /// The solver's answer at a fraction of each axis.
    fn solve_at(
        &self,
        stiffness: f64,
        lean: f64,
    ) -> Result<blade_shape::BladeShape<f64>, ShapeError> {
        let k_prime = libm::exp2(self.log2_k.value(stiffness));
        blade_shape::solve(
            self.segments,
            stiffness_for_segments(k_prime, self.segments),
            self.root,
            self.lean_rad.value(lean),
        )
    }

    /// The place at a fraction of each axis; fractions outside 0…1 lie at the nearer end.
    pub fn place<R: Real>(&self, stiffness: R, lean: R) -> Place<R> {
        let (stiffness_entry, stiffness) = entry_and_rest(stiffness, self.log2_k.entries);
        let (lean_entry, lean) = entry_and_rest(lean, self.lean_rad.entries);
        let entry = lean_entry * self.log2_k.entries as usize + stiffness_entry;
        Place {
            first: entry * self.segments as usize,
            stiffness,
            lean,
        }
    }

    /// [sin θ, cos θ] of a segment (from 0 at the root), slightly shorter than a unit vector.
    pub fn direction<R: Real>(&self, place: Place<R>, segment: usize) -> [R; 2] {
        let along_stiffness = self.segments as usize;
        let along_lean = along_stiffness * self.log2_k.entries as usize;
        let low = place.first + segment;
        let mixed = |axis: usize| {
            let at = |index: usize| R::of_f32(self.directions[index][axis]);
            let mix = |a: R, b: R, t: R| a + (b - a) * t;
            let upright = mix(at(low), at(low + along_stiffness), place.stiffness);
            let leaning = low + along_lean;
            let leaned = mix(at(leaning), at(leaning + along_stiffness), place.stiffness);
            mix(upright, leaned, place.lean)
        };
        [mixed(0), mixed(1)]
    }

    /// The largest distance of a node between table and solver, in blade lengths, over nine
    /// points inside every cell of the table.
    ///
    /// # Errors
    ///
    /// The solver's.
    pub fn max_error(&self) -> Result<f64, ShapeError> {
        let inside = |entry: u32, quarter: u32, entries: u32| {
            (f64::from(entry) + f64::from(quarter) * 0.25) / f64::from(entries - 1)
        };
        let mut largest: f64 = 0.0;
        for lean in 0..self.lean_rad.entries - 1 {
            for stiffness in 0..self.log2_k.entries - 1 {
                for quarters in 0..9 {
                    largest = largest.max(self.error_at(
                        inside(stiffness, 1 + quarters % 3, self.log2_k.entries),
                        inside(lean, 1 + quarters / 3, self.lean_rad.entries),
                    )?);
                }
            }
        }
        Ok(largest)
    }

    fn error_at(&self, stiffness: f64, lean: f64) -> Result<f64, ShapeError> {
        let shape = self.solve_at(stiffness, lean)?;
        let place = self.place(stiffness, lean);
        let mut at = [0.0, 0.0];
        let mut largest: f64 = 0.0;
        for (segment, node) in shape.nodes.iter().skip(1).enumerate() {
            let [x, y] = self.direction(place, segment);
            let length = libm::hypot(x, y) * f64::from(self.segments);
            at = [at[0] + x / length, at[1] + y / length];
            largest = largest.max(libm::hypot(at[0] - node[0], at[1] - node[1]));
        }
        Ok(largest)
    }
}

/// The entry below a fraction of an axis, with one above it, and the rest of the way to that.
fn entry_and_rest<R: Real>(fraction: R, entries: u32) -> (usize, R) {
    let at = fraction.clamp(R::ZERO, R::ONE) * R::of(f64::from(entries - 1));
    let below = at.floor().min(R::of(f64::from(entries - 2)));
    (below.to_f64() as usize, at - below)
}

fn log2_k_range(kind: &Species) -> Result<[f64; 2], TableError> {
    let range = checked(kind, "stiffness", kind.stiffness, STIFFNESS_RANGE)?;
    Ok(range.map(libm::log2))
}

fn lean_range_rad(kind: &Species) -> Result<[f64; 2], TableError> {
    let range = checked(
        kind,
        "lean_deg",
        kind.lean_deg,
        [0.0, f64::from(MAX_LEAN_DEG)],
    )?;
    Ok(range.map(f64::to_radians))
}

fn checked(
    kind: &Species,
    key: &'static str,
    [low, high]: [f32; 2],
    [smallest, largest]: [f64; 2],
) -> Result<[f64; 2], TableError> {
    let range = [f64::from(low), f64::from(high)];
    if smallest <= range[0] && range[0] <= range[1] && range[1] <= largest {
        Ok(range)
    } else {
        Err(TableError::Range {
            species: kind.name.clone(),
            key,
            low,
            high,
            smallest,
            largest,
        })
    }
}

#[cfg(test)]
mod tests;
