//! The ground: the exact triangles of the height samples, and land around them to the horizon.
//!
//! The field is drawn in chunks of samples; one index list serves all of them, since a chunk
//! starts at an even sample and so repeats the cut of its squares. A chunk's place is taken
//! relative to the eye in `f64`. Shader: `shaders/terrain.wgsl`.

use wgpu::{BufferUsages, ShaderStages};

use crate::gpu::{Buffer, Gpu, GpuError};
use crate::gpu_struct;
use crate::terrain::HeightGrid;

use super::blades::Canopy;
use super::camera::View;
use super::ground_look::GroundTexture;
use super::pipeline::{DepthUse, Drawing, READ_STORAGE, UNIFORM, bind_group, group_layout};
use super::view_group::ViewGroups;

/// Samples along a chunk's side; one less is its number of squares, an even number.
pub(super) const CHUNK_SAMPLES: u32 = 33;
/// Distances beyond the field's edge at which the land around it is cut, in metres. The first
/// ring slips under the field.
pub(super) const LAND_RINGS_M: [f32; 12] = [
    -0.1, 0.0, 1.0, 3.0, 9.0, 25.0, 60.0, 150.0, 400.0, 1000.0, 2500.0, 7000.0,
];

gpu_struct! {
    pub(super) struct Ground {
        columns: u32,
        rows: u32,
        spacing_m: f32,
        canopy_m: f32,
        size_m: [f32; 2],
        edge_y_m: f32,
        edge_steps: u32,
        corner_from_eye: [f32; 3],
        hill_m: f32,
        soil_rgb: [f32; 3],
        cover: f32,
        mean_rgb: [f32; 3],
        pad: f32,
        map_m: [f32; 2],
        pad_b: [f32; 2],
    }
}

gpu_struct! {
    pub(super) struct Chunk {
        first_from_eye: [f32; 3],
        first_column: u32,
        first_row: u32,
        pad_a: u32,
        pad_b: u32,
        pad_c: u32,
    }
}

/// A chunk of the field as the processor sees it.
#[derive(Clone, Copy, Debug)]
struct ChunkBounds {
    first: [u32; 2],
    low_in_world: [f64; 3],
    high_in_world: [f64; 3],
}

/// What belongs to one field.
#[derive(Debug)]
struct GroundScene {
    ground: Ground,
    corner_in_world: [f64; 2],
    chunks: Vec<ChunkBounds>,
    uniform: Buffer<Ground>,
    records: Buffer<Chunk>,
    group: wgpu::BindGroup,
    visible: u32,
}

/// Draws the ground.
#[derive(Debug)]
pub(super) struct TerrainLayer {
    field: wgpu::RenderPipeline,
    land: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    /// Triangles of a chunk's squares.
    indices: Buffer<u32>,
    scene: Option<GroundScene>,
}

impl TerrainLayer {
    pub(super) fn new(gpu: &Gpu, groups: &ViewGroups, samples: u32) -> Result<Self, GpuError> {
        let both = ShaderStages::VERTEX_FRAGMENT;
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let layout = group_layout(
            gpu,
            "ground",
            &[
                (both, UNIFORM),
                (ShaderStages::VERTEX, READ_STORAGE),
                (ShaderStages::VERTEX, READ_STORAGE),
                (ShaderStages::FRAGMENT, texture),
                (ShaderStages::FRAGMENT, sampler),
            ],
        );
        let field = Drawing {
            shader: "terrain.wgsl",
            vertex: "field_vertex",
            fragment: "ground_fragment",
            groups: groups.lit(&layout),
            depth: DepthUse::Write,
            samples,
            ..Drawing::default()
        };
        let land = Drawing {
            vertex: "land_vertex",
            ..field
        };
        Ok(Self {
            field: field.pipeline(gpu)?,
            land: land.pipeline(gpu)?,
            layout,
            indices: Buffer::with(gpu, "chunk indices", &chunk_indices(), BufferUsages::INDEX)?,
            scene: None,
        })
    }

