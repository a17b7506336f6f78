//! The second layer of a meadow: billboards that stand for clumps of grass (O09 section 4).
//!
//! Deviations from the paper: the direction map may say another direction at every place (the paper's
//! says one for all, "for simplicity"); tiles are leaves of the octree of the blades' layer, whose ranges
//! are looked up by the tile's number instead of being stored in the tree. The device's generation is
//! `shaders/billboard_place.wgsl`.

mod packed;
mod seeds;

pub use packed::{
    AZIMUTH_STEPS, CLUMP_VARIANTS, FINE_STEPS, PackedBillboard, UNIT_STEP, UNIT_STEPS,
};
pub use seeds::{
    BILLBOARD_COUNT_WORD, BILLBOARD_WORD, BillboardSeeds, ClumpNumbers, FACES_FROM,
    MOST_TILT_TURNS, TileStart,
};

use std::ops::Range;

use rayon::prelude::*;

use crate::base::{Real, Vec3, most};
use crate::scene::limits::{BILLBOARDS, BILLBOARDS_PER_TILE, CLUMPS, TILES};
use crate::scene::{Billboards, ClumpKind};
use crate::terrain::{CoverMap, HeightGrid};

use super::grid::{FieldGrid, TileId};

/// Most kinds of clumps in one meadow.
pub const MAX_CLUMPS: usize = CLUMPS;
/// Share of the wind's bend that the straight sides of a quad take: the mean of s(2 − s), so that its upper
/// edge moves as far as the tip of a blade of the same flexibility.
pub const WIND_SHARE: f64 = 2.0 / 3.0;
/// Tiles that one thread lays out at a time.
const TILES_AT_ONCE: u32 = 256;

/// One billboard at rest, in its anchor's coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Billboard {
    /// Middle of its lower edge, on the ground.
    pub root_in_anchor: [f32; 3],
    /// Level unit direction of its lower edge, along x and z.
    pub across: [f32; 2],
    /// Unit vector from the lower edge to the upper one.
    pub up: [f32; 3],
    /// Length of its sides, in metres.
    pub height_m: f32,
    /// Length of its lower edge, in metres.
    pub width_m: f32,
    /// How far wind bends it, 1 as the wind's strength says.
    pub flexibility: f32,
    /// Phase of its own trembling.
    pub flutter_turns: f32,
    /// Layer of the array of clump pictures.
    pub texture: u32,
    /// Place in the scene's list of kinds.
    pub kind: u32,
}

impl Billboard {
    pub fn root<R: Real>(&self) -> Vec3<R> {
        Vec3::of_f32(self.root_in_anchor)
    }

    /// Radius of a ball about the root that holds the billboard in any pose of its lengths, in metres.
    pub fn reach_m<R: Real>(&self) -> R {
        R::of_f32(self.width_m) * R::of(0.5) + R::of_f32(self.height_m)
    }
}

/// Every billboard of a meadow, tile by tile.
#[derive(Clone, Debug)]
pub struct BillboardField {
    pub seeds: BillboardSeeds,
    pub all: Vec<Billboard>,
    /// Where the billboards of every tile begin in `all`, and their number as the last one.
    pub ranges: Vec<u32>,
    /// Columns and rows of nodes of a touched billboard.
    pub nodes: [u32; 2],
    /// Drawn segments per segment between them.
    pub draw_subdivision: u32,
    /// What the clumps look like, kind by kind.
    pub clumps: Vec<ClumpKind>,
    /// How far one of them can reach from its root, in metres.
    pub reach_m: f32,
}

/// Why billboards cannot be laid out. A loaded scene has been checked for all of it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BillboardError {
    #[error(
        "billboards.density_per_m2 makes up to {count} billboards in a tile, more than \
         {BILLBOARDS_PER_TILE}: lower it or solver.tile_m"
    )]
    TileTooFull { count: u64 },
    #[error(
        "billboards.density_per_m2 makes {count:.0} billboards where the extent is white everywhere, \
         more than {BILLBOARDS}: lower it or make the ground smaller"
    )]
    TooMany { count: f64 },
    #[error("the field has {count} tiles, more than {TILES}: make solver.tile_m larger")]
    TooManyTiles { count: u32 },
    #[error("billboards.clumps has {count} kinds: give 1 to {MAX_CLUMPS}")]
    Kinds { count: usize },
}

