//! Rigid bodies: shape, mass, motion.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Coat, limits};

/// A rigid body of the scene.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Unique in the scene. Bodies act in the order of their names.
    pub name: String,
    /// Its true shape.
    pub shape: Shape,
    /// Position of the body's origin, in metres.
    #[serde(default)]
    #[schemars(inner(range(min = limits::PLACE.min, max = limits::PLACE.max)))]
    pub position_m: [f64; 3],
    /// If true, `position_m`'s y counts from the ground under it instead of from 0.
    #[serde(default)]
    pub above_ground: bool,
    /// Turns about x, then y, then z of the world, in degrees.
    #[serde(default)]
    #[schemars(inner(range(min = limits::ANGLE.min, max = limits::ANGLE.max)))]
    pub rotation_deg: [f32; 3],
    /// What moves it.
    #[serde(default)]
    pub motion: Motion,
    /// How heavy it is.
    #[serde(default)]
    pub mass: Mass,
    /// Friction coefficient, 0 for ice.
    #[serde(default = "default_friction")]
    #[schemars(range(min = limits::FRICTION.min, max = limits::FRICTION.max))]
    pub friction: f32,
    /// Share of the speed that a bounce keeps.
    #[serde(default)]
    #[schemars(range(min = limits::FRACTION.min, max = limits::FRACTION.max))]
    pub restitution: f32,
    /// Fraction of the velocity lost per second, linear and angular.
    #[serde(default)]
    #[schemars(inner(range(min = limits::DAMPING.min, max = limits::DAMPING.max)))]
    pub damping: [f32; 2],
    /// How the grass feels the body.
    #[serde(default)]
    pub collider: Collider,
    /// Colour, linear RGB in 0…1.
    #[serde(default = "default_rgb")]
    #[schemars(inner(range(min = limits::FRACTION.min, max = limits::FRACTION.max)))]
    pub rgb: [f32; 3],
    /// Plants that grow on its surface and move with it. They are drawn only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coat: Option<Coat>,
}

fn default_friction() -> f32 {
    0.6
}

fn default_rgb() -> [f32; 3] {
    [0.55, 0.12, 0.06]
}

/// The true shape of a body, about its own origin.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub enum Shape {
    /// A sphere.
    Ball {
        /// Metres.
        #[schemars(range(min = limits::BODY_LENGTH.min, max = limits::BODY_LENGTH.max))]
        radius_m: f32,
    },
    /// A cuboid.
    Box {
        /// Full extents along x, y, z.
        #[schemars(inner(range(min = limits::BODY_LENGTH.min, max = limits::BODY_LENGTH.max)))]
        size_m: [f32; 3],
    },
    /// Axis along y.
    Capsule {
        /// Of the straight part and of the two caps, in metres.
        #[schemars(range(min = limits::BODY_LENGTH.min, max = limits::BODY_LENGTH.max))]
        radius_m: f32,
        /// Length of the straight part, without the two caps.
        #[schemars(range(min = limits::BODY_LENGTH.min, max = limits::BODY_LENGTH.max))]
        length_m: f32,
    },
    /// Axis along y.
    Cylinder {
        /// Metres.
        #[schemars(range(min = limits::BODY_LENGTH.min, max = limits::BODY_LENGTH.max))]
        radius_m: f32,
        /// Full height, in metres.
        #[schemars(range(min = limits::BODY_LENGTH.min, max = limits::BODY_LENGTH.max))]
        height_m: f32,
    },
    /// The convex hull of at least four points that do not lie in one plane.
    ConvexHull {
        /// From the body's origin.
        #[schemars(length(min = limits::HULL_POINTS[0], max = limits::HULL_POINTS[1]))]
        points_m: Vec<[f32; 3]>,
    },
    /// A triangle mesh from an OBJ, glTF or GLB file, split into convex parts for physics and
    /// grass alike.
    Mesh {
        /// Path, looked up in the scene's folder and then in the asset folders.
        file: String,
        /// Metres of one unit of the file.
        #[serde(default = "unit_scale")]
        #[schemars(range(min = limits::MESH_SCALE.min, max = limits::MESH_SCALE.max))]
        scale: f32,
        /// Most convex parts the mesh may be split into.
        #[serde(default = "default_max_parts")]
        #[schemars(range(min = limits::MESH_PARTS.min, max = limits::MESH_PARTS.max))]
        max_parts: u32,
    },
    /// Several rigidly joined shapes; no meshes, vehicles or compounds inside.
    Compound {
        /// The shapes, with their places.
        #[schemars(length(min = 1, max = limits::COMPOUND_PARTS))]
        parts: Vec<Part>,
    },
    /// A chassis on four ray-cast wheels; +z is ahead.
    Vehicle {
        /// Full extents of the chassis along x, y, z.
        #[schemars(inner(range(min = limits::BODY_LENGTH.min, max = limits::BODY_LENGTH.max)))]
        chassis_m: [f32; 3],
        /// Metres.
        #[schemars(range(min = limits::BODY_LENGTH.min, max = limits::BODY_LENGTH.max))]
        wheel_radius_m: f32,
        /// Along the axle, in metres.
        #[schemars(range(min = limits::BODY_LENGTH.min, max = limits::BODY_LENGTH.max))]
        wheel_width_m: f32,
    },
}

