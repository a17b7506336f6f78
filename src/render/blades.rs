//! Blades of grass (P15 sections 2.3, 2.4). Shader: `shaders/blades.wgsl`.
//!
//! Per frame the processor lists the tiles in sight, near to far, and nothing per plant. Tiles of
//! one band of distance share a draw call: they have the same number of segments, a subset of the
//! simulated nodes, and at most the same number of plants. How many plants of a tile are drawn
//! falls smoothly with its distance; they are a prefix of the tile's sequence, and their width
//! makes up for those left out.

use wgpu::{BufferUsages, ShaderStages};

use crate::base::Vec3;
use crate::field::{Bounds, Field, TileId, WindNow};
use crate::gpu::field_data::{FieldBuffers, TileRecord};
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::gpu_struct;

use super::camera::View;
use super::ground_look::GroundTexture;
use super::pipeline::{Drawing, READ_STORAGE, UNIFORM, bind_group, group_layout};
use super::view_group::ViewGroups;

/// How far and how finely blades are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BladeDetail {
    /// Distance up to which every plant is drawn, in metres.
    pub full_m: f32,
    /// Distance at which the last blades end and the ground takes over their look, in metres.
    pub reach_m: f32,
    /// Blades drawn per plant near by, at least 1: the simulated one and companions that move
    /// with it.
    pub tuft: u32,
}

impl Default for BladeDetail {
    fn default() -> Self {
        Self {
            full_m: 12.0,
            reach_m: 110.0,
            tuft: 4,
        }
    }
}

impl BladeDetail {
    /// For a rasteriser on the processor, which pays about 1 µs per triangle.
    pub fn software() -> Self {
        Self {
            full_m: 4.0,
            reach_m: 50.0,
            tuft: 3,
        }
    }

    /// Share of a tile's blades that is drawn at a distance: all of them near by, then falling
    /// so that every ring of equal width holds fewer blades than the one before it.
    fn share(self, distance_m: f64) -> f64 {
        (f64::from(self.full_m) / distance_m.max(1e-3))
            .powf(1.4)
            .min(1.0)
    }
}

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

gpu_struct! {
    pub(super) struct Band {
        first_tile: u32,
        blades: u32,
        stride: u32,
        steps: u32,
    }
}

gpu_struct! {
    pub(super) struct DrawnTile {
        tile: TileRecord,
        anchor_from_eye: [f32; 3],
        blades: f32,
        widen: f32,
        spare_a: f32,
        spare_b: [f32; 2],
    }
}

