//! Floats, small maths, random numbers, statistics: nothing that knows of grass.

pub mod fixed;
pub mod hash;
pub mod philox;
pub mod pose;
pub mod real;
pub mod statistics;
pub mod trig;
pub mod vec3;

pub use hash::Hash64;
pub use pose::{Pose, Quat};
pub use real::{Real, least, most, widened};
pub use vec3::{Vec3, vec3};
