//! Light from volumes: O09 section 6.1.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::limits;

/// Light of the sky past the scene's ground and fixed bodies, worked out before the scene is drawn and
/// kept in volumes over the whole ground: a hollow, and the grass at the foot of a wall, are darker, and
/// light comes from where the sky is seen. Cells stand in columns, and every column begins at the ground
/// under it. A scene without this key is lit as if nothing hid the sky.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct LightVolumes {
    /// Wished distance of columns along x and z, in metres: they are spread evenly from edge to edge, and
    /// no farther apart than this.
    #[schemars(range(min = limits::LIGHT_CELL.min, max = limits::LIGHT_CELL.max))]
    pub cell_m: f32,
    /// Height of the columns over the ground, in metres; what is higher has the light at their top.
    #[schemars(range(min = limits::LIGHT_HEIGHT.min, max = limits::LIGHT_HEIGHT.max))]
    pub height_m: f32,
    /// Cells of a column, the first at the ground: slices of the textures.
    #[schemars(range(min = limits::LIGHT_SLICES.min, max = limits::LIGHT_SLICES.max))]
    pub slices: u32,
    /// Directions of the sky that every cell looks into.
    #[schemars(range(min = limits::LIGHT_RAYS.min, max = limits::LIGHT_RAYS.max))]
    pub rays: u32,
    /// Turns the directions about the vertical.
    pub seed: u32,
}

impl Default for LightVolumes {
    fn default() -> Self {
        Self {
            cell_m: 0.5,
            height_m: 2.0,
            slices: 6,
            rays: 256,
            seed: 1,
        }
    }
}

impl LightVolumes {
    /// Columns along x and z over a ground of an extent along both, in metres.
    pub fn columns(&self, size_m: [f64; 2]) -> [u64; 2] {
        // A whole number of cells stays one although f32 rounds it: 2⁻²³ off, twice.
        let cells = |side: f64| (side / f64::from(self.cell_m) * (1.0 - 3e-7)).ceil();
        size_m.map(|side| cells(side).max(1.0) as u64 + 1)
    }
}
