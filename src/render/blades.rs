//! Blades of grass (P15 sections 2.3, 2.4). Shader: `shaders/blades.wgsl`.
//!
//! A plant is drawn as a tuft: the simulated blade, and companions that move with it. Near by every
//! one is drawn; `blade_tiles.rs` says how many farther off.

use wgpu::{BufferUsages, ShaderStages};

use crate::field::{Field, MAX_SEGMENTS, TileId, WindNow};
use crate::gpu::field_data::FieldBuffers;
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::gpu_struct;

use super::blade_tiles::{Band, BladeDetail, DrawnTile, bands_in_sight};
use super::camera::View;
use super::ground_look::GroundTexture;
use super::pipeline::{Drawing, READ_STORAGE, UNIFORM, bind_group, group_layout};
use super::view_group::ViewGroups;

/// The grass as a whole, as far as the light is concerned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Canopy {
    /// Height of the tallest kind, 0 where nothing grows.
    pub(super) height_m: f32,
    /// Share of the ground's sky that plants hide, 0 to 1.
    pub(super) cover: f32,
}

impl Canopy {
    pub(super) fn of(field: &Field) -> Self {
        if field.is_bare() {
            return Self {
                height_m: 0.0,
                cover: 0.0,
            };
        }
        let kinds = &field.seeds.species;
        let mean = |[low, span]: [f32; 2]| low + 0.5 * span;
        let area_m2: f32 = kinds
            .iter()
            .map(|kind| mean(kind.height_m) * mean(kind.width_m))
            .sum::<f32>()
            / kinds.len() as f32;
        let cell_m2 = field.grid.cell_m * field.grid.cell_m;
        // Companions are thinner and shorter: two of them hide about as much as a plant.
        let per_m2 = 2.0 * field.grid.plants_per_triangle() as f32 / cell_m2 * 2.0;
        Self {
            height_m: field.reach_m,
            // Beer's law for leaves that stand at random angles.
            cover: 1.0 - (-area_m2 * per_m2).exp(),
        }
    }
}

gpu_struct! {
    pub(super) struct BladeLook {
        map_m: [f32; 2],
        cover: f32,
        reach_m: f32,
        samples: u32,
        spare_a: u32,
        spare_b: [u32; 2],
    }
}

/// Vertices reserved per band: two per segment of the longest blade, and its tip.
const BAND_VERTICES: u32 = 64;
const _: () = assert!(2 * (MAX_SEGMENTS as u32) < BAND_VERTICES);
/// Companions stand at most this far from their plant's root, in metres.
pub(super) const TUFT_RADIUS_M: f32 = 0.045;
/// Range of a companion's turn about its plant's root, in turns.
pub(super) const TUFT_TURNS: f32 = 0.16;
/// What grows, and what of it is awake.
#[derive(Clone, Copy, Debug)]
pub struct BladesInput<'a> {
    pub field: &'a Field,
    pub wind: &'a WindNow,
    /// Active tiles with their slabs, in the order of their ids.
    pub active: &'a [(TileId, u32)],
    /// Nodes of the active tiles' plants in their anchors, as
    /// [`GpuGrass::drawn`](crate::gpu::GpuGrass::drawn) or [`ActiveNodes`](super::ActiveNodes)
    /// lays them out: a row per node, root first.
    pub active_nodes: &'a Buffer<[f32; 4]>,
    pub detail: BladeDetail,
}

/// Counts of a frame, for panels and benches.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct BladeCounts {
    pub tiles: u64,
    pub blades: u64,
    pub triangles: u64,
}

impl BladeCounts {
    fn add(&mut self, band: &Band, drawn: &[DrawnTile]) {
        let blades = drawn.iter().map(|tile| tile.blades.ceil() as u64);
        let blades: u64 = blades.map(|count| count.min(u64::from(band.blades))).sum();
        self.tiles += drawn.len() as u64;
        self.blades += blades;
        self.triangles += blades * u64::from(2 * band.steps - 1);
    }
}

/// What belongs to one field.
#[derive(Debug)]
struct BladeScene {
    buffers: FieldBuffers,
    colour: GroundTexture,
    cover: f32,
    group: Option<(wgpu::Buffer, wgpu::BindGroup)>,
}

/// Draws the blades.
#[derive(Debug)]
pub(super) struct BladesLayer {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    field_layout: wgpu::BindGroupLayout,
    look: Buffer<BladeLook>,
    bands: Buffer<Band>,
    tiles: Buffer<DrawnTile>,
    scene: Option<BladeScene>,
    /// Vertices and instances of each band's draw call.
    draws: Vec<(std::ops::Range<u32>, std::ops::Range<u32>)>,
    pub(super) counts: BladeCounts,
    samples: u32,
}

