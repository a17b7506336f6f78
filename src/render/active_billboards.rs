//! Nodes of the billboards in active tiles, brought to the device from an engine on the processor.

use rayon::prelude::*;
use wgpu::BufferUsages;

use crate::base::Real;
use crate::field::TileId;
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::sim::Meadow;
use crate::sim::billboard::Weave;
use crate::sim::billboard::recover::Poses;
use crate::sim::cpu::tile_of;
use crate::sim::measure::GrassState;
use crate::sim::recover::{Fading, offset_left};
use crate::sim::slab::Slab;
use crate::sim::work::TileWork;

/// What is drawn of the billboards in active tiles.
#[derive(Clone, Copy, Debug)]
pub struct BillboardNodes<'a> {
    /// Active tiles that have billboards, in the order of their ids, and where the rows of each begin.
    pub tiles: &'a [(TileId, u32)],
    /// A row per node: place in the tile's anchor and 1, or four zeros in all rows of a billboard that
    /// stands in the wind as if nothing had touched it. The billboards of a tile follow each other in the
    /// field's order, each with `columns · rows` rows, from the ground up and from left to right.
    pub nodes: &'a Buffer<[f32; 4]>,
}

/// A copy of what an engine on the processor knows of its active billboards, for drawing.
#[derive(Debug)]
pub struct ActiveBillboards {
    nodes: Buffer<[f32; 4]>,
    tiles: Vec<(TileId, u32)>,
}

impl ActiveBillboards {
    /// # Errors
    /// The device's own.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            nodes: Buffer::new(gpu, "nodes of billboards", 1, BufferUsages::STORAGE)?,
            tiles: Vec::new(),
        })
    }

    /// The copy, for a frame.
    pub fn drawn(&self) -> BillboardNodes<'_> {
        BillboardNodes {
            tiles: &self.tiles,
            nodes: &self.nodes,
        }
    }

    /// Copies the poses of all active tiles' billboards as they are after the last tick.
    ///
    /// # Errors
    /// More of them than the device can bind the nodes of.
    pub fn copy<R: Real>(
        &mut self,
        gpu: &Gpu,
        meadow: &Meadow,
        state: &(impl GrassState<R> + Sync),
    ) -> Result<(), GpuError> {
        self.tiles.clear();
        let Some(weave) = &meadow.weave else {
            return Ok(());
        };
        let mut rows = 0;
        let mut active = Vec::new();
        for tile in &meadow.work.tiles {
            let Some(slab) = state.billboards(tile.slab) else {
                continue;
            };
            self.tiles.push((tile.tile, rows as u32));
            active.push((tile, slab));
            rows += meadow.field.billboards_in(tile.tile).len() * weave.grid.nodes();
        }
        let mut nodes = vec![[0.0; 4]; rows];
        let mut rest = &mut nodes[..];
        let mut jobs = Vec::with_capacity(active.len());
        for (tile, slab) in active {
            let own = meadow.field.billboards_in(tile.tile).len() * weave.grid.nodes();
            let (of_tile, others) = rest.split_at_mut(own);
            jobs.push((tile, slab, of_tile));
            rest = others;
        }
        jobs.into_par_iter().for_each_init(
            || Poses::new(weave),
            |poses, (tile, slab, out)| write_tile(meadow, weave, (tile, slab), poses, out),
        );
        self.nodes.write_or_grow(gpu, &nodes)?;
        Ok(())
    }
}

/// Writes the rows of a tile's billboards that are not back in the wind.
fn write_tile<R: Real>(
    meadow: &Meadow,
    weave: &Weave,
    (tile, slab): (&TileWork, &Slab<R>),
    poses: &mut Poses<R, { crate::sim::billboard::tile::LANES }>,
    out: &mut [[f32; 4]],
) {
    let nodes = weave.grid.nodes();
    let step_over_t = Fading::<R>::new(meadow).step_over_t;
    let billboards = meadow.field.billboards_in(tile.tile);
    let of_tile = tile_of(meadow, weave, tile, billboards, &[]);
    of_tile.poses(slab, poses, |place, lane, poses| {
        let touched_at = slab.touched_at[place];
        let is_bent =
            touched_at != 0 && offset_left(meadow.work.now - touched_at, step_over_t) > R::ZERO;
        if is_bent {
            let rows = &mut out[place * nodes..][..nodes];
            for (node, row) in rows.iter_mut().enumerate() {
                let [x, y, z] = poses.nodes.get(node, lane).to_f32();
                *row = [x, y, z, 1.0];
            }
        }
    });
}
