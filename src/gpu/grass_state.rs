//! The grass's state between device and memory: read back for measures and tests, uploaded to show
//! or continue what another engine simulated.

use std::ops::Range;

use super::buffer::read_together;
use super::grass::GpuGrass;
use super::grass_buffers::TOUCHED_HEADER;
use super::{Buffer, GpuError};
use crate::base::Vec3;
use crate::sim::Meadow;
use crate::sim::measure::GrassState;
use crate::sim::slab::Slab;

/// The state of a meadow's active tiles, read back.
#[derive(Clone, Debug, Default)]
pub struct GpuState {
    slabs: Vec<Option<Slab<f32>>>,
    billboards: Vec<Option<Slab<f32>>>,
}

impl GrassState<f32> for GpuState {
    fn slab(&self, slab: u32) -> Option<&Slab<f32>> {
        self.slabs.get(slab as usize)?.as_ref()
    }

    fn billboards(&self, slab: u32) -> Option<&Slab<f32>> {
        self.billboards.get(slab as usize)?.as_ref()
    }
}

/// What the passes counted.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Counts {
    /// Plants and billboards that were touched in the last tick in which a tile collided.
    pub touched: u32,
    /// Most rounds any plant took since the start.
    pub rounds_peak: u32,
    /// Kernels whose loops the driver has ended early since the start: what they computed is wrong.
    pub cut_short: u32,
}

impl Counts {
    /// From the header of the list of touched plants.
    fn new(header: &[u32]) -> Self {
        let word = |n: usize| header.get(n).copied().unwrap_or(0);
        Self {
            touched: word(0),
            rounds_peak: word(1),
            cut_short: word(3),
        }
    }
}

impl GpuGrass {
    /// Reads the slabs of the meadow's active tiles. Waits for the device.
    ///
    /// # Errors
    /// The device's; kernels that the driver did not let finish.
    pub fn read_state(&self, meadow: &Meadow) -> Result<GpuState, GpuError> {
        let slabs: Vec<u32> = meadow.work.tiles.iter().map(|tile| tile.slab).collect();
        let runs = runs(self, &slabs);
        let header = 0..TOUCHED_HEADER as usize;
        let mut parts = self.buffers.touched.parts(std::slice::from_ref(&header))?;
        parts.extend(self.buffers.state.parts(&runs)?);
        if let Some(billboards) = &self.billboards {
            parts.extend(billboards.parts(&slabs)?);
        }
        // One wait for all.
        let bytes = read_together(&self.gpu, "grass state", &parts)?;
        let (header, rows) = bytes.split_at(TOUCHED_HEADER as usize * size_of::<u32>());
        let header: Vec<u32> = bytemuck::pod_collect_to_vec(header);
        self.check_cut_short(Counts::new(&header).cut_short)?;
        let rows: Vec<[u32; 4]> = bytemuck::pod_collect_to_vec(rows);
        let (rows, of_boards) = rows.split_at(runs.iter().map(Range::len).sum());
        let plants = meadow.field.grid.plants_per_tile() as usize;
        let segments = meadow.scene.solver.segments as usize;
        let mut state = GpuState::default();
        let high = slabs.iter().map(|&slab| slab as usize + 1).max();
        state.slabs.resize(high.unwrap_or(0), None);
        // Slabs of a meadow of billboards alone have no rows.
        for (&slab, first) in slabs.iter().zip((0..).step_by(self.slab_rows.max(1))) {
            let rows = &rows[first.min(rows.len())..][..self.slab_rows];
            state.slabs[slab as usize] = Some(unpack(rows, plants, segments));
        }
        if let Some(billboards) = &self.billboards {
            state.billboards = billboards.unpack(meadow, of_boards);
        }
        Ok(state)
    }

    /// Reads the drawn nodes of the meadow's active tiles, tile after tile. Waits for the device.
    ///
    /// # Errors
    /// The device's.
    pub fn read_drawn(&self, meadow: &Meadow) -> Result<Vec<[f32; 4]>, GpuError> {
        let slabs: Vec<u32> = meadow.work.tiles.iter().map(|tile| tile.slab).collect();
        read_slabs(self, self.drawn(), &slabs)
    }

