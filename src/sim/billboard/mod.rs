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
pub mod collide;
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

#[cfg(test)]
mod tests;
