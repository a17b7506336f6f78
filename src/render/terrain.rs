//! The ground: the exact triangles of the height samples, and land around them to the horizon.
//!
//! A small field is drawn in chunks of samples; one index list serves all of them, since a chunk
//! starts at an even sample and so repeats the cut of its squares. A chunk's place is taken
//! relative to the eye in `f64`. A large one is drawn as the mesh of its bintree (`ground_mesh.rs`).
//! Shader: `shaders/terrain.wgsl`.

use std::sync::Arc;

use wgpu::{BufferUsages, ShaderStages};

use crate::base::Vec3;
use crate::base::widened;
use crate::field::Field;
use crate::gpu::{Buffer, FieldBuffers, Gpu, GpuError};
use crate::gpu_struct;
use crate::terrain::HeightGrid;
use crate::terrain::bintree::MeshChange;

use super::camera::View;
use super::canopy::Canopy;
use super::error::RenderError;
use super::ground_look::{GroundTexture, TASTE_ROWS, looks};
use super::ground_mesh::{GroundMesh, TerrainDetail};
use super::pipeline::{
    DepthUse, Drawing, READ_STORAGE, SAMPLER, TEXTURE, UNIFORM, bind_group, group_layout,
};
use super::plants::BladesInput;
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
        eye_sample_from_eye: [f32; 3],
        pad_c: f32,
        eye_sample: [i32; 2],
        pad_d: [i32; 2],
        looks: [[u32; 4]; TASTE_ROWS as usize],
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
    /// The kinds that grow and the colours they like.
    field: FieldBuffers,
    heights: Arc<HeightGrid>,
    /// Chunks of a small field.
    chunks: Vec<ChunkBounds>,
    /// The mesh of a large one.
    mesh: Option<GroundMesh>,
    edge: Buffer<f32>,
    uniform: Buffer<Ground>,
    records: Buffer<Chunk>,
    group: wgpu::BindGroup,
    visible: u32,
}

/// Draws the ground.
#[derive(Debug)]
pub(super) struct TerrainLayer {
    field: wgpu::RenderPipeline,
    mesh: wgpu::RenderPipeline,
    land: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    /// Triangles of a chunk's squares.
    indices: Buffer<u32>,
    scene: Option<GroundScene>,
}

impl TerrainLayer {
    pub(super) fn new(gpu: &Gpu, groups: &ViewGroups, samples: u32) -> Result<Self, GpuError> {
        let both = ShaderStages::VERTEX_FRAGMENT;
        let layout = group_layout(
            gpu,
            "ground",
            &[
                (both, UNIFORM),
                (ShaderStages::VERTEX, READ_STORAGE),
                (ShaderStages::FRAGMENT, TEXTURE),
                (ShaderStages::FRAGMENT, SAMPLER),
                (ShaderStages::VERTEX, READ_STORAGE),
            ],
        );
        let field_layout = FieldBuffers::layout(gpu);
        let mut used = groups.lit(&layout);
        used[0] = Some(&field_layout);
        let field = Drawing {
            shader: "terrain.wgsl",
            vertex: "field_vertex",
            fragment: "ground_fragment",
            groups: used,
            depth: DepthUse::Write,
            samples,
            ..Drawing::default()
        };
        let mesh = Drawing {
            vertex: "mesh_vertex",
            fragment: "mesh_fragment",
            ..field
        };
        let land = Drawing {
            vertex: "land_vertex",
            ..field
        };
        Ok(Self {
            field: field.pipeline(gpu)?,
            mesh: mesh.pipeline(gpu)?,
            land: land.pipeline(gpu)?,
            layout,
            indices: Buffer::with(gpu, "chunk indices", &chunk_indices(), BufferUsages::INDEX)?,
            scene: None,
        })
    }

    /// Takes a field's heights, kinds and colours in place of the old ones.
    ///
    /// # Errors
    /// `TooLarge` for more samples than the device can bind.
    pub(super) fn set_ground(
        &mut self,
        gpu: &Gpu,
        field: &Field,
        buffers: &FieldBuffers,
        colour: &GroundTexture,
        soil_rgb: [f32; 3],
    ) -> Result<(), GpuError> {
        let canopy = Canopy::of(field);
        let heights = Arc::clone(&field.ground);
        let storage = BufferUsages::STORAGE;
        let mesh = GroundMesh::if_large(gpu, &field.bintree, canopy.height_m)?;
        let chunks = match &mesh {
            Some(_) => Vec::new(),
            None => chunks_of(&heights),
        };
        let edge = Buffer::with(gpu, "edge heights", &edge_heights(&heights), storage)?;
        let uniform = Buffer::new(gpu, "ground", 1, BufferUsages::UNIFORM)?;
        let records = Buffer::new(gpu, "ground chunks", chunks.len(), storage)?;
        let group = bind_group(
            gpu,
            "ground",
            &self.layout,
            &[
                uniform.binding(),
                records.binding(),
                wgpu::BindingResource::TextureView(&colour.view),
                wgpu::BindingResource::Sampler(&colour.sampler),
                edge.binding(),
            ],
        );
        self.scene = Some(GroundScene {
            ground: Ground {
                looks: looks(field),
                ..ground_uniform(&heights, colour, soil_rgb, canopy)
            },
            field: buffers.clone(),
            heights,
            chunks,
            mesh,
            edge,
            uniform,
            records,
            group,
            visible: 0,
        });
        Ok(())
    }

