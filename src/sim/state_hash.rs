//! The state hash: equal for two runs whose bodies and grass have the same bits in every tick.
//!
//! A tick's hash is the sum of the hashes of single plants, each over the seed that the plant is
//! (triangle and index), the tick of its last contact, its offsets and its faces; a billboard is known by
//! its root and edge instead of a seed. A sum knows no
//! order and a seed no tile, so neither the number of threads nor the order, size or slabs of
//! tiles matter. The chain takes in one tick after the other, with the bodies of that tick.
//!
//! A contact is all that ever writes to a plant: what no tick wrote is what it was. So most ticks
//! take in the plants they pushed alone, and every [`FULL_EVERY`]th one takes in all that are not
//! yet back in the wind pose, should anything else have written to them.

use rayon::prelude::*;

use crate::base::{Hash64, Real};

use super::cpu::Grass;
use super::meadow::Meadow;
use super::measure::GrassState;
use super::slab::Slab;
use super::work::TileWork;

/// Ticks from one that takes in the whole state to the next.
pub const FULL_EVERY: u32 = 32;

/// The hash of a run up to some tick, each tick chained to the one before.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct StateHash {
    chain: Hash64,
}

impl StateHash {
    /// Takes in a tick that is done.
    pub fn tick<R: Real>(&mut self, meadow: &Meadow, grass: &Grass<R>) {
        let since = if meadow.ticks.is_multiple_of(FULL_EVERY) {
            first_bent(meadow)
        } else {
            meadow.ticks
        };
        self.bodies(meadow);
        self.chain.word(plants_hash(meadow, grass, since));
    }

    /// Takes in the bodies of a tick alone, for an engine that promises no bits of the grass.
    pub fn bodies(&mut self, meadow: &Meadow) {
        self.chain.word(u64::from(meadow.ticks));
        self.chain.word(meadow.bodies.hash());
    }

    pub fn value(&self) -> u64 {
        self.chain.value()
    }
}

/// The hash of the grass as it stands, whatever was before.
pub fn state_hash<R: Real>(meadow: &Meadow, grass: &Grass<R>) -> u64 {
    let mut hash = Hash64::default();
    hash.word(u64::from(meadow.ticks));
    hash.word(plants_hash(meadow, grass, first_bent(meadow)));
    hash.value()
}

/// Earliest last contact that still shows: a plant touched before it is back in the wind pose.
fn first_bent(meadow: &Meadow) -> u32 {
    (meadow.ticks + 1).saturating_sub(meadow.recovery_ticks())
}

/// The sum of the hashes of the plants and billboards touched in tick `since` or later.
fn plants_hash<R: Real>(meadow: &Meadow, grass: &Grass<R>, since: u32) -> u64 {
    let since = since.max(1);
    let of_tile = |tile: &TileWork| {
        let plants = GrassState::slab(grass, tile.slab).map(|slab| {
            let segments = meadow.field.table.segments as usize;
            touched_hash(slab, segments, since, |place| {
                plant_key(meadow, tile, place)
            })
        });
        let billboards = GrassState::billboards(grass, tile.slab);
        let billboards = billboards.zip(meadow.weave.as_ref()).map(|(slab, weave)| {
            let key = |place| billboard_key(meadow, tile, place);
            touched_hash(slab, weave.grid.movable(), since, key)
        });
        plants.unwrap_or(0).wrapping_add(billboards.unwrap_or(0))
    };
    let tiles = meadow.work.tiles.par_iter();
    tiles.map(of_tile).reduce(|| 0, u64::wrapping_add)
}

/// The seed that a plant is.
fn plant_key(meadow: &Meadow, tile: &TileWork, place: usize) -> Hash64 {
    let grid = &meadow.field.grid;
    let seed = grid.seed_place(tile.tile, place as u32);
    let mut key = Hash64::default();
    key.word(u64::from(grid.triangle(&seed)) << 32 | u64::from(seed.index));
    key
}

/// Where a billboard stands and which way its edge runs: no tile knows the seed that it is.
fn billboard_key(meadow: &Meadow, tile: &TileWork, place: usize) -> Hash64 {
    let mut key = Hash64::default();
    let field = meadow.field.billboards.as_ref();
    if let Some(billboard) = field.and_then(|field| field.in_tile(tile.tile).get(place)) {
        tile.anchor
            .index
            .iter()
            .for_each(|&i| key.word(u64::from(i)));
        let places = billboard.root_in_anchor.iter().chain(&billboard.across);
        places.for_each(|x| key.word(u64::from(x.to_bits())));
    }
    key
}

/// The sum over those of a slab that were touched in tick `since` or later; each has `nodes` movable ones.
fn touched_hash<R: Real>(
    slab: &Slab<R>,
    nodes: usize,
    since: u32,
    key: impl Fn(usize) -> Hash64,
) -> u64 {
    let mut sum = 0_u64;
    for (place, &touched_at) in slab.touched_at.iter().enumerate() {
        if touched_at < since {
            continue;
        }
        let mut hash = key(place);
        hash.word(u64::from(touched_at));
        let nodes = place * nodes..(place + 1) * nodes;
        for (offset, &face) in slab.offsets[nodes.clone()].iter().zip(&slab.faces[nodes]) {
            offset.to_f64().iter().for_each(|x| hash.word(x.to_bits()));
            hash.word(u64::from(face));
        }
        sum = sum.wrapping_add(hash.value());
    }
    sum
}
