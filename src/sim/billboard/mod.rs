//! The kernel of billboards: how one semi-transparent quad, refined to a grid of nodes while it has
//! been touched, collides, keeps its shape and recovers (O09 sections 5.1 to 5.5).
//!
//! - [`grid`]: nodes and springs, shared by all billboards of a scene;
//! - [`shape`]: the quad in the wind, and its grid;
//! - [`lanes`]: nodes of several billboards side by side, so that a CPU works on all of them at once;
//! - [`springs`]: O09 eq. 6-7 over lanes;
//! - [`relax`]: a sub-step of those that a body touches; [`batch`] holds them meanwhile;
//! - [`recover`]: where they are some time after the last contact;
//! - [`tile`]: all of these for the billboards of a tile.
//!
//! What happens to a billboard does not depend on the lane it is in, on the others beside it or on how
//! many there are: every lane does the same operations in the same order, and one that is done is put
//! aside while the others go on.

#![allow(
    clippy::needless_range_loop,
    reason = "a lane's number counts in several arrays at once"
)]

pub mod batch;
pub mod grid;
pub mod lanes;
pub mod recover;
pub mod relax;
pub mod shape;
pub mod springs;
pub mod tile;

pub use batch::Batch;
pub use grid::{Grid, GridError, Weave};
pub use shape::Quad;

use crate::base::{Real, Vec3};
use crate::field::Billboard;

/// What the kernel needs to know of a billboard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rooted {
    /// Middle of the quad's lower edge, in its anchor's coordinates.
    pub root_in_anchor: [f32; 3],
    /// Cosine and sine of the lower edge's azimuth from +x towards +z.
    pub across: [f32; 2],
    /// Unit vector along which it grows.
    pub up: [f32; 3],
    pub height_m: f32,
    pub width_m: f32,
    pub flexibility: f32,
    /// Phase of its own trembling.
    pub flutter_turns: f32,
}

impl From<&Billboard> for Rooted {
    fn from(of: &Billboard) -> Self {
        Self {
            root_in_anchor: of.root_in_anchor,
            across: of.across,
            up: of.up,
            height_m: of.height_m,
            width_m: of.width_m,
            flexibility: of.flexibility,
            flutter_turns: of.flutter_turns,
        }
    }
}

impl Rooted {
    pub fn root<R: Real>(&self) -> Vec3<R> {
        Vec3::of_f32(self.root_in_anchor)
    }

    /// Radius of a ball about the root that holds the billboard in any pose of its lengths, in metres.
    pub fn reach_m<R: Real>(&self) -> R {
        R::of_f32(self.width_m) * R::of(0.5) + R::of_f32(self.height_m)
    }
}

#[cfg(test)]
mod tests;
