//! The first stage of drawing plants (P15 section 3.5): the device finds the plants that are seen
//! and sorts them into one range per form and detail, which the second stage draws indirectly;
//! nothing is read back. Shader: `shaders/sort_plants.wgsl`.
//!
//! Kernels live as long as the renderer, the lists grow with the largest frame.

use wgpu::BufferUsages;

use crate::field::plant::MAX_SPECIES;
use crate::gpu::passes::{Access, Groups, Kernel, MOST_GROUPS, Recording, WORKGROUP};
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::gpu_struct;

use super::SHADERS;
use super::blade_tiles::{BladeDetail, Count, DrawnTile, Size};
use super::blades::TUFT_RADIUS_M;
use super::camera::View;
use super::plant_form::{BUCKETS, DETAILS, FORM_COUNT, FORMS};

/// A candidate that is not seen.
pub(super) const NO_BUCKET: u32 = 255;
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
        spare_a: f32,
        spare_b: [f32; 2],
    }
}

gpu_struct! {
    pub(super) struct SortUniform {
        clip_from_eye: [[f32; 4]; 4],
        clip_reach: [f32; 2],
        reach_m: f32,
        tuft_m: f32,
        jobs: u32,
        groups_wide: u32,
        spare: [u32; 2],
        count: CountUniform,
        forms: [[u32; 4]; MAX_SPECIES / 4],
        vertices: [[u32; DETAILS as usize]; FORM_COUNT as usize],
    }
}

gpu_struct! {
    pub(super) struct Job {
        tile: u32,
        first_rank: u32,
    }
}

gpu_struct! {
    pub(super) struct DrawArgs {
        pub(super) vertices: u32,
        pub(super) instances: u32,
        first_vertex: u32,
        first_instance: u32,
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
    /// Form of each kind.
    pub(super) forms: &'a [u32],
    /// Segments of a plant.
    pub(super) segments: u32,
    pub(super) tiles: &'a [DrawnTile],
}

/// The lists on the device.
#[derive(Debug)]
pub(super) struct PlantSort {
    list: Kernel,
    sum: Kernel,
    sort: Kernel,
    uniform: Buffer<SortUniform>,
    jobs: Buffer<Job>,
    candidates: Buffer<[u32; 4]>,
    slots: Buffer<u32>,
    job_counts: Buffer<u32>,
    pub(super) tiles: Buffer<DrawnTile>,
    pub(super) totals: Buffer<u32>,
    pub(super) sorted: Buffer<[u32; 4]>,
    pub(super) draws: Buffer<DrawArgs>,
    /// Jobs of this frame.
    count: u32,
}

impl PlantSort {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let (read, write) = (Access::Read, Access::Write);
        let kernel = |name, bindings: &[(u32, Access)]| {
            Kernel::of_library(gpu, SHADERS, "sort_plants.wgsl", name, bindings, WORKGROUP)
        };
        let storage = BufferUsages::STORAGE;
        let buckets = BUCKETS as usize;
        Ok(Self {
            list: kernel(
                "list_plants",
                &[
                    (0, Access::Uniform),
                    (1, read),
                    (2, read),
                    (3, write),
                    (4, write),
                    (8, write),
                ],
            )?,
            sum: kernel("sum_jobs", &[(0, Access::Uniform), (4, write), (5, write)])?,
            sort: kernel(
                "sort_plants",
                &[
                    (0, Access::Uniform),
                    (3, write),
                    (4, write),
                    (5, write),
                    (6, write),
                    (7, write),
                    (8, write),
                ],
            )?,
            uniform: Buffer::new(gpu, "plant sorting", 1, BufferUsages::UNIFORM)?,
            jobs: Buffer::new(gpu, "plant jobs", 1024, storage)?,
            candidates: Buffer::new(gpu, "plant candidates", 0, storage)?,
            slots: Buffer::new(gpu, "buckets of plant candidates", 0, storage)?,
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
            count: 0,
        })
    }

    /// Nothing to sort in the next frame.
    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Lists a frame's jobs. Returns true if a buffer was replaced that the second stage binds.
    ///
    /// # Errors
    /// More plants than the device can list.
    pub(super) fn write(&mut self, gpu: &Gpu, input: &SortInput<'_>) -> Result<bool, GpuError> {
        let jobs: Vec<Job> = (0..)
            .zip(input.tiles)
            .flat_map(|(tile, drawn)| {
                let firsts = (0..drawn.ranks).step_by(WORKGROUP as usize);
                firsts.map(move |first_rank| Job { tile, first_rank })
            })
            .collect();
        self.count = jobs.len() as u32;
        self.jobs.write_or_grow(gpu, &jobs)?;
        let places = jobs.len() * WORKGROUP as usize;
        reserve(gpu, &mut self.candidates, places)?;
        reserve(gpu, &mut self.slots, places)?;
        reserve(gpu, &mut self.job_counts, jobs.len() * BUCKETS as usize)?;
        let grown =
            self.tiles.write_or_grow(gpu, input.tiles)? | reserve(gpu, &mut self.sorted, places)?;
        self.uniform
            .write(gpu, 0, &[sort_uniform(input, self.count)])?;
        Ok(grown)
    }

    /// Records the three kernels.
    pub(super) fn record(&self, gpu: &Gpu, into: &mut Recording<'_>) {
        if self.is_empty() {
            return;
        }
        let (uniform, counts) = (&self.uniform.raw, &self.job_counts.raw);
        let (candidates, totals) = (&self.candidates.raw, &self.totals.raw);
        let wide = self.count.min(MOST_GROUPS);
        let groups = Groups::Direct([wide, self.count.div_ceil(wide), 1]);
        let listed = self.list.bind(
            gpu,
            &[
                (0, uniform),
                (1, &self.tiles.raw),
                (2, &self.jobs.raw),
                (3, candidates),
                (4, counts),
                (8, &self.slots.raw),
            ],
        );
        self.list.record(into, &listed, groups);
        let summed = (self.sum).bind(gpu, &[(0, uniform), (4, counts), (5, totals)]);
        self.sum
            .record(into, &summed, Groups::Direct([BUCKETS, 1, 1]));
        let sorted = self.sort.bind(
            gpu,
            &[
                (0, uniform),
                (3, candidates),
                (4, counts),
                (5, totals),
                (6, &self.sorted.raw),
                (7, &self.draws.raw),
                (8, &self.slots.raw),
            ],
        );
        self.sort.record(into, &sorted, groups);
    }
}