fn unit_scale() -> f32 {
    1.0
}

fn default_max_parts() -> u32 {
    16
}

/// One piece of a compound.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Its shape.
    pub shape: Shape,
    /// Place of its origin from the body's.
    #[serde(default)]
    pub position_m: [f32; 3],
    /// Turns about x, then y, then z of the body, in degrees.
    #[serde(default)]
    #[schemars(inner(range(min = limits::ANGLE.min, max = limits::ANGLE.max)))]
    pub rotation_deg: [f32; 3],
}

/// What moves a body.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub enum Motion {
    /// Gravity, contacts and events.
    #[default]
    Free,
    /// As `Free`, with a velocity at the start.
    Thrown {
        /// Along x, y and z of the world.
        #[schemars(inner(range(min = limits::VELOCITY.min, max = limits::VELOCITY.max)))]
        velocity_m_per_s: [f32; 3],
        /// About x, y and z of the world.
        #[serde(default)]
        #[schemars(inner(range(min = limits::SPIN.min, max = limits::SPIN.max)))]
        spin_deg_per_s: [f32; 3],
    },
    /// Never moves.
    Fixed,
    /// Follows way points by time, whatever stands in its way; smooth in between.
    Path {
        /// Where it is when.
        #[schemars(length(min = 2, max = limits::WAYPOINTS))]
        waypoints: Vec<Waypoint>,
        /// Start again after the last way point.
        #[serde(default)]
        repeat: bool,
    },
}

/// A place on a path.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// Seconds since the start of the scene, rising along the path.
    pub at_s: f64,
    /// Place of the body's origin; y counts from the ground if the body says `above_ground`.
    #[schemars(inner(range(min = limits::PLACE.min, max = limits::PLACE.max)))]
    pub position_m: [f64; 3],
    /// Turns about x, then y, then z of the world, in degrees.
    #[serde(default)]
    #[schemars(inner(range(min = limits::ANGLE.min, max = limits::ANGLE.max)))]
    pub rotation_deg: [f32; 3],
}

/// How heavy a body is.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub enum Mass {
    /// Kilograms, 1e-6 to 1e7.
    Kilograms(f32),
    /// Kilograms per cubic metre, 0.01 to 50000.
    Density(f32),
}

impl Default for Mass {
    fn default() -> Self {
        Self::Density(500.0)
    }
}

/// What the grass tests its vertices against.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Collider {
    /// `cube` wherever half the body's thickness is at least two texels, else `analytic`.
    #[default]
    Auto,
    /// Six orthographic depth faces per convex part (O09 section 5.2).
    Cube,
    /// The closed-form distance, or the planes of a convex part.
    Analytic,
}
