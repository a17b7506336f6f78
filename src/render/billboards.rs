//! Billboards: quads that stand for clumps of grass (O09 section 6). In tiles at rest they are drawn straight
//! from the records that the device laid out (pass RU), in tiles that are awake from the nodes of their
//! refined forms (pass RA). Shader: `shaders/billboards.wgsl`.
//!
//! Everything here lives as long as a scene has billboards: one without them has none of it. Per frame the
//! processor lists runs of tiles in view, near to far, and nothing per billboard.

use std::ops::Range;
use std::sync::Arc;

use wgpu::{BufferUsages, ShaderStages};

use crate::field::Field;
use crate::field::billboards::{BillboardField, MAX_CLUMPS};
use crate::gpu::billboard_place::{BillboardPlacing, BillboardRecord};
use crate::gpu::{Buffer, FieldBuffers, Gpu, GpuError};
use crate::gpu_struct;

use super::billboard_runs::{BillboardTile, Sight};
use super::billboard_surface::{SurfaceTap, taps, triangles};
use super::blade_tiles::Size;
use super::camera::View;
use super::canopy::Canopy;
use super::clump_textures::ClumpTextures;
use super::error::RenderError;
use super::ground_look::GroundTexture;
use super::pipeline::{Drawing, READ_STORAGE, SAMPLER, TEXTURE, UNIFORM, bind_group, group_layout};
use super::plants::BladesInput;
use super::view_group::ViewGroups;

/// How much further than blades billboards are drawn: two triangles stand for a whole clump.
const REACH_SHARE: f32 = 3.0;

gpu_struct! {
    /// Twin of `BillboardLook` in the shader.
    pub(super) struct BillboardLook {
        map_m: [f32; 2],
        cover: f32,
        reach_m: f32,
        samples: u32,
        spare: u32,
        nodes: [u32; 2],
        steps: [u32; 2],
        spare_b: [u32; 2],
        tints: [[f32; 4]; MAX_CLUMPS],
    }
}

/// The two forms of a billboard, each with a pass of its own.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum BillboardForm {
    /// Of tiles at rest.
    Quad,
    /// Of tiles that are awake.
    Refined,
}

impl BillboardForm {
    /// The name under which its pass is timed.
    pub(super) fn pass(self) -> &'static str {
        match self {
            Self::Quad => "billboards RU",
            Self::Refined => "billboards RA",
        }
    }
}

/// What a frame drew of the billboards.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct BillboardCounts {
    /// Tiles in view that have some and are drawn.
    pub tiles: u64,
    /// Tiles in view that are left out since the ground hides them.
    pub hidden_tiles: u64,
    /// Those of them that are awake, drawn from the nodes of refined forms.
    pub refined_tiles: u64,
    pub billboards: u64,
    /// Those of them in tiles that are awake.
    pub refined: u64,
    /// Draw calls: runs of consecutive tiles.
    pub draws: u64,
    /// Bytes on the device: records, tiles and the refined surface's tables; nodes of the refined forms in
    /// awake tiles; and pictures with their mip levels.
    pub state_bytes: u64,
    pub nodes_bytes: u64,
    pub picture_bytes: u64,
}

/// What all billboards of a scene are drawn from, but the nodes of a frame.
#[derive(Debug)]
struct Sources {
    layout: wgpu::BindGroupLayout,
    look: Buffer<BillboardLook>,
    records: Buffer<BillboardRecord>,
    tiles: Buffer<BillboardTile>,
    colour: GroundTexture,
    textures: ClumpTextures,
    taps: Buffer<SurfaceTap>,
}

impl Sources {
    fn group(&self, gpu: &Gpu, nodes: &Buffer<[f32; 4]>) -> wgpu::BindGroup {
        bind_group(
            gpu,
            "billboards",
            &self.layout,
            &[
                self.look.binding(),
                self.records.binding(),
                self.tiles.binding(),
                wgpu::BindingResource::TextureView(&self.colour.view),
                wgpu::BindingResource::Sampler(&self.colour.sampler),
                wgpu::BindingResource::TextureView(&self.textures.view),
                wgpu::BindingResource::Sampler(&self.textures.sampler),
                nodes.binding(),
                self.taps.binding(),
            ],
        )
    }
}

