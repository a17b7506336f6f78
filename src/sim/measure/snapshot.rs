//! The metrics of one instant.

use rayon::prelude::*;

use crate::base::{Real, Vec3, most};
use crate::field::Plant;
use crate::field::grid::ground_in_anchor;
use crate::sim::cpu::segment_length;
use crate::sim::meadow::Meadow;
use crate::sim::relax::largest_strain;
use crate::sim::slab::Slab;
use crate::sim::true_bodies::{Depth, ON_GROUND_M, TrueBodies};
use crate::sim::work::TileWork;

use super::{GrassState, Standing, StandingBillboard, stand, standing_billboards};

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

/// Measures every active tile.
pub fn snapshot<R: Real>(meadow: &Meadow, state: &(impl GrassState<R> + Sync)) -> Snapshot {
    let tiles = &meadow.work.tiles;
    let of_tile = |tile: &TileWork| {
        let mut snapshot = measured(meadow, tile, state.slab(tile.slab)?);
        if let Some(slab) = state.billboards(tile.slab) {
            snapshot.add_billboards(meadow, tile, slab);
        }
        Some(snapshot)
    };
    let parts: Vec<Snapshot> = tiles.par_iter().filter_map(of_tile).collect();
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

    fn add_billboards<R: Real>(&mut self, meadow: &Meadow, tile: &TileWork, slab: &Slab<R>) {
        let bodies = TrueBodies::near(meadow, tile);
        for billboard in standing_billboards(meadow, tile, slab) {
            let at_rest = &billboard.billboard;
            let near = || bodies.may_reach(at_rest.root(), at_rest.reach_m());
            if billboard.touched_at != 0 || near() {
                self.add_billboard(meadow, tile, &bodies, &billboard);
            }
        }
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
        self.add_offsets(&plant.nodes, &plant.wind);
        let grown = Grown {
            touched_at: plant.touched_at,
            root: Vec3::of_f32(plant.plant.root_in_anchor),
            reach_m: f64::from(plant.plant.height_m),
            lines: vec![wide(plant.nodes.iter().copied())],
        };
        self.add_contact(meadow, tile, bodies, &grown);
    }

    fn add_billboard<R: Real>(
        &mut self,
        meadow: &Meadow,
        tile: &TileWork,
        bodies: &TrueBodies,
        billboard: &StandingBillboard<R>,
    ) {
        if !billboard.nodes.iter().all(|node| node.is_finite()) {
            self.not_finite += 1;
            return;
        }
        if let Some(weave) = &meadow.weave {
            self.max_strain = most(self.max_strain, billboard.strain(weave));
        }
        self.add_offsets(&billboard.nodes, &billboard.wind);
        let grown = Grown {
            touched_at: billboard.touched_at,
            root: billboard.billboard.root(),
            reach_m: billboard.billboard.reach_m(),
            lines: (0..billboard.columns)
                .map(|column| wide(billboard.column(column)))
                .collect(),
        };
        self.add_contact(meadow, tile, bodies, &grown);
    }

    fn add_offsets<R: Real>(&mut self, nodes: &[Vec3<R>], wind: &[Vec3<R>]) {
        for (node, wind) in nodes.iter().zip(wind) {
            self.max_offset_m = most(self.max_offset_m, (*node - *wind).length().to_f64());
        }
    }

    /// What a plant is to the bodies near its tile, by their true shapes.
    fn add_contact(
        &mut self,
        meadow: &Meadow,
        tile: &TileWork,
        bodies: &TrueBodies,
        grown: &Grown,
    ) {
        let excess = |p: Vec3<f64>, found| {
            let ground = ground_in_anchor(&meadow.field.ground, &tile.anchor, p.x, p.z);
            (bodies.beyond_pinch(p, found, ground), ground)
        };
        if grown.touched_at == meadow.work.now {
            self.add_pushed(bodies, grown, excess);
        } else if bodies.may_reach(grown.root, grown.reach_m) {
            for &p in grown.movable() {
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
        grown: &Grown,
        excess: impl Fn(Vec3<f64>, Depth) -> (Depth, f64),
    ) {
        let is_covered = |found: Depth| found.depth_m >= -ON_GROUND_M;
        let mut pinned = grown.lines.iter().map(|line| line[0]);
        let is_buried = pinned.any(|p| bodies.deepest(p).is_some_and(is_covered));
        self.buried += u64::from(is_buried);
        self.pushed_nodes += grown.movable().count() as u64;
        for line in &grown.lines {
            self.add_pushed_line(bodies, line, &excess);
        }
        let movable: Vec<Vec3<f64>> = grown.movable().copied().collect();
        let gap_m = bodies.least_gap_m(&movable, self.over_push_m);
        // Without a body there is no gap to speak of.
        if gap_m.is_finite() {
            self.over_push_m = most(self.over_push_m, gap_m);
        }
    }

    fn add_pushed_line(
        &mut self,
        bodies: &TrueBodies,
        line: &[Vec3<f64>],
        excess: &impl Fn(Vec3<f64>, Depth) -> (Depth, f64),
    ) {
        let mut below_inside = false;
        for (&from, &p) in line.iter().zip(&line[1..]) {
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
    }
}

/// Whatever grows, as bodies meet it: lines of nodes, the first of each on the ground.
struct Grown {
    touched_at: u32,
    root: Vec3<f64>,
    reach_m: f64,
    lines: Vec<Vec<Vec3<f64>>>,
}

impl Grown {
    fn movable(&self) -> impl Iterator<Item = &Vec3<f64>> {
        self.lines.iter().flat_map(|line| &line[1..])
    }
}

fn wide<R: Real>(nodes: impl Iterator<Item = Vec3<R>>) -> Vec<Vec3<f64>> {
    nodes.map(|node| Vec3::of(node.to_f64())).collect()
}
