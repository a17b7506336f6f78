//! A plant is its seed: everything about it follows from (triangle id, plant index).
//!
//! P15 section 2.2 with eq. 23-25: two words from Philox-2x32 place the root on the seeding
//! triangle, alone or in a cluster; a small generator gives the rest. Deviations: the hash takes the triangle's integer
//! id instead of float coordinates (exact on every machine), the reflection of eq. 23-24 is done on
//! the words (exact), and a plant count with a fraction is rounded by a hash of the triangle, not
//! cut off (the mean stays right). WGSL twin: `shaders/shared/plant.wgsl`; words agree bit for
//! bit, the floats made of them to 2 ulp.

use crate::base::philox::{Pcg, philox2x32, unit};
use crate::base::trig::{cos_turns, sin_turns};
use crate::scene::{Form, Grass, PhiloxRounds, Response, Species};
use crate::terrain::HeightGrid;

use super::blade_table::{BladeTable, SpeciesRange};
use super::clusters::{CLUSTER_WORD, folded, stratum};
use super::grid::{ANCHOR_CELLS, Anchor, FieldGrid, SeedPlace, TileId, ground_in_anchor};
use super::kinds::{Choice, Kinds};

/// Most kinds of plants in one meadow.
pub const MAX_SPECIES: usize = 8;

/// [`SpeciesNumbers::towards`] of a kind that leans to all sides alike.
const NO_LIGHT: [f32; 2] = [0.0, -1.0];

/// One plant, in its anchor's coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plant {
    pub root_in_anchor: [f32; 3],
    /// Direction the blade leans to: cosine and sine of its azimuth from +x towards +z.
    pub azimuth: [f32; 2],
    /// Length of the centre line, in metres.
    pub height_m: f32,
    pub width_m: f32,
    /// Places in the blade table, 0…1.
    pub stiffness: f32,
    pub lean: f32,
    pub flexibility: f32,
    pub species: u32,
    /// Phase of its own trembling, and a free word for its colour.
    pub flutter_turns: f32,
    pub shade: u32,
}

/// The numbers of a kind of plant as the seeds use them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpeciesNumbers {
    /// A plant is of the first kind whose bound lies above its random word.
    pub share_below: u32,
    pub height_m: [f32; 2],
    pub width_m: [f32; 2],
    /// Smallest place in the blade table and the span of places.
    pub stiffness: [f32; 2],
    pub lean: [f32; 2],
    /// Azimuth of the light and how far from it plants lean, in turns; the latter below 0 where they
    /// lean to all sides alike.
    pub towards: [f32; 2],
    pub flexibility: f32,
    pub tint_rgb: [f32; 3],
    /// Part of its height and stiffness that a plant lacks where the ground is another kind's.
    pub dwindle: f32,
    /// Whether bodies push its plants aside, bent or shoved.
    pub responds: bool,
    pub form: Form,
}

/// How seeds become plants in one meadow.
#[derive(Clone, Debug, PartialEq)]
pub struct Seeds {
    pub key: u32,
    pub rounds: u32,
    /// Seeds of a cluster; 1 for seeds that lie alone.
    pub cluster: u32,
    pub species: Vec<SpeciesNumbers>,
    /// Where each kind grows; `None` for everywhere, by the shares alone.
    pub kinds: Option<Kinds>,
}

/// Where a seed lies: shares of its triangle's legs, as words.
struct Sown {
    root: [u32; 2],
    /// Where its kind is looked up.
    middle: [u32; 2],
    /// What chooses its kind.
    word: u32,
}

impl Seeds {
    /// `table` says where each kind draws its stiffness and lean from.
    pub fn new(grass: &Grass, philox: PhiloxRounds, table: &BladeTable, grid: &FieldGrid) -> Self {
        let total: f64 = grass.species.iter().map(|s| f64::from(s.share)).sum();
        let mut below = 0.0;
        let mut species: Vec<SpeciesNumbers> = grass
            .species
            .iter()
            .zip(&table.species)
            .map(|(kind, range)| {
                below += f64::from(kind.share) / total;
                // The product saturates at u32::MAX, which the last kind gets in any case.
                numbers(kind, range, (below * 4_294_967_296.0) as u32)
            })
            .collect();
        if let Some(last) = species.last_mut() {
            last.share_below = u32::MAX;
        }
        Self {
            key: grass.seed,
            rounds: match philox {
                PhiloxRounds::Seven => 7,
                PhiloxRounds::Paper => 3,
            },
            // P15: a triangle of fewer plants than a cluster has none.
            cluster: if grid.sure_plants < grass.cluster {
                1
            } else {
                grass.cluster
            },
            species,
            kinds: None,
        }
    }

