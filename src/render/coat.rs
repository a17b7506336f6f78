//! Coats: plants on bodies, drawn in two stages as those of the ground are. Shader: `shaders/coat.wgsl`.
//!
//! Everything here lives as long as a scene has coats: one without them has none of it. Deviation of P15
//! section 3.6: coats cast no shadows of their own; the bodies under them do, and their plants receive
//! them.

use wgpu::{BufferUsages, ShaderStages};

use crate::gpu::passes::Recording;
use crate::gpu::{Buffer, FieldBuffers, Gpu, GpuError, PassTimer};
use crate::gpu_struct;

use super::bodies::BodyInstance;
use super::coat_place::{
    COAT_BUCKETS, COAT_DETAILS, COAT_FORMS, COAT_VERTICES, CoatFrame, CoatPlaces, PlacedPlant,
};
use super::coat_scene::CoatScene;
use super::error::RenderError;
use super::pipeline::{Drawing, READ_STORAGE, UNIFORM, bind_group, group_layout};
use super::view_group::ViewGroups;

/// Segments of a plant, by form and detail: by its height on the picture, in place of P15 eq. 4.
pub(super) const STEPS: [[u32; COAT_DETAILS as usize]; COAT_FORMS as usize] =
    [[5, 3, 2], [5, 3, 1]];

const _: () = assert!(2 * STEPS[0][0] < COAT_VERTICES && 2 * STEPS[1][0] < COAT_VERTICES);

/// Share of a coat's cover that shades its plants on average. The sun that is left at a depth d of it, 0 to
/// 1, is exp(-3.6 c d^1.4); the mean over all depths is that of 0.28 c to 0.32 c for covers of 1 to 0.7.
const OUTER_COVER: f32 = 0.3;

/// How many plants of coats are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatDetail {
    /// P15 eq. 1: plants per pixel of a triangle's projected area, up to all that it has.
    pub per_px: f32,
}

impl CoatDetail {
    /// What an adapter can draw in a moment: one on the processor pays about 1 µs per triangle.
    pub fn of_device(gpu: &Gpu) -> Self {
        let per_px = if gpu.adapter.is_software { 0.3 } else { 1.0 };
        Self { per_px }
    }

    /// # Errors
    /// A density that is not finite and above 0.
    pub(super) fn check(self) -> Result<(), RenderError> {
        if self.per_px.is_finite() && self.per_px > 0.0 {
            return Ok(());
        }
        Err(RenderError::BadInput {
            what: "the detail of the coats",
            found: format!("{self:?}"),
            wanted: "give a density above 0",
        })
    }
}

/// What a frame drew of the coats.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnCoats {
    /// Plants of every triangle of the coated bodies, with their fractions, body by body.
    pub counts: Vec<f32>,
    /// Drawn triangles of the plants.
    pub triangles: u64,
    /// By form and detail, then by triangle and index.
    pub plants: Vec<PlacedPlant>,
}

gpu_struct! {
    /// Twin of `CoatLook` in `shaders/coat.wgsl`.
    pub(super) struct CoatLook {
        steps: [[u32; 4]; 2],
        samples: u32,
        spare_a: u32,
        spare_b: [u32; 2],
    }
}

/// Draws the coats of a scene that has some.
#[derive(Debug)]
pub(super) struct CoatLayer {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    look: Buffer<CoatLook>,
    places: CoatPlaces,
    scene: CoatScene,
    field: FieldBuffers,
    group: Option<wgpu::BindGroup>,
}

impl CoatLayer {
    pub(super) fn new(
        gpu: &Gpu,
        groups: &ViewGroups,
        samples: u32,
        scene: CoatScene,
        field: FieldBuffers,
    ) -> Result<Self, GpuError> {
        let vertex = ShaderStages::VERTEX;
        let layout = group_layout(
            gpu,
            "coats",
            &[
                (ShaderStages::VERTEX_FRAGMENT, UNIFORM),
                (vertex, READ_STORAGE),
                (vertex, READ_STORAGE),
                (vertex, READ_STORAGE),
            ],
        );
        let pipeline = Drawing {
            shader: "coat.wgsl",
            vertex: "coat_vertex",
            fragment: "coat_fragment",
            groups: groups.lit(&layout),
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            samples,
            alpha_to_coverage: samples > 1,
            ..Drawing::default()
        }
        .pipeline(gpu)?;
        let mut steps = [[0; 4]; 2];
        for (bucket, &count) in STEPS.iter().flatten().enumerate() {
            steps[bucket / 4][bucket % 4] = count;
        }
        let look = CoatLook {
            steps,
            samples,
            spare_a: 0,
            spare_b: [0; 2],
        };
        Ok(Self {
            pipeline,
            look: Buffer::with(gpu, "look of coats", &[look], BufferUsages::UNIFORM)?,
            places: CoatPlaces::new(gpu)?,
            layout,
            scene,
            field,
            group: None,
        })
    }

    /// Takes other coats in place of the old ones, and keeps what is compiled.
    pub(super) fn set_scene(&mut self, scene: CoatScene, field: FieldBuffers) {
        self.scene = scene;
        self.field = field;
        self.places.clear();
    }

    /// Lists what this frame may draw.
    ///
    /// # Errors
    /// A body whose coat was not given; more plants than the device can list.
    pub(super) fn write(&mut self, gpu: &Gpu, frame: &CoatFrame<'_>) -> Result<(), RenderError> {
        frame.detail.check()?;
        let grown = self.places.write(gpu, &self.scene, frame)?;
        if grown || self.group.is_none() {
            self.group = Some(bind_group(
                gpu,
                "coats",
                &self.layout,
                &[
                    self.look.binding(),
                    self.places.bodies.binding(),
                    self.places.placed.binding(),
                    self.places.totals.binding(),
                ],
            ));
        }
        Ok(())
    }

    /// Records the first stage.
    pub(super) fn place(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        timer: &mut PassTimer,
    ) {
        let mut into = Recording {
            encoder,
            timer,
            field: &self.field,
        };
        self.places.record(gpu, &mut into, &self.scene);
    }

    /// Records the second stage.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(group) = self.group.as_ref().filter(|_| !self.places.is_empty()) else {
            return;
        };
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(3, group, &[]);
        for bucket in 0..COAT_BUCKETS {
            if self.places.forms[(bucket / COAT_DETAILS) as usize] {
                let offset = u64::from(bucket) * size_of::<[u32; 4]>() as u64;
                pass.draw_indirect(&self.places.draws.raw, offset);
            }
        }
    }

    /// What the last frame drew. Waits for the device.
    ///
    /// # Errors
    /// The device's.
    pub(super) fn read(&self, gpu: &Gpu) -> Result<DrawnCoats, GpuError> {
        self.places.read(gpu)
    }

    /// Share of the sky that its coat hides on a body's surface. Where plants are left out, those that
    /// are drawn stand for fewer layers, and what is seen between them is the coat too.
    pub(super) fn cover(&self, frame: &CoatFrame<'_>, body: &BodyInstance) -> f32 {
        let coat = (body.coat).and_then(|coat| self.scene.coats.get(coat as usize));
        let Some(coat) = coat else {
            return 0.0;
        };
        let away_m = (body.world_from_body.place - frame.view.eye_in_world).length() as f32;
        let pixel_m = away_m * frame.view.pixel_rad(frame.picture.rows);
        let drawn_per_m2 = frame.detail.per_px * frame.density / (pixel_m * pixel_m).max(1e-12);
        let share = (drawn_per_m2 / coat.per_m2.max(1e-6)).min(1.0);
        coat.cover * (OUTER_COVER + (1.0 - OUTER_COVER) * share)
    }
}
