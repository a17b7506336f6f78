//! Light from volumes (O09 section 6.1): what the ground and the fixed bodies leave of the sky.
//!
//! ```text
//! grid         where the cells are
//! directions   into which directions of the sky a cell looks
//! visibility   what it sees there: rays, traced once and kept on disk by the caller
//! irradiance   ambient occlusion, and irradiance from the sky of a moment
//! lookup       the light at any place, as a shader finds it
//! textures     both as 2D texture arrays; shader: `shaders/shared/volume_light.wgsl`
//! ```

mod directions;
mod grid;
mod half;
mod irradiance;
mod lookup;
mod textures;
mod visibility;

pub use directions::sky_directions;
pub use grid::LightGrid;
pub use irradiance::{CellLight, LightTexels, cell_lights};
pub use textures::LightTextures;
pub(super) use textures::{LightVolume, check_layers};
pub use visibility::{SightOf, TraceProgress, Visibility};

#[cfg(test)]
mod tests;
