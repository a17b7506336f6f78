//! The first stage of drawing plants (P15 section 3.5): the device finds the plants that are seen
//! and sorts them into one range per form and detail, which the second stage draws indirectly;
//! nothing is read back. Shader: `shaders/sort_plants.wgsl`.
//!
//! Kernels live as long as the renderer, the lists grow with the largest frame.

use wgpu::BufferUsages;

use crate::field::count::{BINS, Bins, clusters_in};
use crate::field::plant::MAX_SPECIES;
use crate::gpu::passes::{Access, Groups, Kernel, Recording, WORKGROUP};
use crate::gpu::sum_rows::{RowSums, Rows};
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::gpu_struct;

use super::SHADERS;
use super::blade_tiles::{BladeDetail, Count, DrawnTile, Size, Submission, Transition};
use super::blades::TUFT_RADIUS_M;
use super::camera::View;
use super::plant_form::{BUCKETS, DETAILS, FORM_COUNT, FORMS};
use super::seed_triangles::{LIST_GROUPS, SeedTriangles, SeededTriangles};

/// A cluster that is not seen, and one on bare ground.
pub(super) const NO_BUCKET: u32 = 63;
pub(super) const BARE_BUCKET: u32 = 62;
/// Rules of counting, as the shader knows them.
pub(super) const COUNT_BY_DISTANCE: u32 = 0;
pub(super) const COUNT_BY_PROJECTED_AREA: u32 = 1;
const COUNT_BY_WORLD_AREA: u32 = 2;
/// Plants smaller than this share of their size are left out.
pub(super) const LEAST_GROWN: f32 = 0.005;

gpu_struct! {
    pub(super) struct CountUniform {
        right: [f32; 3],
        pixel_rad: f32,
        up: [f32; 3],
        per_px: f32,
        forward: [f32; 3],
        rule: u32,
        most: f32,
        is_plain: u32,
        spare_a: [f32; 2],
        judge_from_eye: [f32; 3],
        spare_b: f32,
    }
}

impl CountUniform {
    /// P15 eq. 1 in a picture of this many rows; the ceiling is each triangle's own.
    pub(super) fn by_projected_area(view: &View, rows: u32, per_px: f32) -> Self {
        Self {
            right: view.right().to_f32(),
            pixel_rad: view.pixel_rad(rows),
            up: view.up().to_f32(),
            per_px,
            forward: view.forward.to_f32(),
            rule: COUNT_BY_PROJECTED_AREA,
            most: 0.0,
            is_plain: 0,
            spare_a: [0.0; 2],
            judge_from_eye: [0.0; 3],
            spare_b: 0.0,
        }
    }
}

gpu_struct! {
    pub(super) struct SortUniform {
        clip_from_eye: [[f32; 4]; 4],
        clip_reach: [f32; 2],
        reach_m: f32,
        tuft_m: f32,
        triangles: u32,
        triangle_groups: u32,
        triangle_groups_wide: u32,
        by_bins: u32,
        count: CountUniform,
        bins: [[f32; 4]; BINS / 4],
        forms: [[u32; 4]; MAX_SPECIES / 4],
        vertices: [[u32; DETAILS as usize]; FORM_COUNT as usize],
    }
}

gpu_struct! {
    pub(super) struct ClusterRecord {
        tile: u32,
        rank: u32,
        what: u32,
        members: u32,
        bucket: u32,
        before: u32,
        sizes: u32,
        end: f32,
        ramp: f32,
        index: u32,
        spare: [u32; 2],
    }
}

gpu_struct! {
    pub(super) struct DrawArgs {
        pub(super) vertices: u32,
        pub(super) instances: u32,
        first_vertex: u32,
        first_instance: u32,
        pub(super) start: u32,
    }
}

/// What a frame sorts.
#[derive(Clone, Copy, Debug)]
pub(super) struct SortInput<'a> {
    pub(super) view: &'a View,
    pub(super) picture: Size,
    pub(super) detail: BladeDetail,
    /// Plants of a triangle and their companions.
    pub(super) most: f32,
    pub(super) triangles_per_tile: u32,
    pub(super) plants_per_triangle: u32,
    /// Seeds of a cluster.
    pub(super) cluster: u32,
    /// Form of each kind.
    pub(super) forms: &'a [u32],
    /// Segments of a plant.
    pub(super) segments: u32,
    pub(super) tiles: &'a [DrawnTile],
}

