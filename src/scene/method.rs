//! The ways the grass can be solved, where there are several: each is a setting, so that they can
//! be compared in one run. The defaults together are the method of this program; the others are
//! what papers print or programs usually do, and cost more error or more time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::limits;

/// Which formulas are used. Every key's default is the stable one.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Method {
    /// What a vertex is tested against.
    pub collide: Collide,
    /// How a depth cube's face is read between its texels.
    pub sampling: Sampling,
    /// What a depth cube is drawn of.
    pub cube_per: CubePer,
    /// How far a vertex inside a depth cube is pushed.
    pub push: Push,
    /// How a pushed plant gets its shape back within a sub-step.
    pub springs: Springs,
    /// How a plant returns to its wind pose.
    pub recovery: Recovery,
    /// How far a body may travel in one sweep of the grass, over its half thickness.
    #[schemars(range(min = limits::SWEEP_SHARE.min, max = limits::SWEEP_SHARE.max))]
    pub sweep_share: f64,
    /// Sub-steps of the grass in one step of the bodies, which are taken to move evenly meanwhile.
    #[schemars(range(min = limits::GRASS_STEPS.min, max = limits::GRASS_STEPS.max))]
    pub grass_steps: u32,
}

impl Default for Method {
    fn default() -> Self {
        Self {
            collide: Collide::AsBodies,
            sampling: Sampling::Planes,
            cube_per: CubePer::Part,
            push: Push::Ratio,
            springs: Springs::Default,
            recovery: Recovery::Lengths,
            sweep_share: 1.0 / 16.0,
            grass_steps: 1,
        }
    }
}

/// What a vertex is tested against.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Collide {
    /// What each body's `collider` says.
    #[default]
    AsBodies,
    /// The depth cube of every body, however thin.
    Cube,
    /// The closed form of every convex part.
    Analytic,
    /// A field of signed distances on a grid of `cube_resolution` cells along each edge.
    Voxels,
    /// The true shape: closed forms, the union of a compound's parts, a mesh's own triangles.
    Exact,
}

/// How a depth cube's face is read between its texels.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sampling {
    /// The surface is each texel's tangent plane; distances to the planes of the texels that were
    /// hit are mixed by their weights. Outside where none was hit.
    #[default]
    Planes,
    /// Depths with weights over texels that were hit, outside where they sum to less than a half.
    Masked,
    /// Weights over all four texels; one that was not hit is as deep as the cube.
    Bilinear,
    /// The texel the point is in, as O09 reads it.
    Nearest,
}

/// What a depth cube is drawn of.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CubePer {
    /// One for every convex part.
    #[default]
    Part,
    /// One for the whole body, as in O09: what no axis sees into counts as inside.
    Body,
}

/// How far a vertex inside a depth cube is pushed along the stored normal; `Planes` know the
/// distance, other samplings only the depth d.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Push {
    /// |d|·|n·a|, to the surface where that is flat.
    #[default]
    Ratio,
    /// |d|, the depth along the face's axis (O09 eq. 4-5): up to √3 too far.
    Literal,
}

/// How a pushed plant gets its shape back within a sub-step.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Springs {
    /// Lengths from root to tip and bend springs at a rate, in rounds with the push.
    #[default]
    Default,
    /// Structural and bend springs once after the push (O09 eq. 6-7), behind the stability clamp.
    Literal,
}

/// How a plant returns to its wind pose.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Recovery {
    /// The offset of the last contact, read with the weight t³, then lengths restored.
    #[default]
    Lengths,
    /// The offset with the weight t³ and nothing else: blades shorten on their way.
    Positions,
    /// The angle between each segment's direction of the last contact and of the wind pose, with
    /// the weight t³.
    Angles,
    /// t³ upon what is already blended, in every sub-step (O09 eq. 8): the time depends on the
    /// rate.
    Literal,
}
