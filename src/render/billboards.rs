//! Billboards: quads that stand for clumps of grass, drawn straight from the records that the device laid
//! out (O09 section 6). Shader: `shaders/billboards.wgsl`.
//!
//! Everything here lives as long as a scene has billboards: one without them has none of it. Per frame the
//! processor lists runs of tiles in view, near to far, and nothing per billboard.

use std::ops::Range;
use std::sync::Arc;

use wgpu::{BufferUsages, ShaderStages};

use crate::base::Vec3;
use crate::field::billboards::{BillboardField, MAX_CLUMPS};
use crate::field::{Field, TileId};
use crate::gpu::billboard_place::{BillboardPlacing, BillboardRecord};
use crate::gpu::{Buffer, FieldBuffers, Gpu, GpuError};
use crate::gpu_struct;
use crate::scene::ClumpKind;

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
        spare_a: u32,
        spare_b: [u32; 2],
        tints: [[f32; 4]; MAX_CLUMPS],
    }
}

gpu_struct! {
    /// Twin of `BillboardTile` in the shader.
    pub(super) struct BillboardTile {
        anchor_from_eye: [f32; 3],
        spare: u32,
        anchor: [u32; 2],
        spare_b: [u32; 2],
    }
}

/// What a frame drew of the billboards.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct BillboardCounts {
    /// Tiles in view that have some.
    pub tiles: u64,
    pub billboards: u64,
    /// Draw calls: runs of consecutive tiles.
    pub draws: u64,
    /// Bytes on the device: records, tiles, and pictures with their mip levels.
    pub state_bytes: u64,
    pub picture_bytes: u64,
}

/// Draws the billboards of a scene that has some.
#[derive(Debug)]
pub(super) struct BillboardsLayer {
    pipeline: wgpu::RenderPipeline,
    field: Arc<BillboardField>,
    buffers: FieldBuffers,
    look: Buffer<BillboardLook>,
    tiles: Buffer<BillboardTile>,
    group: wgpu::BindGroup,
    base: BillboardLook,
    runs: Vec<Range<u32>>,
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
        let layout = layout(gpu);
        let textures = ClumpTextures::new(gpu, &billboards.clumps)?;
        let storage = BufferUsages::STORAGE;
        let look = Buffer::new(gpu, "look of billboards", 1, BufferUsages::UNIFORM)?;
        let tiles = Buffer::new(gpu, "tiles of billboards", placed.tiles as usize, storage)?;
        let group = bind_group(
            gpu,
            "billboards",
            &layout,
            &[
                look.binding(),
                placed.records.binding(),
                tiles.binding(),
                wgpu::BindingResource::TextureView(&colour.view),
                wgpu::BindingResource::Sampler(&colour.sampler),
                wgpu::BindingResource::TextureView(&textures.view),
                wgpu::BindingResource::Sampler(&textures.sampler),
            ],
        );
        let counts = BillboardCounts {
            state_bytes: u64::from(placed.count) * size_of::<BillboardRecord>() as u64
                + u64::from(placed.tiles) * size_of::<BillboardTile>() as u64,
            picture_bytes: textures.bytes,
            ..BillboardCounts::default()
        };
        Ok(Some(Self {
            pipeline: pipeline(gpu, groups, &layout, samples)?,
            field: Arc::clone(billboards),
            buffers: buffers.clone(),
            base: look_of(field, &billboards.clumps, colour, samples),
            look,
            tiles,
            group,
            runs: Vec::new(),
            counts,
        }))
    }

    /// Leaves the billboards out of the next frame.
    pub(super) fn clear(&mut self) {
        self.runs.clear();
        self.counts = BillboardCounts {
            tiles: 0,
            billboards: 0,
            draws: 0,
            ..self.counts
        };
    }

    /// Lists what this frame draws.
    ///
    /// # Errors
    /// The device's.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        view: &View,
        picture: Size,
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
        self.look.write(gpu, 0, &[look])?;
        let margin_m = (2.0 * field.grid.tile_m()) + self.field.reach_m;
        let viewpoint = view.viewpoint(picture.aspect(), picture.rows);
        let mut seen = field.tiles_in_view(&viewpoint, reach_m + margin_m);
        seen.retain(|&tile| !self.field.range(tile).is_empty());
        seen.sort_unstable();
        self.counts.tiles = seen.len() as u64;
        let mut runs: Vec<(f64, Range<u32>)> = Vec::new();
        for run in seen.chunk_by(|a, b| a + 1 == *b) {
            let places: Vec<BillboardTile> = run
                .iter()
                .map(|&tile| place_of(field, view, tile))
                .collect();
            self.tiles.write(gpu, run[0] as usize, &places)?;
            let first = self.field.ranges[run[0] as usize];
            let end = self.field.ranges[run[run.len() - 1] as usize + 1];
            self.counts.billboards += u64::from(end - first);
            runs.push((nearest_m(&places), first..end));
        }
        // Near to far, so that what is hidden is not shaded.
        runs.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.counts.draws = runs.len() as u64;
        self.runs = runs.into_iter().map(|(_, run)| run).collect();
        Ok(())
    }

    /// Whether the next frame shows any.
    pub(super) fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Records the draws.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.buffers.bind_group, &[]);
        pass.set_bind_group(3, &self.group, &[]);
        for run in &self.runs {
            pass.draw(0..6, run.clone());
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
        ],
    )
}

fn pipeline(
    gpu: &Gpu,
    groups: &ViewGroups,
    layout: &wgpu::BindGroupLayout,
    samples: u32,
) -> Result<wgpu::RenderPipeline, GpuError> {
    let field_layout = FieldBuffers::layout(gpu);
    let mut used = groups.lit(layout);
    used[0] = Some(&field_layout);
    Drawing {
        shader: "billboards.wgsl",
        vertex: "billboard_vertex",
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
    clumps: &[ClumpKind],
    colour: &GroundTexture,
    samples: u32,
) -> BillboardLook {
    let mut tints = [[1.0; 4]; MAX_CLUMPS];
    for (place, kind) in tints.iter_mut().zip(clumps) {
        place[..3].copy_from_slice(&kind.tint_rgb);
    }
    BillboardLook {
        map_m: colour.size_m,
        cover: Canopy::of(field).cover,
        reach_m: 0.0,
        samples,
        spare_a: 0,
        spare_b: [0; 2],
        tints,
    }
}

fn place_of(field: &Field, view: &View, tile: TileId) -> BillboardTile {
    let anchor = field.grid.anchor_of(tile, &field.ground);
    let origin = Vec3::of(field.grid.anchor_in_world(&anchor, &field.ground));
    BillboardTile {
        anchor_from_eye: view.from_eye(origin),
        spare: 0,
        anchor: anchor.index,
        spare_b: [0; 2],
    }
}

/// Distance of the nearest of some anchors from the eye.
fn nearest_m(places: &[BillboardTile]) -> f64 {
    let away = |place: &BillboardTile| Vec3::<f64>::of_f32(place.anchor_from_eye).length();
    places
        .iter()
        .map(away)
        .fold(f64::INFINITY, crate::base::least)
}
