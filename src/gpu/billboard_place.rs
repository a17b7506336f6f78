//! Billboards on the device: laid out once per scene from its maps, one buffer, tiles as ranges.
//! Shader: `shaders/billboard_place.wgsl`; twin: `src/field/billboards/seeds.rs`.

use wgpu::BufferUsages;

use super::passes::{Access, Groups, Kernel, MOST_GROUPS, Recording, WORKGROUP};
use super::sum_rows::{RowSums, Rows};
use super::{Buffer, FieldBuffers, Gpu, GpuError, PassTimer};
use crate::field::Field;
use crate::field::billboards::{BillboardSeeds, ClumpNumbers, MAX_CLUMPS, PackedBillboard};
use crate::field::grid::ANCHOR_CELLS;
use crate::gpu_struct;

/// Tiles whose billboards one workgroup sums up.
pub const ROW_TILES: u32 = 4096;
/// Kernels that are timed.
const KERNELS: usize = 4;

gpu_struct! {
    /// Twin of `ClumpUniform` in the shader.
    pub struct ClumpUniform {
        pub height: [u32; 2],
        pub width: [u32; 2],
        pub share_below: u32,
        pub flexibility: u32,
        pub spare: [u32; 2],
    }
}

gpu_struct! {
    /// Twin of `BillboardUniform` in the shader.
    pub struct BillboardUniform {
        pub tiles: [u32; 2],
        pub map_texels: [u32; 2],
        pub map_step: u32,
        pub anchors: u32,
        pub halvings: u32,
        pub sure: u32,
        pub one_more: u32,
        pub places: u32,
        pub key: u32,
        pub kind_count: u32,
        pub wide: u32,
        pub spare_a: u32,
        pub spare_b: [u32; 2],
        pub kinds: [ClumpUniform; MAX_CLUMPS],
    }
}

gpu_struct! {
    /// Twin of `BillboardRecord` in `shaders/shared/billboard.wgsl`: a billboard at rest, in 32 bytes.
    pub struct BillboardRecord {
        pub root: [f32; 3],
        pub size: u32,
        pub up: u32,
        pub across: u32,
        pub sway: u32,
        pub tile_and_texture: u32,
    }
}

impl From<&ClumpNumbers> for ClumpUniform {
    fn from(kind: &ClumpNumbers) -> Self {
        Self {
            height: kind.height,
            width: kind.width,
            share_below: kind.share_below,
            flexibility: kind.flexibility,
            spare: [0; 2],
        }
    }
}

impl From<&BillboardRecord> for PackedBillboard {
    fn from(record: &BillboardRecord) -> Self {
        Self {
            root_in_anchor: record.root,
            size: record.size,
            up: record.up,
            across: record.across,
            sway: record.sway,
            tile_and_texture: record.tile_and_texture,
        }
    }
}

impl BillboardUniform {
    fn new(seeds: &BillboardSeeds) -> Self {
        let grid = &seeds.grid;
        let mut kinds = [ClumpUniform::from(&ClumpNumbers::default()); MAX_CLUMPS];
        for (place, kind) in kinds.iter_mut().zip(&seeds.kinds) {
            *place = kind.into();
        }
        Self {
            tiles: grid.tiles,
            map_texels: [seeds.map.columns, seeds.map.rows],
            map_step: seeds.on_map.step,
            anchors: anchors(seeds)[0],
            halvings: grid.halvings,
            sure: grid.sure_plants,
            one_more: grid.one_more,
            places: grid.plants_per_tile(),
            key: seeds.key,
            kind_count: seeds.kinds.len() as u32,
            wide: groups(grid.tile_count())[0] * WORKGROUP,
            spare_a: 0,
            spare_b: [0; 2],
            kinds,
        }
    }
}

/// Anchors along x and z.
fn anchors(seeds: &BillboardSeeds) -> [u32; 2] {
    let cells = seeds.grid.tiles.map(|n| n * seeds.grid.tile_cells);
    cells.map(|n| n.div_ceil(ANCHOR_CELLS))
}

/// Places of the anchors' origins on the map along x, then along z.
fn anchors_on_map(seeds: &BillboardSeeds) -> Vec<u32> {
    let along = |count: u32| (0..count).map(|n| seeds.on_map.nth_anchor(&seeds.grid, n));
    let [x, z] = anchors(seeds);
    along(x).chain(along(z)).collect()
}

/// Workgroups of one invocation a tile.
fn groups(tiles: u32) -> [u32; 3] {
    let all = tiles.div_ceil(WORKGROUP).max(1);
    let wide = all.min(MOST_GROUPS);
    [wide, all.div_ceil(wide), 1]
}

/// The compiled pass.
#[derive(Clone, Debug)]
pub struct BillboardPlacing {
    field: wgpu::BindGroupLayout,
    count: Kernel,
    place: Kernel,
    sums: RowSums,
}

/// The billboards of a scene on the device, all at rest.
#[derive(Clone, Debug)]
pub struct PlacedBillboards {
    /// Tile by tile.
    pub records: Buffer<BillboardRecord>,
    /// Where the billboards of every tile begin, and their number as the last one. Longer than that.
    pub ranges: Buffer<u32>,
    pub count: u32,
    pub tiles: u32,
}

