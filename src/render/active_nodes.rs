//! Nodes of the plants in active tiles, brought to the device from an engine on the processor.

use rayon::prelude::*;
use wgpu::BufferUsages;

use crate::base::Real;
use crate::field::TileId;
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::sim::Meadow;
use crate::sim::cpu::poses;
use crate::sim::measure::GrassState;
use crate::sim::recover::Fading;

/// A copy of what an engine on the processor knows of its active tiles, for drawing. It is laid
/// out like [`GpuGrass::drawn`](crate::gpu::GpuGrass::drawn).
#[derive(Debug)]
pub struct ActiveNodes {
    pub nodes: Buffer<[f32; 4]>,
    /// Active tiles with their places in `nodes`, in the order of their ids.
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

    /// Copies the poses of all active tiles as they are after the last tick.
    ///
    /// # Errors
    /// More active tiles than the device can bind the nodes of.
    pub fn copy<R: Real>(
        &mut self,
        gpu: &Gpu,
        meadow: &Meadow,
        state: &(impl GrassState<R> + Sync),
    ) -> Result<(), GpuError> {
        let (field, work) = (&meadow.field, &meadow.work);
        let rows = field.table.segments as usize + 1;
        let plants = field.grid.plants_per_tile();
        let fading = Fading::<R>::new(meadow);
        // Tiles are packed anew at every copy, so that the buffer follows the active tiles.
        let mut nodes = vec![[0.0; 4]; work.tiles.len() * plants as usize * rows];
        nodes
            .par_chunks_exact_mut((plants as usize * rows).max(1))
            .zip(&work.tiles)
            .for_each(|(out, tile)| {
                let Some(slab) = state.slab(tile.slab) else {
                    return;
                };
                for (place, out) in (0..plants).zip(out.chunks_exact_mut(rows)) {
                    let Some(plant) = field.plant(&tile.anchor, tile.tile, place) else {
                        continue;
                    };
                    let (_, pose) = poses(field, work, &fading, tile, &plant, slab, place);
                    for (node, out) in pose.iter().zip(out) {
                        let [x, y, z] = node.to_f32();
                        *out = [x, y, z, 1.0];
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
