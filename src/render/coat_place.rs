//! The first stage of drawing coats: the device counts the plants of every triangle of the coated bodies
//! and places them, sorted by form and detail. Shader: `shaders/coat_place.wgsl`.
//!
//! Kernels live as long as a scene has coats, the lists grow with the largest frame.

use wgpu::BufferUsages;

use crate::gpu::passes::{Access, Groups, Kernel, MOST_GROUPS, Recording, WORKGROUP};
use crate::gpu::sum_rows::{RowSums, Rows};
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::gpu_struct;

use super::SHADERS;
use super::blade_tiles::Size;
use super::bodies::BodyInstance;
use super::camera::View;
use super::coat::{CoatDetail, DrawnCoats, STEPS};
use super::coat_scene::CoatScene;
use super::error::RenderError;
use super::sort_plants::CountUniform;

/// Forms of plants.
pub(super) const COAT_FORMS: u32 = 2;
/// Steps of detail, 0 the finest.
pub(super) const COAT_DETAILS: u32 = 3;
/// Ranges into which a frame's plants are sorted.
pub(super) const COAT_BUCKETS: u32 = COAT_FORMS * COAT_DETAILS;
/// Of a triangle without plants.
pub(super) const NO_COAT_BUCKET: u32 = 255;
/// Vertices reserved per bucket, so that a vertex tells its bucket.
pub(super) const COAT_VERTICES: u32 = 16;
/// Heights on the picture down to which plants have the finest detail, and the next, in pixels.
const DETAIL_PX: [f32; 2] = [28.0, 9.0];

gpu_struct! {
    /// Twin of `CoatBody` in `shaders/shared/coat.wgsl`.
    pub(super) struct CoatBody {
        turn: [f32; 4],
        place_from_eye: [f32; 3],
        first_number: u32,
        height_m: [f32; 2],
        width_m: [f32; 2],
        lean_turns: [f32; 2],
        key: u32,
        form: u32,
        rgb: [f32; 3],
        cover: f32,
        first_triangle: u32,
        spare_a: u32,
        spare_b: [u32; 2],
    }
}

gpu_struct! {
    /// Twin of `PlacedPlant` in `shaders/shared/coat.wgsl`: a plant of a coat, as a frame draws it.
    pub struct PlacedPlant {
        pub root_from_eye: [f32; 3],
        pub height_m: f32,
        pub direction: [f32; 3],
        pub width_m: f32,
        pub normal: [f32; 3],
        pub shade: u32,
        pub body: u32,
        pub triangle: u32,
        pub index: u32,
        pub tone: f32,
    }
}

gpu_struct! {
    /// Twin of `CoatView` in `shaders/coat_place.wgsl`.
    pub(super) struct CoatView {
        clip_from_eye: [[f32; 4]; 4],
        clip_reach: [f32; 2],
        bodies: u32,
        triangles: u32,
        groups: u32,
        groups_wide: u32,
        density: f32,
        spare: u32,
        count: CountUniform,
        detail_px: [f32; 4],
        vertices: [[u32; 4]; 2],
    }
}

/// What of a frame decides which plants are placed.
#[derive(Clone, Copy, Debug)]
pub(super) struct CoatFrame<'a> {
    pub(super) view: &'a View,
    pub(super) picture: Size,
    pub(super) bodies: &'a [BodyInstance],
    pub(super) detail: CoatDetail,
    /// Factor of every count.
    pub(super) density: f32,
}

/// The lists on the device.
#[derive(Debug)]
pub(super) struct CoatPlaces {
    count: Kernel,
    place: Kernel,
    size: Kernel,
    sums: RowSums,
    uniform: Buffer<CoatView>,
    pub(super) bodies: Buffer<CoatBody>,
    counted: Buffer<[u32; 2]>,
    rows: Buffer<u32>,
    groups: Buffer<u32>,
    pub(super) totals: Buffer<u32>,
    pub(super) placed: Buffer<PlacedPlant>,
    pub(super) draws: Buffer<[u32; 4]>,
    /// This frame's.
    triangle_count: u32,
    pub(super) forms: [bool; COAT_FORMS as usize],
}