/// Draws the billboards of a scene that has some.
#[derive(Debug)]
pub(super) struct BillboardsLayer {
    quads: wgpu::RenderPipeline,
    refined: wgpu::RenderPipeline,
    field: Arc<BillboardField>,
    buffers: FieldBuffers,
    sources: Sources,
    /// Corners of a refined form's triangles.
    triangles: Buffer<u32>,
    /// What is bound where no tile is awake.
    no_nodes: Buffer<[f32; 4]>,
    /// The nodes of the last frame, and what binds them.
    group: (wgpu::Buffer, wgpu::BindGroup),
    base: BillboardLook,
    quad_runs: Vec<Range<u32>>,
    refined_runs: Vec<Range<u32>>,
    pub(super) counts: BillboardCounts,
}

impl BillboardsLayer {
    /// A layer for a field that has billboards; none for one that has none.
    ///
    /// # Errors
    /// More pictures or billboards than the device can hold.
    pub(super) fn of(
        gpu: &Gpu,
        groups: &ViewGroups,
        samples: u32,
        field: &Field,
        buffers: &FieldBuffers,
        colour: &GroundTexture,
    ) -> Result<Option<Self>, RenderError> {
        let Some(billboards) = &field.billboards else {
            return Ok(None);
        };
        let Some(placed) = BillboardPlacing::new(gpu)?.lay_out(gpu, field)? else {
            return Ok(None);
        };
        let storage = BufferUsages::STORAGE;
        let subdivision = billboards.draw_subdivision.max(1);
        let drawn: Vec<SurfaceTap> = (billboards.nodes.iter())
            .flat_map(|&nodes| taps(nodes, subdivision))
            .collect();
        let base = look_of(field, billboards, colour, samples);
        let sources = Sources {
            layout: layout(gpu),
            look: Buffer::new(gpu, "look of billboards", 1, BufferUsages::UNIFORM)?,
            tiles: Buffer::new(gpu, "tiles of billboards", placed.tiles as usize, storage)?,
            records: placed.records,
            colour: colour.clone(),
            textures: ClumpTextures::new(gpu, &billboards.clumps)?,
            taps: Buffer::with(gpu, "surfaces of billboards", &drawn, storage)?,
        };
        let corners = triangles(base.steps);
        let triangles = Buffer::with(
            gpu,
            "triangles of billboards",
            &corners,
            BufferUsages::INDEX,
        )?;
        let counts = BillboardCounts {
            state_bytes: u64::from(placed.count) * size_of::<BillboardRecord>() as u64
                + u64::from(placed.tiles) * size_of::<BillboardTile>() as u64
                + size_of_val(&drawn[..]) as u64
                + size_of_val(&corners[..]) as u64,
            picture_bytes: sources.textures.bytes,
            ..BillboardCounts::default()
        };
        let pipeline = |vertex| pipeline(gpu, groups, &sources.layout, samples, vertex);
        let no_nodes = Buffer::new(gpu, "no nodes of billboards", 1, storage)?;
        Ok(Some(Self {
            quads: pipeline("quad_vertex")?,
            refined: pipeline("refined_vertex")?,
            field: Arc::clone(billboards),
            buffers: buffers.clone(),
            group: (no_nodes.raw.clone(), sources.group(gpu, &no_nodes)),
            sources,
            triangles,
            no_nodes,
            base,
            quad_runs: Vec::new(),
            refined_runs: Vec::new(),
            counts,
        }))
    }

    /// Leaves the billboards out of the next frame.
    pub(super) fn clear(&mut self) {
        self.quad_runs.clear();
        self.refined_runs.clear();
        self.counts = BillboardCounts {
            state_bytes: self.counts.state_bytes,
            picture_bytes: self.counts.picture_bytes,
            ..BillboardCounts::default()
        };
    }

