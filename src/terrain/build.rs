//! From a scene's ground to height samples.

use super::HeightGrid;
use crate::scene::assets::Assets;
use crate::scene::{Ground, Terrain};

/// Why a ground cannot be made.
#[derive(Clone, Debug, thiserror::Error)]
pub enum TerrainError {
    #[error("not made yet")]
    NotYet,
}

/// The height samples of a scene's ground.
pub fn height_grid(terrain: &Terrain, _assets: &Assets) -> Result<HeightGrid, TerrainError> {
    match &terrain.ground {
        Ground::Flat { size_m, spacing_m } => {
            let n = size_m.map(|s| (s / spacing_m).ceil() as u32 + 1);
            Ok(HeightGrid::flat(n[0], n[1], *spacing_m))
        }
        _ => Err(TerrainError::NotYet),
    }
}
