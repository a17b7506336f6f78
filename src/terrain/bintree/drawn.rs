//! The triangles of a mesh that can be in the picture.

use super::Bintree;
use super::geometry::{Point, Triangle};
use super::lattice::Side;
use super::mesh::Mesh;
use super::sight::{ALL_SIDES, Crossed, Sight};
use super::viewpoint::Viewpoint;

/// Triangles for drawing. A corner is a sample's rank, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnMesh {
    /// Three corners a triangle, counter-clockwise from above.
    pub corners: Vec<u32>,
    /// Edges of triangles that lie on the terrain's edge.
    pub border: Vec<[u32; 2]>,
}

impl Mesh {
    /// Lists the triangles that can be seen, with plants `canopy_m` high on them. A triangle that
    /// lies within a side of the picture is not asked about it again below, one that lies beyond
    /// is left out with all that is below it.
    pub fn in_view(&self, tree: &Bintree, viewpoint: &Viewpoint, canopy_m: f32) -> DrawnMesh {
        let sight = Sight::new(&tree.lattice, viewpoint, canopy_m);
        let mut drawn = DrawnMesh::default();
        for root in tree.lattice.roots().flatten() {
            self.collect(tree, Some(&sight), &root, ALL_SIDES, &mut drawn);
        }
        drawn
    }

    /// Lists all triangles.
    pub fn whole(&self, tree: &Bintree) -> DrawnMesh {
        let mut drawn = DrawnMesh::default();
        for root in tree.lattice.roots().flatten() {
            self.collect(tree, None, &root, 0, &mut drawn);
        }
        drawn
    }

    fn collect(
        &self,
        tree: &Bintree,
        sight: Option<&Sight<'_>>,
        triangle: &Triangle,
        mut open: Crossed,
        drawn: &mut DrawnMesh,
    ) {
        let lattice = &tree.lattice;
        if lattice.side(triangle) == Side::Outside {
            return;
        }
        let middle = triangle.split_point();
        if let Some(sight) = sight.filter(|_| open != 0) {
            let half_m = middle.map_or(0.0, |p| tree.wedgies.half_m(lattice.index(p)));
            match sight.crossed(&sight.bounds(triangle, half_m), open) {
                Some(crossed) => open = crossed,
                None => return,
            }
        }
        match middle.filter(|&p| self.is_split(tree, p)) {
            Some(middle) => {
                for half in triangle.halves(middle) {
                    self.collect(tree, sight, &half, open, drawn);
                }
            }
            None => drawn.add(tree, triangle),
        }
    }
}

impl DrawnMesh {
    fn add(&mut self, tree: &Bintree, triangle: &Triangle) {
        let last = tree.lattice.squares;
        let columns = tree.lattice.ground.columns;
        let corners = triangle.corners().map(|p| tree.lattice.on_terrain(p));
        let rank = |[x, z]: Point| z as u32 * columns + x as u32;
        self.corners.extend(corners.map(rank));
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (corners[a], corners[b]);
            let is_border = (0..2).any(|i| a[i] == b[i] && (a[i] == 0 || a[i] == last[i]));
            if is_border {
                self.border.push([rank(a), rank(b)]);
            }
        }
    }
}