impl CoatPlaces {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let (uniform, read, write) = (Access::Uniform, Access::Read, Access::Write);
        let kernel = |name, bindings: &[(u32, Access)]| {
            Kernel::of_library(gpu, SHADERS, "coat_place.wgsl", name, bindings, WORKGROUP)
        };
        let counted = [(0, uniform), (1, read), (2, read), (3, write), (4, write)];
        let placed = [
            (0, uniform),
            (1, read),
            (2, read),
            (3, write),
            (4, write),
            (5, read),
            (6, write),
        ];
        let storage = BufferUsages::STORAGE;
        let buckets = COAT_BUCKETS as usize;
        let indirect = storage | BufferUsages::INDIRECT;
        Ok(Self {
            count: kernel("count_coats", &counted)?,
            place: kernel("place_coats", &placed)?,
            size: kernel("size_coat_draws", &[(0, uniform), (5, read), (7, write)])?,
            sums: RowSums::new(gpu)?,
            uniform: Buffer::new(gpu, "coats in view", 1, BufferUsages::UNIFORM)?,
            bodies: Buffer::new(gpu, "coated bodies", 1, storage)?,
            counted: Buffer::new(gpu, "counts of coats", 0, storage)?,
            rows: Buffer::new(gpu, "plants per group of coats", 0, storage)?,
            groups: Buffer::new(gpu, "groups of coats", 1, storage)?,
            totals: Buffer::new(gpu, "plants of coats per bucket", buckets, storage)?,
            placed: Buffer::new(gpu, "placed plants of coats", 0, storage)?,
            draws: Buffer::new(gpu, "draws of coats", buckets, indirect)?,
            triangle_count: 0,
            forms: [false; COAT_FORMS as usize],
        })
    }

    /// Nothing to place in the next frame.
    pub(super) fn clear(&mut self) {
        self.triangle_count = 0;
        self.forms = [false; COAT_FORMS as usize];
    }

    /// Whether the frame has no coats.
    pub(super) fn is_empty(&self) -> bool {
        self.triangle_count == 0
    }

    /// Makes room for a frame and lists its coated bodies. Returns true if a buffer was replaced that
    /// the second stage binds.
    ///
    /// # Errors
    /// A body whose coat was not given; more plants than the device can list.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        scene: &CoatScene,
        frame: &CoatFrame<'_>,
    ) -> Result<bool, RenderError> {
        self.clear();
        let (mut records, mut plants) = (Vec::new(), 0);
        for (number, body) in frame.bodies.iter().enumerate() {
            let Some(index) = body.coat else {
                continue;
            };
            let coat = scene.coats.get(index as usize);
            let coat = coat.ok_or(RenderError::UnknownCoat {
                body: number,
                coat: index,
                known: scene.coats.len(),
            })?;
            if coat.triangles == 0 {
                continue;
            }
            records.push(CoatBody {
                turn: body.world_from_body.turn.cast::<f32>().to_array(),
                place_from_eye: frame.view.from_eye(body.world_from_body.place),
                first_number: self.triangle_count,
                height_m: coat.ranges.height_m,
                width_m: coat.ranges.width_m,
                lean_turns: coat.ranges.lean_turns,
                key: coat.ranges.key,
                form: coat.form,
                rgb: coat.rgb,
                cover: coat.cover,
                first_triangle: coat.first_triangle,
                spare_a: 0,
                spare_b: [0; 2],
            });
            self.triangle_count += coat.triangles;
            self.forms[coat.form as usize] = true;
            plants += coat.most_plants;
        }
        if records.is_empty() {
            return Ok(false);
        }
        let groups = self.triangle_count.div_ceil(WORKGROUP) as usize;
        self.counted.reserve(gpu, groups * WORKGROUP as usize)?;
        self.rows.reserve(gpu, groups * COAT_BUCKETS as usize)?;
        self.groups.write(gpu, 0, &[groups as u32])?;
        let uniform = self.uniform(frame, records.len() as u32);
        self.uniform.write(gpu, 0, &[uniform])?;
        let grown = self.bodies.write_or_grow(gpu, &records)?;
        Ok(self.placed.reserve(gpu, plants)? | grown)
    }

    fn uniform(&self, frame: &CoatFrame<'_>, bodies: u32) -> CoatView {
        let clip_from_eye = frame.view.clip_from_eye(frame.picture.aspect());
        let per_px = frame.detail.per_px * frame.density;
        let mut vertices = [[0; 4]; 2];
        for (bucket, steps) in STEPS.iter().flatten().enumerate() {
            vertices[bucket / 4][bucket % 4] = 2 * steps + 1;
        }
        let (groups, groups_wide) = self.groups();
        CoatView {
            clip_from_eye: clip_from_eye.to_cols_array_2d(),
            clip_reach: frame.view.clip_reach(frame.picture.aspect()),
            bodies,
            triangles: self.triangle_count,
            groups,
            groups_wide,
            density: frame.density.min(1.0),
            spare: 0,
            count: CountUniform::by_projected_area(frame.view, frame.picture.rows, per_px),
            detail_px: [DETAIL_PX[0], DETAIL_PX[1], 0.0, 0.0],
            vertices,
        }
    }

    /// Groups of triangles, and how many of them are dispatched side by side.
    fn groups(&self) -> (u32, u32) {
        let groups = self.triangle_count.div_ceil(WORKGROUP);
        (groups, groups.clamp(1, MOST_GROUPS))
    }

    /// Records the kernels.
    pub(super) fn record(&self, gpu: &Gpu, into: &mut Recording<'_>, scene: &CoatScene) {
        if self.is_empty() {
            return;
        }
        let (count, wide) = self.groups();
        let groups = Groups::Direct([wide, count.div_ceil(wide), 1]);
        let shared = [
            (0, &self.uniform.raw),
            (1, &self.bodies.raw),
            (2, &scene.triangles.raw),
            (3, &self.counted.raw),
            (4, &self.rows.raw),
        ];
        let counted = self.count.bind(gpu, &shared);
        self.count.record(into, &counted, groups);
        let rows = Rows {
            length: &self.groups,
            rows: &self.rows,
            totals: &self.totals,
            count: COAT_BUCKETS,
        };
        self.sums.record(gpu, into, rows);
        let outputs = [(5, &self.totals.raw), (6, &self.placed.raw)];
        let placed = self.place.bind(gpu, &[&shared[..], &outputs].concat());
        self.place.record(into, &placed, groups);
        let sized = [(0, &self.uniform.raw), outputs[0], (7, &self.draws.raw)];
        let sized = self.size.bind(gpu, &sized);
        self.size.record(into, &sized, Groups::Direct([1, 1, 1]));
    }

    /// What the last frame counted and placed. Waits for the device.
    ///
    /// # Errors
    /// The device's.
    pub(super) fn read(&self, gpu: &Gpu) -> Result<DrawnCoats, GpuError> {
        if self.is_empty() {
            return Ok(DrawnCoats::default());
        }
        let counted = self.counted.read(gpu, self.triangle_count as usize)?;
        let draws = self.draws.read(gpu, COAT_BUCKETS as usize)?;
        let plants: u32 = draws.iter().map(|[_, instances, ..]| instances).sum();
        let triangles =
            |[vertices, instances, ..]: &[u32; 4]| u64::from(vertices - 2) * u64::from(*instances);
        Ok(DrawnCoats {
            counts: counted.iter().map(|t| f32::from_bits(t[0])).collect(),
            triangles: draws.iter().map(triangles).sum(),
            plants: self.placed.read(gpu, plants as usize)?,
        })
    }
}
