//! Rigid bodies: what the physics engine moves, and what the grass needs to know of it.

pub mod shape;

pub use shape::{ConvexPart, DrawMesh, RigidShape, Solid};
