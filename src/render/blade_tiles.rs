//! Which tiles' plants a frame draws, and how finely.
//!
//! Per frame the processor lists the tiles in sight, near to far, and nothing per plant. Tiles of
//! one band of distance have the same detail: the same number of drawn segments, a subset of the
//! simulated nodes. How many plants of a tile are drawn falls smoothly with its distance; they are
//! a prefix of the tile's sequence, and their width makes up for those left out.

use crate::base::Vec3;
use crate::field::TileId;
use crate::field::count::Bins;
use crate::gpu::Gpu;
use crate::gpu::field_data::TileRecord;
use crate::gpu_struct;

use super::camera::{Frustum, View};
use super::error::RenderError;
use super::plant_form::DETAILS;
use super::plants::BladesInput;

/// What decides how many of a triangle's plants are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Count {
    /// All of them up to [`BladeDetail::full_m`], then fewer with distance, whatever the slope.
    Distance,
    /// P15 eq. 1: so many per pixel of the triangle's projected area.
    ProjectedArea { per_px: f32 },
    /// P15 eq. 2: the same from its area in the world and its distance.
    WorldArea { per_px: f32 },
}

/// How the plants of a triangle are submitted to the device: P15 section 3.2.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Submission {
    /// Every triangle gets the count that its rule says; prefix sums over the triangles place it.
    #[default]
    Exact,
    /// Every triangle gets the count of the nearest of 32 bins in geometric progression, eq. 15.
    Bins,
}

/// What happens where the camera's distance changes how many plants are drawn, and how finely.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Transition {
    /// The last plants of a triangle's prefix are small, and nodes that the next detail lacks move to
    /// its straight segments before it comes.
    #[default]
    Smooth,
    /// Plants and segments come and go at once, as in P15.
    Plain,
}

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
    pub count: Count,
    /// Factor of every count and of its ceiling: above 1, blades get more companions; below 1, the last
    /// plants of every triangle's sequence are left out. Those that stay do not move.
    pub density: f32,
    pub submission: Submission,
    pub transition: Transition,
    /// Whether plants within twice `full_m` cast shadows on the ground, where
    /// they leave some of it open: P15 section 3.6.
    pub shadows: bool,
    /// The place from which distances decide what is drawn, where that is not the view's eye: what the
    /// camera's way changes can then be told from its motion. Counts by area stay the view's.
    pub judged_from: Option<Vec3<f64>>,
    /// Leave out tiles of billboards that the ground hides as a whole, which changes no picture.
    pub drops_hidden: bool,
}

impl Default for BladeDetail {
    fn default() -> Self {
        Self {
            full_m: 12.0,
            reach_m: 110.0,
            tuft: 4,
            count: Count::Distance,
            density: 1.0,
            submission: Submission::Exact,
            transition: Transition::Smooth,
            shadows: true,
            judged_from: None,
            drops_hidden: true,
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
            ..Self::default()
        }
    }

    /// What an adapter can draw in a moment.
    pub fn of_device(gpu: &Gpu) -> Self {
        if gpu.adapter.is_software {
            Self::software()
        } else {
            Self::default()
        }
    }