    /// Picks what is in view.
    ///
    /// # Errors
    /// A detail that cannot be kept to; the device's own.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        view: &View,
        size: [u32; 2],
        detail: TerrainDetail,
        blades: Option<&BladesInput<'_>>,
    ) -> Result<(), RenderError> {
        let Some(scene) = &mut self.scene else {
            return Ok(());
        };
        let aspect = size[0] as f32 / size[1] as f32;
        if let Some(mesh) = &mut scene.mesh {
            let viewpoint = view.viewpoint(aspect, size[1]);
            mesh.write(gpu, &viewpoint, detail, blades, &scene.edge)?;
        } else {
            scene.pick_chunks(gpu, view, aspect)?;
        }
        let eye = view.eye_in_world;
        let corner = scene.heights.corner_in_world();
        scene.ground.corner_from_eye = level_from_eye(eye, corner);
        let spacing_m = f64::from(scene.heights.spacing_m);
        let sample = [
            (eye.x - corner[0]) / spacing_m,
            (eye.z - corner[1]) / spacing_m,
        ];
        // The cast of a float stops at the integer's ends, far beyond any eye.
        scene.ground.eye_sample = sample.map(|s| s.floor() as i32);
        let [x, z] = [0, 1].map(|a| corner[a] + f64::from(scene.ground.eye_sample[a]) * spacing_m);
        scene.ground.eye_sample_from_eye = level_from_eye(eye, [x, z]);
        Ok(scene.uniform.write(gpu, 0, &[scene.ground])?)
    }

    /// What the last frame's mesh is, if the field is large enough to have one.
    pub(super) fn mesh_change(&self) -> Option<MeshChange> {
        self.scene.as_ref()?.mesh.as_ref().map(GroundMesh::change)
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(scene) = &self.scene else {
            return;
        };
        pass.set_bind_group(0, &scene.field.bind_group, &[]);
        pass.set_bind_group(3, &scene.group, &[]);
        if let Some(mesh) = &scene.mesh {
            pass.set_pipeline(&self.mesh);
            mesh.draw(pass);
        } else {
            pass.set_pipeline(&self.field);
            pass.set_index_buffer(self.indices.raw.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..self.indices.len() as u32, 0, 0..scene.visible);
        }
        pass.set_pipeline(&self.land);
        let cells = scene.ground.edge_steps * (LAND_RINGS_M.len() as u32 - 1);
        pass.draw(0..6 * cells, 0..1);
    }
}

impl GroundScene {
    fn pick_chunks(&mut self, gpu: &Gpu, view: &View, aspect: f32) -> Result<(), GpuError> {
        let frustum = view.frustum(aspect);
        let visible: Vec<Chunk> = self
            .chunks
            .iter()
            .filter(|chunk| frustum.may_see(chunk.low_in_world, chunk.high_in_world))
            .map(|chunk| Chunk {
                first_from_eye: level_from_eye(
                    view.eye_in_world,
                    [chunk.low_in_world[0], chunk.low_in_world[2]],
                ),
                first_column: chunk.first[0],
                first_row: chunk.first[1],
                pad_a: 0,
                pad_b: 0,
                pad_c: 0,
            })
            .collect();
        self.visible = visible.len() as u32;
        self.records.write(gpu, 0, &visible)
    }
}

/// A place at height 0, relative to the eye.
fn level_from_eye(eye: Vec3<f64>, [x, z]: [f64; 2]) -> [f32; 3] {
    [(x - eye.x) as f32, -eye.y as f32, (z - eye.z) as f32]
}

/// Heights of the samples around the field's edge, from its corner along x first: the walk of
/// `edge_sample` in the shader.
pub(super) fn edge_heights(heights: &HeightGrid) -> Vec<f32> {
    let [east, south] = heights.squares();
    let north_side = (0..east).map(|i| heights.sample(i, 0));
    let east_side = (0..south).map(|j| heights.sample(east, j));
    let south_side = (0..east).map(|i| heights.sample(east - i, south));
    let west_side = (0..south).map(|j| heights.sample(0, south - j));
    let walk = north_side.chain(east_side).chain(south_side);
    walk.chain(west_side).collect()
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
                    range = widened(range, [h, h]);
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
        eye_sample_from_eye: [0.0; 3],
        pad_c: 0.0,
        eye_sample: [0; 2],
        pad_d: [0; 2],
        looks: [[0; 4]; TASTE_ROWS as usize],
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
