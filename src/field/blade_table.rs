//! Resting blade shapes for every plant of a meadow: a table over stiffness and lean.
//!
//! A plant draws log k′ and its lean evenly between its kind's limits, so both axes are even in
//! what is drawn: a plant's random fraction turns into a place in the table by one multiplication
//! and one addition, without a logarithm. Entries are the directions (sin θ_j, cos θ_j) of the
//! segments. Between entries they are mixed bilinearly and come out slightly too short, so whoever
//! follows them from root to tip makes them unit vectors first.
//!
//! Where blades that hardly lean are drawn about the critical stiffness k′c, the shape is no smooth
//! function of either: its angles grow with √(1 − k′/k′c) below k′c and with the cube
//! root of the lean at it, and an even table errs by up to several percent of the length.
//! There the stiffness axis has a *knee*: half of the entries lie on each side of k′c, at the fourth
//! powers of even steps away from it, and those of the lean at the fourth powers of even steps from
//! its smallest. The angles then grow with the square of the steps. Two square roots, which IEEE 754
//! rounds correctly, turn a fraction into a place.
//!
//! Source: P15 section 2.3, which keeps the solutions of eq. 12 over k′ in a texture. Deviations:
//! directions instead of end points; a second axis for the lean; the knee.
//!
//! Limits: stated by [`BladeTable::max_error`]; in blade lengths, eight segments, measured:
//!
//! | stiffness, lean | 64 × 32 | 128 × 64 | 256 × 128 |
//! |---|---|---|---|
//! | 60 … 160, 2 … 16° (default kind) | 7.1e-4 | 1.9e-4 | 4.8e-5 |
//! | 8 … 160, 5° | 1.6e-3 | 4.0e-4 | 1.0e-4 |
//! | 8 … 160, 0 … 16° | 3.1e-3 | 1.2e-3 | 4.9e-4 |
//! | 8 … 160, 0 … 90° | 5.7e-3 | 2.2e-3 | 8.8e-4 |
//! | 8 … 160, none | 1.9e-3 | 4.9e-4 | 2.1e-4 |
//! | 0.5 … 2000, none | 3.1e-3 | 7.8e-4 | 2.0e-4 |
//!
//! A scene that does not say gets 128 × 64 entries, with a knee 256 × 128: over 70 random pairs of
//! ranges, k′ 0.06 … 6e4 and lean 0 … 90°, the worst was 6.6e-4. None of 720 more is worse than a
//! thousandth, half of whose ends were drawn about k′c and about no lean.
//!
//! A blade without lean at k′c itself has no place in `f32`: an ulp of its fraction turns its tip by
//! 1e-3 rad.

use thiserror::Error;

mod errors;

pub use errors::TableErrors;

use super::blade_shape::{
    self, STIFFNESS_RANGE, ShapeError, critical_stiffness, stiffness_for_segments,
};
use crate::base::{Real, least, most};
use crate::scene::{Grass, Root, Species};

/// Even axes of the usual size err by more than a thousandth of a blade's length about the critical
/// stiffness where the smallest lean is less than this share of the range of leans, …
const KNEE_LEAN_SHARE: f64 = 1.0 / 8.0;
/// … or where a step of log₂ k′ is more than this times the smallest lean, in radians, to the power of
/// ⅔: so much stiffer or softer a blade must be than k′c for its lean to be small beside its bend.
const KNEE_STEP: f64 = 0.2;
/// Even axes feel the critical stiffness from outside the table too: a tenth of an octave away they err by
/// up to 2e-2 of a blade's length, a third by 2e-3, and an octave by 3e-4. Nearer than this, in octaves,
/// the end of the axis is its knee.
const KNEE_REACH: f64 = 1.0;

/// Entries of a table with even axes, and of one with a knee, that keep blades within a thousandth of
/// their length of the solver.
const EVEN_ENTRIES: [u32; 2] = [128, 64];
const KNEE_ENTRIES: [u32; 2] = [256, 128];

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

/// Entries from `min` to `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    pub min: f64,
    pub max: f64,
    /// At least 2.
    pub entries: u32,
    pub spacing: Spacing,
}

