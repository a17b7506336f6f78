//! What a scene promises: each line is measured and has a limit.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One expectation. Places are x and z on the ground, in metres. What is said of plants holds for
/// billboards too.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub enum Expectation {
    /// The mean lean of the plants rooted near a place, from root to tip against the vertical; of a
    /// billboard, from the middle of its lower edge to that of its upper one.
    Lean {
        /// When, in simulated seconds.
        at_s: f64,
        /// World x and z of the middle of the circle in which plants are rooted.
        near_m: [f64; 2],
        /// Radius of that circle, in metres.
        within_m: f64,
        /// Degrees; this limit or `at_most_deg` is needed.
        #[serde(default)]
        at_least_deg: Option<f64>,
        /// Degrees.
        #[serde(default)]
        at_most_deg: Option<f64>,
    },
    /// The mean distance of the plants' vertices near a place from their wind pose.
    Offset {
        /// When, in simulated seconds.
        at_s: f64,
        /// World x and z of the middle of the circle in which plants are rooted.
        near_m: [f64; 2],
        /// Radius of that circle, in metres.
        within_m: f64,
        /// Metres; this limit or `at_most_m` is needed.
        #[serde(default)]
        at_least_m: Option<f64>,
        /// Metres.
        #[serde(default)]
        at_most_m: Option<f64>,
    },
    /// At the end of no frame is a movable vertex deeper inside a body's true shape.
    Penetration {
        /// Metres. Without it, each collider's own promise: one texel of its depth cube, or 1 mm for
        /// an analytic one.
        #[serde(default)]
        at_most_m: Option<f64>,
    },
    /// No segment is ever longer or shorter by more than this share of its length; of a billboard, no side
    /// or diagonal of a cell of its nodes.
    Strain {
        /// Share of the segment's length.
        at_most: f64,
    },
    /// Every tile rests at this time and after it.
    AllRest {
        /// Simulated seconds.
        by_s: f64,
    },
    /// The largest number of tiles that were active at once.
    ActiveTiles {
        /// This limit or `at_most` is needed.
        #[serde(default)]
        at_least: Option<u64>,
        /// This limit or `at_least` is needed.
        #[serde(default)]
        at_most: Option<u64>,
    },
    /// The largest number of plants simulated at once.
    SimulatedPlants {
        /// This limit or `at_most` is needed.
        #[serde(default)]
        at_least: Option<u64>,
        /// This limit or `at_least` is needed.
        #[serde(default)]
        at_most: Option<u64>,
    },
    /// The largest number of bytes of grass state.
    StateBytes {
        /// Bytes.
        at_most: u64,
    },
    /// Where a body is.
    BodyNear {
        /// Name of the body.
        body: String,
        /// When, in simulated seconds.
        at_s: f64,
        /// Place in the world where its origin should be.
        position_m: [f64; 3],
        /// How far from there it may be, in metres.
        within_m: f64,
    },
    /// Share of the plants rooted under the path a body has swept that are bent by it, over those
    /// swept or bent (intersection over union of the two sets of plants).
    Imprint {
        /// Name of the body.
        body: String,
        /// When, in simulated seconds.
        at_s: f64,
        /// Overlap, 0 to 1.
        at_least: f64,
    },
    /// The hash of bodies and grass over all ticks; cpu engine only.
    StateHash {
        /// The hexadecimal digits that a run prints.
        is: String,
    },
}