    /// Number of plants on a seeding triangle.
    pub fn plants_on(&self, grid: &FieldGrid, triangle: u32) -> u32 {
        let word = philox2x32([triangle, u32::MAX], self.key, self.rounds)[0];
        grid.sure_plants + u32::from(word < grid.one_more)
    }

    /// The plant at a place of a tile's order, or `None` where nothing grows: beyond the ground's
    /// edge, or past a triangle's own count.
    pub fn plant(
        &self,
        grid: &FieldGrid,
        ground: &HeightGrid,
        anchor: &Anchor,
        tile: TileId,
        place: u32,
    ) -> Option<Plant> {
        let seed = grid.seed_place(tile, place);
        let SeedPlace { cell, half, index } = seed;
        if cell[0] >= grid.cells[0] || cell[1] >= grid.cells[1] {
            return None;
        }
        let triangle = grid.triangle(&seed);
        if index >= grid.sure_plants && index >= self.plants_on(grid, triangle) {
            return None;
        }
        let words = philox2x32([triangle, index], self.key, self.rounds);
        let sown = self.sown(triangle, index, words);
        let in_cell = in_cell(cell, half, sown.root);
        let choice = match &self.kinds {
            None => self.by_share(sown.word),
            Some(kinds) => {
                let origin = kinds.on_map.anchor(grid, anchor);
                let middle = self::in_cell(cell, half, sown.middle);
                kinds.choose(kinds.on_map.place(origin, cell, middle), sown.word)
            }
        };
        let species = choice.kind?;
        let root_in_anchor = root_in_anchor(grid, ground, anchor, cell, in_cell);
        Some(self.grow(words, species, choice.thrives, root_in_anchor))
    }

    /// Where a seed lies, alone or in its cluster.
    fn sown(&self, triangle: u32, index: u32, words: [u32; 2]) -> Sown {
        if self.cluster <= 1 {
            let root = folded(words);
            return Sown {
                root,
                middle: root,
                word: Pcg::from_words(words).next_word(),
            };
        }
        let cluster = index / self.cluster;
        let stratum = stratum(triangle, cluster, self.key, self.rounds);
        let of_cluster = philox2x32([triangle, CLUSTER_WORD + cluster], self.key, self.rounds);
        Sown {
            root: stratum.within(words),
            middle: stratum.within(of_cluster),
            word: Pcg::from_words(of_cluster).next_word(),
        }
    }

    /// A kind by the shares alone.
    fn by_share(&self, word: u32) -> Choice {
        let kind = self.species.iter().position(|s| word < s.share_below);
        Choice {
            kind: Some(kind.unwrap_or(self.species.len() - 1) as u32),
            thrives: 1 << 16,
        }
    }

    /// The plant of a kind that thrives by so many 2⁻¹⁶ parts.
    fn grow(&self, words: [u32; 2], species: u32, thrives: u32, root_in_anchor: [f32; 3]) -> Plant {
        let mut random = Pcg::from_words(words);
        // The word that chooses the kind of a seed that lies alone.
        random.next_word();
        let kind = &self.species[species as usize];
        // Eq. 18: on its own ground a plant is as large and stiff as its seed says.
        let vigour = 1.0 - kind.dwindle * (1.0 - thrives as f32 * (1.0 / 65_536.0));
        let mut draw = |range: [f32; 2]| range[0] + range[1] * unit(random.next_word());
        let height_m = draw(kind.height_m) * vigour;
        let width_m = draw(kind.width_m);
        let stiffness = draw([kind.stiffness[0], kind.stiffness[1] * vigour]);
        let lean = draw(kind.lean);
        let turns = azimuth_turns(kind.towards, unit(random.next_word()));
        Plant {
            root_in_anchor,
            azimuth: [cos_turns(turns), sin_turns(turns)],
            height_m,
            width_m,
            stiffness,
            lean,
            flexibility: kind.flexibility,
            species,
            flutter_turns: unit(random.next_word()),
            shade: random.next_word(),
        }
    }
}