/// Makes room without keeping what was there. Returns true if the buffer was replaced.
fn reserve<T: bytemuck::Pod>(
    gpu: &Gpu,
    buffer: &mut Buffer<T>,
    len: usize,
) -> Result<bool, GpuError> {
    if len <= buffer.len() {
        return Ok(false);
    }
    *buffer = buffer
        .of_len(gpu, len + len / 2)
        .or_else(|_| buffer.of_len(gpu, len))?;
    Ok(true)
}

fn sort_uniform(input: &SortInput<'_>, jobs: u32) -> SortUniform {
    let clip_from_eye = input.view.clip_from_eye(input.picture.aspect());
    let rows = clip_from_eye.transpose();
    let length = |row: glam::Vec4| row.truncate().length();
    let ahead = length(rows.w_axis);
    let mut forms = [[0; 4]; MAX_SPECIES / 4];
    for (kind, &form) in input.forms.iter().enumerate() {
        forms[kind / 4][kind % 4] = form;
    }
    SortUniform {
        clip_from_eye: clip_from_eye.to_cols_array_2d(),
        clip_reach: [length(rows.x_axis) + ahead, length(rows.y_axis) + ahead],
        reach_m: input.detail.reach_m,
        tuft_m: TUFT_RADIUS_M,
        jobs,
        groups_wide: jobs.clamp(1, MOST_GROUPS),
        spare: [0; 2],
        count: count_uniform(input),
        forms,
        vertices: FORMS.map(|form| {
            [0, 1, 2, 3].map(|detail| {
                let [_, steps] = form.steps(detail, input.segments);
                (form.vertices)(steps)
            })
        }),
    }
}

fn count_uniform(input: &SortInput<'_>) -> CountUniform {
    let (rule, per_px) = match input.detail.count {
        Count::Distance => (COUNT_BY_DISTANCE, 0.0),
        Count::ProjectedArea { per_px } => (COUNT_BY_PROJECTED_AREA, per_px),
        Count::WorldArea { per_px } => (COUNT_BY_WORLD_AREA, per_px),
    };
    CountUniform {
        right: input.view.right().to_f32(),
        pixel_rad: input.view.pixel_rad(input.picture.rows),
        up: input.view.up().to_f32(),
        per_px,
        forward: input.view.forward.to_f32(),
        rule,
        most: input.most,
        spare_a: 0.0,
        spare_b: [0.0; 2],
    }
}
