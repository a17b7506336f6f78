//! Nodes of the plants in active tiles, brought to the device from an engine on the processor.

use rayon::prelude::*;
use wgpu::BufferUsages;

use crate::field::TileId;
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::sim::cpu::poses;
use crate::sim::meadow::Meadow;
use crate::sim::slab::Slab;

/// A copy of what an engine on the processor knows of its active tiles, for drawing.
#[derive(Debug)]
pub struct ActiveNodes {
    /// As [`BladesInput::active_nodes`](super::BladesInput) wants it.
    pub nodes: Buffer<[f32; 4]>,
    /// Active tiles with their slabs, in the order of their ids.
    pub tiles: Vec<(TileId, u32)>,
}

impl ActiveNodes {
    /// # Errors
    /// The device's own.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            nodes: Buffer::new(gpu, "active nodes", 1, BufferUsages::STORAGE)?,
            tiles: Vec::new(),
        })
    }

    /// Copies the poses of all active tiles as they are after the last tick. `slab` gives the
    /// state of a slab in use.
    ///
    /// # Errors
    /// More active tiles than the device can bind the nodes of.
    pub fn copy<'a>(
        &mut self,
        gpu: &Gpu,
        meadow: &Meadow,
        slab: impl Fn(u32) -> Option<&'a Slab<f32>> + Sync,
    ) -> Result<(), GpuError> {
        let field = &meadow.field;
        let segments = field.table.segments as usize;
        let plants = field.grid.plants_per_tile();
        let per_tile = plants as usize * segments;
        let work = &meadow.work;
        // Tiles are packed anew at every copy, so that the buffer follows the active tiles.
        let mut nodes = vec![[0.0; 4]; work.tiles.len() * per_tile];
        nodes
            .par_chunks_exact_mut(per_tile.max(1))
            .zip(&work.tiles)
            .for_each(|(out, tile)| {
                let Some(state) = slab(tile.slab) else {
                    return;
                };
                let step_over_t = meadow.step_over_t() as f32;
                for (place, out) in (0..plants).zip(out.chunks_exact_mut(segments)) {
                    let Some(plant) = field.plant(&tile.anchor, tile.tile, place) else {
                        continue;
                    };
                    let (_, pose) = poses(field, work, step_over_t, tile, &plant, state, place);
                    for (node, out) in pose[1..].iter().zip(out) {
                        *out = [node.x, node.y, node.z, 0.0];
                    }
                }
            });
        self.tiles = (work.tiles.iter().zip(0..))
            .map(|(tile, packed)| (tile.tile, packed))
            .collect();
        self.nodes.write_or_grow(gpu, &nodes)?;
        Ok(())
    }
}
