//! What is measured of a simulated meadow: penetration, strain, lean, offset.
//!
//! Everything is computed in `f64` from the state that an engine hands out, against the bodies'
//! true shapes, whatever the engine itself collided with.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use crate::base::{Real, Vec3};
use crate::field::grid::ground_in_anchor;
use crate::field::{Bounds, Plant, TileId};

use super::contact::body_of;
use super::cpu::{poses, segment_length};
use super::meadow::Meadow;
use super::relax::largest_strain;
use super::slab::Slab;
use super::work::TileWork;

/// A node this close to the ground lies on it, in metres: on a slope the last segment is laid down by
/// the height at its end before it is turned.
const ON_GROUND_M: f64 = 1e-3;

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
    /// Depths of the nodes inside a true shape that were pushed in this sub-step, in metres; nodes
    /// pinched between body and ground not counted.
    pub depths_m: Vec<f64>,
    /// The deepest of them relative to what its collider promises.
    pub worst: Depth,
    /// Movable nodes of plants pushed in this sub-step.
    pub pushed_nodes: u64,
    /// Nodes that lie on the ground inside a body.
    pub pinched: u64,
    /// Largest gap between a plant pushed in this sub-step and the body, in metres: how far its
    /// nearest node was pushed past the surface.
    pub over_push_m: f64,
    pub max_strain: f64,
    pub max_offset_m: f64,
    /// Plants with a value that is not finite.
    pub not_finite: u64,
}

/// A depth and what its collider promises: one texel of a depth cube, 1 mm for a closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    pub depth_m: f64,
    pub limit_m: f64,
}

impl Default for Depth {
    fn default() -> Self {
        Self {
            depth_m: 0.0,
            limit_m: ANALYTIC_LIMIT_M,
        }
    }
}

/// Depth an analytic collider may leave, in metres.
const ANALYTIC_LIMIT_M: f64 = 1e-3;

/// One plant of an active tile as it stands.
#[derive(Clone, Debug)]
pub struct Standing<R> {
    pub plant: Plant,
    /// World place of the anchor that `nodes` and `wind` are relative to.
    pub origin: [f64; 3],
    pub wind: Vec<Vec3<R>>,
    pub nodes: Vec<Vec3<R>>,
    /// Tick of the last contact, 0 for never.
    pub touched_at: u32,
}

