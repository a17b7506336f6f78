//! Rigid bodies: what the physics engine moves, and what the grass needs to know of it.

mod link;
pub mod shape;

pub use link::Link;
pub use shape::{ConvexPart, DrawMesh, RigidShape, Solid};