/// Azimuth of a plant from its random number: evenly all around, or with a density that falls along
/// straight lines from the light's azimuth to both sides, where the inverse of the distribution is a
/// square root.
fn azimuth_turns([light, spread]: [f32; 2], random: f32) -> f32 {
    if spread < 0.0 {
        return random;
    }
    let side = 2.0 * random - 1.0;
    let away = 1.0 - (1.0 - side.abs()).sqrt();
    light + spread * if side < 0.0 { -away } else { away }
}

/// Steps that a seeding cell's side is divided into.
pub const CELL_STEPS: u32 = 1 << 24;

/// Place in a seeding cell along x and z, in 2⁻²⁴ of its side, given the shares of both legs as
/// words (eq. 25). Half 0 of an evenly cut cell has its right angle at (1, 0), half 1 at (0, 1); of
/// an oddly cut one at (0, 0) and (1, 1). From the right angle both legs run along the axes, so that
/// no vertices are needed.
pub(super) fn in_cell(cell: [u32; 2], half: u32, [a, b]: [u32; 2]) -> [u32; 2] {
    let even = (cell[0] + cell[1]) & 1 == 0;
    let along = |at_end: bool, r: u32| {
        if at_end {
            CELL_STEPS - (r >> 8)
        } else {
            r >> 8
        }
    };
    [along(even != (half == 1), a), along(half == 1, b)]
}

/// Place on the ground of a place in a cell in units of 2⁻²⁴ of its side, in the anchor's coordinates.
pub(super) fn root_in_anchor(
    grid: &FieldGrid,
    ground: &HeightGrid,
    anchor: &Anchor,
    cell: [u32; 2],
    in_cell: [u32; 2],
) -> [f32; 3] {
    let [x, z] = [0, 1].map(|a| {
        // At most 2²⁴ steps: exact.
        let share = in_cell[a] as f32 * (1.0 / CELL_STEPS as f32);
        ((cell[a] % ANCHOR_CELLS) as f32 + share) * grid.cell_m
    });
    [x, ground_in_anchor(ground, anchor, x, z), z]
}

fn numbers(kind: &Species, range: &SpeciesRange, share_below: u32) -> SpeciesNumbers {
    let span = |[low, high]: [f32; 2]| [low, high - low];
    SpeciesNumbers {
        share_below,
        height_m: span(kind.height_m),
        width_m: span(kind.width_m),
        stiffness: span(range.stiffness),
        lean: span(range.lean),
        towards: kind.phototropic.map_or(NO_LIGHT, |towards| {
            [
                towards.light_deg.rem_euclid(360.0) / 360.0,
                towards.spread_deg / 360.0,
            ]
        }),
        flexibility: kind.flexibility,
        tint_rgb: kind.tint_rgb,
        dwindle: kind.likes.as_ref().map_or(0.0, |likes| likes.dwindle),
        responds: kind.response != Response::Stays,
        form: kind.form,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One peak at the light's azimuth, falling to nothing at the spread on both sides: with a
    /// triangular density half the spread holds three quarters of the plants, a quarter 7/16.
    #[test]
    fn phototropic_plants_crowd_about_the_light() {
        let towards = [0.6, 0.25];
        let count = 1 << 16;
        let turns = (0..count).map(|n| azimuth_turns(towards, n as f32 / count as f32));
        let away: Vec<f32> = turns.map(|turns| turns - towards[0]).collect();
        assert!(away.iter().all(|away| away.abs() <= towards[1]));
        let within = |share: f32| {
            let inside = away.iter().filter(|a| a.abs() < share * towards[1]).count();
            inside as f64 / f64::from(count)
        };
        assert!((within(0.5) - 0.75).abs() < 1e-3);
        assert!((within(0.25) - 0.4375).abs() < 1e-3);
        let left = away.iter().filter(|&&a| a < 0.0).count();
        assert!(left.abs_diff(count as usize / 2) <= 1);
        assert_eq!(azimuth_turns(NO_LIGHT, 0.37), 0.37);
    }
}