/// What the first stage made of its clusters. The rest of those submitted are out of sight.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct SeededClusters {
    pub submitted: u64,
    /// On ground where nothing grows.
    pub bare: u64,
    /// With at least one plant that is drawn.
    pub drawn: u64,
}

impl SortInput<'_> {
    /// A number that a tile's clusters do not exceed.
    fn most_clusters(&self, tile: &DrawnTile) -> u32 {
        let places = tile.most_places / self.triangles_per_tile;
        clusters_in(places, self.plants_per_triangle, self.cluster) * self.triangles_per_tile
    }
}

/// The lists on the device.
#[derive(Debug)]
pub(super) struct PlantSort {
    triangles: SeedTriangles,
    sums: RowSums,
    list: Kernel,
    sort: Kernel,
    uniform: Buffer<SortUniform>,
    clusters: Buffer<ClusterRecord>,
    job_counts: Buffer<u32>,
    pub(super) tiles: Buffer<DrawnTile>,
    totals: Buffer<u32>,
    pub(super) sorted: Buffer<[u32; 4]>,
    pub(super) draws: Buffer<DrawArgs>,
    /// Whether the frame has tiles.
    has_tiles: bool,
}

impl PlantSort {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let (uniform, read, write) = (Access::Uniform, Access::Read, Access::Write);
        let kernel = |name, bindings: &[(u32, Access)]| {
            Kernel::of_library(gpu, SHADERS, "sort_plants.wgsl", name, bindings, WORKGROUP)
        };
        let listed = [
            (0, uniform),
            (1, read),
            (2, read),
            (3, read),
            (4, read),
            (5, write),
            (6, write),
        ];
        let sorted = [
            (0, uniform),
            (4, read),
            (5, write),
            (6, write),
            (7, read),
            (8, write),
            (9, write),
        ];
        let storage = BufferUsages::STORAGE;
        let buckets = BUCKETS as usize;
        Ok(Self {
            triangles: SeedTriangles::new(gpu)?,
            sums: RowSums::new(gpu)?,
            list: kernel("list_plants", &listed)?,
            sort: kernel("sort_plants", &sorted)?,
            uniform: Buffer::new(gpu, "plant sorting", 1, BufferUsages::UNIFORM)?,
            clusters: Buffer::new(gpu, "clusters of plants", 0, storage)?,
            job_counts: Buffer::new(gpu, "plants per job", 0, storage)?,
            tiles: Buffer::new(gpu, "drawn tiles", 1024, storage)?,
            totals: Buffer::new(gpu, "plants per bucket", buckets, storage)?,
            sorted: Buffer::new(gpu, "sorted plants", 0, storage)?,
            draws: Buffer::new(
                gpu,
                "plant draws",
                buckets,
                storage | BufferUsages::INDIRECT,
            )?,
            has_tiles: false,
        })
    }

    /// Nothing to sort in the next frame.
    pub(super) fn clear(&mut self) {
        self.has_tiles = false;
    }

    pub(super) fn is_empty(&self) -> bool {
        !self.has_tiles
    }

    /// Lists a frame's tiles. Returns true if a buffer was replaced that the second stage binds.
    ///
    /// # Errors
    /// More plants than the device can list.
    pub(super) fn write(&mut self, gpu: &Gpu, input: &SortInput<'_>) -> Result<bool, GpuError> {
        self.has_tiles = !input.tiles.is_empty();
        let triangles = input.tiles.len() as u32 * input.triangles_per_tile;
        let submission = input.detail.submission;
        self.triangles.write(gpu, submission, triangles)?;
        let places: usize = (input.tiles.iter())
            .map(|tile| tile.most_places as usize)
            .sum();
        let clusters: usize = (input.tiles.iter())
            .map(|tile| input.most_clusters(tile) as usize)
            .sum();
        // One job at least says that there is nothing to draw.
        let jobs = clusters.div_ceil(WORKGROUP as usize).max(1);
        (self.clusters).reserve(gpu, jobs * WORKGROUP as usize)?;
        self.job_counts.reserve(gpu, jobs * BUCKETS as usize)?;
        let grown = self.tiles.write_or_grow(gpu, input.tiles)?
            | self.sorted.reserve(gpu, places.max(1))?;
        let uniform = self.uniform(input, triangles);
        self.uniform.write(gpu, 0, &[uniform])?;
        Ok(grown)
    }

    /// Records the kernels of the first stage.
    pub(super) fn record(&self, gpu: &Gpu, into: &mut Recording<'_>) {
        if self.is_empty() {
            return;
        }
        let (uniform, triangles) = (&self.uniform.raw, &self.triangles);
        triangles.record(gpu, into, &self.sums, uniform, &self.tiles);
        let (list, counts) = (&triangles.list, &self.job_counts.raw);
        let clusters = &self.clusters.raw;
        let groups = Groups::Indirect(list, LIST_GROUPS);
        let listed = self.list.bind(
            gpu,
            &[
                (0, uniform),
                (1, &self.tiles.raw),
                (2, &triangles.triangles.raw),
                (3, &triangles.order().raw),
                (4, &list.raw),
                (5, clusters),
                (6, counts),
            ],
        );
        self.list.record(into, &listed, groups);
        let of_buckets = Rows {
            length: list,
            rows: &self.job_counts,
            totals: &self.totals,
            count: BUCKETS,
        };
        self.sums.record(gpu, into, of_buckets);
        let sorted = self.sort.bind(
            gpu,
            &[
                (0, uniform),
                (4, &list.raw),
                (5, clusters),
                (6, counts),
                (7, &self.totals.raw),
                (8, &self.sorted.raw),
                (9, &self.draws.raw),
            ],
        );
        self.sort.record(into, &sorted, groups);
    }

    /// Reads back what the last frame made of its triangles. Waits for the device.
    ///
    /// # Errors
    /// The device's.
    pub(super) fn read_triangles(&self, gpu: &Gpu) -> Result<SeededTriangles, GpuError> {
        if self.is_empty() {
            return Ok(SeededTriangles::default());
        }
        self.triangles.read(gpu)
    }

    /// Reads back what the last frame made of its clusters. Waits for the device.
    ///
    /// # Errors
    /// The device's.
    pub(super) fn read_clusters(&self, gpu: &Gpu) -> Result<SeededClusters, GpuError> {
        let submitted = self.read_triangles(gpu)?.clusters;
        let records = self.clusters.read(gpu, submitted as usize)?;
        let count = |is_one: fn(&&ClusterRecord) -> bool| records.iter().filter(is_one).count();
        Ok(SeededClusters {
            submitted,
            bare: count(|record| record.bucket == BARE_BUCKET) as u64,
            drawn: count(|record| record.bucket < BUCKETS) as u64,
        })
    }

    fn uniform(&self, input: &SortInput<'_>, triangles: u32) -> SortUniform {
        let clip_from_eye = input.view.clip_from_eye(input.picture.aspect());
        let mut forms = [[0; 4]; MAX_SPECIES / 4];
        for (kind, &form) in input.forms.iter().enumerate() {
            forms[kind / 4][kind % 4] = form;
        }
        let bins = Bins::up_to(input.most);
        SortUniform {
            clip_from_eye: clip_from_eye.to_cols_array_2d(),
            clip_reach: input.view.clip_reach(input.picture.aspect()),
            reach_m: input.detail.reach_m,
            tuft_m: TUFT_RADIUS_M,
            triangles,
            triangle_groups: self.triangles.group_count,
            triangle_groups_wide: self.triangles.groups_wide(),
            by_bins: u32::from(input.detail.submission == Submission::Bins),
            count: count_uniform(input),
            bins: std::array::from_fn(|row| std::array::from_fn(|i| bins.centres[4 * row + i])),
            forms,
            vertices: FORMS.map(|form| {
                [0, 1, 2, 3].map(|detail| {
                    let [_, steps] = form.steps(detail, input.segments);
                    (form.vertices)(steps)
                })
            }),
        }
    }
}

fn count_uniform(input: &SortInput<'_>) -> CountUniform {
    let (rule, per_px) = match input.detail.count {
        Count::Distance => (COUNT_BY_DISTANCE, 0.0),
        Count::ProjectedArea { per_px } => (COUNT_BY_PROJECTED_AREA, per_px),
        Count::WorldArea { per_px } => (COUNT_BY_WORLD_AREA, per_px),
    };
    let per_px = per_px * input.detail.density;
    CountUniform {
        rule,
        most: input.most,
        is_plain: u32::from(input.detail.transition == Transition::Plain),
        judge_from_eye: (input.detail.judged_from)
            .map_or([0.0; 3], |place| input.view.from_eye(place)),
        ..CountUniform::by_projected_area(input.view, input.picture.rows, per_px)
    }
}
