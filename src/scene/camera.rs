//! Named views.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::limits;

/// A view that stays where it is, or keeps its offset to a body.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Unique in the scene; for `sward render --camera`.
    pub name: String,
    /// Place of the eye, in metres; relative to the followed body if there is one.
    #[schemars(inner(range(min = limits::PLACE.min, max = limits::PLACE.max)))]
    pub eye_m: [f64; 3],
    /// Point looked at; relative to the followed body if there is one.
    #[schemars(inner(range(min = limits::PLACE.min, max = limits::PLACE.max)))]
    pub target_m: [f64; 3],
    /// Vertical field of view, in degrees.
    #[serde(default = "default_fov")]
    #[schemars(range(min = limits::FIELD_OF_VIEW.min, max = limits::FIELD_OF_VIEW.max))]
    pub fov_deg: f32,
    /// Name of a body to follow (its place, not its turning).
    #[serde(default)]
    pub follow: Option<String>,
}

impl Camera {
    /// One that stays at `eye_m` and looks at `target_m`.
    pub fn at(name: &str, eye_m: [f64; 3], target_m: [f64; 3]) -> Self {
        Self {
            name: name.into(),
            eye_m,
            target_m,
            fov_deg: default_fov(),
            follow: None,
        }
    }
}

fn default_fov() -> f32 {
    45.0
}
