//! Which tiles' plants a frame draws, and how finely.
//!
//! Per frame the processor lists the tiles in sight, near to far, and nothing per plant. Tiles of
//! one band of distance have the same detail: the same number of drawn segments, a subset of the
//! simulated nodes. How many plants of a tile are drawn falls smoothly with its distance; they are
//! a prefix of the tile's sequence, and their width makes up for those left out.

use crate::base::Vec3;
use crate::field::TileId;
use crate::gpu::field_data::TileRecord;
use crate::gpu_struct;

use super::camera::{Frustum, View};
use super::error::RenderError;
use super::plant_form::DETAILS;
use super::plants::BladesInput;

/// How far and how finely blades are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BladeDetail {
    /// Distance up to which every plant is drawn, in metres.
    pub full_m: f32,
    /// Distance at which the last blades end and the ground takes over their look, in metres.
    pub reach_m: f32,
    /// Blades drawn per plant near by, at least 1: the simulated one and companions that move
    /// with it.
    pub tuft: u32,
}

impl Default for BladeDetail {
    fn default() -> Self {
        Self {
            full_m: 12.0,
            reach_m: 110.0,
            tuft: 4,
        }
    }
}

impl BladeDetail {
    /// For a rasteriser on the processor, which pays about 1 µs per triangle.
    pub fn software() -> Self {
        Self {
            full_m: 4.0,
            reach_m: 50.0,
            tuft: 3,
        }
    }

    /// # Errors
    /// Distances that are not finite and positive, an empty tuft.
    pub(super) fn check(self) -> Result<(), RenderError> {
        let lengths = [self.full_m, self.reach_m];
        if lengths.iter().all(|m| m.is_finite() && *m > 0.0) && self.tuft > 0 {
            return Ok(());
        }
        Err(RenderError::BadInput {
            what: "the detail of the blades",
            found: format!("{self:?}"),
            wanted: "give distances above 0 and at least one blade per plant",
        })
    }

    /// Share of a tile's blades that is drawn at a distance: all of them near by, then falling
    /// so that every ring of equal width holds fewer blades than the one before it.
    fn share(self, distance_m: f64) -> f64 {
        (f64::from(self.full_m) / distance_m.max(1e-3))
            .powf(1.4)
            .min(1.0)
    }
}

gpu_struct! {
    pub(super) struct DrawnTile {
        tile: TileRecord,
        anchor_from_eye: [f32; 3],
        pub(super) blades: f32,
        widen: f32,
        pub(super) detail: u32,
        spare: [u32; 2],
    }
}

/// Distance of a band's end over that of its start.
const BAND_RATIO: f64 = std::f64::consts::SQRT_2;
/// Active tiles are drawn as finely as others at this share of their distance, so that imprints
/// stay readable.
const ACTIVE_NEARNESS: f64 = 0.4;
/// Share of the lost cover that the remaining blades make up for by their width; the ground's
/// own look supplies the rest.
const WIDEN_POWER: f64 = 0.75;

/// A tile in sight.
#[derive(Clone, Copy, Debug)]
struct Sight {
    tile: TileId,
    /// From the eye; less for an active tile.
    distance_m: f64,
    band: u32,
}

/// Tiles in sight, near to far. The work follows the tiles within reach, not the meadow.
fn tiles_in_sight(input: &BladesInput<'_>, view: &View, aspect: f32) -> Vec<Sight> {
    let field = input.field;
    let frustum = view.frustum(aspect);
    // A tile's box may be nearer than the closest corner of its ground.
    let margin_m = 3.0 * field.grid.tile_m() + 2.0 * field.reach_m;
    let reach_m = input.detail.reach_m + margin_m;
    let mut seen: Vec<Sight> = field
        .tiles_in_view(&view.viewpoint(aspect, 1), reach_m)
        .into_iter()
        .filter_map(|tile| sight_of(input, view, &frustum, tile))
        .collect();
    seen.sort_by(|a, b| {
        a.distance_m
            .total_cmp(&b.distance_m)
            .then(a.tile.cmp(&b.tile))
    });
    seen
}

