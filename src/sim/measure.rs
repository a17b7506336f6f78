//! What is measured of a simulated meadow: penetration, strain, lean, offset.
//!
//! Everything is computed in `f64` from the state that an engine hands out, against the bodies'
//! true shapes, whatever the engine itself collided with.

use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::base::{Real, Vec3, most};
use crate::field::grid::ground_in_anchor;
use crate::field::{Bounds, Plant, TileId};

use super::contact::body_of;
use super::cpu::{poses, segment_length};
use super::meadow::Meadow;
use super::recover::Fading;
use super::relax::largest_strain;
use super::slab::Slab;
pub use super::true_bodies::Depth;
use super::true_bodies::{ON_GROUND_M, TrueBodies};
use super::work::TileWork;

/// Where the grass's state can be read.
pub trait GrassState<R: Real> {
    /// The slab of an active tile.
    fn slab(&self, slab: u32) -> Option<&Slab<R>>;
}

impl<R: Real> GrassState<R> for super::cpu::Grass<R> {
    fn slab(&self, slab: u32) -> Option<&Slab<R>> {
        Self::slab(self, slab)
    }
}

/// Metrics of one instant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Depths of the nodes inside a true shape, of plants within a body's reach, in metres; nodes pinched
    /// between body and ground not counted.
    pub depths_m: Vec<f64>,
    /// The same for the middles of segments of plants that a body pushed or held in this sub-step, where
    /// neither end is inside.
    pub middle_depths_m: Vec<f64>,
    /// The deepest of them relative to what its collider promises.
    pub worst: Depth,
    /// Movable nodes of plants pushed or held in this sub-step.
    pub pushed_nodes: u64,
    /// Largest depth of a node of any other plant within a body's reach, in metres: of one that the
    /// collider did not notice.
    pub missed_m: f64,
    /// Nodes that lie on the ground inside a body.
    pub pinched: u64,
    /// Plants whose root a body stands on or covers.
    pub buried: u64,
    /// Largest gap between a plant pushed in this sub-step and the body, in metres: how far its
    /// nearest node was pushed past the surface, with the body where it came closest. A body that
    /// is gone by the end of the sub-step has not pushed the plant as far as it went.
    pub over_push_m: f64,
    pub max_strain: f64,
    pub max_offset_m: f64,
    /// Plants with a value that is not finite.
    pub not_finite: u64,
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
        let [x, y, z] = (*last - *first).to_f64();
        libm::atan2(libm::sqrt(x * x + z * z), y)
    }

    /// Mean distance of the movable nodes from the wind pose, in metres.
    pub fn offset_m(&self) -> f64 {
        let far = |(a, b): (&Vec3<R>, &Vec3<R>)| (*a - *b).length().to_f64();
        let sum: f64 = self.nodes.iter().zip(&self.wind).skip(1).map(far).sum();
        sum / (self.nodes.len().max(2) - 1) as f64
    }
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

/// Measures every active tile.
pub fn snapshot<R: Real>(meadow: &Meadow, state: &(impl GrassState<R> + Sync)) -> Snapshot {
    let tiles = &meadow.work.tiles;
    let parts: Vec<Snapshot> = tiles
        .par_iter()
        .filter_map(|tile| Some(measured(meadow, tile, state.slab(tile.slab)?)))
        .collect();
    parts
        .into_iter()
        .fold(Snapshot::default(), Snapshot::joined)
}

fn measured<R: Real>(meadow: &Meadow, tile: &TileWork, slab: &Slab<R>) -> Snapshot {
    let mut snapshot = Snapshot::default();
    let bodies = TrueBodies::near(meadow, tile);
    for place in 0..meadow.field.grid.plants_per_tile() {
        let is_touched = slab.touched_at[place as usize] != 0;
        if !is_touched && !may_be_reached(meadow, tile, &bodies, place) {
            continue;
        }
        if let Some(plant) = stand(meadow, tile, slab, place) {
            snapshot.add_plant(meadow, tile, &bodies, &plant);
        }
    }
    snapshot
}

/// Whether a body may reach the plant at a place.
fn may_be_reached(meadow: &Meadow, tile: &TileWork, bodies: &TrueBodies, place: u32) -> bool {
    let plant = || {
        meadow
            .field
            .responding_plant(&tile.anchor, tile.tile, place)
    };
    let is_near = |plant: Plant| {
        let root = Vec3::of_f32(plant.root_in_anchor);
        bodies.may_reach(root, f64::from(plant.height_m))
    };
    !tile.contacts.is_empty() && plant().is_some_and(is_near)
}

impl Snapshot {
    fn joined(mut self, other: Self) -> Self {
        self.depths_m.extend(other.depths_m);
        self.middle_depths_m.extend(other.middle_depths_m);
        self.worst = self.worst.worse(other.worst);
        self.pushed_nodes += other.pushed_nodes;
        self.missed_m = most(self.missed_m, other.missed_m);
        self.pinched += other.pinched;
        self.buried += other.buried;
        self.over_push_m = self.over_push_m.max(other.over_push_m);
        self.max_strain = self.max_strain.max(other.max_strain);
        self.max_offset_m = self.max_offset_m.max(other.max_offset_m);
        self.not_finite += other.not_finite;
        self
    }

