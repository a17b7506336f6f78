//! The ground: one surface for the collider, the plants' roots and the picture.

mod base_colour;
mod between_texels;
pub mod bintree;
mod build;
mod cover_map;
mod height_grid;
mod noise;

pub use base_colour::{ColourMap, MOST_TEXELS, base_colour};
pub use between_texels::BetweenTexels;
pub use build::{MOST_SAMPLES, TerrainError, height_grid};
pub use cover_map::{Cover, CoverMap};
pub use height_grid::HeightGrid;
