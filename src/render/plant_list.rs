//! The list that the first stage of drawing makes of the plants in view, read back for tests.

use crate::field::TileId;
use crate::gpu::{Gpu, GpuError};

use super::plant_form::{BUCKETS, DETAILS, FORMS};
use super::sort_plants::PlantSort;

/// A plant, or a companion of one, that a frame drew.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub struct ListedPlant {
    pub tile: TileId,
    /// Place in the tile; those of companions go on after all plants of the tile.
    pub rank: u32,
    /// Number of its kind in the scene's list.
    pub kind: u32,
    /// s′ of P15 eq. 18 in units of 2⁻¹⁶.
    pub thrives: u32,
    /// Name of its form's shader.
    pub form: &'static str,
}

/// Bits of a row that tell how a plant thrives; its kind follows.
const THRIVES_BITS: u32 = 17;

pub(super) fn read(gpu: &Gpu, sort: &PlantSort) -> Result<Vec<ListedPlant>, GpuError> {
    if sort.is_empty() {
        return Ok(Vec::new());
    }
    let draws = sort.draws.read(gpu, BUCKETS as usize)?;
    let tiles = sort.tiles.read(gpu, sort.tiles.len())?;
    let total = draws.iter().map(|draw| draw.instances as usize).sum();
    let rows = sort.sorted.read(gpu, total)?;
    let mut plants = Vec::with_capacity(total);
    for (draw, form) in draws.iter().zip((0..).map(|bucket| bucket / DETAILS)) {
        let first = draw.start as usize;
        for &[tile, rank, what, _] in &rows[first..first + draw.instances as usize] {
            plants.push(ListedPlant {
                tile: tiles[tile as usize].tile.tile,
                rank,
                kind: what >> THRIVES_BITS,
                thrives: what & ((1 << THRIVES_BITS) - 1),
                form: FORMS[form as usize].shader,
            });
        }
    }
    Ok(plants)
}