    /// Takes a field's heights and colours in place of the old ones.
    ///
    /// # Errors
    /// `TooLarge` for more samples than the device can bind.
    pub(super) fn set_ground(
        &mut self,
        gpu: &Gpu,
        heights: &HeightGrid,
        colour: &GroundTexture,
        soil_rgb: [f32; 3],
        canopy: Canopy,
    ) -> Result<(), GpuError> {
        let samples = Buffer::with(
            gpu,
            "ground heights",
            &heights.heights_m,
            BufferUsages::STORAGE,
        )?;
        let chunks = chunks_of(heights);
        let uniform = Buffer::new(gpu, "ground", 1, BufferUsages::UNIFORM)?;
        let records = Buffer::new(gpu, "ground chunks", chunks.len(), BufferUsages::STORAGE)?;
        let group = bind_group(
            gpu,
            "ground",
            &self.layout,
            &[
                uniform.binding(),
                samples.binding(),
                records.binding(),
                wgpu::BindingResource::TextureView(&colour.view),
                wgpu::BindingResource::Sampler(&colour.sampler),
            ],
        );
        self.scene = Some(GroundScene {
            ground: ground_uniform(heights, colour, soil_rgb, canopy),
            corner_in_world: heights.corner_in_world(),
            chunks,
            uniform,
            records,
            group,
            visible: 0,
        });
        Ok(())
    }

    /// Picks the chunks in view.
    pub(super) fn write(&mut self, gpu: &Gpu, view: &View, aspect: f32) -> Result<(), GpuError> {
        let Some(scene) = &mut self.scene else {
            return Ok(());
        };
        let eye = view.eye_in_world;
        let from_eye = |x: f64, z: f64| [(x - eye.x) as f32, -eye.y as f32, (z - eye.z) as f32];
        let frustum = view.frustum(aspect);
        let visible: Vec<Chunk> = scene
            .chunks
            .iter()
            .filter(|chunk| frustum.may_see(chunk.low_in_world, chunk.high_in_world))
            .map(|chunk| Chunk {
                first_from_eye: from_eye(chunk.low_in_world[0], chunk.low_in_world[2]),
                first_column: chunk.first[0],
                first_row: chunk.first[1],
                pad_a: 0,
                pad_b: 0,
                pad_c: 0,
            })
            .collect();
        scene.visible = visible.len() as u32;
        scene.records.write(gpu, 0, &visible)?;
        scene.ground.corner_from_eye = from_eye(scene.corner_in_world[0], scene.corner_in_world[1]);
        scene.uniform.write(gpu, 0, &[scene.ground])
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(scene) = &self.scene else {
            return;
        };
        pass.set_bind_group(3, &scene.group, &[]);
        pass.set_pipeline(&self.field);
        pass.set_index_buffer(self.indices.raw.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.indices.len() as u32, 0, 0..scene.visible);
        pass.set_pipeline(&self.land);
        let cells = scene.ground.edge_steps * (LAND_RINGS_M.len() as u32 - 1);
        pass.draw(0..6 * cells, 0..1);
    }
}

/// Two triangles for each square of a chunk, cut as [`HeightGrid`] cuts them, seen from above
/// counter-clockwise.
fn chunk_indices() -> Vec<u32> {
    let mut indices = Vec::new();
    for row in 0..CHUNK_SAMPLES - 1 {
        for column in 0..CHUNK_SAMPLES - 1 {
            let at = |i: u32, j: u32| (row + j) * CHUNK_SAMPLES + column + i;
            let (p00, p10, p01, p11) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
            indices.extend(if (row + column) % 2 == 0 {
                [p00, p11, p10, p00, p01, p11]
            } else {
                [p00, p01, p10, p10, p01, p11]
            });
        }
    }
    indices
}

