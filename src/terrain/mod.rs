//! The ground: one surface for the collider, the plants' roots and the picture.

mod base_colour;
pub mod bintree;
mod build;
mod height_grid;
mod noise;

pub use base_colour::{ColourMap, MOST_TEXELS, base_colour};
pub use build::{MOST_SAMPLES, TerrainError, height_grid};
pub use height_grid::HeightGrid;
