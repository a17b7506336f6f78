//! Triangles to draw. Nothing of these enters the simulation.

use crate::base::trig::{cos_turns, sin_turns};
use crate::base::{Pose, Vec3};

use super::convex::Hull;
use super::shape::DrawMesh;

/// Segments around an axis of revolution: edges deviate by 0.5% of the radius.
const AROUND: u32 = 32;
/// Rings from a pole to the equator.
const QUARTER: u32 = 8;
/// Faces that meet at less than this angle are shaded as one smooth surface: cos 40°.
const SMOOTH_COSINE: f64 = 0.766;

/// A ring of a surface of revolution about y: radius, height, and the normal's two components.
#[derive(Clone, Copy, PartialEq)]
struct Ring {
    radius: f64,
    y: f64,
    normal: [f64; 2],
}

impl DrawMesh {
    pub(super) fn ball(radius: f64) -> Self {
        Self::capsule(radius, 0.0)
    }

    /// Axis along y, from −half to +half, with round caps.
    pub(super) fn capsule(radius: f64, half: f64) -> Self {
        let ring = |k: u32, side: f64| {
            let turns = 0.25 * f64::from(k) / f64::from(QUARTER);
            // The pole's radius is exactly 0, which rounding would miss.
            let c = if k == QUARTER { 0.0 } else { cos_turns(turns) };
            let s = sin_turns(turns);
            Ring {
                radius: radius * c,
                y: side * (half + radius * s),
                normal: [c, side * s],
            }
        };
        let lower = (0..=QUARTER).rev().map(|k| ring(k, -1.0));
        let rings: Vec<Ring> = lower.chain((0..=QUARTER).map(|k| ring(k, 1.0))).collect();
        revolve(&rings)
    }

    /// Axis along y.
    pub(super) fn cylinder(radius: f64, half: f64) -> Self {
        let ring = |radius, y, normal| Ring { radius, y, normal };
        revolve(&[
            ring(0.0, -half, [0.0, -1.0]),
            ring(radius, -half, [0.0, -1.0]),
            ring(radius, -half, [1.0, 0.0]),
            ring(radius, half, [1.0, 0.0]),
            ring(radius, half, [0.0, 1.0]),
            ring(0.0, half, [0.0, 1.0]),
        ])
    }

    /// About the origin, with flat faces.
    pub(super) fn cuboid(half: [f64; 3]) -> Self {
        let mut mesh = Self::default();
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let corner = |u: f64, v: f64| {
                    let mut p = [0.0; 3];
                    p[axis] = side * half[axis];
                    // Swapping u and v on the low side keeps the corners counter-clockwise.
                    let (u, v) = if side > 0.0 { (u, v) } else { (v, u) };
                    p[(axis + 1) % 3] = u * half[(axis + 1) % 3];
                    p[(axis + 2) % 3] = v * half[(axis + 2) % 3];
                    Vec3::of(p)
                };
                let [a, b, c, d] = [
                    corner(-1.0, -1.0),
                    corner(1.0, -1.0),
                    corner(1.0, 1.0),
                    corner(-1.0, 1.0),
                ];
                mesh.push_flat(a, b, c);
                mesh.push_flat(a, c, d);
            }
        }
        mesh
    }

    /// A hull's own triangles, flat.
    pub(super) fn hull(hull: &Hull) -> Self {
        let mut mesh = Self::default();
        for t in &hull.triangles {
            let [a, b, c] = t.map(|i| Vec3::of(hull.vertices[i as usize]));
            mesh.push_flat(a, b, c);
        }
        mesh
    }

    /// Triangles with smooth normals, weighted by the corners' angles, except across edges
    /// sharper than 40°. `triangles` must name existing positions.
    pub(super) fn smooth(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Self {
        let at = |i: u32| Vec3::of(positions[i as usize]);
        let shared = weld(positions);
        let flat: Vec<Vec3<f64>> = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(at);
                (b - a).cross(c - a).unit_or(Vec3::ZERO)
            })
            .collect();
        // Per welded vertex: the triangles that meet there and their angle.
        let mut corners: Vec<Vec<(usize, f64)>> = vec![Vec::new(); positions.len()];
        for (k, t) in triangles.iter().enumerate() {
            for c in 0..3 {
                let [p, q, r] = [t[c], t[(c + 1) % 3], t[(c + 2) % 3]].map(at);
                let (u, v) = ((q - p).unit_or(Vec3::ZERO), (r - p).unit_or(Vec3::ZERO));
                let angle = u.dot(v).clamp(-1.0, 1.0).acos();
                corners[shared[t[c] as usize] as usize].push((k, angle));
            }
        }
        let mut mesh = Self::default();
        for (k, t) in triangles.iter().enumerate() {
            for &i in t {
                let mut normal = Vec3::ZERO;
                for &(other, angle) in &corners[shared[i as usize] as usize] {
                    if flat[other].dot(flat[k]) >= SMOOTH_COSINE {
                        normal += flat[other] * angle;
                    }
                }
                mesh.push(at(i), normal.unit_or(flat[k]));
            }
        }
        mesh
    }

    /// Adds another mesh, moved by `body_from_part`.
    pub(super) fn append(&mut self, part: &Self, body_from_part: Pose<f64>) {
        let first = self.positions.len() as u32;
        self.positions.extend(
            part.positions
                .iter()
                .map(|&p| body_from_part.point(Vec3::of_f32(p)).to_f32()),
        );
        self.normals.extend(
            part.normals
                .iter()
                .map(|&n| body_from_part.turn.rotate(Vec3::of_f32(n)).to_f32()),
        );
        self.indices.extend(part.indices.iter().map(|i| first + i));
    }

    fn push_flat(&mut self, a: Vec3<f64>, b: Vec3<f64>, c: Vec3<f64>) {
        let normal = (b - a).cross(c - a).unit_or(Vec3::UP);
        for p in [a, b, c] {
            self.push(p, normal);
        }
    }

    fn push(&mut self, position: Vec3<f64>, normal: Vec3<f64>) {
        self.indices.push(self.positions.len() as u32);
        self.positions.push(position.to_f32());
        self.normals.push(normal.to_f32());
    }
}

