//! The exact distance to a closed triangle mesh.

use std::collections::BTreeMap;

use rapier3d::math::Vector;
use rapier3d::parry::query::PointQueryWithLocation;
use rapier3d::parry::shape::{TriMesh, TriMeshFlags};

/// A closed mesh with outward triangles, in the body's space. Distances are computed in `f32` by
/// parry, from the pseudo-normals of the nearest vertex, edge or face: about 1e-7 of the mesh's
/// size.
#[derive(Clone, Debug)]
pub struct TrueMesh {
    mesh: TriMesh,
    /// Smallest and largest corner.
    pub bounds_m: [[f64; 3]; 2],
}

/// The nearest point of a mesh's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    pub point: [f64; 3],
    pub inside: bool,
    pub triangle: u32,
    /// Outward normal of that triangle.
    pub normal: [f64; 3],
}

impl TrueMesh {
    /// `None` where the triangles do not close a volume, each edge once in each direction: then
    /// nothing tells inside from outside.
    pub(super) fn new(positions: &[Vector], triangles: &[[u32; 3]]) -> Option<Self> {
        let flags = TriMeshFlags::ORIENTED
            | TriMeshFlags::MERGE_DUPLICATE_VERTICES
            | TriMeshFlags::DELETE_DEGENERATE_TRIANGLES;
        let mesh = TriMesh::with_flags(positions.to_vec(), triangles.to_vec(), flags).ok()?;
        let volume = is_closed(&mesh).then(|| six_volumes(&mesh))?;
        let mesh = if volume < 0.0 {
            let turned = mesh.indices().iter().map(|&[a, b, c]| [a, c, b]).collect();
            TriMesh::with_flags(mesh.vertices().to_vec(), turned, flags).ok()?
        } else {
            mesh
        };
        let bounds = mesh.local_aabb();
        let corner = |v: Vector| [v.x, v.y, v.z].map(f64::from);
        Some(Self {
            bounds_m: [corner(bounds.mins), corner(bounds.maxs)],
            mesh,
        })
    }

    /// The nearest surface point to a point of the body's space.
    pub fn nearest(&self, p: [f64; 3]) -> Nearest {
        let point = Vector::new(p[0] as f32, p[1] as f32, p[2] as f32);
        let (found, (triangle, _)) = (self.mesh).project_local_point_and_get_location(point, false);
        let normal = self.mesh.triangle(triangle).normal().unwrap_or(Vector::Y);
        let wide = |v: Vector| [v.x, v.y, v.z].map(f64::from);
        Nearest {
            point: wide(found.point),
            inside: found.is_inside,
            triangle,
            normal: wide(normal),
        }
    }
}

/// True where every edge is walked once in each direction.
fn is_closed(mesh: &TriMesh) -> bool {
    let mut walked: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for &[a, b, c] in mesh.indices() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *walked.entry((from.min(to), from.max(to))).or_default() +=
                if from < to { 1 } else { 1 << 16 };
        }
    }
    !walked.is_empty() && walked.values().all(|&count| count == 1 + (1 << 16))
}

/// Six times the signed volume: negative where triangles turn inward.
fn six_volumes(mesh: &TriMesh) -> f64 {
    let at = |n: u32| mesh.vertices()[n as usize];
    let of = |&[a, b, c]: &[u32; 3]| f64::from(at(a).dot(at(b).cross(at(c))));
    mesh.indices().iter().map(of).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube of side 2, its triangles outward or inward.
    fn cube(outward: bool) -> (Vec<Vector>, Vec<[u32; 3]>) {
        let corner = |n: u32| {
            let side = |bit: u32| if n >> bit & 1 == 1 { 1.0 } else { -1.0 };
            Vector::new(side(0), side(1), side(2))
        };
        let quads = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let triangles = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .map(|[a, b, c]| if outward { [a, b, c] } else { [a, c, b] })
            .collect();
        ((0..8).map(corner).collect(), triangles)
    }

    #[test]
    fn a_cube_is_solid_whichever_way_its_triangles_turn() {
        for outward in [true, false] {
            let (positions, triangles) = cube(outward);
            let mesh = TrueMesh::new(&positions, &triangles).expect("closed");
            let inside = mesh.nearest([0.5, 0.1, -0.2]);
            assert!(inside.inside, "{outward}");
            assert!((inside.point[0] - 1.0).abs() < 1e-6 && inside.normal[0] > 0.999);
            assert!(!mesh.nearest([1.5, 1.5, 1.5]).inside);
        }
    }

    #[test]
    fn an_open_mesh_has_no_inside() {
        let (positions, mut triangles) = cube(true);
        triangles.pop();
        assert!(TrueMesh::new(&positions, &triangles).is_none());
    }
}