/// What the kernels work on, and what only they need.
struct Laying {
    uniform: Buffer<BillboardUniform>,
    map: Buffer<[u32; 2]>,
    anchors: Buffer<u32>,
    /// Tiles of every row of sums; then rows.
    row_length: Buffer<u32>,
    row_count: Buffer<u32>,
    ranges: Buffer<u32>,
    rows_before: Buffer<u32>,
    count: Buffer<u32>,
    rows: u32,
    groups: [u32; 3],
}

impl Laying {
    fn new(gpu: &Gpu, seeds: &BillboardSeeds) -> Result<Self, GpuError> {
        let storage = BufferUsages::STORAGE;
        let tiles = seeds.grid.tile_count();
        let rows = tiles.div_ceil(ROW_TILES).max(1);
        let uniform = [BillboardUniform::new(seeds)];
        let texels = &seeds.map.texels;
        let anchors = anchors_on_map(seeds);
        // One more than whole rows, for the end of the last tile.
        let range_count = rows as usize * ROW_TILES as usize + 1;
        Ok(Self {
            uniform: Buffer::with(gpu, "billboards", &uniform, BufferUsages::UNIFORM)?,
            map: Buffer::with(gpu, "the maps of billboards", texels, storage)?,
            anchors: Buffer::with(gpu, "anchors on the maps of billboards", &anchors, storage)?,
            row_length: Buffer::with(gpu, "tiles of a row", &[ROW_TILES], storage)?,
            row_count: Buffer::with(gpu, "rows of tiles", &[rows], storage)?,
            ranges: Buffer::new(gpu, "billboards of tiles", range_count, storage)?,
            rows_before: Buffer::new(gpu, "billboards of rows", rows as usize, storage)?,
            count: Buffer::new(gpu, "number of billboards", 1, storage)?,
            rows,
            groups: groups(tiles),
        })
    }

    /// Bindings that both kernels have.
    fn shared(&self) -> [(u32, &wgpu::Buffer); 4] {
        [
            (0, &self.uniform.raw),
            (1, &self.map.raw),
            (2, &self.anchors.raw),
            (3, &self.ranges.raw),
        ]
    }
}

impl BillboardPlacing {
    /// # Errors
    /// A shader that the driver refuses.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let (uniform, read, write) = (Access::Uniform, Access::Read, Access::Write);
        let shared = [(0, uniform), (1, read), (2, read), (3, write)];
        let kernel = |name, more: &[(u32, Access)]| {
            let bindings = [&shared[..], more].concat();
            Kernel::new(gpu, "billboard_place.wgsl", name, &bindings, WORKGROUP)
        };
        Ok(Self {
            field: FieldBuffers::layout(gpu),
            count: kernel("count_billboards", &[])?,
            place: kernel("place_billboards", &[(4, read), (5, write)])?,
            sums: RowSums::new(gpu)?,
        })
    }

    /// Lays out the billboards of a field that has some; `None` for one that has none. Waits for the
    /// device once, to learn how many there are.
    ///
    /// # Errors
    /// Maps, tiles or billboards that the device cannot bind, with its limit.
    pub fn lay_out(&self, gpu: &Gpu, field: &Field) -> Result<Option<PlacedBillboards>, GpuError> {
        let Some(billboards) = &field.billboards else {
            return Ok(None);
        };
        let buffers = FieldBuffers::new(gpu, &self.field, field)?;
        let laying = Laying::new(gpu, &billboards.seeds)?;
        let timer = &mut PassTimer::new(gpu, KERNELS);
        submit(gpu, timer, &buffers, |into| {
            self.record_count(gpu, into, &laying)
        });
        let count = laying.count.read(gpu, 1)?;
        let count = count.first().copied().unwrap_or(0);
        let storage = BufferUsages::STORAGE;
        let records = Buffer::new(gpu, "billboard records", count as usize, storage)?;
        submit(gpu, timer, &buffers, |into| {
            let own = [(4, &laying.rows_before.raw), (5, &records.raw)];
            let bound = self.place.bind(gpu, &[&laying.shared()[..], &own].concat());
            self.place
                .record(into, &bound, Groups::Direct(laying.groups));
        });
        Ok(Some(PlacedBillboards {
            records,
            ranges: laying.ranges,
            count,
            tiles: billboards.seeds.grid.tile_count(),
        }))
    }

    fn record_count(&self, gpu: &Gpu, into: &mut Recording<'_>, laying: &Laying) {
        let counted = self.count.bind(gpu, &laying.shared());
        self.count
            .record(into, &counted, Groups::Direct(laying.groups));
        let in_rows = Rows {
            length: &laying.row_length,
            rows: &laying.ranges,
            totals: &laying.rows_before,
            count: laying.rows,
        };
        self.sums.record(gpu, into, in_rows);
        let of_rows = Rows {
            length: &laying.row_count,
            rows: &laying.rows_before,
            totals: &laying.count,
            count: 1,
        };
        self.sums.record(gpu, into, of_rows);
    }
}

fn submit(
    gpu: &Gpu,
    timer: &mut PassTimer,
    field: &FieldBuffers,
    record: impl FnOnce(&mut Recording<'_>),
) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    record(&mut Recording {
        encoder: &mut encoder,
        timer,
        field,
    });
    gpu.queue.submit([encoder.finish()]);
}