impl BillboardField {
    /// Lays out the billboards of a scene on the tiles of its field. `rounds` are Philox's.
    ///
    /// # Errors
    /// More billboards than a tile or a field may hold, before anything is allocated.
    pub fn new(
        ground: &HeightGrid,
        grid: &FieldGrid,
        map: CoverMap,
        billboards: &Billboards,
        rounds: u32,
    ) -> Result<Self, BillboardError> {
        let kinds = billboards.clumps.len();
        if !(1..=MAX_CLUMPS).contains(&kinds) {
            return Err(BillboardError::Kinds { count: kinds });
        }
        let tiles = grid.tile_count();
        if u64::from(tiles) > TILES {
            return Err(BillboardError::TooManyTiles { count: tiles });
        }
        let grid = grid.with_density(billboards.density_per_m2);
        let in_tile = u64::from(grid.triangles_per_tile()) * u64::from(grid.plants_per_triangle());
        if in_tile > BILLBOARDS_PER_TILE {
            return Err(BillboardError::TileTooFull { count: in_tile });
        }
        let [wide, deep] = ground.size_m();
        let count = wide * deep * f64::from(billboards.density_per_m2);
        if count > BILLBOARDS as f64 {
            return Err(BillboardError::TooMany { count });
        }
        let seeds = BillboardSeeds::new(billboards, rounds, grid, map);
        let (all, ranges) = listed(&seeds, ground);
        // Sides and half an edge, in whatever direction they point.
        let reach_m = all.iter().fold(0.0_f32, |reach, billboard| {
            most(reach, billboard.height_m + 0.5 * billboard.width_m)
        });
        Ok(Self {
            seeds,
            all,
            ranges,
            nodes: billboards.nodes,
            draw_subdivision: billboards.draw_subdivision,
            clumps: billboards.clumps.clone(),
            reach_m,
        })
    }

    /// Where the billboards of a tile lie in `all`.
    pub fn range(&self, tile: TileId) -> Range<usize> {
        let tile = tile as usize;
        self.ranges[tile] as usize..self.ranges[tile + 1] as usize
    }

    /// Those of a tile, in the order of its slab.
    pub fn in_tile(&self, tile: TileId) -> &[Billboard] {
        &self.all[self.range(tile)]
    }

    /// Most billboards of a tile.
    pub fn most_in_tile(&self) -> u32 {
        let counts = self.ranges.windows(2).map(|pair| pair[1] - pair[0]);
        counts.max().unwrap_or(0)
    }
}

/// The billboards of all tiles in their order, and where each tile's begin.
fn listed(seeds: &BillboardSeeds, ground: &HeightGrid) -> (Vec<Billboard>, Vec<u32>) {
    let tiles = seeds.grid.tile_count();
    let of_tiles = |chunk: u32| {
        let first = chunk * TILES_AT_ONCE;
        let (mut all, mut counts) = (Vec::new(), Vec::new());
        for tile in first..tiles.min(first + TILES_AT_ONCE) {
            let before = all.len();
            all.extend(seeds.in_tile(ground, tile).map(|packed| packed.open()));
            counts.push((all.len() - before) as u32);
        }
        (all, counts)
    };
    let chunks: Vec<(Vec<Billboard>, Vec<u32>)> = (0..tiles.div_ceil(TILES_AT_ONCE))
        .into_par_iter()
        .map(of_tiles)
        .collect();
    let mut all = Vec::with_capacity(chunks.iter().map(|(some, _)| some.len()).sum());
    let mut ranges = Vec::with_capacity(tiles as usize + 1);
    let mut first = 0;
    for (some, counts) in chunks {
        all.extend(some);
        for count in counts {
            ranges.push(first);
            first += count;
        }
    }
    ranges.push(first);
    (all, ranges)
}

#[cfg(test)]
mod tests;
