//! What is measured of a simulated meadow: penetration, strain, lean, offset.
//!
//! Everything is computed in `f64` from the state that an engine hands out, against the bodies'
//! true shapes, whatever the engine itself collided with.

mod billboards;
mod snapshot;

use std::collections::BTreeSet;

use crate::base::{Real, Vec3};
use crate::field::{Bounds, Plant, TileId};

use super::contact::body_of;
use super::cpu::poses;
use super::meadow::Meadow;
use super::recover::Fading;
use super::slab::Slab;
pub use super::true_bodies::Depth;
use super::work::TileWork;

pub use billboards::{StandingBillboard, billboards_near, standing_billboards};
pub use snapshot::{Snapshot, snapshot};

/// Where the grass's state can be read.
pub trait GrassState<R: Real> {
    /// The slab of an active tile.
    fn slab(&self, slab: u32) -> Option<&Slab<R>>;

    /// That of its billboards; `None` where it has none, and for an engine that cannot move them.
    fn billboards(&self, _slab: u32) -> Option<&Slab<R>> {
        None
    }
}

impl<R: Real> GrassState<R> for super::cpu::Grass<R> {
    fn slab(&self, slab: u32) -> Option<&Slab<R>> {
        Self::slab(self, slab)
    }

    fn billboards(&self, slab: u32) -> Option<&Slab<R>> {
        Self::billboards(self).slab(slab)
    }
}

/// One plant of an active tile as it stands.
#[derive(Clone, Debug)]
pub struct Standing<R> {
    /// Number of the plant within its tile.
    pub place: u32,
    pub plant: Plant,
    /// World place of the anchor that `nodes` and `wind` are relative to.
    pub origin: [f64; 3],
    pub wind: Vec<Vec3<R>>,
    pub nodes: Vec<Vec3<R>>,
    /// Offsets of the movable nodes from the wind pose at the last contact.
    pub offsets: Vec<Vec3<R>>,
    /// Tick of the last contact, 0 for never.
    pub touched_at: u32,
}

impl<R: Real> Standing<R> {
    /// The same plant in `f64`.
    pub fn widened(self) -> Standing<f64> {
        let wide = |nodes: Vec<Vec3<R>>| nodes.iter().map(|n| Vec3::of(n.to_f64())).collect();
        Standing {
            place: self.place,
            plant: self.plant,
            origin: self.origin,
            wind: wide(self.wind),
            nodes: wide(self.nodes),
            offsets: wide(self.offsets),
            touched_at: self.touched_at,
        }
    }

    /// World x and z of the root.
    pub fn root_in_world(&self) -> [f64; 2] {
        let [x, _, z] = self.plant.root_in_anchor.map(f64::from);
        [self.origin[0] + x, self.origin[2] + z]
    }

    /// Angle between the vertical and the line from root to tip, in radians.
    pub fn lean_rad(&self) -> f64 {
        let (Some(first), Some(last)) = (self.nodes.first(), self.nodes.last()) else {
            return 0.0;
        };
        from_vertical_rad(*last - *first)
    }

    /// Mean distance of the movable nodes from the wind pose, in metres.
    pub fn offset_m(&self) -> f64 {
        mean_distance_m(&self.nodes, &self.wind, 1)
    }
}

/// Angle between a line and the vertical, in radians.
fn from_vertical_rad<R: Real>(line: Vec3<R>) -> f64 {
    let [x, y, z] = line.to_f64();
    libm::atan2(libm::sqrt(x * x + z * z), y)
}

/// Mean distance of nodes from others but for the first ones, which are pinned, in metres.
fn mean_distance_m<R: Real>(nodes: &[Vec3<R>], others: &[Vec3<R>], pinned: usize) -> f64 {
    let far = |(a, b): (&Vec3<R>, &Vec3<R>)| (*a - *b).length().to_f64();
    let sum: f64 = nodes.iter().zip(others).skip(pinned).map(far).sum();
    sum / nodes.len().saturating_sub(pinned).max(1) as f64
}

/// A plant as it stands; `None` where nothing grows.
fn stand<R: Real>(
    meadow: &Meadow,
    tile: &TileWork,
    slab: &Slab<R>,
    place: u32,
) -> Option<Standing<R>> {
    let field = &meadow.field;
    let segments = field.table.segments as usize;
    let fading = Fading::new(meadow);
    let plant = field.responding_plant(&tile.anchor, tile.tile, place)?;
    let (wind, nodes) = poses(field, &meadow.work, &fading, tile, &plant, slab, place);
    Some(Standing {
        place,
        plant,
        origin: field.grid.anchor_in_world(&tile.anchor, &field.ground),
        wind: wind[..=segments].to_vec(),
        nodes: nodes[..=segments].to_vec(),
        offsets: slab.offsets[place as usize * segments..][..segments].to_vec(),
        touched_at: slab.touched_at[place as usize],
    })
}

