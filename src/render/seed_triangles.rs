//! The list of clusters in which a frame looks for plants: P15 section 3.2, on the device.
//!
//! Every seeding triangle of the tiles in view gets its count of clusters, its own or that of its bin
//! ([`Submission`](super::Submission)). Shader: `shaders/seed_triangles.wgsl`. The buffers grow with
//! the largest frame.

use wgpu::BufferUsages;

use crate::field::count::BINS;
use crate::gpu::passes::{Access, Groups, Kernel, MOST_GROUPS, Recording, WORKGROUP};
use crate::gpu::sum_rows::{RowSums, Rows};
use crate::gpu::{Buffer, Gpu, GpuError};

use super::SHADERS;
use super::blade_tiles::{DrawnTile, Submission};

/// Words of the list's head: its jobs (WORKGROUP clusters each), the workgroups that take them (three
/// words), its clusters, the cluster at which each bin ends, the triangles before each bin.
pub(super) const LIST_JOBS: u32 = 0;
pub(super) const LIST_GROUPS: u32 = 1;
pub(super) const LIST_CLUSTERS: u32 = 4;
pub(super) const LIST_BIN_ENDS: u32 = 8;
pub(super) const LIST_BIN_TRIANGLES: u32 = LIST_BIN_ENDS + BINS as u32;
const LIST_WORDS: usize = LIST_BIN_TRIANGLES as usize + BINS;
/// A triangle without clusters.
pub(super) const NO_BIN: u32 = 255;

/// The list and what it is made with.
#[derive(Debug)]
pub(super) struct SeedTriangles {
    count: Kernel,
    order: Kernel,
    size: Kernel,
    rows: Buffer<u32>,
    totals: Buffer<u32>,
    order_of_bins: Buffer<u32>,
    groups: Buffer<u32>,
    pub(super) triangles: Buffer<[u32; 2]>,
    pub(super) list: Buffer<u32>,
    /// This frame's.
    submission: Submission,
    triangle_count: u32,
    pub(super) group_count: u32,
}

impl SeedTriangles {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let (uniform, read, write) = (Access::Uniform, Access::Read, Access::Write);
        let kernel = |name, bindings: &[(u32, Access)], workgroup| {
            let file = "seed_triangles.wgsl";
            Kernel::of_library(gpu, SHADERS, file, name, bindings, workgroup)
        };
        let storage = BufferUsages::STORAGE;
        let ordered = [(0, uniform), (2, write), (3, write), (4, write), (5, write)];
        Ok(Self {
            count: kernel(
                "count_triangles",
                &[(0, uniform), (1, read), (2, write), (3, write)],
                WORKGROUP,
            )?,
            order: kernel("order_triangles", &ordered, WORKGROUP)?,
            size: kernel(
                "size_list",
                &[(0, uniform), (4, write), (6, write)],
                WORKGROUP,
            )?,
            rows: Buffer::new(gpu, "clusters per group of triangles", 0, storage)?,
            totals: Buffer::new(gpu, "triangles per bin", BINS, storage)?,
            order_of_bins: Buffer::new(gpu, "triangles by bin", 0, storage)?,
            groups: Buffer::new(gpu, "groups of triangles", 1, storage)?,
            triangles: Buffer::new(gpu, "triangles in view", 0, storage)?,
            list: Buffer::new(
                gpu,
                "list of clusters",
                LIST_WORDS,
                storage | BufferUsages::INDIRECT,
            )?,
            submission: Submission::Exact,
            triangle_count: 0,
            group_count: 0,
        })
    }

    /// Makes room for a frame.
    ///
    /// # Errors
    /// More triangles than the device can hold.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        submission: Submission,
        triangles: u32,
    ) -> Result<(), GpuError> {
        self.submission = submission;
        self.triangle_count = triangles;
        self.group_count = triangles.div_ceil(WORKGROUP);
        self.groups.write(gpu, 0, &[self.group_count])?;
        let groups = self.group_count as usize;
        self.triangles.reserve(gpu, groups * WORKGROUP as usize)?;
        self.rows.reserve(gpu, groups * self.row_count() as usize)?;
        if submission == Submission::Bins {
            self.order_of_bins.reserve(gpu, triangles as usize)?;
        }
        Ok(())
    }

    fn row_count(&self) -> u32 {
        match self.submission {
            Submission::Exact => 1,
            Submission::Bins => BINS as u32,
        }
    }

    /// Workgroups side by side.
    pub(super) fn groups_wide(&self) -> u32 {
        self.group_count.clamp(1, MOST_GROUPS)
    }

    /// Where the triangles of the list's clusters are looked up.
    pub(super) fn order(&self) -> &Buffer<u32> {
        match self.submission {
            Submission::Exact => &self.rows,
            Submission::Bins => &self.order_of_bins,
        }
    }

    /// Records the kernels; `uniform` is the frame's.
    pub(super) fn record(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        sums: &RowSums,
        uniform: &wgpu::Buffer,
        tiles: &Buffer<DrawnTile>,
    ) {
        let (triangles, rows) = (&self.triangles.raw, &self.rows.raw);
        let totals = &self.totals.raw;
        let wide = self.groups_wide();
        let groups = Groups::Direct([wide, self.group_count.div_ceil(wide), 1]);
        let counted = self.count.bind(
            gpu,
            &[(0, uniform), (1, &tiles.raw), (2, triangles), (3, rows)],
        );
        self.count.record(into, &counted, groups);
        let of_groups = Rows {
            length: &self.groups,
            rows: &self.rows,
            totals: &self.totals,
            count: self.row_count(),
        };
        sums.record(gpu, into, of_groups);
        if self.submission == Submission::Bins {
            let order = &self.order_of_bins.raw;
            let ordered = self.order.bind(
                gpu,
                &[
                    (0, uniform),
                    (2, triangles),
                    (3, rows),
                    (4, totals),
                    (5, order),
                ],
            );
            self.order.record(into, &ordered, groups);
        }
        let sized = self
            .size
            .bind(gpu, &[(0, uniform), (4, totals), (6, &self.list.raw)]);
        self.size.record(into, &sized, Groups::Direct([1, 1, 1]));
    }

    /// The counts that the last frame gave its triangles, and the clusters in its list. Waits for the
    /// device.
    ///
    /// # Errors
    /// The device's.
    pub(super) fn read(&self, gpu: &Gpu) -> Result<SeededTriangles, GpuError> {
        let triangles = self.triangles.read(gpu, self.triangle_count as usize)?;
        let list = self.list.read(gpu, LIST_WORDS)?;
        Ok(SeededTriangles {
            counts: triangles.iter().map(|t| f32::from_bits(t[0])).collect(),
            clusters: u64::from(list[LIST_CLUSTERS as usize]),
        })
    }
}

/// What the first stage made of the seeding triangles in view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SeededTriangles {
    /// Plants and companions of every triangle of the tiles in view, with their fractions.
    pub counts: Vec<f32>,
    /// Clusters that were looked at for plants: as many as places where seeds lie alone.
    pub clusters: u64,
}