    fn add_plant<R: Real>(
        &mut self,
        meadow: &Meadow,
        tile: &TileWork,
        bodies: &TrueBodies,
        plant: &Standing<R>,
    ) {
        if !plant.nodes.iter().all(|node| node.is_finite()) {
            self.not_finite += 1;
            return;
        }
        let segments = plant.nodes.len() - 1;
        let mut nodes = [Vec3::ZERO; crate::field::MAX_NODES];
        nodes[..=segments].copy_from_slice(&plant.nodes);
        let length: R = segment_length(&plant.plant, segments);
        let strain = largest_strain(&nodes, segments, length).to_f64();
        self.max_strain = most(self.max_strain, strain);
        for (node, wind) in plant.nodes.iter().zip(&plant.wind).skip(1) {
            self.max_offset_m = most(self.max_offset_m, (*node - *wind).length().to_f64());
        }
        self.add_contact(meadow, tile, bodies, plant);
    }

    /// What a plant is to the bodies near its tile, by their true shapes.
    fn add_contact<R: Real>(
        &mut self,
        meadow: &Meadow,
        tile: &TileWork,
        bodies: &TrueBodies,
        plant: &Standing<R>,
    ) {
        let nodes = plant.nodes.iter().map(|node| Vec3::of(node.to_f64()));
        let nodes: Vec<Vec3<f64>> = nodes.collect();
        let excess = |p: Vec3<f64>, found| {
            let ground = ground_in_anchor(&meadow.field.ground, &tile.anchor, p.x, p.z);
            (bodies.beyond_pinch(p, found, ground), ground)
        };
        if plant.touched_at == meadow.work.now {
            self.add_pushed(bodies, &nodes, excess);
        } else if bodies.may_reach(nodes[0], f64::from(plant.plant.height_m)) {
            for &p in &nodes[1..] {
                let found = bodies.deepest(p).filter(|found| found.depth_m > 0.0);
                let beyond = found.map(|found| excess(p, found).0);
                if let Some(beyond) = beyond.filter(|beyond| beyond.depth_m > 0.0) {
                    self.add_depth(beyond);
                    self.missed_m = most(self.missed_m, beyond.depth_m);
                }
            }
        }
    }

    fn add_depth(&mut self, beyond: Depth) {
        self.depths_m.push(beyond.depth_m);
        self.worst = self.worst.worse(beyond);
    }

    /// Depths of a plant that was pushed or is held. `excess` tells what a depth at a place is without
    /// what body and ground share, and the ground's height there.
    fn add_pushed(
        &mut self,
        bodies: &TrueBodies,
        nodes: &[Vec3<f64>],
        excess: impl Fn(Vec3<f64>, Depth) -> (Depth, f64),
    ) {
        let is_covered = |found: Depth| found.depth_m >= -ON_GROUND_M;
        self.buried += u64::from(bodies.deepest(nodes[0]).is_some_and(is_covered));
        self.pushed_nodes += nodes.len() as u64 - 1;
        let mut below_inside = false;
        for (&from, &p) in nodes.iter().zip(&nodes[1..]) {
            let Some(found) = bodies.deepest(p) else {
                return;
            };
            let (beyond, ground) = excess(p, found);
            let is_inside = found.depth_m > 0.0;
            self.pinched += u64::from(is_inside && p.y <= ground + ON_GROUND_M);
            if beyond.depth_m > 0.0 {
                self.add_depth(beyond);
            }
            if !is_inside && !below_inside {
                let middle = (from + p) * 0.5;
                let found = bodies.deepest(middle).filter(|found| found.depth_m > 0.0);
                let depth_m = found.map(|found| excess(middle, found).0.depth_m);
                self.middle_depths_m
                    .extend(depth_m.filter(|&depth_m| depth_m > 0.0));
            }
            below_inside = is_inside;
        }
        let gap_m = bodies.least_gap_m(&nodes[1..], self.over_push_m);
        self.over_push_m = most(self.over_push_m, gap_m);
    }
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
    let field = &meadow.field;
    let disc = Bounds {
        low: [place_m[0] - within_m, f64::MIN, place_m[1] - within_m],
        high: [place_m[0] + within_m, f64::MAX, place_m[1] + within_m],
    };
    let mut tiles = Vec::new();
    let (grid, ground) = (&field.grid, &field.ground);
    field
        .octree
        .query(grid, ground, &disc, 0.0, |tile| tiles.push(tile));
    let plants = tiles
        .into_iter()
        .flat_map(|tile| of_tile(meadow, state, tile));
    let is_near = |plant: &Standing<R>| {
        let [x, z] = plant.root_in_world();
        (x - place_m[0]).powi(2) + (z - place_m[1]).powi(2) <= within_m * within_m
    };
    plants.filter(is_near).collect()
}

/// Plants touched within the last `ticks` ticks whose last contact took a node at least `far_m`
/// from its wind pose, and of which body `body` has pushed a node.
pub fn bent<R: Real>(
    meadow: &Meadow,
    state: &impl GrassState<R>,
    body: u32,
    ticks: u32,
    far_m: f64,
) -> BTreeSet<(TileId, u32)> {
    let mut found = BTreeSet::new();
    for tile in &meadow.work.tiles {
        let Some(slab) = state.slab(tile.slab) else {
            continue;
        };
        for place in 0..meadow.field.grid.plants_per_tile() {
            let at = slab.touched_at[place as usize];
            if at == 0 || meadow.ticks - at >= ticks {
                continue;
            }
            let segments = meadow.field.table.segments as usize;
            let offsets = &slab.offsets[place as usize * segments..][..segments];
            let faces = &slab.faces[place as usize * segments..][..segments];
            let far = offsets.iter().any(|d| d.length().to_f64() >= far_m);
            if far && faces.iter().any(|&face| body_of(face) == Some(body)) {
                found.insert((tile.tile, place));
            }
        }
    }
    found
}
