//! Convex hulls as planes.

use rapier3d::math::Vector;
use rapier3d::parry::transformation::try_convex_hull;

use crate::base::Vec3;

/// Faces whose vertices lie within this share of the hull's size of a larger face's plane belong
/// to that face: rounding to f32 and slivers make many such. It moves no surface by more.
const COPLANAR: f64 = 1e-4;

/// A convex hull with a volume.
#[derive(Clone, Debug)]
pub(super) struct Hull {
    pub vertices: Vec<[f64; 3]>,
    /// Counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Outward unit normal and distance: the hull is n·p ≤ d for all. Every vertex is inside.
    pub planes: Vec<[f64; 4]>,
}

impl Hull {
    /// The hull of some points; `None` if it has no volume.
    pub fn of(points: &[Vector]) -> Option<Self> {
        if points.len() < 4 || !points.iter().all(|p| p.is_finite()) {
            return None;
        }
        let (points, triangles) = try_convex_hull(points).ok()?;
        let vertices: Vec<[f64; 3]> = points
            .iter()
            .map(|p| [p.x, p.y, p.z].map(f64::from))
            .collect();
        let size = diagonal(&vertices);
        let planes = planes(&vertices, &triangles, COPLANAR * size);
        let hull = Self {
            vertices,
            triangles,
            planes,
        };
        // A hull that f32 cannot tell from a flat one has no inside to push from.
        (hull.planes.len() >= 4 && hull.smallest_width() > 1e-5 * size).then_some(hull)
    }

    /// Diagonal of the bounds.
    pub fn size(&self) -> f64 {
        diagonal(&self.vertices)
    }

    pub fn volume(&self) -> f64 {
        let corner = |i: u32| Vec3::<f64>::of(self.vertices[i as usize]);
        let origin = corner(0);
        self.triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| corner(i) - origin);
                a.dot(b.cross(c)) / 6.0
            })
            .sum()
    }

    /// The vertices as parry takes them; they came from there, so nothing is rounded.
    pub fn points(&self) -> Vec<Vector> {
        self.vertices
            .iter()
            .map(|v| Vector::from_array(v.map(|c| c as f32)))
            .collect()
    }

    /// A hull of fewer of the vertices, inside this one; the others are at most `tolerance_m`
    /// outside of it. Takes the farthest vertex again and again, from the six extreme ones on.
    pub fn thinned(&self, tolerance_m: f64) -> Self {
        let points = self.points();
        let mut kept: Vec<usize> = Vec::new();
        for axis in 0..3 {
            let order =
                |&a: &usize, &b: &usize| self.vertices[a][axis].total_cmp(&self.vertices[b][axis]);
            kept.extend((0..points.len()).min_by(order));
            kept.extend((0..points.len()).max_by(order));
        }
        while kept.len() < points.len() {
            kept.sort_unstable();
            kept.dedup();
            let few: Vec<Vector> = kept.iter().map(|&i| points[i]).collect();
            let Some(hull) = Self::of(&few) else { break };
            let outside = |i: usize| {
                let p = Vec3::of(self.vertices[i]);
                let beyond = |&[x, y, z, d]: &[f64; 4]| Vec3::new(x, y, z).dot(p) - d;
                hull.planes.iter().map(beyond).fold(0.0, f64::max)
            };
            let worst = (0..points.len())
                .map(|i| (i, outside(i)))
                .max_by(|a, b| a.1.total_cmp(&b.1));
            match worst {
                Some((i, far)) if far > tolerance_m && !kept.contains(&i) => kept.push(i),
                _ => return hull,
            }
        }
        self.clone()
    }

    /// The smallest distance of two parallel planes that hold the hull, one of them a face.
    pub fn smallest_width(&self) -> f64 {
        self.planes
            .iter()
            .map(|&[x, y, z, d]| {
                let n = Vec3::new(x, y, z);
                let lowest = self.along(n).fold(f64::INFINITY, f64::min);
                d - lowest
            })
            .fold(f64::INFINITY, f64::min)
    }

    fn along(&self, n: Vec3<f64>) -> impl Iterator<Item = f64> {
        self.vertices.iter().map(move |&p| n.dot(Vec3::of(p)))
    }
}

