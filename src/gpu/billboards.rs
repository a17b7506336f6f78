//! The billboards of the `gpu` engine: refined forms in slabs of their own, for active tiles alone.
//!
//! The second layer of [`GpuGrass`](super::GpuGrass), whose methods call those here by the same names. A
//! scene without billboards has none of this. Layout of the pool: `shaders/shared/billboard_state.wgsl`.

use wgpu::BufferUsages;

use super::billboard_place::{BillboardPlacing, BillboardRecord, PlacedBillboards};
use super::buffer::Part;
use super::grass_buffers::{
    COLLIDE_GROUPS, CUT_SHORT_BYTE, RECOVER_GROUPS, TOUCHED_HEADER, slab_limit,
};
use super::late_count::LateCount;
use super::passes::billboard::{Around, BillboardPasses};
use super::passes::{Recording, WORKGROUP};
use super::turns::BillboardTurns;
use super::{Buffer, Gpu, GpuError};
use crate::base::Vec3;
use crate::field::TileId;
use crate::gpu_struct;
use crate::sim::Meadow;
use crate::sim::billboard::Weave;
use crate::sim::billboard::relax::Settings;
use crate::sim::slab::Slab;

/// Columns, rows and whether there are bend springs, as shaders are checked with them: a scene's own are
/// put in their place when its passes are compiled.
pub const BOARD_COLUMNS: u32 = 4;
pub const BOARD_ROWS: u32 = 4;
pub const BOARD_BENDS: u32 = 1;
/// Rows of a billboard's record in a slab.
const RECORD_ROWS: usize = 2;
/// Bytes of a row.
const ROW_BYTES: u64 = 16;

gpu_struct! {
    /// Numbers of a sub-step that only billboards need.
    pub struct BoardUniform {
        pub slots: u32,
        pub fewest_rounds: u32,
        pub most_rounds: u32,
        pub passes: u32,
        pub rate_step: f32,
        pub bend_step: f32,
        pub strain_limit: f32,
        pub collide_sweeps: u32,
        pub relax_rounds: u32,
        pub spare_a: u32,
        pub spare_b: [u32; 2],
    }
}

/// What the passes read and write.
#[derive(Debug)]
pub struct BillboardBuffers {
    /// Scene: by slab, records and states.
    pub pool: Buffer<[u32; 4]>,
    /// Tick: its numbers, the list of touched billboards, and the passes' sizes.
    pub numbers: Buffer<BoardUniform>,
    pub touched: Buffer<u32>,
    pub groups: Buffer<u32>,
    /// Frame: nodes as they are drawn.
    pub drawn: Buffer<[f32; 4]>,
}

/// State of a scene's billboards on the device.
#[derive(Debug)]
pub struct GpuBillboards {
    passes: BillboardPasses,
    placed: PlacedBillboards,
    pub buffers: BillboardBuffers,
    weave: Weave,
    /// Billboards that a slab has room for.
    slots: usize,
    turns: BillboardTurns,
    pub(super) cut_short: LateCount,
}

impl GpuBillboards {
    /// Those of a meadow that has some. Lowers the meadow's slab limit to what the device can bind.
    ///
    /// # Errors
    /// Maps or billboards larger than the device can bind; a shader that the driver refuses.
    pub fn new(gpu: &Gpu, meadow: &mut Meadow) -> Result<Option<Self>, GpuError> {
        let Some(weave) = meadow.weave.clone() else {
            return Ok(None);
        };
        let Some(placed) = BillboardPlacing::new(gpu)?.lay_out(gpu, &meadow.field)? else {
            return Ok(None);
        };
        let tiles = meadow
            .field
            .billboards
            .iter()
            .flat_map(|b| b.ranges.windows(2));
        let slots = tiles.map(|ends| (ends[1] - ends[0]) as usize).max();
        let slots = slots.unwrap_or(0).max(1);
        let settings = Settings::new(&meadow.scene.solver);
        let boards = Self {
            passes: BillboardPasses::new(gpu, &weave, WORKGROUP)?,
            placed,
            buffers: BillboardBuffers::new(gpu)?,
            slots,
            turns: BillboardTurns::new(meadow, &weave, &settings),
            weave,
            cut_short: LateCount::new(gpu),
        };
        let widest = boards.slab_rows().max(boards.drawn_rows()) as u64 * ROW_BYTES;
        meadow.tiles.slabs.lower_limit(slab_limit(gpu, widest));
        Ok(Some(boards))
    }

    /// Rows of what is kept of a billboard: its state, then two of every node to work with.
    fn rows_each(&self) -> usize {
        1 + self.weave.grid.movable() + 2 * self.weave.grid.nodes()
    }

    /// Rows of a slab of the pool.
    fn slab_rows(&self) -> usize {
        self.slots * (RECORD_ROWS + self.rows_each())
    }