impl BladesLayer {
    pub(super) fn new(gpu: &Gpu, groups: &ViewGroups, samples: u32) -> Result<Self, GpuError> {
        let (vertex, fragment) = (ShaderStages::VERTEX, ShaderStages::FRAGMENT);
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let layout = group_layout(
            gpu,
            "blades",
            &[
                (vertex | fragment, UNIFORM),
                (vertex, READ_STORAGE),
                (vertex, READ_STORAGE),
                (vertex, READ_STORAGE),
                (vertex, texture),
                (vertex, sampler),
            ],
        );
        let field_layout = FieldBuffers::layout(gpu);
        let mut used = groups.lit(&layout);
        used[0] = Some(&field_layout);
        let pipeline = Drawing {
            shader: "blades.wgsl",
            vertex: "blade_vertex",
            fragment: "blade_fragment",
            groups: used,
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            samples,
            alpha_to_coverage: samples > 1,
            ..Drawing::default()
        }
        .pipeline(gpu)?;
        Ok(Self {
            pipeline,
            field_layout,
            look: Buffer::new(gpu, "blade look", 1, BufferUsages::UNIFORM)?,
            bands: Buffer::new(gpu, "blade bands", 32, BufferUsages::STORAGE)?,
            tiles: Buffer::new(gpu, "drawn tiles", 1024, BufferUsages::STORAGE)?,
            layout,
            scene: None,
            draws: Vec::new(),
            counts: BladeCounts::default(),
            samples,
        })
    }

    /// Takes a field in place of the old one.
    ///
    /// # Errors
    /// A field larger than the device can bind.
    pub(super) fn set_field(
        &mut self,
        gpu: &Gpu,
        field: &Field,
        colour: &GroundTexture,
    ) -> Result<(), GpuError> {
        self.clear();
        self.scene = None;
        if !field.is_bare() {
            self.scene = Some(BladeScene {
                buffers: FieldBuffers::new(gpu, &self.field_layout, field)?,
                colour: colour.clone(),
                cover: Canopy::of(field).cover,
                group: None,
            });
        }
        Ok(())
    }

    /// Leaves the blades out of the next frame.
    pub(super) fn clear(&mut self) {
        self.draws.clear();
        self.counts = BladeCounts::default();
    }

    /// Lists what this frame draws.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        view: &View,
        aspect: f32,
        input: &BladesInput<'_>,
    ) -> Result<(), GpuError> {
        self.clear();
        let Some(scene) = &mut self.scene else {
            return Ok(());
        };
        scene.buffers.set_wind(gpu, input.wind)?;
        let look = BladeLook {
            map_m: scene.colour.size_m,
            cover: scene.cover,
            reach_m: input.detail.reach_m,
            samples: self.samples,
            spare_a: 0,
            spare_b: [0; 2],
        };
        self.look.write(gpu, 0, &[look])?;

        let mut bands: Vec<Band> = Vec::new();
        let mut tiles: Vec<DrawnTile> = Vec::new();
        for (band, drawn) in bands_in_sight(input, view, aspect) {
            let first = bands.len() as u32 * BAND_VERTICES;
            let vertices = first..first + 2 * band.steps + 1;
            self.draws
                .push((vertices, 0..drawn.len() as u32 * band.blades));
            bands.push(Band {
                first_tile: tiles.len() as u32,
                ..band
            });
            self.counts.add(&band, &drawn);
            tiles.extend(drawn);
        }
        let grown =
            self.bands.write_or_grow(gpu, &bands)? | self.tiles.write_or_grow(gpu, &tiles)?;
        let known = scene.group.as_ref().map(|(nodes, _)| nodes);
        if grown || known != Some(&input.active_nodes.raw) {
            let group = bind_group(
                gpu,
                "blades",
                &self.layout,
                &[
                    self.look.binding(),
                    self.bands.binding(),
                    self.tiles.binding(),
                    input.active_nodes.binding(),
                    wgpu::BindingResource::TextureView(&scene.colour.view),
                    wgpu::BindingResource::Sampler(&scene.colour.sampler),
                ],
            );
            scene.group = Some((input.active_nodes.raw.clone(), group));
        }
        Ok(())
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(scene) = &self.scene else {
            return;
        };
        let Some((_, group)) = &scene.group else {
            return;
        };
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &scene.buffers.bind_group, &[]);
        pass.set_bind_group(3, group, &[]);
        for (vertices, instances) in &self.draws {
            pass.draw(vertices.clone(), instances.clone());
        }
    }
}
