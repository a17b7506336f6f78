//! Wind over the whole scene.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::limits;

/// A steady wind with gusts that travel along it. Strengths are bends: the horizontal pull on a
/// blade's tip segment relative to its own upright direction, without unit. 0 is calm, 0.3 a
/// breeze, 1 bends a tip by about 45°.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wind {
    /// Where the wind blows to, in degrees from +x towards +z.
    #[schemars(range(min = limits::ANGLE.min, max = limits::ANGLE.max))]
    pub direction_deg: f32,
    /// Steady bend.
    #[schemars(range(min = limits::WIND_BEND.min, max = limits::WIND_BEND.max))]
    pub strength: f32,
    /// Bend added and taken away by gusts.
    #[schemars(range(min = limits::WIND_BEND.min, max = limits::WIND_BEND.max))]
    pub gust: f32,
    /// Length of a gust along the wind, in metres.
    #[schemars(range(min = limits::GUST_LENGTH.min, max = limits::GUST_LENGTH.max))]
    pub gust_length_m: f32,
    /// Speed of the gusts over the ground, in metres per second.
    #[schemars(range(min = limits::GUST_SPEED.min, max = limits::GUST_SPEED.max))]
    pub gust_speed_m_per_s: f32,
    /// Bend of each plant's own quick trembling.
    #[schemars(range(min = limits::WIND_BEND.min, max = limits::WIND_BEND.max))]
    pub flutter: f32,
}

impl Default for Wind {
    fn default() -> Self {
        Self {
            direction_deg: 20.0,
            strength: 0.08,
            gust: 0.12,
            gust_length_m: 6.0,
            gust_speed_m_per_s: 3.0,
            flutter: 0.02,
        }
    }
}