    /// Rows of a slab of the drawn nodes.
    fn drawn_rows(&self) -> usize {
        self.slots * self.weave.grid.nodes()
    }

    /// Active tiles that have billboards, in the order of their ids, where the rows of each begin in the
    /// nodes as they are drawn, and those nodes, of the last [`GpuGrass::recover`](super::GpuGrass::recover).
    pub fn drawn(&self, meadow: &Meadow) -> (Vec<(TileId, u32)>, &Buffer<[f32; 4]>) {
        let rows = self.drawn_rows() as u32;
        let tiles = (meadow.work.tiles.iter())
            .filter(|tile| !meadow.field.billboards_in(tile.tile).is_empty())
            .map(|tile| (tile.tile, tile.slab * rows))
            .collect();
        (tiles, &self.buffers.drawn)
    }

    /// Bytes of the records of all billboards, and of the slabs, lists and nodes of active tiles.
    pub fn bytes(&self) -> [u64; 2] {
        let record = size_of::<BillboardRecord>() as u64;
        let BillboardBuffers {
            pool,
            numbers: _,
            touched,
            groups: _,
            drawn,
        } = &self.buffers;
        let rows = (pool.len() + drawn.len()) as u64 * ROW_BYTES;
        let all = (self.placed.records.len() as u64) * record + self.placed.ranges.len() as u64 * 4;
        [all, rows + touched.len() as u64 * 4]
    }

    /// Sets the numbers of the meadow's current tick, whose colliding and active tiles are so many, and
    /// makes room for its slabs.
    pub(super) fn take_in(
        &mut self,
        gpu: &Gpu,
        meadow: &Meadow,
        [colliding, active]: [u32; 2],
    ) -> Result<(), GpuError> {
        let slabs = meadow.tiles.slabs.high_water() as usize;
        let rows = self.slab_rows();
        if slabs * rows > self.buffers.pool.len() {
            let limit = meadow.tiles.slabs.limit() as usize;
            let room = slabs.next_power_of_two().min(limit).max(slabs);
            self.buffers.pool.grow_to(gpu, room * rows)?;
        }
        let settings = Settings::<f32>::new(&meadow.scene.solver);
        self.turns = BillboardTurns::new(meadow, &self.weave, &settings);
        let numbers = BoardUniform {
            slots: self.slots as u32,
            fewest_rounds: settings.fewest_rounds,
            most_rounds: settings.most_rounds,
            passes: settings.passes,
            rate_step: settings.rate_step as f32,
            bend_step: settings.bend_step as f32,
            strain_limit: settings.strain_limit,
            collide_sweeps: self.turns.collide.sweeps,
            relax_rounds: self.turns.relax.sweeps,
            spare_a: 0,
            spare_b: [0; 2],
        };
        self.buffers.numbers.write(gpu, 0, &[numbers])?;
        let listed = TOUCHED_HEADER as usize + 2 * colliding as usize * self.slots;
        self.buffers.touched.grow_to(gpu, listed)?;
        let across = (self.slots as u32).div_ceil(WORKGROUP);
        let groups = &self.buffers.groups;
        groups.write(gpu, COLLIDE_GROUPS as usize, &[across, colliding, 1])?;
        groups.write(gpu, RECOVER_GROUPS as usize, &[across, active, 1])
    }

    /// Gives woken tiles a wiped slab with the records of their billboards.
    pub(super) fn assign_slabs(&self, encoder: &mut wgpu::CommandEncoder, meadow: &Meadow) {
        let bytes = self.slab_rows() as u64 * ROW_BYTES;
        for &(tile, slab) in &meadow.changes.woken {
            let pool = &self.buffers.pool.raw;
            encoder.clear_buffer(pool, u64::from(slab) * bytes, Some(bytes));
            self.copy_records(encoder, meadow, tile, slab);
        }
    }

    fn copy_records(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        meadow: &Meadow,
        tile: TileId,
        slab: u32,
    ) {
        let Some(field) = &meadow.field.billboards else {
            return;
        };
        let ends = [tile, tile + 1].map(|end| u64::from(field.ranges[end as usize]));
        let record = RECORD_ROWS as u64 * ROW_BYTES;
        if ends[0] < ends[1] {
            encoder.copy_buffer_to_buffer(
                &self.placed.records.raw,
                ends[0] * record,
                &self.buffers.pool.raw,
                u64::from(slab) * self.slab_rows() as u64 * ROW_BYTES,
                (ends[1] - ends[0]) * record,
            );
        }
    }

    pub(super) fn collide(&self, gpu: &Gpu, into: &mut Recording<'_>, around: Around<'_>) {
        let (boards, turns) = (&self.buffers, self.turns);
        (self.passes.collide).record(gpu, into, boards, around, turns.collide);
    }

