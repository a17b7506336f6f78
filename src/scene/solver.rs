//! How the scene is solved. The defaults are the cheapest that meet the accuracy limits.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::limits;
use super::method::Method;

/// Settings of the simulation.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Solver {
    /// Length of a sub-step of the grass, in seconds, whatever the frame rate. The bodies have the
    /// same unless `method.grass_steps` is more than 1.
    #[schemars(range(min = limits::SUBSTEP.min, max = limits::SUBSTEP.max))]
    pub substep_s: f64,
    /// Time from the last contact to the wind pose, T of O09 section 5.5, in seconds.
    #[schemars(range(min = limits::RECOVERY.min, max = limits::RECOVERY.max))]
    pub recovery_s: f64,
    /// Segments of a simulated blade, 1 to 16.
    #[schemars(range(min = limits::SEGMENTS.min, max = limits::SEGMENTS.max))]
    pub segments: u32,
    /// Texels along an edge of a depth-cube face, 8 to 256.
    #[schemars(range(min = limits::CUBE_RESOLUTION.min, max = limits::CUBE_RESOLUTION.max))]
    pub cube_resolution: u32,
    /// The grass keeps this far from a body, in metres.
    #[schemars(range(min = limits::SKIN.min, max = limits::SKIN.max))]
    pub skin_m: f32,
    /// Rate of the bend springs, κ, per second.
    #[schemars(range(min = limits::SPRING_RATE.min, max = limits::SPRING_RATE.max))]
    pub spring_rate_per_s: f32,
    /// Fewest and most rounds of lengths, springs and push-out in a sub-step. Lengths are restored in
    /// each, so that the default method ends with the fewest; one round costs a tenth less, and leaves nodes
    /// in a fork's inner corners beyond the limit of closed forms.
    #[schemars(inner(range(min = limits::ROUNDS.min, max = limits::ROUNDS.max)))]
    pub rounds: [u32; 2],
    /// Rounds end early once no segment is strained by more than this share.
    #[schemars(range(min = limits::STRAIN_LIMIT.min, max = limits::STRAIN_LIMIT.max))]
    pub strain_limit: f32,
    /// Most pieces a sub-step is cut into for a fast body; reaching it is reported.
    #[schemars(range(min = limits::SWEEPS.min, max = limits::SWEEPS.max))]
    pub max_sweeps: u32,
    /// Wished side of a tile, in metres: the largest of 1, 2 and 4 seeding cells that is not longer
    /// is taken, or 1. Refused where 8 would not be longer.
    #[schemars(range(min = limits::TILE_SIDE.min, max = limits::TILE_SIDE.max))]
    pub tile_m: f32,
    /// Wished side of a seeding cell (two seeding triangles), in metres; the height samples'
    /// spacing is halved until it is not longer, 12 times at most.
    #[schemars(range(min = limits::SEEDING_CELL.min, max = limits::SEEDING_CELL.max))]
    pub seeding_cell_m: f32,
    /// Entries of the table of resting blade shapes along stiffness and lean, 2 to 512 each. Without
    /// it they are as many as keep every blade within a thousandth of its length: 128 × 64, or twice
    /// each where some blades hardly lean and are soft enough to bend all the same.
    #[schemars(inner(inner(range(min = limits::BLADE_TABLE.min, max = limits::BLADE_TABLE.max))))]
    pub blade_table: Option<[u32; 2]>,
    /// Rounds of the random numbers from which plants are made.
    pub philox: PhiloxRounds,
    /// Stiffness of a blade's root hinge.
    pub root: Root,
    /// Which formulas are used where there are several.
    pub method: Method,
}

impl Default for Solver {
    fn default() -> Self {
        Self {
            substep_s: 1.0 / 120.0,
            recovery_s: 2.0,
            segments: 8,
            cube_resolution: 64,
            skin_m: 0.001,
            spring_rate_per_s: 3.0,
            rounds: [2, 6],
            strain_limit: 0.02,
            max_sweeps: 1024,
            tile_m: 1.0,
            seeding_cell_m: 0.5,
            blade_table: None,
            philox: PhiloxRounds::Seven,
            root: Root::Double,
            method: Method::default(),
        }
    }
}

/// Rounds of the Philox-2x32 generator.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PhiloxRounds {
    /// Seven rounds, which pass statistical tests.
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
