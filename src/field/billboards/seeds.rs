//! How seeds become billboards: places as for blades, growth from the maps.
//!
//! A billboard's growth direction is the map's, tilted to a random side by a random share of the mess.
//! Its lower edge lies across that direction, so that a leaning clump shows its face, and turns away from
//! there at random: by as much as the ground is messy, and by a quarter turn to either side where clumps
//! stand upright, which have no face to show. A clump that lies on the ground keeps its edge across, or it
//! would be no more than a line.
//!
//! All that decides how many billboards there are, and which, is done in integers. WGSL twin:
//! `shaders/billboard_place.wgsl`.

use std::sync::Arc;

use crate::base::philox::{Pcg, philox2x32, unit};
use crate::base::trig::{cos_turns, sin_turns};
use crate::base::{Vec3, least, most};
use crate::field::clusters::folded;
use crate::field::grid::{Anchor, FieldGrid, SeedPlace, TileId};
use crate::field::on_map::OnMap;
use crate::field::plant::{in_cell, root_in_anchor};
use crate::scene::{Billboards, ClumpKind};
use crate::terrain::{Cover, CoverMap, HeightGrid};

use super::packed::{
    CLUMP_VARIANTS, FINE_STEPS, PackedBillboard, UNIT_STEP, UNIT_STEPS, level_squared, pair,
    signed_pair,
};

/// Second counter word of a triangle's first billboard. Blades have smaller words and clusters larger
/// ones, so that no billboard shares random numbers with a blade, whatever the seeds.
pub const BILLBOARD_WORD: u32 = 1 << 30;
/// Second counter word of the hash that rounds a triangle's number of billboards.
pub const BILLBOARD_COUNT_WORD: u32 = (1 << 31) - 1;
/// Largest tilt from the map's direction, at full messiness.
pub const MOST_TILT_TURNS: f32 = 0.125;
/// Sine of the lean from which on a clump shows its face all the way, as a factor.
pub const FACES_FROM: f32 = 4.0;

/// The numbers of a kind of clump as the seeds use them. Pairs are the smallest value and how many steps
/// there are from it, in 1/4096 m.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct ClumpNumbers {
    /// A billboard is of the first kind whose bound lies above its random word.
    pub share_below: u32,
    pub height: [u32; 2],
    pub width: [u32; 2],
    /// In 1/4096.
    pub flexibility: u32,
}

/// How seeds become billboards in one meadow.
#[derive(Clone, Debug, PartialEq)]
pub struct BillboardSeeds {
    pub key: u32,
    pub rounds: u32,
    /// The meadow's division with the billboards' own numbers per triangle.
    pub grid: FieldGrid,
    pub kinds: Vec<ClumpNumbers>,
    pub map: Arc<CoverMap>,
    pub on_map: OnMap,
}

/// What the seeds of a tile have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileStart {
    pub tile: TileId,
    pub anchor: Anchor,
    /// Place of the anchor's origin on the map, in units of 2⁻¹⁶ texel.
    pub anchor_on_map: [u32; 2],
}

impl BillboardSeeds {
    /// `grid` has the billboards' numbers per triangle.
    pub(super) fn new(
        billboards: &Billboards,
        rounds: u32,
        grid: FieldGrid,
        map: CoverMap,
    ) -> Self {
        let total: f64 = billboards.clumps.iter().map(|k| f64::from(k.share)).sum();
        let mut below = 0.0;
        let mut kinds: Vec<ClumpNumbers> = billboards
            .clumps
            .iter()
            .map(|kind| {
                below += f64::from(kind.share) / total;
                // The product saturates at u32::MAX, which the last kind gets in any case.
                numbers(kind, (below * 4_294_967_296.0) as u32)
            })
            .collect();
        if let Some(last) = kinds.last_mut() {
            last.share_below = u32::MAX;
        }
        Self {
            key: billboards.seed,
            rounds,
            on_map: OnMap::new(&grid, map.texel_m),
            grid,
            kinds,
            map: Arc::new(map),
        }
    }

    pub fn start_of(&self, ground: &HeightGrid, tile: TileId) -> TileStart {
        let anchor = self.grid.anchor_of(tile, ground);
        TileStart {
            tile,
            anchor,
            anchor_on_map: self.on_map.anchor(&self.grid, &anchor),
        }
    }

