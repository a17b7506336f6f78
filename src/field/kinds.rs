//! Which kind of plant grows on a ground: P15 section 3.3, eq. 16 and 18.
//!
//! The base map's colour at a place, as HSV, is compared with the reference colour of every kind
//! and of every bare ground; of the two with the best scores one is chosen by chance, in proportion
//! to the scores. Everything is done in integers, from texels to the choice, so that every engine
//! chooses alike: scores are kept as logarithms, which makes eq. 16 a product.
//!
//! Deviations: distances are floored (equal colours would have an infinite score) and hue wraps
//! around; the chance is s₁/(s₀ + s₁); a score is multiplied by its kind's share.
//!
//! Limits: places to 2⁻¹⁶ texel, colours between texels to 2⁻⁸ of a byte's step, logarithms of
//! scores to 2⁻¹². WGSL twin: `shaders/shared/kinds.wgsl`, bit for bit.

use std::sync::Arc;

use crate::base::fixed::{exp2_minus_q15, log2_q12};
use crate::scene::{Grass, Likes};
use crate::terrain::{BetweenTexels, ColourMap};

use super::grid::FieldGrid;
use super::on_map::OnMap;

/// Most kinds and bare grounds together.
pub const MAX_TASTES: usize = crate::scene::limits::SPECIES + crate::scene::limits::BARE_GROUNDS;
/// Hues of a full turn: 2¹⁴ for each of the six edges of the colour hexagon.
pub const HUE_TURN: u32 = 6 << 14;
/// Least squared distance of colours, in units of 2⁻²⁴: a distance of 2⁻⁷, two steps of a byte. Scenes
/// whose weights stay below it are refused: [`limits::LEAST_DISTANCE`](crate::scene::limits::LEAST_DISTANCE).
pub const LEAST_SQUARED: u32 = 1 << 10;
/// A threshold that every score passes.
const NO_THRESHOLD: i32 = i32::MIN;

/// A liking for a ground, in the units of the scores.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Taste {
    /// Hue in [`HUE_TURN`]ths of a turn; saturation and value, 0…65536.
    pub hsv: [u32; 3],
    /// In units of 2⁻¹².
    pub weights: [u32; 3],
    /// In units of 2⁻⁸.
    pub exponent: u32,
    /// log₂ of the share and of the threshold, in units of 2⁻¹².
    pub share_log: i32,
    pub threshold_log: i32,
}

/// What grows at a place.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Choice {
    /// `None` on bare ground.
    pub kind: Option<u32>,
    /// s′ of eq. 18 in units of 2⁻¹⁶: how much of the ground is this kind's, 0…65536.
    pub thrives: u32,
}

/// The likings of a meadow's kinds and the map they are about.
#[derive(Clone, Debug, PartialEq)]
pub struct Kinds {
    /// The kinds', in the order of their list, then those of bare grounds.
    pub tastes: Vec<Taste>,
    /// How many of the tastes are kinds'.
    pub kinds: usize,
    pub map: Arc<ColourMap>,
    pub on_map: OnMap,
}

impl Kinds {
    /// `None` for a grass whose kinds do not look at the ground.
    pub fn new(grass: &Grass, grid: &FieldGrid, map: Arc<ColourMap>) -> Option<Self> {
        if !grass.grows_by_colour() {
            return None;
        }
        let of_kinds = grass
            .species
            .iter()
            .map(|kind| taste(&kind.likes.clone().unwrap_or_default(), kind.share));
        let of_bare = grass.bare.iter().map(|likes| taste(likes, 1.0));
        Some(Self {
            tastes: of_kinds.chain(of_bare).collect(),
            kinds: grass.species.len(),
            on_map: OnMap::new(grid, map.texel_m),
            map,
        })
    }

