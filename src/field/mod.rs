//! The plants: their resting shape, and where and in which state they are.

pub mod blade_shape;

pub use blade_shape::{BladeShape, ShapeError};
