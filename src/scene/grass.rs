//! The plants of a meadow, as ranges from which each seed draws.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::limits;

/// The plant cover of a scene.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Grass {
    /// Mean number of plants per square metre of the ground's plan, 0 or more.
    #[schemars(range(min = limits::PLANT_DENSITY.min, max = limits::PLANT_DENSITY.max))]
    pub density_per_m2: f32,
    /// Key of the random numbers of every plant.
    pub seed: u32,
    /// Kinds of plants; at most 8. An empty list grows nothing.
    #[schemars(length(max = limits::SPECIES))]
    pub species: Vec<Species>,
}

impl Default for Grass {
    fn default() -> Self {
        Self {
            density_per_m2: 256.0,
            seed: 1,
            species: vec![Species::default()],
        }
    }
}

/// One kind of plant. Pairs are smallest and largest value; a plant draws evenly between them.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Species {
    pub name: String,
    /// Share of this kind among all plants, relative to the other kinds' shares.
    #[schemars(range(min = limits::SHARE.min, max = limits::SHARE.max))]
    pub share: f32,
    /// Length of the blade along its centre line, in metres.
    #[schemars(inner(range(min = limits::PLANT_HEIGHT.min, max = limits::PLANT_HEIGHT.max)))]
    pub height_m: [f32; 2],
    /// Width at the root, in metres.
    #[schemars(inner(range(min = limits::PLANT_WIDTH.min, max = limits::PLANT_WIDTH.max)))]
    pub width_m: [f32; 2],
    /// k′ of P15 eq. 12 for eight segments: spring constant over segment weight and length.
    #[schemars(inner(range(min = limits::STIFFNESS.min, max = limits::STIFFNESS.max)))]
    pub stiffness: [f32; 2],
    /// Lean of the root from the vertical, in degrees.
    #[schemars(inner(range(min = limits::ROOT_LEAN.min, max = limits::ROOT_LEAN.max)))]
    pub lean_deg: [f32; 2],
    /// How far wind bends the tip: 0 rigid, 1 as the wind's strength says.
    #[schemars(range(min = limits::FLEXIBILITY.min, max = limits::FLEXIBILITY.max))]
    pub flexibility: f32,
    /// Colour of the blade relative to the ground under it, linear RGB factors.
    #[schemars(inner(range(min = limits::TINT.min, max = limits::TINT.max)))]
    pub tint_rgb: [f32; 3],
}

impl Default for Species {
    fn default() -> Self {
        Self {
            name: "meadow grass".into(),
            share: 1.0,
            height_m: [0.25, 0.42],
            width_m: [0.005, 0.009],
            stiffness: [60.0, 160.0],
            lean_deg: [2.0, 16.0],
            flexibility: 1.0,
            tint_rgb: [1.0, 1.0, 1.0],
        }
    }
}