/// Every plant of an active tile as it stands, in the order of places.
pub fn standing<R: Real>(meadow: &Meadow, tile: &TileWork, slab: &Slab<R>) -> Vec<Standing<R>> {
    let plants = 0..meadow.field.grid.plants_per_tile();
    plants
        .filter_map(|place| stand(meadow, tile, slab, place))
        .collect()
}

/// Every plant of a tile as it stands, awake or not, in the order of places.
pub fn of_tile<R: Real>(
    meadow: &Meadow,
    state: &impl GrassState<R>,
    tile: TileId,
) -> Vec<Standing<R>> {
    let field = &meadow.field;
    let plants = 0..field.grid.plants_per_tile();
    let active = meadow.tiles.get(tile);
    let work = TileWork {
        tile,
        slab: active.map_or(0, |a| a.slab),
        anchor: field.grid.anchor_of(tile, &field.ground),
        contacts: 0..0,
    };
    match active.and_then(|a| state.slab(a.slab)) {
        Some(slab) => standing(meadow, &work, slab),
        None => {
            let segments = field.table.segments as usize;
            standing(meadow, &work, &Slab::new(plants.len(), segments))
        }
    }
}

/// Plants rooted near a place on the ground, resting ones included.
pub fn near<R: Real>(
    meadow: &Meadow,
    state: &impl GrassState<R>,
    place_m: [f64; 2],
    within_m: f64,
) -> Vec<Standing<R>> {
    let plants = tiles_near(meadow, place_m, within_m)
        .into_iter()
        .flat_map(|tile| of_tile(meadow, state, tile));
    let is_near = |plant: &Standing<R>| {
        let [x, z] = plant.root_in_world();
        (x - place_m[0]).powi(2) + (z - place_m[1]).powi(2) <= within_m * within_m
    };
    plants.filter(is_near).collect()
}

/// Tiles that have a part of a disc on the ground.
fn tiles_near(meadow: &Meadow, place_m: [f64; 2], within_m: f64) -> Vec<TileId> {
    let disc = Bounds {
        low: [place_m[0] - within_m, f64::MIN, place_m[1] - within_m],
        high: [place_m[0] + within_m, f64::MAX, place_m[1] + within_m],
    };
    let mut tiles = Vec::new();
    let (grid, ground) = (&meadow.field.grid, &meadow.field.ground);
    meadow
        .field
        .octree
        .query(grid, ground, &disc, 0.0, |tile| tiles.push(tile));
    tiles
}

/// Plants touched within the last `ticks` ticks whose last contact took a node at least `far_m`
/// from its wind pose, and of which body `body` has pushed a node. Billboards of a tile are counted on
/// from its plants.
pub fn bent<R: Real>(
    meadow: &Meadow,
    state: &impl GrassState<R>,
    body: u32,
    ticks: u32,
    far_m: f64,
) -> BTreeSet<(TileId, u32)> {
    let is_bent = |slab: &Slab<R>, place: usize, nodes: usize| {
        let at = slab.touched_at[place];
        let nodes = place * nodes..(place + 1) * nodes;
        at != 0
            && meadow.ticks - at < ticks
            && slab.offsets[nodes.clone()]
                .iter()
                .any(|d| d.length().to_f64() >= far_m)
            && slab.faces[nodes]
                .iter()
                .any(|&face| body_of(face) == Some(body))
    };
    let plants = meadow.field.grid.plants_per_tile();
    let segments = meadow.field.table.segments as usize;
    let movable = meadow.weave.as_ref().map_or(0, |w| w.grid.movable());
    let mut found = BTreeSet::new();
    for tile in &meadow.work.tiles {
        let layers = [
            (state.slab(tile.slab), segments, 0),
            (state.billboards(tile.slab), movable, plants),
        ];
        for (slab, nodes, first) in layers {
            let Some(slab) = slab else {
                continue;
            };
            let bent = (0..slab.touched_at.len()).filter(|&place| is_bent(slab, place, nodes));
            found.extend(bent.map(|place| (tile.tile, first + place as u32)));
        }
    }
    found
}