/// Vertices reserved per band: two per segment of the longest blade, and its tip.
const BAND_VERTICES: u32 = 64;
/// Distance of a band's end over that of its start.
const BAND_RATIO: f64 = std::f64::consts::SQRT_2;
/// Companions stand at most this far from their plant's root, in metres.
pub(super) const TUFT_RADIUS_M: f32 = 0.045;
/// Range of a companion's turn about its plant's root, in turns.
pub(super) const TUFT_TURNS: f32 = 0.16;
/// Active tiles are drawn as finely as others at this share of their distance, so that imprints
/// stay readable.
const ACTIVE_NEARNESS: f64 = 0.4;
/// Share of the lost cover that the remaining blades make up for by their width; the ground's
/// own look supplies the rest.
const WIDEN_POWER: f64 = 0.75;

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
        self.draws.clear();
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

    /// Lists what this frame draws.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        view: &View,
        aspect: f32,
        input: &BladesInput<'_>,
    ) -> Result<(), GpuError> {
        self.draws.clear();
        self.counts = BladeCounts::default();
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

        let seen = tiles_in_sight(input, view, aspect);
        let mut bands: Vec<Band> = Vec::new();
        let mut tiles = Vec::with_capacity(seen.len());
        for run in seen.chunk_by(|a, b| a.band == b.band) {
            let band = band_of(input, run[0].band, tiles.len() as u32);
            let first = bands.len() as u32 * BAND_VERTICES;
            self.draws.push((
                first..first + 2 * band.steps + 1,
                0..run.len() as u32 * band.blades,
            ));
            for sight in run {
                let drawn = drawn_tile(input, view, sight);
                let blades = u64::from(drawn.blades as u32).min(u64::from(band.blades));
                self.counts.blades += blades;
                self.counts.triangles += blades * u64::from(2 * band.steps - 1);
                tiles.push(drawn);
            }
            bands.push(band);
        }
        self.counts.tiles = tiles.len() as u64;
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

/// A tile in sight.
#[derive(Clone, Copy, Debug)]
struct Sight {
    tile: TileId,
    /// From the eye; less for an active tile.
    distance_m: f64,
    band: u32,
}

/// Tiles in sight, near to far. The work follows the tiles within reach, not the meadow.
fn tiles_in_sight(input: &BladesInput<'_>, view: &View, aspect: f32) -> Vec<Sight> {
    let field = input.field;
    let frustum = view.frustum(aspect);
    let eye = view.eye_in_world.to_f64();
    let reach = f64::from(input.detail.reach_m);
    let around = Bounds {
        low: eye.map(|x| x - reach),
        high: eye.map(|x| x + reach),
    };
    let tall = f64::from(field.reach_m);
    let mut seen = Vec::new();
    field
        .octree
        .query(&field.grid, &field.ground, &around, tall, |tile| {
            let [low, high] = field.grid.tile_bounds(tile, &field.ground);
            let heights = field.grid.tile_heights(tile, &field.ground).map(f64::from);
            // A blade may lean over its tile's border, and hang below a slope.
            let low = [low[0] - tall, heights[0] - 0.5 * tall, low[1] - tall];
            let high = [high[0] + tall, heights[1] + tall, high[1] + tall];
            let nearest = [0, 1, 2].map(|a| eye[a].clamp(low[a], high[a]) - eye[a]);
            let mut distance_m = Vec3::<f64>::of(nearest).length();
            if distance_m < reach && frustum.may_see(low, high) {
                if slab_of(input, tile).is_some() {
                    distance_m *= ACTIVE_NEARNESS;
                }
                let band = band_at(input.detail, distance_m);
                seen.push(Sight {
                    tile,
                    distance_m,
                    band,
                });
            }
        });
    seen.sort_by(|a, b| {
        a.distance_m
            .total_cmp(&b.distance_m)
            .then(a.tile.cmp(&b.tile))
    });
    seen
}

/// Bands start at half the distance of full density; band 0 lies before that.
fn band_at(detail: BladeDetail, distance_m: f64) -> u32 {
    let relative = distance_m / (0.5 * f64::from(detail.full_m));
    if relative <= 1.0 {
        0
    } else {
        (relative.ln() / BAND_RATIO.ln()).floor() as u32 + 1
    }
}

/// Distance at which a band starts.
fn band_start_m(detail: BladeDetail, band: u32) -> f64 {
    if band == 0 {
        0.0
    } else {
        0.5 * f64::from(detail.full_m) * BAND_RATIO.powi(band as i32 - 1)
    }
}

fn band_of(input: &BladesInput<'_>, band: u32, first_tile: u32) -> Band {
    let start = band_start_m(input.detail, band);
    let all = blades_per_tile(input);
    let segments = input.field.table.segments;
    // P15 eq. 4 with a reference distance: half the segments for every 1.4 times the distance.
    let stride = match band {
        0 => 1,
        1..=2 => 2,
        3..=4 => 4,
        _ => segments,
    }
    .min(segments);
    Band {
        first_tile,
        blades: (all * input.detail.share(start)).ceil().max(1.0) as u32,
        stride,
        steps: segments.div_ceil(stride),
    }
}

fn slab_of(input: &BladesInput<'_>, tile: TileId) -> Option<u32> {
    let found = input.active.binary_search_by_key(&tile, |&(id, _)| id);
    found.ok().map(|index| input.active[index].1)
}

fn blades_per_tile(input: &BladesInput<'_>) -> f64 {
    f64::from(input.field.grid.plants_per_tile()) * f64::from(input.detail.tuft.max(1))
}

fn drawn_tile(input: &BladesInput<'_>, view: &View, sight: &Sight) -> DrawnTile {
    let (field, grid) = (input.field, &input.field.grid);
    let mut record = TileRecord::resting(field, sight.tile);
    if let Some(slab) = slab_of(input, sight.tile) {
        record.slab = slab;
    }
    let anchor = grid.anchor_of(sight.tile, &field.ground);
    let origin = Vec3::of(grid.anchor_in_world(&anchor, &field.ground));
    let share = input.detail.share(sight.distance_m);
    DrawnTile {
        tile: record,
        anchor_from_eye: view.from_eye(origin),
        blades: (blades_per_tile(input) * share) as f32,
        widen: share.powf(-WIDEN_POWER) as f32,
        spare_a: 0.0,
        spare_b: [0.0; 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_lie_end_to_end() {
        let detail = BladeDetail::default();
        for band in 1..12 {
            let start = band_start_m(detail, band);
            assert_eq!(band_at(detail, start * 1.0001), band);
            assert_eq!(band_at(detail, start * 0.9999), band - 1);
        }
        assert_eq!(band_at(detail, 0.0), 0);
    }

    /// A band's draw call has as many places as its nearest tile needs.
    #[test]
    fn no_tile_needs_more_places_than_its_band_has() {
        let detail = BladeDetail::software();
        for step in 1..500 {
            let distance = 0.1 * f64::from(step);
            let start = band_start_m(detail, band_at(detail, distance));
            assert!(detail.share(distance) <= detail.share(start));
        }
    }

    #[test]
    fn a_strip_of_the_longest_blade_fits_its_band() {
        assert!(2 * (crate::field::MAX_SEGMENTS as u32) < BAND_VERTICES);
    }
}
