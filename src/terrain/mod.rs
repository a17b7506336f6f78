//! The ground: one surface for the collider, the plants' roots and the picture.

mod build;
mod height_grid;

pub use build::{TerrainError, height_grid};
pub use height_grid::HeightGrid;