    /// # Errors
    /// Distances that are not finite and positive, an empty tuft.
    pub(super) fn check(self) -> Result<(), RenderError> {
        let lengths = [self.full_m, self.reach_m, self.density];
        let per_px = match self.count {
            Count::Distance => 1.0,
            Count::ProjectedArea { per_px } | Count::WorldArea { per_px } => per_px,
        };
        let is_positive = |number: &f32| number.is_finite() && *number > 0.0;
        if lengths.iter().all(is_positive) && is_positive(&per_px) && self.tuft > 0 {
            return Ok(());
        }
        Err(RenderError::BadInput {
            what: "the detail of the blades",
            found: format!("{self:?}"),
            wanted: "give distances and a density above 0 and at least one blade per plant",
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
        pub(super) tile: TileRecord,
        anchor_from_eye: [f32; 3],
        bound: f32,
        pub(super) detail: u32,
        pub(super) most_places: u32,
        morph: f32,
        spare: u32,
    }
}

/// Part of a detail's range, in doublings of the distance, over which it turns into the next.
const MORPH_DOUBLINGS: f64 = 0.5;
/// Share of the lost cover that the remaining blades make up for by their width; the ground's
/// own look supplies the rest.
pub(super) const WIDEN_POWER: f32 = 0.75;

/// Columns and rows of a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    pub(super) columns: u32,
    pub(super) rows: u32,
}

impl Size {
    pub(super) fn aspect(self) -> f32 {
        self.columns as f32 / self.rows as f32
    }
}

/// A tile in sight.
#[derive(Clone, Copy, Debug)]
struct Sight {
    tile: TileId,
    /// From the eye.
    distance_m: f64,
    level: f64,
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
    let eye = input.detail.judged_from.unwrap_or(view.eye_in_world);
    let eye = eye.to_f64();
    let nearest = [0, 1, 2].map(|a| eye[a].clamp(low[a], high[a]) - eye[a]);
    let distance_m = Vec3::<f64>::of(nearest).length();
    if distance_m >= f64::from(input.detail.reach_m) || !frustum.may_see(low, high) {
        return None;
    }
    Some(Sight {
        tile,
        distance_m,
        level: level_at(input.detail, distance_m),
    })
}

/// Tiles in sight as the device gets them, near to far.
pub(super) fn drawn_tiles(input: &BladesInput<'_>, view: &View, picture: Size) -> Vec<DrawnTile> {
    let seen = tiles_in_sight(input, view, picture.aspect());
    seen.iter()
        .map(|sight| drawn_tile(input, view, picture, sight))
        .collect()
}

/// Doublings of the distance from that of full density; below 0 before that.
fn level_at(detail: BladeDetail, distance_m: f64) -> f64 {
    let relative = distance_m / f64::from(detail.full_m);
    libm::log2(relative.max(1e-3))
}

/// Detail of the plants at a level, 0 the finest: each of the following is good for a doubling.
///
/// Deviation from P15 eq. 4, n = n_max (d_ref/d)² of every root: segments halve with every doubling of a
/// tile's distance, n_max (d_ref/d), since a blade's height on the picture falls by as much and its segments
/// keep their length there; a quarter would leave blades of five segments with one at twice the distance,
/// where one of 0.4 m is still 14 of 720 pixels tall. Coarse details take every second or fourth node of the simulated
/// ones, so that the pose needs no second formula; n_max is the scene's `segments` therefore.
fn detail_of(level: f64) -> u32 {
    (level.max(0.0).ceil() as u32).min(DETAILS - 1)
}

/// How far the plants at a level are on their way to the next coarser detail, 0 to 1.
fn morph_of(detail: BladeDetail, level: f64) -> f32 {
    let own = detail_of(level);
    if detail.transition == Transition::Plain || own == DETAILS - 1 {
        return 0.0;
    }
    let left = f64::from(own) - level;
    (1.0 - left / MORPH_DOUBLINGS).clamp(0.0, 1.0) as f32
}

fn slab_of(input: &BladesInput<'_>, tile: TileId) -> Option<u32> {
    let found = input.active.binary_search_by_key(&tile, |&(id, _)| id);
    found.ok().map(|index| input.active[index].1)
}

/// Plants of a seeding triangle and their companions: n_max of eq. 1.
pub(super) fn most_on_triangle(input: &BladesInput<'_>) -> f64 {
    let plants = f64::from(input.field.grid.plants_per_triangle());
    plants * f64::from(input.detail.tuft.max(1)) * f64::from(input.detail.density)
}

/// A number that no triangle of a tile's count exceeds.
fn count_bound(input: &BladesInput<'_>, view: &View, picture: Size, sight: &Sight) -> f64 {
    let most = most_on_triangle(input);
    let per_px = match input.detail.count {
        Count::Distance => return input.detail.share(sight.distance_m) * most,
        Count::ProjectedArea { per_px } | Count::WorldArea { per_px } => {
            f64::from(per_px) * f64::from(input.detail.density)
        }
    };
    let (field, grid) = (input.field, &input.field.grid);
    let cell_m = f64::from(grid.cell_m);
    let [low, high] = grid.tile_heights(sight.tile, &field.ground).map(f64::from);
    let slope = (high - low) / cell_m;
    let area_m2 = 0.5 * cell_m * cell_m * (1.0 + slope * slope).sqrt();
    let viewpoint = view.viewpoint(picture.aspect(), picture.rows);
    // Off the middle of the picture an angle covers more pixels.
    let off_middle = 1.0 + viewpoint.half_tan.iter().map(|t| t * t).sum::<f64>();
    let away_px = sight.distance_m * viewpoint.pixel_rad;
    let bound = per_px * area_m2 * off_middle.powf(1.5) / (away_px * away_px).max(1e-12);
    bound.min(most)
}

fn drawn_tile(input: &BladesInput<'_>, view: &View, picture: Size, sight: &Sight) -> DrawnTile {
    let (field, grid) = (input.field, &input.field.grid);
    let mut record = TileRecord::resting(field, sight.tile);
    if let Some(slab) = slab_of(input, sight.tile) {
        record.slab = slab;
    }
    let anchor = grid.anchor_of(sight.tile, &field.ground);
    let origin = Vec3::of(grid.anchor_in_world(&anchor, &field.ground));
    let bound = count_bound(input, view, picture, sight) as f32;
    let most = match input.detail.submission {
        Submission::Exact => bound,
        Submission::Bins => Bins::up_to(most_on_triangle(input) as f32).binned(bound),
    };
    DrawnTile {
        tile: record,
        anchor_from_eye: view.from_eye(origin),
        bound,
        detail: detail_of(sight.level),
        most_places: most.ceil() as u32 * grid.triangles_per_tile(),
        morph: morph_of(input.detail, sight.level),
        spare: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::plant_form::HALVING_STRIDES;

    #[test]
    fn detail_falls_with_distance() {
        let detail = BladeDetail::default();
        assert_eq!(detail_of(level_at(detail, 0.0)), 0);
        let at = |metres: f64| detail_of(level_at(detail, metres));
        assert!((0..500).all(|step| at(f64::from(step)) <= at(f64::from(step + 1))));
        assert_eq!(at(0.99 * 12.0), 0);
        assert_eq!(at(1.01 * 12.0), 1);
        assert_eq!(at(1e6), DETAILS - 1);
    }

    /// Segments at whole doublings of the distance, beside P15 eq. 4: the deviation that `detail_of` names.
    #[test]
    fn segments_halve_with_the_distance() {
        let detail = BladeDetail::default();
        for (doublings, segments, of_eq_4) in [(0, 8, 8.0), (1, 4, 2.0), (2, 2, 0.5)] {
            let relative = f64::from(1 << doublings);
            let distance_m = f64::from(detail.full_m) * relative;
            let own = detail_of(level_at(detail, distance_m));
            assert_eq!(8 / HALVING_STRIDES[own as usize], segments);
            assert_eq!(8.0 / (relative * relative), of_eq_4);
            assert_eq!(detail_of(level_at(detail, distance_m * 1.001)), own + 1);
        }
        assert_eq!(detail_of(level_at(detail, 0.1)), 0);
    }

    /// A detail ends as its next, and begins as itself.
    #[test]
    fn details_turn_into_each_other() {
        let detail = BladeDetail::default();
        for end in 0..DETAILS - 1 {
            let level = f64::from(end);
            assert_eq!(morph_of(detail, level), 1.0);
            assert!(morph_of(detail, level - 1e-3) > 0.99);
            assert_eq!(morph_of(detail, level + 1e-3), 0.0);
        }
        assert_eq!(morph_of(detail, 20.0), 0.0);
        let plain = BladeDetail {
            transition: Transition::Plain,
            ..detail
        };
        assert_eq!(morph_of(plain, 0.0), 0.0);
    }
}
