//! What can be wrong with a body or with what is asked of it.

use thiserror::Error;

/// A body that cannot be made, or an action that cannot be done.
#[derive(Debug, Error, PartialEq)]
pub enum BodyError {
    #[error("body `{name}`: another body has this name; give each body a name of its own")]
    DuplicateName { name: String },
    #[error(
        "body `{name}` is one more than the {limit} that may be in the world; remove one before"
    )]
    TooMany { name: String, limit: usize },
    #[error("no body is named `{name}`; name one of the scene or one spawned before this action")]
    UnknownBody { name: String },
    #[error("body `{name}` is no vehicle; only a vehicle can be driven")]
    NotAVehicle { name: String },
    #[error(
        "body `{name}` {held}, so it cannot {wish}; give it the motion `Free` or `Thrown` instead"
    )]
    NotFree {
        name: String,
        held: &'static str,
        wish: &'static str,
    },
    #[error("body `{name}`: a vehicle drives freely; give it the motion `Free` or `Thrown`")]
    HeldVehicle { name: String },
    #[error("body `{name}`: {source}")]
    Shape { name: String, source: ShapeError },
    #[error("body `{name}` has a mass of {kilograms} kg; it must be more than 0 and finite")]
    Mass { name: String, kilograms: f64 },
    #[error("body `{name}`: its path {problem}")]
    Path { name: String, problem: String },
    #[error("the ground makes no collider: {reason}")]
    Ground { reason: String },
}

/// A shape that has no inside.
#[derive(Debug, Error, PartialEq)]
pub enum ShapeError {
    #[error("`{key}` is {value} m; it must be more than 0 and finite")]
    Size { key: &'static str, value: f32 },
    #[error(
        "the convex hull of its {points} points has no volume; give at least four points that do \
         not lie in one plane"
    )]
    FlatHull { points: usize },
    #[error("mesh `{file}` is not among the loaded assets; name it in the scene's own bodies")]
    MissingMesh { file: String },
    #[error(
        "mesh `{file}` at scale {scale} gives no convex part with a volume; it needs triangles \
         that enclose one, and a scale more than 0"
    )]
    FlatMesh { file: String, scale: f32 },
    #[error("mesh `{file}` may be split into {max_parts} parts; give 1 to {most}")]
    PartCount {
        file: String,
        max_parts: u32,
        most: u32,
    },
    #[error("mesh `{file}`: triangle {triangle} names vertex {vertex}, but there are {vertices}")]
    MeshIndex {
        file: String,
        triangle: usize,
        vertex: u32,
        vertices: usize,
    },
    #[error("a compound has no parts; give it at least one")]
    EmptyCompound,
    #[error("a compound may not contain a {inner}; use it as a body of its own")]
    Nested { inner: &'static str },
    #[error("a vehicle is more than one rigid piece and cannot be made as one shape")]
    Vehicle,
}
