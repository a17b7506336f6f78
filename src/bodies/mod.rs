//! Rigid bodies: what the physics engine moves, and what the grass needs to know of it.
//!
//! [`Bodies`] wraps a rapier world. It takes the scene's bodies and timed actions and gives one
//! [`Link`] per rigid piece and sub-step, with the [`RigidShape`] it is made of. The convex parts
//! of a shape are the colliders of the physics and what pushes the grass, alike.

mod actions;
mod actor;
mod collider;
mod convex;
mod decompose;
mod draw_mesh;
mod error;
mod frame;
mod library;
mod link;
mod occluders;
mod path;
pub mod shape;
mod snapshot;
mod solids;
mod true_mesh;
mod vehicle;
mod world;

pub use error::{BodyError, ShapeError};
pub use frame::turn_of_degrees;
pub use library::CoatedShape;
pub use link::Link;
pub use occluders::{Occluders, Sight};
pub use shape::{ConvexPart, DrawMesh, RigidShape, Solid};
pub use snapshot::BodiesState;
pub use true_mesh::{Nearest, TrueMesh};
pub use world::{Bodies, BodyInfo, RayHit};

#[cfg(test)]
mod contact_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod vehicle_tests;