/// Diagonal of the bounds.
fn diagonal(vertices: &[[f64; 3]]) -> f64 {
    let mut low: Vec3<f64> = Vec3::of([f64::INFINITY; 3]);
    let mut high = -low;
    for &[x, y, z] in vertices {
        low = Vec3::new(low.x.min(x), low.y.min(y), low.z.min(z));
        high = Vec3::new(high.x.max(x), high.y.max(y), high.z.max(z));
    }
    (high - low).length()
}

/// The planes of the faces, the largest first; each reaches out to the farthest vertex, so that
/// dropping a sliver's plane never cuts into the hull.
fn planes(vertices: &[[f64; 3]], triangles: &[[u32; 3]], tolerance_m: f64) -> Vec<[f64; 4]> {
    let corner = |i: u32| Vec3::of(vertices[i as usize]);
    let mut faces: Vec<(Vec3<f64>, [u32; 3])> = triangles
        .iter()
        .map(|&t| {
            let [a, b, c] = t.map(corner);
            ((b - a).cross(c - a), t)
        })
        .collect();
    faces.sort_by(|a, b| {
        b.0.length_squared()
            .total_cmp(&a.0.length_squared())
            .then(a.1.cmp(&b.1))
    });
    let mut planes: Vec<(Vec3<f64>, f64)> = Vec::new();
    for (cross, triangle) in faces {
        let length = cross.length();
        if length <= f64::MIN_POSITIVE {
            continue;
        }
        let normal = cross * (1.0 / length);
        let on = |&(n, d): &(Vec3<f64>, f64)| {
            n.dot(normal) > 0.9
                && triangle
                    .iter()
                    .all(|&i| (d - n.dot(corner(i))).abs() <= tolerance_m)
        };
        if planes.iter().any(on) {
            continue;
        }
        let distance = vertices
            .iter()
            .map(|&p| normal.dot(Vec3::of(p)))
            .fold(f64::NEG_INFINITY, f64::max);
        planes.push((normal, distance));
    }
    planes.iter().map(|(n, d)| [n.x, n.y, n.z, *d]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(half: [f32; 3]) -> Vec<Vector> {
        (0..8)
            .map(|k| {
                let side = |bit: usize| {
                    if (k >> bit) & 1 == 1 {
                        half[bit]
                    } else {
                        -half[bit]
                    }
                };
                Vector::new(side(0), side(1), side(2))
            })
            .collect()
    }

    #[test]
    fn a_box_has_six_planes_at_its_half_extents() {
        let mut points = corners([1.0, 0.5, 0.25]);
        points.push(Vector::new(0.1, 0.2, 0.1));
        let hull = Hull::of(&points).expect("a box has a volume");
        assert_eq!(hull.planes.len(), 6);
        for [x, y, z, d] in &hull.planes {
            let want = x.abs() * 1.0 + y.abs() * 0.5 + z.abs() * 0.25;
            assert!((d - want).abs() < 1e-12);
            assert!((x * x + y * y + z * z - 1.0).abs() < 1e-12);
        }
        assert!((hull.smallest_width() - 0.5).abs() < 1e-12);
    }

    #[test]
    fn flat_and_poisoned_points_have_no_hull() {
        assert!(Hull::of(&corners([1.0, 0.0, 1.0])).is_none());
        assert!(Hull::of(&corners([1.0, 1.0, 1.0])[..3]).is_none());
        assert!(Hull::of(&corners([1.0, f32::NAN, 1.0])).is_none());
        assert!(Hull::of(&[Vector::ZERO; 9]).is_none());
    }
}
