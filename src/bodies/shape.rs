//! The true shape of a rigid body, as convex parts.

use std::sync::Arc;

use crate::base::Pose;

use super::true_mesh::TrueMesh;

/// A rigid shape: made once, shared by every body that has it.
#[derive(Clone, Debug)]
pub struct RigidShape {
    /// Convex parts in the body's space; their union is the shape.
    pub parts: Vec<ConvexPart>,
    /// Radius of a ball about the body's origin that holds every part, in metres.
    pub bounding_radius_m: f64,
    /// Smallest half thickness among the parts, in metres: how far a body may travel in one
    /// sweep without missing a blade.
    pub half_thickness_m: f64,
    /// The mesh that the parts stand for, if there is one and it is closed.
    pub true_mesh: Option<Arc<TrueMesh>>,
    /// What is drawn.
    pub mesh: DrawMesh,
}

/// One convex part.
#[derive(Clone, Debug)]
pub struct ConvexPart {
    pub solid: Solid,
    /// `body_from_part`.
    pub pose: Pose<f64>,
    /// Bounds of the part in the body's space: smallest and largest corner.
    pub bounds_m: [[f64; 3]; 2],
    pub half_thickness_m: f64,
}

/// The solid of a part, about the part's own origin. Lengths in metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Solid {
    Ball {
        radius: f64,
    },
    Box {
        half: [f64; 3],
    },
    /// Axis along y, from −half to +half, with round caps.
    Capsule {
        radius: f64,
        half: f64,
    },
    /// Axis along y.
    Cylinder {
        radius: f64,
        half: f64,
    },
    /// The points with n·p ≤ d for every plane [nx, ny, nz, d], n of unit length.
    Convex {
        planes: Vec<[f64; 4]>,
        vertices: Vec<[f64; 3]>,
    },
}

/// Triangles to draw, in the body's space.
#[derive(Clone, Debug, Default)]
pub struct DrawMesh {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub indices: Vec<u32>,
}
