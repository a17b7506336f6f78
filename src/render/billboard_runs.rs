//! Which tiles' billboards a frame draws, in runs of consecutive tiles.

use std::ops::Range;

use crate::base::Vec3;
use crate::field::billboards::BillboardField;
use crate::field::{Field, Horizon, TileId};
use crate::gpu_struct;

use super::active_billboards::BillboardNodes;
use super::blade_tiles::Size;
use super::camera::View;

gpu_struct! {
    /// Twin of `BillboardTile` in the shader.
    pub(super) struct BillboardTile {
        anchor_from_eye: [f32; 3],
        first: u32,
        anchor: [u32; 2],
        nodes_at: u32,
        spare: u32,
    }
}

/// From where and how far billboards are seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight<'a> {
    pub(super) field: &'a Field,
    pub(super) billboards: &'a BillboardField,
    pub(super) view: &'a View,
    pub(super) picture: Size,
    /// How far off they are drawn, in metres.
    pub(super) reach_m: f32,
    /// How far the drawn ground may be from the true one, in pixels.
    pub(super) error_px: f32,
}

/// Consecutive tiles of one form, drawn at once.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) first: TileId,
    pub(super) places: Vec<BillboardTile>,
    /// Their billboards in the field's list.
    pub(super) billboards: Range<u32>,
    /// Whether the tiles are awake.
    pub(super) is_refined: bool,
    near_m: f64,
}

impl Sight<'_> {
    /// Tiles in view that have billboards, in the order of their ids.
    pub(super) fn tiles(&self) -> Vec<TileId> {
        let margin_m = 2.0 * self.field.grid.tile_m() + self.billboards.reach_m;
        let viewpoint = (self.view).viewpoint(self.picture.aspect(), self.picture.rows);
        let mut tiles = self
            .field
            .tiles_in_view(&viewpoint, self.reach_m + margin_m);
        tiles.retain(|&tile| !self.billboards.range(tile).is_empty());
        tiles.sort_unstable();
        tiles
    }

    /// Takes out the tiles whose billboards the ground hides as a whole.
    pub(super) fn drop_hidden(&self, tiles: &mut Vec<TileId>) {
        let Self { field, view, .. } = *self;
        let tall_m = field.farthest_m();
        let [wide, deep] = field.ground.size_m();
        let error_rad = f64::from(self.error_px * view.pixel_rad(self.picture.rows));
        let eye = view.eye_in_world;
        let mut horizon = Horizon::new(&field.ground, eye, wide.hypot(deep), error_rad);
        tiles.retain(|&tile| {
            let [low, high] = field.grid.tile_bounds(tile, &field.ground);
            let [lowest, highest] = field.grid.tile_heights(tile, &field.ground).map(f64::from);
            let low = [low[0] - tall_m, lowest - tall_m, low[1] - tall_m];
            let high = [high[0] + tall_m, highest + tall_m, high[1] + tall_m];
            !horizon.hides(low, high)
        });
    }

    /// Runs of tiles that are given in their order, near to far, so that what is hidden is not shaded.
    pub(super) fn runs(&self, tiles: &[TileId], active: Option<BillboardNodes<'_>>) -> Vec<Run> {
        let tiles: Vec<(TileId, Option<u32>)> = (tiles.iter())
            .map(|&tile| (tile, nodes_of(active, tile)))
            .collect();
        let in_one = |a: &(TileId, Option<u32>), b: &(TileId, Option<u32>)| {
            a.0 + 1 == b.0 && a.1.is_some() == b.1.is_some()
        };
        let mut runs: Vec<Run> = (tiles.chunk_by(in_one)).map(|run| self.run(run)).collect();
        runs.sort_by(|a, b| a.near_m.total_cmp(&b.near_m));
        runs
    }

    fn run(&self, tiles: &[(TileId, Option<u32>)]) -> Run {
        let places: Vec<BillboardTile> = (tiles.iter())
            .map(|&(tile, nodes_at)| self.place_of(tile, nodes_at))
            .collect();
        let ((first, nodes_at), (last, _)) = (tiles[0], tiles[tiles.len() - 1]);
        let ranges = &self.billboards.ranges;
        Run {
            first,
            near_m: nearest_m(&places),
            places,
            billboards: ranges[first as usize]..ranges[last as usize + 1],
            is_refined: nodes_at.is_some(),
        }
    }

    fn place_of(&self, tile: TileId, nodes_at: Option<u32>) -> BillboardTile {
        let field = self.field;
        let anchor = field.grid.anchor_of(tile, &field.ground);
        let origin = Vec3::of(field.grid.anchor_in_world(&anchor, &field.ground));
        BillboardTile {
            anchor_from_eye: self.view.from_eye(origin),
            first: self.billboards.ranges[tile as usize],
            anchor: anchor.index,
            nodes_at: nodes_at.unwrap_or(0),
            spare: 0,
        }
    }
}

/// Where the nodes of a tile that is awake begin.
fn nodes_of(active: Option<BillboardNodes<'_>>, tile: TileId) -> Option<u32> {
    let tiles = active?.tiles;
    let found = tiles.binary_search_by_key(&tile, |&(id, _)| id).ok()?;
    Some(tiles[found].1)
}

/// Distance of the nearest of some anchors from the eye.
fn nearest_m(places: &[BillboardTile]) -> f64 {
    let away = |place: &BillboardTile| Vec3::<f64>::of_f32(place.anchor_from_eye).length();
    places
        .iter()
        .map(away)
        .fold(f64::INFINITY, crate::base::least)
}