    pub(super) fn relax(&self, gpu: &Gpu, into: &mut Recording<'_>, around: Around<'_>) {
        let (boards, turns) = (&self.buffers, self.turns);
        (self.passes.relax).record(gpu, into, boards, around, turns.relax);
    }

    /// Notes whether the driver cut loops short, to be known a frame or two later.
    pub(super) fn record_cut_short(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let touched = &self.buffers.touched.raw;
        self.cut_short.record(encoder, touched, CUT_SHORT_BYTE);
    }

    /// Writes the nodes of active tiles' billboards as they stand after the last tick.
    pub(super) fn recover(
        &mut self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        grass: &super::grass_buffers::GrassBuffers,
    ) -> Result<(), GpuError> {
        let slabs = self.buffers.pool.len() / self.slab_rows();
        let rows = slabs * self.drawn_rows();
        self.buffers.drawn.grow_to(gpu, rows)?;
        (self.passes.recover).record(gpu, into, &self.buffers, grass);
        Ok(())
    }

    /// What is read back of the billboards in slabs: their states.
    pub(super) fn parts(&self, slabs: &[u32]) -> Result<Vec<Part<'_>>, GpuError> {
        let [first, end] = [self.slots * RECORD_ROWS, self.slab_rows()];
        let slabs = slabs.iter().map(|&slab| slab as usize * end);
        let runs: Vec<_> = slabs.map(|slab| slab + first..slab + end).collect();
        self.buffers.pool.parts(&runs)
    }

    /// The states of active tiles' billboards by slab, from the rows of [`GpuBillboards::parts`].
    pub(super) fn unpack(&self, meadow: &Meadow, rows: &[[u32; 4]]) -> Vec<Option<Slab<f32>>> {
        let tiles = &meadow.work.tiles;
        let high = tiles.iter().map(|tile| tile.slab as usize + 1).max();
        let mut slabs = vec![None; high.unwrap_or(0)];
        let of_tiles = rows.chunks_exact(self.slots * self.rows_each());
        for (tile, rows) in tiles.iter().zip(of_tiles) {
            let count = meadow.field.billboards_in(tile.tile).len();
            slabs[tile.slab as usize] = (count > 0).then(|| self.slab_of(count, rows));
        }
        slabs
    }

    fn slab_of(&self, count: usize, rows: &[[u32; 4]]) -> Slab<f32> {
        let movable = self.weave.grid.movable();
        let mut slab = Slab::new(count, movable);
        for (place, rows) in rows.chunks_exact(self.rows_each()).take(count).enumerate() {
            slab.touched_at[place] = rows[0][0];
            for (n, &[x, y, z, face]) in rows[1..=movable].iter().enumerate() {
                let at = place * movable + n;
                slab.offsets[at] = Vec3::of_f32([x, y, z].map(f32::from_bits));
                slab.faces[at] = face;
            }
        }
        slab
    }

    /// The header of the list of touched billboards. Waits for the device.
    pub(super) fn read_header(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        self.buffers.touched.read(gpu, TOUCHED_HEADER as usize)
    }

    /// Takes over the state of a tile's billboards from another engine.
    pub(super) fn upload(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        meadow: &Meadow,
        (tile, number): (TileId, u32),
        slab: &Slab<f32>,
    ) -> Result<(), GpuError> {
        self.copy_records(encoder, meadow, tile, number);
        let movable = self.weave.grid.movable();
        let mut rows = Vec::with_capacity(slab.touched_at.len() * self.rows_each());
        for (place, &touched_at) in slab.touched_at.iter().enumerate() {
            rows.push([touched_at, 0, 0, 0]);
            let nodes = place * movable..(place + 1) * movable;
            for (offset, face) in slab.offsets[nodes.clone()].iter().zip(&slab.faces[nodes]) {
                let [x, y, z] = offset.to_f32().map(f32::to_bits);
                rows.push([x, y, z, *face]);
            }
            rows.resize((place + 1) * self.rows_each(), [0; 4]);
        }
        let first = number as usize * self.slab_rows() + self.slots * RECORD_ROWS;
        self.buffers.pool.write(gpu, first, &rows)
    }
}

impl BillboardBuffers {
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let storage = BufferUsages::STORAGE;
        let indirect = storage | BufferUsages::INDIRECT;
        let header = TOUCHED_HEADER as usize;
        Ok(Self {
            pool: Buffer::new(gpu, "billboards of active tiles", 0, storage)?,
            numbers: Buffer::new(gpu, "numbers of billboards", 1, BufferUsages::UNIFORM)?,
            touched: Buffer::new(gpu, "touched billboards", header, storage)?,
            groups: Buffer::new(gpu, "workgroups of billboards", 9, indirect)?,
            drawn: Buffer::new(gpu, "drawn nodes of billboards", 0, storage)?,
        })
    }
}
