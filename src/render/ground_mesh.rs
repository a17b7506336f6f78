//! A large field's ground: the triangles of its bintree's mesh, changed from frame to frame.

use std::sync::Arc;

use wgpu::BufferUsages;

use crate::field::{FieldGrid, TileId};
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::terrain::HeightGrid;
use crate::terrain::bintree::{Bintree, DrawnMesh, Mesh, MeshChange, MeshDetail, Point, Viewpoint};

use super::error::RenderError;
use super::plants::BladesInput;
use super::terrain::edge_heights;

/// Fields of more triangles than this are drawn through their bintree; drawing fewer takes less
/// time than choosing among them.
const LARGE: usize = 20_000;

/// How finely a large field's ground is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TerrainDetail {
    /// Error that need not be mended, in pixels.
    pub error_px: f32,
    /// Most triangles of the ground, in view or not.
    pub budget: usize,
}

impl Default for TerrainDetail {
    fn default() -> Self {
        Self {
            error_px: 1.0,
            budget: 30_000,
        }
    }
}

/// The mesh of one field.
#[derive(Debug)]
pub(super) struct GroundMesh {
    tree: Arc<Bintree>,
    mesh: Mesh,
    canopy_m: f32,
    /// Corners of the drawn triangles.
    corners: Buffer<u32>,
    drawn: u32,
    /// Heights of the field's edge at full resolution.
    edge_m: Vec<f32>,
    change: MeshChange,
}

impl GroundMesh {
    /// The mesh of a field that is large enough to need one.
    pub(super) fn if_large(
        gpu: &Gpu,
        tree: &Arc<Bintree>,
        canopy_m: f32,
    ) -> Result<Option<Self>, GpuError> {
        if tree.finest_triangles() <= LARGE {
            return Ok(None);
        }
        Ok(Some(Self {
            tree: Arc::clone(tree),
            mesh: Mesh::new(tree),
            canopy_m,
            corners: Buffer::new(gpu, "ground corners", 1024, BufferUsages::INDEX)?,
            drawn: 0,
            edge_m: edge_heights(tree.ground()),
            change: MeshChange::default(),
        }))
    }

    /// Fits the mesh to a view. Ground that carries drawn blades keeps its full resolution, and so
    /// do active tiles wherever they are: plants stand on the drawn ground.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        viewpoint: &Viewpoint,
        detail: TerrainDetail,
        blades: Option<&BladesInput<'_>>,
        edge: &Buffer<f32>,
    ) -> Result<(), RenderError> {
        let tree = &self.tree;
        let mut held_m = 0.0;
        let mut pinned = Vec::new();
        if let Some(blades) = blades {
            let grid = &blades.field.grid;
            // A tile is drawn if its nearest point is within reach.
            held_m = blades.detail.reach_m + 2.0 * grid.tile_m() + blades.field.reach_m;
            let tiles = blades
                .active
                .iter()
                .map(|&(tile, _)| samples_of(grid, tile));
            pinned.extend(tiles);
        }
        self.mesh.pin(tree, pinned);
        let wanted = MeshDetail {
            error_px: detail.error_px,
            budget: detail.budget,
            held_m,
            canopy_m: self.canopy_m,
        };
        self.change = self.mesh.update(tree, viewpoint, &wanted)?;
        let drawn = self.mesh.in_view(tree, viewpoint, self.canopy_m);
        self.drawn = drawn.corners.len() as u32;
        self.corners.write_or_grow(gpu, &drawn.corners)?;
        let edge_m = drawn_edge(tree.ground(), &self.edge_m, &drawn);
        Ok(edge.write(gpu, 0, &edge_m)?)
    }

    pub(super) fn change(&self) -> MeshChange {
        self.change
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_index_buffer(self.corners.raw.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.drawn, 0, 0..1);
    }
}

/// First and last sample around a tile.
fn samples_of(grid: &FieldGrid, tile: TileId) -> [Point; 2] {
    let first = grid.first_cell(tile);
    let last = first.map(|n| (n + grid.tile_cells).div_ceil(1 << grid.halvings));
    [
        first.map(|n| (n >> grid.halvings) as i32),
        last.map(|n| n as i32),
    ]
}

/// Heights along the field's edge as they are drawn: straight between the corners of the mesh.
fn drawn_edge(ground: &HeightGrid, full_m: &[f32], drawn: &DrawnMesh) -> Vec<f32> {
    let [east, south] = ground.squares();
    let mut edge_m = full_m.to_vec();
    // Place on the walk around the edge; its end is its start.
    let step = |[x, z]: [u32; 2], side: usize| match side {
        0 => x,
        1 => east + z,
        2 => 2 * east + south - x,
        _ => 2 * (east + south) - z,
    };
    for &ranks in &drawn.border {
        let [a, b] = ranks.map(|rank| [rank % ground.columns, rank / ground.columns]);
        let sides = [
            a[1] == 0 && b[1] == 0,
            a[0] == east && b[0] == east,
            a[1] == south && b[1] == south,
            a[0] == 0 && b[0] == 0,
        ];
        for side in (0..4).filter(|&side| sides[side]) {
            let [from, to] = [step(a, side), step(b, side)];
            let [start_m, end_m] = [a, b].map(|[x, z]| ground.sample(x, z));
            let (first, last) = (from.min(to), from.max(to));
            for place in first..=last {
                let along =
                    (f64::from(place) - f64::from(from)) / (f64::from(to) - f64::from(from));
                let [start_m, end_m] = [start_m, end_m].map(f64::from);
                let height_m = start_m + along * (end_m - start_m);
                let count = edge_m.len();
                edge_m[place as usize % count] = height_m as f32;
            }
        }
    }
    edge_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Vec3;
    use crate::render::View;

    #[test]
    fn the_land_meets_the_edge_as_it_is_drawn() {
        let mut ground = HeightGrid::flat(33, 21, 1.0);
        for (k, h) in ground.heights_m.iter_mut().enumerate() {
            *h = ((k * 7919) % 23) as f32 * 0.05;
        }
        let ground = Arc::new(ground);
        let tree = Bintree::new(Arc::clone(&ground));
        let mesh = Mesh::new(&tree);
        let full_m = edge_heights(&ground);
        assert_eq!(full_m.len(), 2 * (32 + 20));
        let edge_m = drawn_edge(&ground, &full_m, &mesh.whole(&tree));
        // Unsplit, the corners of the root squares, four samples apart, are all that is met.
        assert_eq!(edge_m[0], ground.sample(0, 0));
        assert_eq!(edge_m[32], ground.sample(32, 0));
        assert_ne!(edge_m, full_m);
        for ends in edge_m[..5].windows(3) {
            assert!((ends[0] - 2.0 * ends[1] + ends[2]).abs() < 1e-6, "{ends:?}");
        }

        // Seen whole and with no error allowed, it is the ground's own edge.
        let mut mesh = mesh;
        let eye = Vec3::new(0.0, 60.0, 0.0);
        let view = View::look_at(eye, Vec3::ZERO, 60.0).viewpoint(1.0, 1000);
        let detail = MeshDetail {
            error_px: 0.0,
            budget: 2000,
            held_m: 0.0,
            canopy_m: 0.0,
        };
        mesh.update(&tree, &view, &detail).expect("a mesh");
        let edge_m = drawn_edge(&ground, &full_m, &mesh.in_view(&tree, &view, 0.0));
        for (drawn, full) in edge_m.iter().zip(&full_m) {
            // Where three samples lie in line the middle one is not a corner: f32 rounding.
            assert!((drawn - full).abs() < 1e-6, "{drawn} {full}");
        }
    }
}