    /// The billboards of a tile in the order of its places.
    pub fn in_tile<'a>(
        &'a self,
        ground: &'a HeightGrid,
        tile: TileId,
    ) -> impl Iterator<Item = PackedBillboard> + 'a {
        let start = self.start_of(ground, tile);
        let places = 0..self.grid.plants_per_tile();
        places.filter_map(move |place| self.billboard(ground, &start, place))
    }

    /// Billboards of a seeding triangle where the extent is white.
    fn most_on(&self, triangle: u32) -> u32 {
        let word = philox2x32([triangle, BILLBOARD_COUNT_WORD], self.key, self.rounds)[0];
        self.grid.sure_plants + u32::from(word < self.grid.one_more)
    }

    /// The billboard at a place of a tile's order, or `None` where nothing grows: beyond the ground's
    /// edge, past a triangle's own count, or where its random word lies outside the extent.
    pub fn billboard(
        &self,
        ground: &HeightGrid,
        start: &TileStart,
        place: u32,
    ) -> Option<PackedBillboard> {
        let grid = &self.grid;
        let seed = grid.seed_place(start.tile, place);
        let SeedPlace { cell, half, index } = seed;
        if cell[0] >= grid.cells[0] || cell[1] >= grid.cells[1] {
            return None;
        }
        let triangle = grid.triangle(&seed);
        if index >= grid.sure_plants && index >= self.most_on(triangle) {
            return None;
        }
        let words = philox2x32([triangle, BILLBOARD_WORD + index], self.key, self.rounds);
        let in_cell = in_cell(cell, half, folded(words));
        let on_map = self.on_map.place(start.anchor_on_map, cell, in_cell);
        let cover = self.map.at(on_map);
        let mut random = Pcg::from_words(words);
        if random.next_word() >> 16 >= cover.extent {
            return None;
        }
        let root = root_in_anchor(grid, ground, &start.anchor, cell, in_cell);
        Some(self.grow(&mut random, start.tile, &cover, root))
    }

    fn grow(
        &self,
        random: &mut Pcg,
        tile: TileId,
        cover: &Cover,
        root_in_anchor: [f32; 3],
    ) -> PackedBillboard {
        let word = random.next_word();
        let kind = self.kinds.iter().position(|kind| word < kind.share_below);
        let kind = kind.unwrap_or(self.kinds.len() - 1);
        let numbers = &self.kinds[kind];
        let variant = random.next_word() >> 30;
        let texture = kind as u32 * CLUMP_VARIANTS + variant;
        let mut drawn =
            |[low, span]: [u32; 2]| low + (((span + 1) * (random.next_word() >> 16)) >> 16);
        let size = pair(drawn(numbers.height), drawn(numbers.width));
        let flutter = random.next_word() >> 16;
        let mess = cover.messiness as f32 * (1.0 / 65_536.0);
        let azimuth_turns = unit(random.next_word());
        let tilt_turns = MOST_TILT_TURNS * mess * unit(random.next_word());
        let up = tilted(cover.direction, azimuth_turns, tilt_turns);
        let across = edge(up, mess, 2.0 * unit(random.next_word()) - 1.0);
        PackedBillboard {
            root_in_anchor,
            size,
            up: signed_pair(up),
            across: signed_pair(across),
            sway: pair(numbers.flexibility, flutter),
            tile_and_texture: tile | (texture << 24),
        }
    }
}

/// The nearest step of a component of a unit vector.
fn steps(x: f32) -> i32 {
    (x * UNIT_STEPS as f32 + 0.5).floor() as i32
}

/// Level steps of the unit vector along a map's direction, tilted to a side. One that would point below
/// the ground's level is mirrored at it.
fn tilted(direction: [i32; 3], azimuth_turns: f32, tilt_turns: f32) -> [i32; 2] {
    // At most 2¹⁶: exact.
    let [x, y, z] = direction.map(|n| n as f32);
    let n = Vec3::new(x, y, z).unit_or(Vec3::UP);
    // Two unit vectors at right angles to n and each other, without a case for any n that rises.
    let a = 1.0 / (1.0 + n.y);
    let b = -(n.x * n.z * a);
    let east = Vec3::new(1.0 - n.x * n.x * a, -n.x, b);
    let north = Vec3::new(b, -n.z, 1.0 - n.z * n.z * a);
    let aside = east * cos_turns(azimuth_turns) + north * sin_turns(azimuth_turns);
    let up = n * cos_turns(tilt_turns) + aside * sin_turns(tilt_turns);
    // Only y would have to be mirrored, and it is not kept.
    [steps(up.x), steps(up.z)]
}

/// Level steps of the lower edge of a clump with this growth direction; `random` is −1…1.
fn edge(up: [i32; 2], mess: f32, random: f32) -> [i32; 2] {
    let level = (level_squared(up) as f32).sqrt();
    let lean = level * UNIT_STEP;
    let shown = (1.0 - mess) * least(1.0, FACES_FROM * lean);
    let order = most(shown, lean * lean);
    let turns = 0.25 * (1.0 - order) * random;
    let [x, z] = if level > 0.0 {
        up.map(|n| n as f32 / level)
    } else {
        [1.0, 0.0]
    };
    let (cos, sin) = (cos_turns(turns), sin_turns(turns));
    // A quarter turn from the lean, then the random rest.
    [steps(-z * cos - x * sin), steps(x * cos - z * sin)]
}

fn numbers(kind: &ClumpKind, share_below: u32) -> ClumpNumbers {
    let steps = |x: f32| (f64::from(x) * f64::from(FINE_STEPS)).round() as u32;
    let span = |[low, high]: [f32; 2]| [steps(low), steps(high) - steps(low)];
    ClumpNumbers {
        share_below,
        height: span(kind.height_m),
        width: span(kind.width_m),
        flexibility: steps(kind.flexibility),
    }
}