    /// What grows at a place of the map, given a random word.
    pub fn choose(&self, place: [u32; 2], word: u32) -> Choice {
        let hsv = hsv_of(self.colour(place));
        // The two best, best first; of equals the first in the list.
        let mut best = [(i32::MIN, usize::MAX); 2];
        for (i, taste) in self.tastes.iter().enumerate() {
            let Some(score) = taste.score_log(hsv) else {
                continue;
            };
            if score > best[0].0 {
                best = [(score, i), best[0]];
            } else if score > best[1].0 {
                best[1] = (score, i);
            }
        }
        let second = match best {
            [_, (_, usize::MAX)] => 0,
            [(first, _), (second, _)] => chance_of_second(first.abs_diff(second)),
        };
        let (taste, thrives) = if word >> 16 < second {
            (best[1].1, second)
        } else {
            (best[0].1, 65_536 - second)
        };
        Choice {
            kind: (taste < self.kinds).then_some(taste as u32),
            thrives,
        }
    }

    /// The map's colour at a place, mixed between texels, in units of 2⁻⁸ of a byte's step.
    fn colour(&self, place: [u32; 2]) -> [u32; 3] {
        let between = BetweenTexels::at(place, [self.map.columns, self.map.rows]);
        [0, 1, 2].map(|c| between.mix(|texel| self.map.rgba8[4 * texel + c].into()) >> 8)
    }
}

impl Taste {
    /// log₂ of the score of a colour times the share, in units of 2⁻¹²; `None` below the threshold.
    pub fn score_log(&self, hsv: [u32; 3]) -> Option<i32> {
        let hue = hsv[0].abs_diff(self.hsv[0]);
        // Differences in units of 2⁻¹² of a turn and of the full range.
        let differences = [
            hue.min(HUE_TURN - hue) / 24,
            hsv[1].abs_diff(self.hsv[1]) >> 4,
            hsv[2].abs_diff(self.hsv[2]) >> 4,
        ];
        let squared: u32 = differences
            .iter()
            .zip(&self.weights)
            .map(|(difference, weight)| ((difference * weight) >> 12).pow(2))
            .sum();
        // The square root is the half in 2⁻⁹ instead of 2⁻⁸.
        let distance_log = log2_q12(squared.max(LEAST_SQUARED)) - (24 << 12);
        let score = -((self.exponent as i32 * distance_log) >> 9);
        (score >= self.threshold_log).then_some(score + self.share_log)
    }
}

/// s₁/(s₀ + s₁) in units of 2⁻¹⁶, at most a half, from log₂ s₀ − log₂ s₁ in units of 2⁻¹².
fn chance_of_second(log_ahead: u32) -> u32 {
    let ratio = exp2_minus_q15(log_ahead);
    (ratio << 16) / (32_768 + ratio)
}

/// Hue in [`HUE_TURN`]ths of a turn, saturation and value in 0…65536, of a colour in units of 2⁻⁸ of a byte's step.
pub fn hsv_of([r, g, b]: [u32; 3]) -> [u32; 3] {
    let most = r.max(g).max(b);
    let spread = most - r.min(g).min(b);
    if spread == 0 {
        return [0, 0, most + (most >> 8)];
    }
    let edge = |from: u32, to: u32| (from as i32 - to as i32) * (1 << 14) / spread as i32;
    let hue = if most == r {
        edge(g, b)
    } else if most == g {
        (2 << 14) + edge(b, r)
    } else {
        (4 << 14) + edge(r, g)
    };
    let hue = if hue < 0 { hue + HUE_TURN as i32 } else { hue };
    [hue as u32, (spread << 16) / most, most + (most >> 8)]
}

/// A scene's liking in the units of the scores. The scene's ranges keep every number within them.
fn taste(likes: &Likes, share: f32) -> Taste {
    let log = |x: f32| (libm::log2(f64::from(x)) * 4096.0).round() as i32;
    let [h, s, v] = likes.hsv.map(f64::from);
    let hue = (h / 360.0 * f64::from(HUE_TURN)).round() as u32 % HUE_TURN;
    Taste {
        hsv: [
            hue,
            (s * 65_536.0).round() as u32,
            (v * 65_535.0).round() as u32,
        ],
        weights: likes
            .weights
            .map(|w| (f64::from(w) * 4096.0).round() as u32),
        exponent: (f64::from(likes.exponent) * 256.0).round() as u32,
        share_log: log(share),
        threshold_log: if likes.threshold > 0.0 {
            log(likes.threshold)
        } else {
            NO_THRESHOLD
        },
    }
}

#[cfg(test)]
mod tests;