    /// Lists what this frame draws. The ground is drawn with errors of up to `error_px` pixels.
    ///
    /// # Errors
    /// The device's.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        view: &View,
        picture: Size,
        error_px: f32,
        blades: &BladesInput<'_>,
    ) -> Result<(), GpuError> {
        self.clear();
        let field = blades.field;
        self.buffers.set_wind(gpu, blades.wind)?;
        let reach_m = REACH_SHARE * blades.detail.reach_m;
        let look = BillboardLook {
            reach_m,
            ..self.base
        };
        self.sources.look.write(gpu, 0, &[look])?;
        let active = blades
            .billboards
            .filter(|_| self.field.draw_subdivision > 0);
        let nodes = active.map_or(&self.no_nodes, |active| active.nodes);
        self.counts.nodes_bytes = nodes.raw.size();
        if self.group.0 != nodes.raw {
            self.group = (nodes.raw.clone(), self.sources.group(gpu, nodes));
        }
        let sight = Sight {
            field,
            billboards: &self.field,
            view,
            picture,
            reach_m,
            error_px,
        };
        let mut tiles = sight.tiles();
        if blades.detail.drops_hidden {
            let found = tiles.len();
            sight.drop_hidden(&mut tiles);
            self.counts.hidden_tiles = (found - tiles.len()) as u64;
        }
        self.counts.tiles = tiles.len() as u64;
        for run in sight.runs(&tiles, active) {
            let count = u64::from(run.billboards.end - run.billboards.start);
            self.counts.draws += 1;
            self.counts.billboards += count;
            (self.sources.tiles).write(gpu, run.first as usize, &run.places)?;
            if run.is_refined {
                self.counts.refined_tiles += run.places.len() as u64;
                self.counts.refined += count;
                self.refined_runs.push(run.billboards);
            } else {
                self.quad_runs.push(run.billboards);
            }
        }
        Ok(())
    }

    /// Whether the next frame shows some of a form.
    pub(super) fn shows(&self, form: BillboardForm) -> bool {
        match form {
            BillboardForm::Quad => !self.quad_runs.is_empty(),
            BillboardForm::Refined => !self.refined_runs.is_empty(),
        }
    }

    /// Records the draws of a form.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, form: BillboardForm) {
        pass.set_bind_group(0, &self.buffers.bind_group, &[]);
        pass.set_bind_group(3, &self.group.1, &[]);
        match form {
            BillboardForm::Quad => {
                pass.set_pipeline(&self.quads);
                for run in &self.quad_runs {
                    pass.draw(0..6, run.clone());
                }
            }
            BillboardForm::Refined => {
                pass.set_pipeline(&self.refined);
                let corners = self.triangles.raw.slice(..);
                pass.set_index_buffer(corners, wgpu::IndexFormat::Uint32);
                for run in &self.refined_runs {
                    pass.draw_indexed(0..self.triangles.len() as u32, 0, run.clone());
                }
            }
        }
    }
}

fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let (vertex, fragment) = (ShaderStages::VERTEX, ShaderStages::FRAGMENT);
    let pictures = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2Array,
        multisampled: false,
    };
    group_layout(
        gpu,
        "billboards",
        &[
            (vertex | fragment, UNIFORM),
            (vertex, READ_STORAGE),
            (vertex, READ_STORAGE),
            (vertex, TEXTURE),
            (vertex, SAMPLER),
            (fragment, pictures),
            (fragment, SAMPLER),
            (vertex, READ_STORAGE),
            (vertex, READ_STORAGE),
        ],
    )
}

fn pipeline(
    gpu: &Gpu,
    groups: &ViewGroups,
    layout: &wgpu::BindGroupLayout,
    samples: u32,
    vertex: &str,
) -> Result<wgpu::RenderPipeline, GpuError> {
    let field_layout = FieldBuffers::layout(gpu);
    let mut used = groups.lit(layout);
    used[0] = Some(&field_layout);
    Drawing {
        shader: "billboards.wgsl",
        vertex,
        fragment: "billboard_fragment",
        groups: used,
        samples,
        alpha_to_coverage: samples > 1,
        ..Drawing::default()
    }
    .pipeline(gpu)
}

fn look_of(
    field: &Field,
    billboards: &BillboardField,
    colour: &GroundTexture,
    samples: u32,
) -> BillboardLook {
    let mut tints = [[1.0; 4]; MAX_CLUMPS];
    for (place, kind) in tints.iter_mut().zip(&billboards.clumps) {
        place[..3].copy_from_slice(&kind.tint_rgb);
    }
    BillboardLook {
        map_m: colour.size_m,
        cover: Canopy::of(field).cover,
        reach_m: 0.0,
        samples,
        spare: 0,
        nodes: billboards.nodes,
        steps: (billboards.nodes).map(|nodes| (nodes - 1) * billboards.draw_subdivision.max(1)),
        spare_b: [0; 2],
        tints,
    }
}
