//! The second layer of the cpu engine: billboards, in slabs of their own, tile by tile.

use std::sync::Arc;

use rayon::prelude::*;

use crate::base::Real;
use crate::field::Billboard;
use crate::sim::billboard::recover::Poses;
use crate::sim::billboard::relax::Settings;
use crate::sim::billboard::tile::{Responded, Tile, Touched};
use crate::sim::billboard::{Batch, Weave};
use crate::sim::contact::Touch;
use crate::sim::meadow::Meadow;
use crate::sim::recover::Fading;
use crate::sim::slab::Slab;
use crate::sim::solid::Solid;
use crate::sim::work::TileWork;

use super::blades::touches_of;

/// How far a node may be from its root over the reach of its billboard, while springs and bodies pull.
const STRETCHED: f64 = 2.0;
/// What the roundings of `f32` may take from a height below 16 m, a hundred times over, in metres.
const HEIGHT_MARGIN_M: f64 = 1e-4;

/// State of the billboards in active tiles.
#[derive(Debug, Default)]
pub struct BillboardLayer<R: Real> {
    /// By the tile's slab number; `None` while no tile has it, and for a tile without billboards.
    slabs: Vec<Option<Arc<Slab<R>>>>,
    /// Those found touched by the last collide pass, per tile of the work.
    touched: Vec<Vec<Touched>>,
}

/// A tile whose touched billboards respond, with its slab taken out of the pool meanwhile.
type Job<'a, R> = (&'a TileWork, &'a mut Vec<Touched>, Arc<Slab<R>>);

impl<R: Real> BillboardLayer<R> {
    /// As [`Grass::assign_slabs`](super::Grass::assign_slabs).
    pub fn assign_slabs(&mut self, meadow: &Meadow) {
        let (Some(weave), Some(field)) = (&meadow.weave, &meadow.field.billboards) else {
            return;
        };
        for &(_, slab) in &meadow.changes.rested {
            self.slabs[slab as usize] = None;
        }
        self.slabs
            .resize_with(meadow.tiles.slabs.high_water() as usize, || None);
        for &(tile, slab) in &meadow.changes.woken {
            let count = field.in_tile(tile).len();
            let state = (count > 0).then(|| Arc::new(Slab::new(count, weave.grid.movable())));
            self.slabs[slab as usize] = state;
        }
    }

    /// Finds the billboards that a body touches. `grown` are the parts' solids with their skin.
    pub fn collide(&mut self, meadow: &Meadow, grown: &[Solid<R>]) {
        let Some(weave) = &meadow.weave else {
            return;
        };
        let tiles = &meadow.work.tiles;
        self.touched.clear();
        self.touched.resize_with(tiles.len(), Vec::new);
        let slabs = &self.slabs;
        self.touched
            .par_iter_mut()
            .zip(tiles)
            .filter(|(_, tile)| !tile.contacts.is_empty())
            .for_each_init(
                || Poses::new(weave),
                |poses, (touched, tile)| {
                    if let Some(slab) = &slabs[tile.slab as usize] {
                        let billboards = meadow.field.billboards_in(tile.tile);
                        let touches = touches_of(meadow, grown, tile);
                        tile_of(meadow, weave, tile, billboards, &touches)
                            .touched(slab, poses, touched);
                    }
                },
            );
    }

    /// Pushes the touched billboards out, restores their shape and stores their offsets. Returns how many
    /// they were and the most rounds of one.
    pub fn relax(&mut self, meadow: &Meadow, grown: &[Solid<R>]) -> (u64, u32) {
        let Some(weave) = &meadow.weave else {
            return (0, 0);
        };
        let settings = Settings::new(&meadow.scene.solver);
        let slabs = &mut self.slabs;
        let mut jobs: Vec<Job<R>> = meadow
            .work
            .tiles
            .iter()
            .zip(&mut self.touched)
            .filter(|(_, touched)| !touched.is_empty())
            .filter_map(|(tile, touched)| Some((tile, touched, slabs[tile.slab as usize].take()?)))
            .collect();
        let done: Vec<Responded> = jobs
            .par_iter_mut()
            .map_init(
                || Poses::new(weave),
                |poses, (tile, touched, slab)| {
                    let billboards = meadow.field.billboards_in(tile.tile);
                    let touches = touches_of(meadow, grown, tile);
                    let of_tile = tile_of(meadow, weave, tile, billboards, &touches);
                    let mut batch = Batch::new(weave);
                    let slab = Arc::make_mut(slab);
                    of_tile.respond(touched, slab, (&mut batch, poses), &settings)
                },
            )
            .collect();
        for (tile, _, slab) in jobs {
            slabs[tile.slab as usize] = Some(slab);
        }
        let touched = done.iter().map(|done| done.touched).sum();
        (touched, done.iter().map(|d| d.rounds).max().unwrap_or(0))
    }

    /// Every slab by its number.
    pub(in crate::sim) fn slabs(&self) -> &[Option<Arc<Slab<R>>>] {
        &self.slabs
    }

    pub(super) fn slabs_mut(&mut self) -> &mut [Option<Arc<Slab<R>>>] {
        &mut self.slabs
    }

    pub(in crate::sim) fn set_slabs(&mut self, slabs: Vec<Option<Arc<Slab<R>>>>) {
        self.slabs = slabs;
    }

    /// The state of a slab in use by a tile that has billboards.
    pub fn slab(&self, slab: u32) -> Option<&Slab<R>> {
        self.slabs.get(slab as usize)?.as_deref()
    }

    /// Bytes of all slabs.
    pub fn bytes(&self) -> u64 {
        self.slabs.iter().flatten().map(|slab| slab.bytes()).sum()
    }
}

/// What the billboards of a tile meet in the meadow's sub-step.
pub fn tile_of<'a, R: Real>(
    meadow: &'a Meadow,
    weave: &'a Weave,
    tile: &'a TileWork,
    billboards: &'a [Billboard],
    touches: &'a [Touch<'a, R>],
) -> Tile<'a, R> {
    Tile {
        weave,
        billboards,
        anchor: &tile.anchor,
        ground: &meadow.field.ground,
        ground_top_m: R::of(ground_top_m(meadow, tile)),
        touches,
        wind: &meadow.work.wind,
        wind_before: &meadow.work.wind_before,
        now: meadow.work.now,
        fading: Fading::new(meadow),
    }
}

/// Nothing of the ground that a tile's billboards may come over is higher, in metres over the anchor's
/// origin.
fn ground_top_m(meadow: &Meadow, tile: &TileWork) -> f64 {
    let (field, ground) = (&meadow.field, &meadow.field.ground);
    let reach_m = STRETCHED * field.farthest_m();
    let [low, high] = field.grid.tile_bounds(tile.tile, ground);
    let top_m = ground.highest_in_world(low.map(|x| x - reach_m), high.map(|x| x + reach_m));
    f64::from(top_m) - f64::from(tile.anchor.base_y) + HEIGHT_MARGIN_M
}
