//! How the scene is solved. The defaults are the cheapest that meet the accuracy limits.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the simulation.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Solver {
    /// Length of a sub-step, in seconds, whatever the frame rate.
    pub substep_s: f64,
    /// Time from the last contact to the wind pose, T of O09 section 5.5, in seconds.
    pub recovery_s: f64,
    /// Segments of a simulated blade, 1 to 16.
    pub segments: u32,
    /// Texels along an edge of a depth-cube face, 8 to 256.
    pub cube_resolution: u32,
    /// The grass keeps this far from a body, in metres.
    pub skin_m: f32,
    /// Rate of the bend springs, κ, per second.
    pub spring_rate_per_s: f32,
    /// Fewest and most rounds of lengths, springs and push-out in a sub-step.
    pub rounds: [u32; 2],
    /// Rounds end early once no segment is strained by more than this share.
    pub strain_limit: f32,
    /// Most pieces a sub-step is cut into for a fast body; reaching it is reported.
    pub max_sweeps: u32,
    /// Wished side of a tile, in metres; the nearest whole number of seeding cells is taken.
    pub tile_m: f32,
    /// Wished side of a seeding cell (two seeding triangles), in metres; the height samples'
    /// spacing is halved until it is not longer.
    pub seeding_cell_m: f32,
    pub philox: PhiloxRounds,
    pub root: Root,
}

impl Default for Solver {
    fn default() -> Self {
        Self {
            substep_s: 1.0 / 120.0,
            recovery_s: 2.0,
            segments: 8,
            cube_resolution: 64,
            skin_m: 0.001,
            spring_rate_per_s: 60.0,
            rounds: [2, 6],
            strain_limit: 0.02,
            max_sweeps: 1024,
            tile_m: 1.0,
            seeding_cell_m: 0.5,
            philox: PhiloxRounds::Seven,
            root: Root::Double,
        }
    }
}

/// Rounds of the Philox-2x32 generator.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PhiloxRounds {
    #[default]
    Seven,
    /// Three rounds, as P15 has it: neighbouring triangles stay correlated.
    Paper,
}

/// Stiffness of a blade's root hinge.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Root {
    /// 2k′: agrees with a continuous beam at second order in the segment length.
    #[default]
    Double,
    /// k′, as P15 has it.
    Paper,
}