/// How a tile is seen, if it is in view and within reach.
fn sight_of(
    input: &BladesInput<'_>,
    view: &View,
    frustum: &Frustum,
    tile: TileId,
) -> Option<Sight> {
    let field = input.field;
    let tall = f64::from(field.reach_m);
    let [low, high] = field.grid.tile_bounds(tile, &field.ground);
    let heights = field.grid.tile_heights(tile, &field.ground).map(f64::from);
    // A blade may lean over its tile's border, and hang below a slope.
    let low = [low[0] - tall, heights[0] - 0.5 * tall, low[1] - tall];
    let high = [high[0] + tall, heights[1] + tall, high[1] + tall];
    let eye = view.eye_in_world.to_f64();
    let nearest = [0, 1, 2].map(|a| eye[a].clamp(low[a], high[a]) - eye[a]);
    let mut distance_m = Vec3::<f64>::of(nearest).length();
    if distance_m >= f64::from(input.detail.reach_m) || !frustum.may_see(low, high) {
        return None;
    }
    if slab_of(input, tile).is_some() {
        distance_m *= ACTIVE_NEARNESS;
    }
    Some(Sight {
        tile,
        distance_m,
        band: band_at(input.detail, distance_m),
    })
}

/// Tiles in sight as the device gets them, near to far.
pub(super) fn drawn_tiles(input: &BladesInput<'_>, view: &View, aspect: f32) -> Vec<DrawnTile> {
    let seen = tiles_in_sight(input, view, aspect);
    seen.iter()
        .map(|sight| drawn_tile(input, view, sight))
        .collect()
}

/// Bands start at half the distance of full density; band 0 lies before that.
fn band_at(detail: BladeDetail, distance_m: f64) -> u32 {
    let relative = distance_m / (0.5 * f64::from(detail.full_m));
    if relative <= 1.0 {
        0
    } else {
        (relative.ln() / BAND_RATIO.ln()).floor() as u32 + 1
    }
}

/// Detail of a band's plants, 0 the finest: each of the following is good for two bands.
fn detail_of(band: u32) -> u32 {
    band.div_ceil(2).min(DETAILS - 1)
}

fn slab_of(input: &BladesInput<'_>, tile: TileId) -> Option<u32> {
    let found = input.active.binary_search_by_key(&tile, |&(id, _)| id);
    found.ok().map(|index| input.active[index].1)
}

fn blades_per_tile(input: &BladesInput<'_>) -> f64 {
    f64::from(input.field.grid.plants_per_tile()) * f64::from(input.detail.tuft.max(1))
}

fn drawn_tile(input: &BladesInput<'_>, view: &View, sight: &Sight) -> DrawnTile {
    let (field, grid) = (input.field, &input.field.grid);
    let mut record = TileRecord::resting(field, sight.tile);
    if let Some(slab) = slab_of(input, sight.tile) {
        record.slab = slab;
    }
    let anchor = grid.anchor_of(sight.tile, &field.ground);
    let origin = Vec3::of(grid.anchor_in_world(&anchor, &field.ground));
    let share = input.detail.share(sight.distance_m);
    DrawnTile {
        tile: record,
        anchor_from_eye: view.from_eye(origin),
        blades: (blades_per_tile(input) * share) as f32,
        widen: share.powf(-WIDEN_POWER) as f32,
        detail: detail_of(sight.band),
        spare: [0; 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn detail_falls_with_distance() {
        let detail = BladeDetail::default();
        assert_eq!(detail_of(band_at(detail, 0.0)), 0);
        let at = |metres: f64| detail_of(band_at(detail, metres));
        assert!((0..500).all(|step| at(f64::from(step)) <= at(f64::from(step + 1))));
        assert_eq!(at(0.49 * 12.0), 0);
        assert_eq!(at(0.51 * 12.0), 1);
        assert_eq!(at(1e6), DETAILS - 1);
    }
}