/// For each position the first one at the same place: files split vertices for their textures.
fn weld(positions: &[[f64; 3]]) -> Vec<u32> {
    let mut first = std::collections::HashMap::new();
    positions
        .iter()
        .enumerate()
        .map(|(i, p)| *first.entry(p.map(f64::to_bits)).or_insert(i as u32))
        .collect()
}

/// Turns rings, given from low to high, about y. A ring of radius 0 is a pole.
fn revolve(rings: &[Ring]) -> DrawMesh {
    let mut mesh = DrawMesh::default();
    let around = AROUND as usize;
    for ring in rings {
        for k in 0..=AROUND {
            let turns = f64::from(k % AROUND) / f64::from(AROUND);
            let (s, c) = (sin_turns(turns), cos_turns(turns));
            let [across, up] = ring.normal;
            mesh.positions
                .push([ring.radius * c, ring.y, -ring.radius * s].map(|v| v as f32));
            mesh.normals
                .push([across * c, up, -across * s].map(|v| v as f32));
        }
    }
    for (r, pair) in rings.windows(2).enumerate() {
        let [low, high] = [pair[0], pair[1]];
        if low.radius == high.radius && low.y == high.y {
            continue;
        }
        for k in 0..around {
            let a = (r * (around + 1) + k) as u32;
            let d = a + around as u32 + 1;
            if low.radius > 0.0 {
                mesh.indices.extend([a, a + 1, d + 1]);
            }
            if high.radius > 0.0 {
                mesh.indices.extend([a, d + 1, d]);
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six times the signed volume of a mesh, and its worst normal.
    fn measure(mesh: &DrawMesh) -> (f64, f64) {
        let mut volume = 0.0;
        let mut agreement: f64 = 1.0;
        for t in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| Vec3::of_f32(mesh.positions[i as usize]));
            volume += a.dot(b.cross(c)) / 6.0;
            let flat: Vec3<f64> = (b - a).cross(c - a).unit_or(Vec3::ZERO);
            for &i in t {
                let n = Vec3::of_f32(mesh.normals[i as usize]);
                agreement = agreement.min(flat.dot(n));
            }
        }
        (volume, agreement)
    }

    #[test]
    fn meshes_face_outward_and_hold_their_volume() {
        use std::f64::consts::PI;
        let (r, h) = (0.5, 0.3);
        let round = PI * r * r;
        let cases = [
            (DrawMesh::ball(r), 4.0 / 3.0 * PI * r * r * r),
            (
                DrawMesh::capsule(r, h),
                4.0 / 3.0 * PI * r * r * r + round * 2.0 * h,
            ),
            (DrawMesh::cylinder(r, h), round * 2.0 * h),
            (DrawMesh::cuboid([0.1, 0.2, 0.3]), 8.0 * 0.006),
        ];
        for (mesh, want) in cases {
            let (volume, agreement) = measure(&mesh);
            // 32 sides of a circle lose 0.64% of its area, 16 of a meridian as much again.
            assert!(
                volume <= want * 1.000_001 && volume > want * 0.98,
                "{volume} {want}"
            );
            assert!(agreement > 0.98, "{agreement}");
        }
    }

    #[test]
    fn smooth_normals_stop_at_sharp_edges() {
        let cube = DrawMesh::cuboid([1.0; 3]);
        let positions: Vec<[f64; 3]> = cube.positions.iter().map(|p| p.map(f64::from)).collect();
        let triangles: Vec<[u32; 3]> = cube
            .indices
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]])
            .collect();
        let (volume, agreement) = measure(&DrawMesh::smooth(&positions, &triangles));
        assert!((volume - 8.0).abs() < 1e-9);
        assert!(agreement > 1.0 - 1e-6);
    }
}
