//! The ground: its height samples and its colour.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::limits;

/// The ground of a scene; heights are along +y.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Terrain {
    /// Where its heights come from.
    pub ground: Ground,
    /// World x and z of the ground's middle. The ground, its plants and its colours are the same
    /// wherever it lies.
    #[schemars(inner(range(min = limits::PLACE.min, max = limits::PLACE.max)))]
    pub centre_m: [f64; 2],
    /// Base map of the whole ground: an 8-bit RGB or RGBA PNG (alpha is ignored) of the ground's
    /// proportions; the first row lies at the smallest z. Looked up like every asset. Without one
    /// the ground is coloured with patches of the three colours below.
    pub base_map: Option<String>,
    /// Colour of lush patches, linear RGB in 0…1. A plant takes the colour of the ground under it.
    #[schemars(inner(range(min = limits::FRACTION.min, max = limits::FRACTION.max)))]
    pub lush_rgb: [f32; 3],
    /// Colour of dry patches.
    #[schemars(inner(range(min = limits::FRACTION.min, max = limits::FRACTION.max)))]
    pub dry_rgb: [f32; 3],
    /// Colour of bare soil, also between the plants.
    #[schemars(inner(range(min = limits::FRACTION.min, max = limits::FRACTION.max)))]
    pub soil_rgb: [f32; 3],
    /// Friction coefficient of the ground, 0 or more.
    #[schemars(range(min = limits::FRICTION.min, max = limits::FRICTION.max))]
    pub friction: f32,
}

impl Default for Terrain {
    fn default() -> Self {
        Self {
            ground: Ground::default(),
            centre_m: [0.0; 2],
            base_map: None,
            lush_rgb: [0.105, 0.185, 0.045],
            dry_rgb: [0.25, 0.24, 0.095],
            soil_rgb: [0.13, 0.085, 0.045],
            friction: 0.8,
        }
    }
}

/// Where the heights come from.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub enum Ground {
    /// A plane at height 0.
    Flat {
        /// Extent along x and z, in metres; rounded up to whole spacings.
        #[schemars(inner(range(min = limits::TERRAIN_SIDE.min, max = limits::TERRAIN_SIDE.max)))]
        size_m: [f32; 2],
        /// Distance of the height samples, in metres.
        #[serde(default = "one_metre")]
        #[schemars(range(min = limits::HEIGHT_SPACING.min, max = limits::HEIGHT_SPACING.max))]
        spacing_m: f32,
    },
    /// Smooth rolling ground from value noise, `octaves` of it, each half as high and half as long.
    Rolling {
        /// Extent along x and z, in metres; rounded up to whole spacings.
        #[schemars(inner(range(min = limits::TERRAIN_SIDE.min, max = limits::TERRAIN_SIDE.max)))]
        size_m: [f32; 2],
        /// Distance of the height samples, in metres.
        #[serde(default = "one_metre")]
        #[schemars(range(min = limits::HEIGHT_SPACING.min, max = limits::HEIGHT_SPACING.max))]
        spacing_m: f32,
        /// Half the height range of the first octave, in metres.
        #[schemars(range(min = limits::AMPLITUDE.min, max = limits::AMPLITUDE.max))]
        amplitude_m: f32,
        /// Wavelength of the first octave, in metres.
        #[schemars(range(min = limits::WAVELENGTH.min, max = limits::WAVELENGTH.max))]
        wavelength_m: f32,
        /// Layers of noise.
        #[serde(default = "three_octaves")]
        #[schemars(range(min = limits::OCTAVES.min, max = limits::OCTAVES.max))]
        octaves: u32,
        /// Another seed is another ground.
        #[serde(default)]
        seed: u32,
    },
    /// A 16-bit grey PNG: black is 0, white is `height_m`; the first row lies at the smallest z.
    HeightMap {
        /// Path, looked up in the scene's folder and then in the asset folders.
        file: String,
        /// Distance of two texels on the ground, in metres.
        #[schemars(range(min = limits::HEIGHT_SPACING.min, max = limits::HEIGHT_SPACING.max))]
        spacing_m: f32,
        /// Height of white above black, in metres.
        #[schemars(range(min = limits::HEIGHT.min, max = limits::HEIGHT.max))]
        height_m: f32,
    },
}

impl Default for Ground {
    fn default() -> Self {
        Self::Flat {
            size_m: [16.0, 16.0],
            spacing_m: one_metre(),
        }
    }
}

fn one_metre() -> f32 {
    1.0
}

fn three_octaves() -> u32 {
    3
}