fn chunks_of(heights: &HeightGrid) -> Vec<ChunkBounds> {
    let squares = CHUNK_SAMPLES - 1;
    let [corner_x, corner_z] = heights.corner_in_world();
    let spacing = f64::from(heights.spacing_m);
    let counts = heights.squares().map(|n| n.div_ceil(squares));
    let mut chunks = Vec::new();
    for first_row in (0..counts[1]).map(|n| n * squares) {
        for first_column in (0..counts[0]).map(|n| n * squares) {
            let mut range = [f32::INFINITY, f32::NEG_INFINITY];
            for row in first_row..=first_row + squares {
                for column in first_column..=first_column + squares {
                    let h = heights.sample(column, row);
                    range = [range[0].min(h), range[1].max(h)];
                }
            }
            let x = corner_x + f64::from(first_column) * spacing;
            let z = corner_z + f64::from(first_row) * spacing;
            let side = f64::from(squares) * spacing;
            chunks.push(ChunkBounds {
                first: [first_column, first_row],
                low_in_world: [x, f64::from(range[0]), z],
                high_in_world: [x + side, f64::from(range[1]), z + side],
            });
        }
    }
    chunks
}

fn ground_uniform(
    heights: &HeightGrid,
    colour: &GroundTexture,
    soil_rgb: [f32; 3],
    canopy: Canopy,
) -> Ground {
    let [east, south] = heights.squares();
    let edge: Vec<f32> = (0..=east)
        .flat_map(|i| [heights.sample(i, 0), heights.sample(i, south)])
        .chain((0..=south).flat_map(|j| [heights.sample(0, j), heights.sample(east, j)]))
        .collect();
    let [low, high] = heights.range_m();
    Ground {
        columns: heights.columns,
        rows: heights.rows,
        spacing_m: heights.spacing_m,
        canopy_m: canopy.height_m,
        size_m: heights.size_m().map(|s| s as f32),
        edge_y_m: edge.iter().sum::<f32>() / edge.len() as f32,
        edge_steps: 2 * (east + south),
        corner_from_eye: [0.0; 3],
        // Even around a flat field the far land rolls a little.
        hill_m: (0.5 * (high - low)).clamp(9.0, 40.0),
        soil_rgb,
        cover: canopy.cover,
        mean_rgb: colour.mean_rgb,
        pad: 0.0,
        map_m: colour.size_m,
        pad_b: [0.0; 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both triangles of every square must lie in the surface that the collider and the roots
    /// use: the middle of each triangle's longest side is on the cut, where the two differ.
    #[test]
    fn the_triangles_are_the_height_grids() {
        let side = CHUNK_SAMPLES;
        let mut grid = HeightGrid::flat(side, side, 1.0);
        for (k, h) in grid.heights_m.iter_mut().enumerate() {
            *h = ((k * 7919) % 23) as f32 * 0.1;
        }
        for triangle in chunk_indices().chunks_exact(3) {
            let corner = |k: u32| [k % side, k / side];
            let mut middle = [0.0; 2];
            let mut height = 0.0;
            for &k in triangle {
                let [i, j] = corner(k);
                middle[0] += f64::from(i) / 3.0;
                middle[1] += f64::from(j) / 3.0;
                height += f64::from(grid.sample(i, j)) / 3.0;
            }
            let [x, z] = grid.corner_in_world();
            let want = grid.height_in_world(x + middle[0], z + middle[1]);
            assert!((height - want).abs() < 1e-6, "{triangle:?}");
        }
    }

    #[test]
    fn chunks_cover_every_square_once() {
        let grid = HeightGrid::flat(70, 34, 0.5);
        let chunks = chunks_of(&grid);
        assert_eq!(chunks.len(), 3 * 2);
        assert!(
            chunks
                .iter()
                .all(|c| c.first[0] % 2 == 0 && c.first[1] % 2 == 0)
        );
        assert_eq!(chunks[5].first, [64, 32]);
    }
}