    /// Reads the passes' counts. Waits for the device.
    ///
    /// # Errors
    /// The device's.
    pub fn read_counts(&self) -> Result<Counts, GpuError> {
        let header = self
            .buffers
            .touched
            .read(&self.gpu, TOUCHED_HEADER as usize)?;
        let mut counts = Counts::new(&header);
        if let Some(billboards) = &self.billboards {
            let of_boards = Counts::new(&billboards.read_header(&self.gpu)?);
            counts.touched += of_boards.touched;
            counts.rounds_peak = counts.rounds_peak.max(of_boards.rounds_peak);
            counts.cut_short += of_boards.cut_short;
        }
        Ok(counts)
    }

    /// Whether the driver has ended loops of kernels early. Waits for the device.
    ///
    /// # Errors
    /// `CutShort`; the device's.
    pub fn check(&self) -> Result<(), GpuError> {
        self.check_cut_short(self.read_counts()?.cut_short)
    }

    pub(super) fn check_cut_short(&self, count: u32) -> Result<(), GpuError> {
        if count == 0 {
            return Ok(());
        }
        Err(GpuError::CutShort {
            adapter: self.gpu.adapter.name.clone(),
            count,
        })
    }

    /// Takes over the state of another engine that simulates the same meadow, together with the
    /// numbers of its current tick, so that `recover` or the next tick goes on from there.
    ///
    /// # Errors
    /// The driver's, as when memory is short.
    pub fn upload(
        &mut self,
        meadow: &Meadow,
        state: &impl GrassState<f32>,
    ) -> Result<(), GpuError> {
        self.take_in(meadow)?;
        let segments = meadow.scene.solver.segments as usize;
        for tile in &meadow.work.tiles {
            if let Some(slab) = state.slab(tile.slab) {
                let first = tile.slab as usize * self.slab_rows;
                self.buffers
                    .state
                    .write(&self.gpu, first, &pack(slab, segments))?;
            }
            let of_boards = self.billboards.as_ref().zip(state.billboards(tile.slab));
            if let Some((billboards, slab)) = of_boards {
                let place = (tile.tile, tile.slab);
                billboards.upload(&self.gpu, &mut self.encoder, meadow, place, slab)?;
            }
        }
        Ok(())
    }
}

/// Rows of a slab on the device.
fn pack(slab: &Slab<f32>, segments: usize) -> Vec<[u32; 4]> {
    let mut rows = Vec::with_capacity(slab.touched_at.len() * (segments + 1));
    for (plant, &touched_at) in slab.touched_at.iter().enumerate() {
        rows.push([touched_at, 0, 0, 0]);
        let nodes = plant * segments..(plant + 1) * segments;
        for (offset, face) in slab.offsets[nodes.clone()].iter().zip(&slab.faces[nodes]) {
            let [x, y, z] = offset.to_f32().map(f32::to_bits);
            rows.push([x, y, z, *face]);
        }
    }
    rows
}

fn unpack(rows: &[[u32; 4]], plants: usize, segments: usize) -> Slab<f32> {
    let mut slab = Slab::new(plants, segments);
    for (plant, rows) in rows.chunks_exact(segments + 1).enumerate() {
        slab.touched_at[plant] = rows[0][0];
        for (j, &[x, y, z, face]) in rows[1..].iter().enumerate() {
            let at = plant * segments + j;
            slab.offsets[at] = Vec3::of_f32([x, y, z].map(f32::from_bits));
            slab.faces[at] = face;
        }
    }
    slab
}

/// Copies slabs out of a buffer, one after the other.
fn read_slabs<T: bytemuck::Pod>(
    grass: &GpuGrass,
    from: &Buffer<T>,
    slabs: &[u32],
) -> Result<Vec<T>, GpuError> {
    from.read_runs(&grass.gpu, &runs(grass, slabs))
}

/// The rows of slabs.
fn runs(grass: &GpuGrass, slabs: &[u32]) -> Vec<Range<usize>> {
    let rows = grass.slab_rows;
    let slabs = slabs.iter().map(|&slab| slab as usize);
    slabs.map(|slab| slab * rows..(slab + 1) * rows).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slab_survives_packing() {
        let mut slab = Slab::<f32>::new(3, 2);
        slab.touched_at = vec![0, 7, 9];
        for (n, offset) in slab.offsets.iter_mut().enumerate() {
            *offset = Vec3::new(n as f32, -0.5, 1e-7);
        }
        slab.faces = vec![1, 2, 3, 4, 5, u32::MAX];
        assert_eq!(unpack(&pack(&slab, 2), 3, 2), slab);
    }
}