impl<R: Real> Standing<R> {
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
    let step_over_t = R::of(meadow.step_over_t());
    let plant = field.plant(&tile.anchor, tile.tile, place)?;
    let (wind, nodes) = poses(field, &meadow.work, step_over_t, tile, &plant, slab, place);
    Some(Standing {
        plant,
        origin: field.grid.anchor_in_world(&tile.anchor, &field.ground),
        wind: wind[..=segments].to_vec(),
        nodes: nodes[..=segments].to_vec(),
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
        .filter_map(|tile| Some(of_tile(meadow, tile, state.slab(tile.slab)?)))
        .collect();
    parts
        .into_iter()
        .fold(Snapshot::default(), Snapshot::joined)
}

fn of_tile<R: Real>(meadow: &Meadow, tile: &TileWork, slab: &Slab<R>) -> Snapshot {
    let mut snapshot = Snapshot::default();
    for place in 0..meadow.field.grid.plants_per_tile() {
        if slab.touched_at[place as usize] == 0 {
            continue;
        }
        if let Some(plant) = stand(meadow, tile, slab, place) {
            snapshot.add_plant(meadow, tile, &plant);
        }
    }
    snapshot
}

impl Snapshot {
    fn joined(mut self, other: Self) -> Self {
        self.depths_m.extend(other.depths_m);
        self.worst = self.worst.worse(other.worst);
        self.pushed_nodes += other.pushed_nodes;
        self.pinched += other.pinched;
        self.over_push_m = self.over_push_m.max(other.over_push_m);
        self.max_strain = self.max_strain.max(other.max_strain);
        self.max_offset_m = self.max_offset_m.max(other.max_offset_m);
        self.not_finite += other.not_finite;
        self
    }

    fn add_plant<R: Real>(&mut self, meadow: &Meadow, tile: &TileWork, plant: &Standing<R>) {
        if !plant.nodes.iter().all(|node| node.is_finite()) {
            self.not_finite += 1;
            return;
        }
        let segments = plant.nodes.len() - 1;
        let mut nodes = [Vec3::ZERO; crate::field::MAX_NODES];
        nodes[..=segments].copy_from_slice(&plant.nodes);
        let length: R = segment_length(&plant.plant, segments);
        let strain = largest_strain(&nodes, segments, length).to_f64();
        self.max_strain = self.max_strain.max(strain);
        for (node, wind) in plant.nodes.iter().zip(&plant.wind).skip(1) {
            self.max_offset_m = self.max_offset_m.max((*node - *wind).length().to_f64());
        }
        if plant.touched_at == meadow.work.now {
            self.add_pushed(meadow, tile, plant);
        }
    }

    /// Depth of a pushed plant's nodes in the parts near its tile, by their true shapes.
    fn add_pushed<R: Real>(&mut self, meadow: &Meadow, tile: &TileWork, plant: &Standing<R>) {
        let mut nearest = f64::NEG_INFINITY;
        for node in &plant.nodes[1..] {
            let p = Vec3::<f64>::of(node.to_f64());
            self.pushed_nodes += 1;
            let deepest = deepest_in(meadow, tile, p);
            let Some(found) = deepest else {
                continue;
            };
            nearest = nearest.max(found.depth_m);
            if found.depth_m <= 0.0 {
                continue;
            }
            let ground: f64 = ground_in_anchor(&meadow.field.ground, &tile.anchor, p.x, p.z);
            let mut excess = found.depth_m;
            if p.y <= ground + ON_GROUND_M {
                // A pinch: the ground wins, so what the body and the ground share there is no fault,
                // nor is the height by which the node lies above it.
                let on_ground = Vec3::new(p.x, ground, p.z);
                let shared = deepest_in(meadow, tile, on_ground).map_or(0.0, |d| d.depth_m);
                excess -= shared.max(0.0) + (p.y - ground).max(0.0);
                self.pinched += 1;
            }
            if excess > 0.0 {
                let found = Depth {
                    depth_m: excess,
                    ..found
                };
                self.depths_m.push(found.depth_m);
                self.worst = self.worst.worse(found);
            }
        }
        if nearest.is_finite() {
            self.over_push_m = self.over_push_m.max(-nearest);
        }
    }
}

impl Depth {
    fn worse(self, other: Self) -> Self {
        if other.depth_m / other.limit_m > self.depth_m / self.limit_m {
            other
        } else {
            self
        }
    }
}

/// The part a point is deepest in among those near a tile, by true shapes; a negative depth is
/// how far off the nearest one is.
fn deepest_in(meadow: &Meadow, tile: &TileWork, p: Vec3<f64>) -> Option<Depth> {
    let contacts = &meadow.work.contacts[tile.contacts.start as usize..tile.contacts.end as usize];
    let depths = contacts.iter().map(|contact| {
        let part = &meadow.parts.parts[contact.part as usize];
        Depth {
            depth_m: part.solid.depth(contact.to.inverse_point(p)),
            limit_m: if contact.uses_cube {
                part.texel_m(meadow.scene.solver.cube_resolution)
            } else {
                ANALYTIC_LIMIT_M
            },
        }
    });
    depths.reduce(|a, b| if b.depth_m > a.depth_m { b } else { a })
}

/// Plants rooted near a place on the ground, resting ones included.
pub fn near<R: Real>(
    meadow: &Meadow,
    state: &impl GrassState<R>,
    place_m: [f64; 2],
    within_m: f64,
) -> Vec<Standing<R>> {
    let field = &meadow.field;
    let segments = field.table.segments as usize;
    let untouched = Slab::new(field.grid.plants_per_tile() as usize, segments);
    let disc = Bounds {
        low: [place_m[0] - within_m, f64::MIN, place_m[1] - within_m],
        high: [place_m[0] + within_m, f64::MAX, place_m[1] + within_m],
    };
    let mut tiles = Vec::new();
    let (grid, ground) = (&field.grid, &field.ground);
    field
        .octree
        .query(grid, ground, &disc, 0.0, |tile| tiles.push(tile));
    let mut found = Vec::new();
    for tile in tiles {
        let active = meadow.tiles.get(tile);
        let slab = active
            .and_then(|a| state.slab(a.slab))
            .unwrap_or(&untouched);
        let work = TileWork {
            tile,
            slab: active.map_or(0, |a| a.slab),
            anchor: grid.anchor_of(tile, ground),
            contacts: 0..0,
        };
        let plants = 0..grid.plants_per_tile();
        let plants = plants.filter_map(|place| stand(meadow, &work, slab, place));
        found.extend(plants.filter(|plant| {
            let [x, z] = plant.root_in_world();
            (x - place_m[0]).powi(2) + (z - place_m[1]).powi(2) <= within_m * within_m
        }));
    }
    found
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

/// A hash of the whole grass state (FNV-1a over ids, ticks and the bits of offsets), the same for
/// any number of threads and any slabs.
pub fn state_hash<R: Real>(meadow: &Meadow, state: &impl GrassState<R>) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut eat = |word: u64| {
        for byte in word.to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    eat(u64::from(meadow.ticks));
    let tiles: BTreeMap<TileId, &TileWork> =
        meadow.work.tiles.iter().map(|t| (t.tile, t)).collect();
    for (id, tile) in tiles {
        let Some(slab) = state.slab(tile.slab) else {
            continue;
        };
        eat(u64::from(id));
        for &tick in &slab.touched_at {
            eat(u64::from(tick));
        }
        for offset in &slab.offsets {
            for x in offset.to_f64() {
                eat(x.to_bits());
            }
        }
    }
    hash
}
