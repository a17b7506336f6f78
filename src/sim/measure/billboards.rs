//! Billboards as they stand.

use crate::base::{Real, Vec3, most};
use crate::field::Billboard;
use crate::sim::billboard::recover::Poses;
use crate::sim::billboard::{Quad, Weave};
use crate::sim::cpu::tile_of;
use crate::sim::meadow::Meadow;
use crate::sim::slab::Slab;
use crate::sim::work::TileWork;

use super::{GrassState, from_vertical_rad, mean_distance_m, tiles_near};

/// One billboard of a tile as it stands.
#[derive(Clone, Debug)]
pub struct StandingBillboard<R> {
    /// Number of the billboard within its tile.
    pub place: u32,
    pub billboard: Billboard,
    /// World place of the anchor that `nodes` and `wind` are relative to.
    pub origin: [f64; 3],
    /// Nodes of a row; the lowest row comes first, and is pinned.
    pub columns: usize,
    pub wind: Vec<Vec3<R>>,
    pub nodes: Vec<Vec3<R>>,
    /// What is drawn of it while nothing has touched it: lower left and right, upper left and right.
    pub quad: [Vec3<R>; 4],
    /// Tick of the last contact, 0 for never.
    pub touched_at: u32,
}

impl<R: Real> StandingBillboard<R> {
    /// The same billboard in `f64`.
    pub fn widened(self) -> StandingBillboard<f64> {
        let wide = |node: Vec3<R>| Vec3::of(node.to_f64());
        StandingBillboard {
            place: self.place,
            billboard: self.billboard,
            origin: self.origin,
            columns: self.columns,
            wind: self.wind.into_iter().map(wide).collect(),
            nodes: self.nodes.into_iter().map(wide).collect(),
            quad: self.quad.map(wide),
            touched_at: self.touched_at,
        }
    }

    /// World x and z of the middle of the lower edge.
    pub fn root_in_world(&self) -> [f64; 2] {
        let [x, _, z] = self.billboard.root_in_anchor.map(f64::from);
        [self.origin[0] + x, self.origin[2] + z]
    }

    /// Nodes of a column from the ground up.
    pub fn column(&self, column: usize) -> impl Iterator<Item = Vec3<R>> {
        self.nodes
            .iter()
            .copied()
            .skip(column)
            .step_by(self.columns)
    }

    /// Nodes at the corners: lower left and right, upper left and right.
    pub fn corners(&self) -> [Vec3<R>; 4] {
        let last = self.nodes.len() - 1;
        [0, self.columns - 1, last + 1 - self.columns, last].map(|node| self.nodes[node])
    }

    /// Angle between the vertical and the line from the middle of the lower edge to that of the upper one,
    /// in radians.
    pub fn lean_rad(&self) -> f64 {
        let [lower_left, lower_right, upper_left, upper_right] = self.corners();
        from_vertical_rad(upper_left + upper_right - lower_left - lower_right)
    }

    /// Mean distance of the movable nodes from the wind pose, in metres.
    pub fn offset_m(&self) -> f64 {
        mean_distance_m(&self.nodes, &self.wind, self.columns)
    }

    /// Largest relative change of a structural or shear spring's length.
    pub fn strain(&self, weave: &Weave) -> f64 {
        let springs = weave.springs.iter().filter(|spring| !spring.side.is_bend());
        let mut largest = 0.0;
        for [a, b] in springs.map(|spring| spring.ends) {
            let length = |nodes: &[Vec3<R>]| (nodes[b] - nodes[a]).length().to_f64();
            let rest = length(&self.wind);
            if rest > 0.0 {
                largest = most(largest, (length(&self.nodes) / rest - 1.0).abs());
            }
        }
        largest
    }
}

/// Every billboard of an active tile as it stands, in the order of places.
pub fn standing_billboards<R: Real>(
    meadow: &Meadow,
    tile: &TileWork,
    slab: &Slab<R>,
) -> Vec<StandingBillboard<R>> {
    let Some(weave) = &meadow.weave else {
        return Vec::new();
    };
    let billboards = meadow.field.billboards_in(tile.tile);
    let of_tile = tile_of(meadow, weave, tile, billboards, &[]);
    let origin = meadow
        .field
        .grid
        .anchor_in_world(&tile.anchor, &meadow.field.ground);
    let mut found = Vec::with_capacity(billboards.len());
    of_tile.poses(slab, &mut Poses::new(weave), |place, lane, poses| {
        let quad = Quad::in_wind(&billboards[place], &tile.anchor, &meadow.work.wind);
        let mut wind = Vec::with_capacity(weave.grid.nodes());
        quad.nodes(weave.grid, |_, node| wind.push(node));
        found.push(StandingBillboard {
            place: place as u32,
            billboard: billboards[place],
            origin,
            columns: weave.grid.columns,
            wind,
            nodes: (0..weave.grid.nodes())
                .map(|node| poses.nodes.get(node, lane))
                .collect(),
            quad: quad.vertices(),
            touched_at: slab.touched_at[place],
        });
    });
    found
}

/// Billboards rooted near a place on the ground, resting ones included.
pub fn billboards_near<R: Real>(
    meadow: &Meadow,
    state: &impl GrassState<R>,
    place_m: [f64; 2],
    within_m: f64,
) -> Vec<StandingBillboard<R>> {
    let Some(weave) = &meadow.weave else {
        return Vec::new();
    };
    let field = &meadow.field;
    let tiles = tiles_near(meadow, place_m, within_m).into_iter();
    let billboards = tiles.flat_map(|tile| {
        let active = meadow.tiles.get(tile);
        let work = TileWork {
            tile,
            slab: active.map_or(0, |active| active.slab),
            anchor: field.grid.anchor_of(tile, &field.ground),
            contacts: 0..0,
        };
        match active.and_then(|active| state.billboards(active.slab)) {
            Some(slab) => standing_billboards(meadow, &work, slab),
            None => {
                let count = field.billboards_on(tile) as usize;
                standing_billboards(meadow, &work, &Slab::new(count, weave.grid.movable()))
            }
        }
    });
    let is_near = |billboard: &StandingBillboard<R>| {
        let [x, z] = billboard.root_in_world();
        (x - place_m[0]).powi(2) + (z - place_m[1]).powi(2) <= within_m * within_m
    };
    billboards.filter(is_near).collect()
}