/// Where the entries of an axis lie, as fractions 0…1 of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spacing {
    Even,
    /// At fourth powers of even steps away from this fraction: half of the entries on each side, or all of
    /// them on one if it is an end.
    Knee(f32),
    /// At fourth powers of even steps from 0.
    FourthPower,
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
    fn over(ranges: &[[f64; 2]]) -> Self {
        Self {
            min: ranges.iter().map(|r| r[0]).fold(f64::INFINITY, least),
            max: ranges.iter().map(|r| r[1]).fold(f64::NEG_INFINITY, most),
            entries: 2,
            spacing: Spacing::Even,
        }
    }

    /// The value at a fraction 0…1 of the axis.
    pub fn value(&self, fraction: f64) -> f64 {
        self.min + (self.max - self.min) * fraction
    }

    /// The fraction 0…1 of the axis at which a value lies; 0 where the axis has no length.
    pub fn fraction(&self, value: f64) -> f32 {
        if self.max > self.min {
            ((value - self.min) / (self.max - self.min)) as f32
        } else {
            0.0
        }
    }

    /// The entry at a knee.
    fn entries_below(&self, knee: f32) -> u32 {
        if knee <= 0.0 {
            0
        } else if knee >= 1.0 {
            self.entries - 1
        } else {
            self.entries / 2
        }
    }

    /// The fraction 0…1 at a place counted in entries.
    fn fraction_at(&self, place: f64) -> f64 {
        let last = f64::from(self.entries - 1);
        match self.spacing {
            Spacing::Even => place / last,
            Spacing::FourthPower => libm::pow(place / last, 4.0),
            Spacing::Knee(knee) => {
                let middle = f64::from(self.entries_below(knee));
                let knee = f64::from(knee);
                if middle > 0.0 && place <= middle {
                    let away = 1.0 - place / middle;
                    knee * (1.0 - libm::pow(away, 4.0))
                } else {
                    let away = (place - middle) / (last - middle);
                    knee + (1.0 - knee) * libm::pow(away, 4.0)
                }
            }
        }
    }

    /// The entry below a fraction of the axis, with one above it, and the rest of the way to that.
    /// Fractions outside 0…1 lie at the nearer end.
    fn entry_and_rest<R: Real>(&self, fraction: R) -> (usize, R) {
        let fraction = fraction.clamp(R::ZERO, R::ONE);
        let last = R::of(f64::from(self.entries - 1));
        let at = match self.spacing {
            Spacing::Even => fraction * last,
            Spacing::FourthPower => fraction.sqrt().sqrt() * last,
            Spacing::Knee(knee) => {
                let middle = R::of(f64::from(self.entries_below(knee)));
                let knee = R::of_f32(knee);
                if knee > R::ZERO && fraction <= knee {
                    middle * (R::ONE - ((knee - fraction) / knee).sqrt().sqrt())
                } else {
                    let away = ((fraction - knee) / (R::ONE - knee)).sqrt().sqrt();
                    middle + (last - middle) * away
                }
            }
        };
        let below = at.floor().min(R::of(f64::from(self.entries - 2)));
        (below.to_f64() as usize, at - below)
    }
}

impl BladeTable {
    /// Solves every entry: `entries` along log₂ k′ and the lean, at least 2 each; without them as
    /// many as keep every blade within a thousandth of its length. A grass without species gets the
    /// table of the default kind, so that a table always has entries.
    ///
    /// # Errors
    ///
    /// A kind's range that is not a range, or a count or stiffness that the solver refuses.
    pub fn new(
        grass: &Grass,
        segments: u32,
        root: Root,
        entries: Option<[u32; 2]>,
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
        let mut log2_k = Axis::over(&log2_ks);
        let mut lean_rad = Axis::over(&leans);
        let mut usual = EVEN_ENTRIES;
        let has_room = entries.is_none_or(|[stiffness, _]| stiffness > 2);
        if let Some(knee) = knee(&log2_k, &lean_rad, segments, root)?.filter(|_| has_room) {
            log2_k.spacing = Spacing::Knee(knee);
            lean_rad.spacing = Spacing::FourthPower;
            usual = KNEE_ENTRIES;
        }
        for (axis, usual) in [&log2_k, &lean_rad].into_iter().zip(&mut usual) {
            if axis.min == axis.max {
                *usual = 2;
            }
        }
        [log2_k.entries, lean_rad.entries] = entries.unwrap_or(usual).map(|n| n.max(2));
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
                    self.log2_k.fraction_at(f64::from(stiffness)),
                    self.lean_rad.fraction_at(f64::from(lean)),
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
        let (stiffness_entry, stiffness) = self.log2_k.entry_and_rest(stiffness);
        let (lean_entry, lean) = self.lean_rad.entry_and_rest(lean);
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
}

/// The fraction of the stiffness axis at which blades without lean turn upright, or its end nearest to
/// that, if the table has blades near it whose lean is too small for even axes.
fn knee(
    log2_k: &Axis,
    lean_rad: &Axis,
    segments: u32,
    root: Root,
) -> Result<Option<f32>, ShapeError> {
    let critical = critical_stiffness(segments, root)? / stiffness_for_segments(1.0, segments);
    let critical = libm::log2(critical);
    let is_near = log2_k.min - KNEE_REACH < critical && critical < log2_k.max + KNEE_REACH;
    let knee = log2_k.fraction(critical).clamp(0.0, 1.0);
    let leans = lean_rad.max - lean_rad.min;
    let step = (log2_k.max - log2_k.min) / f64::from(EVEN_ENTRIES[0] - 1);
    let hardly_leans = lean_rad.min < KNEE_LEAN_SHARE * leans
        || step > KNEE_STEP * libm::pow(lean_rad.min, 2.0 / 3.0);
    Ok((is_near && hardly_leans).then_some(knee))
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
