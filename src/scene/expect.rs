//! What a scene promises: each line is measured and has a limit.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One expectation. Places are x and z on the ground, in metres.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub enum Expectation {
    /// The mean lean of the plants rooted near a place, from root to tip against the vertical.
    Lean {
        at_s: f64,
        near_m: [f64; 2],
        within_m: f64,
        #[serde(default)]
        at_least_deg: Option<f64>,
        #[serde(default)]
        at_most_deg: Option<f64>,
    },
    /// The mean distance of the plants' vertices near a place from their wind pose.
    Offset {
        at_s: f64,
        near_m: [f64; 2],
        within_m: f64,
        #[serde(default)]
        at_least_m: Option<f64>,
        #[serde(default)]
        at_most_m: Option<f64>,
    },
    /// No movable vertex is ever deeper inside a body's true shape. Without a limit: one texel for
    /// a depth cube, 1 mm for an analytic collider.
    Penetration {
        #[serde(default)]
        at_most_m: Option<f64>,
    },
    /// No segment is ever longer or shorter by more than this share of its length.
    Strain { at_most: f64 },
    /// Every tile rests at this time and after it.
    AllRest { by_s: f64 },
    /// The largest number of tiles that were active at once.
    ActiveTiles {
        #[serde(default)]
        at_least: Option<u64>,
        #[serde(default)]
        at_most: Option<u64>,
    },
    /// The largest number of plants simulated at once.
    SimulatedPlants {
        #[serde(default)]
        at_least: Option<u64>,
        #[serde(default)]
        at_most: Option<u64>,
    },
    /// The largest number of bytes of grass state.
    StateBytes { at_most: u64 },
    /// Where a body is.
    BodyNear {
        body: String,
        at_s: f64,
        position_m: [f64; 3],
        within_m: f64,
    },
    /// Share of the plants rooted under the path a body has swept that are bent by it, over those
    /// swept or bent (intersection over union of the two sets of plants).
    Imprint {
        body: String,
        at_s: f64,
        at_least: f64,
    },
    /// The hash of bodies and grass over all ticks; cpu engine only.
    StateHash { is: String },
}
