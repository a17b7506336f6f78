//! Depth cubes: six orthographic depth faces around a convex part.
//!
//! O09 section 5.2, after Kolb et al. 2004: a point is inside where it lies behind the stored
//! surface on ALL six faces (eq. 3), and leaves along the stored normal of the face with the
//! shortest way. Deviations, each for accuracy:
//! - one cube per convex part, in the part's own space, so that nothing concave is filled;
//! - a ray through each texel's centre meets the part exactly, instead of a rasterised mesh;
//! - the way out is |d|·|n·a| along n (a the face's axis), not |d|: pushing by |d| overshoots by
//!   up to √3 (eq. 4-5 count the normal twice);
//! - sampling is *masked bilinear*: weights over texels that were hit only, outside if they sum to
//!   less than ½;
//! - a texel whose surface point lies inside a neighbouring part of the same body is *hidden*: it
//!   tells inside from outside, but no way out leads through it.
//!
//! Limits: the silhouette is known to half a texel, so a point may stay inside by up to a texel.
//! WGSL twin: `shaders/depth_cube.wgsl` (drawing), `shaders/shared/cube.wgsl` (sampling).

use crate::base::{Real, Vec3, vec3};

use super::solid::{Choice, Exit, Plane, Reach, Solid};

/// Set where a texel's ray met the part.
pub const HIT: u32 = 1 << 31;
/// Set where the surface point lies inside another part of the body.
pub const HIDDEN: u32 = 1 << 30;
/// Depth is stored as a fraction of the face's extent in units of 2⁻²⁹.
pub const DEPTH_STEPS: f64 = 536_870_912.0;
/// A way out through a hidden face counts as longer by this, in metres: more than any body's size.
pub const HIDDEN_M: f64 = 1000.0;
/// A surface point this deep inside a neighbouring part is hidden, in metres: faces that merely
/// meet do not hide each other.
pub const COVER_MARGIN_M: f64 = 1e-4;
const DEPTH_MASK: u32 = HIDDEN - 1;

/// The six faces of one part. Face 2a looks along −axis a from the upper bound, face 2a + 1 along
/// +axis a from the lower one; its columns run along axis a + 1, its rows along axis a + 2.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthCube {
    /// Bounds in the part's space.
    pub low: Vec3<f32>,
    pub high: Vec3<f32>,
    /// Texels along the edge of a face.
    pub resolution: u32,
    /// Six faces of `resolution`² texels: flags and depth, and the packed normal.
    pub texels: Vec<[u32; 2]>,
}

/// A surface point on a face.
#[derive(Clone, Copy, Debug)]
struct Surface<R> {
    depth: R,
    normal: Vec3<R>,
    hidden: bool,
}

/// Axis `a` of a vector.
fn axis<R: Real>(v: Vec3<R>, a: u32) -> R {
    match a % 3 {
        0 => v.x,
        1 => v.y,
        _ => v.z,
    }
}

impl DepthCube {
    /// Draws the cube of `solid`. `covered` says whether a point of the part's space lies inside a
    /// neighbouring part.
    pub fn draw(solid: &Solid<f32>, resolution: u32, covered: impl Fn(Vec3<f32>) -> bool) -> Self {
        let [low, high] = solid.bounds();
        let size = high - low;
        let mut texels = Vec::with_capacity(6 * (resolution * resolution) as usize);
        for face in 0..6 {
            let (a, extent) = (face / 2, axis(size, face / 2));
            for row in 0..resolution {
                for column in 0..resolution {
                    let centre = |n: u32, a: u32| {
                        axis(low, a) + (n as f32 + 0.5) / resolution as f32 * axis(size, a)
                    };
                    let (from, along) =
                        ray(face, low, high, centre(column, a + 1), centre(row, a + 2));
                    texels.push(match enter(solid, from, along) {
                        Some((depth, normal)) => {
                            let hidden = covered(from + along * depth);
                            pack(depth / extent, normal, hidden)
                        }
                        None => [0, 0],
                    });
                }
            }
        }
        Self {
            low,
            high,
            resolution,
            texels,
        }
    }

    /// Longest edge of a texel, in metres.
    pub fn texel_m(&self) -> f32 {
        let size = self.high - self.low;
        size.x.max(size.y).max(size.z) / self.resolution as f32
    }

    /// Depth of a point behind face `face`, along its axis; `None` outside the face's silhouette.
    fn behind<R: Real>(&self, p: Vec3<R>, face: u32) -> Option<R> {
        let surface = self.sample(p, face, false)?;
        let a = face / 2;
        let below = if face & 1 == 0 {
            R::of_f32(axis(self.high, a)) - axis(p, a)
        } else {
            axis(p, a) - R::of_f32(axis(self.low, a))
        };
        Some(below - surface.depth)
    }

    /// True where a point is behind all six faces.
    pub fn inside<R: Real>(&self, p: Vec3<R>) -> bool {
        (0..3).all(|a| {
            axis(p, a) > R::of_f32(axis(self.low, a)) && axis(p, a) < R::of_f32(axis(self.high, a))
        }) && (0..6).all(|face| self.behind(p, face).is_some_and(|d| d > R::ZERO))
    }

    /// The way out for a point inside, or `None` outside. `kept` is the face of the last sub-step
    /// or [`NO_FACE`](super::solid::NO_FACE).
    pub fn exit<R: Real>(&self, p: Vec3<R>, kept: u32, reach: &Reach<R>) -> Option<Exit<R>> {
        if !self.inside(p) {
            return None;
        }
        let mut choice = Choice::new(kept);
        for face in 0..6 {
            let surface = self.sample(p, face, true)?;
            let normal = surface.normal;
            let depth = self.behind(p, face)? * axis(normal, face / 2).abs();
            let mut cost = reach.cost(p, depth, normal);
            if surface.hidden {
                cost += R::of(HIDDEN_M);
            }
            choice.offer(
                cost,
                Exit {
                    depth,
                    normal,
                    face,
                },
            );
        }
        choice.take()
    }

    /// Masked bilinear sample of a face under a point.
    fn sample<R: Real>(&self, p: Vec3<R>, face: u32, with_normal: bool) -> Option<Surface<R>> {
        let a = face / 2;
        let place = |b: u32| {
            let low = R::of_f32(axis(self.low, b));
            let size = R::of_f32(axis(self.high, b)) - low;
            (axis(p, b) - low) / size * R::of(f64::from(self.resolution)) - R::of(0.5)
        };
        let (s, t) = (place(a + 1), place(a + 2));
        let (column, row) = (s.floor(), t.floor());
        let (fs, ft) = (s - column, t - row);
        let last = i64::from(self.resolution) - 1;
        let clamped = |n: R, more: i64| (n.to_f64() as i64 + more).clamp(0, last) as usize;
        let mut weight = R::ZERO;
        let mut hidden = R::ZERO;
        let mut depth = R::ZERO;
        let mut normal = Vec3::ZERO;
        for corner in 0..4 {
            let (right, down) = (corner & 1, corner >> 1);
            let w = (if right == 1 { fs } else { R::ONE - fs })
                * (if down == 1 { ft } else { R::ONE - ft });
            let at = clamped(row, down) * self.resolution as usize + clamped(column, right);
            let [word, packed] =
                self.texels[face as usize * (self.resolution * self.resolution) as usize + at];
            if word & HIT == 0 {
                continue;
            }
            weight += w;
            depth += w * R::of(f64::from(word & DEPTH_MASK) / DEPTH_STEPS);
            if with_normal {
                normal += unpack_normal(packed) * w;
                if word & HIDDEN != 0 {
                    hidden += w;
                }
            }
        }
        if weight < R::of(0.5) {
            return None;
        }
        let extent = R::of_f32(axis(self.high, a)) - R::of_f32(axis(self.low, a));
        Some(Surface {
            depth: depth / weight * extent,
            normal: normal.unit_or(face_normal(face)),
            hidden: hidden * R::of(2.0) > weight,
        })
    }
}

fn face_normal<R: Real>(face: u32) -> Vec3<R> {
    let sign = if face & 1 == 0 { R::ONE } else { -R::ONE };
    match face / 2 {
        0 => vec3(sign, R::ZERO, R::ZERO),
        1 => vec3(R::ZERO, sign, R::ZERO),
        _ => vec3(R::ZERO, R::ZERO, sign),
    }
}

/// Start and direction of the ray through a texel of a face.
fn ray(face: u32, low: Vec3<f32>, high: Vec3<f32>, s: f32, t: f32) -> (Vec3<f32>, Vec3<f32>) {
    let from = if face & 1 == 0 { high } else { low };
    let from = match face / 2 {
        0 => vec3(from.x, s, t),
        1 => vec3(t, from.y, s),
        _ => vec3(s, t, from.z),
    };
    (from, -face_normal(face))
}

/// First meeting of a ray along a coordinate axis with a solid: distance and outward normal.
fn enter(solid: &Solid<f32>, from: Vec3<f32>, along: Vec3<f32>) -> Option<(f32, Vec3<f32>)> {
    match solid {
        Solid::Ball { radius } => enter_ball(from, along, *radius),
        Solid::Box { half } => {
            let plane = |x, y, z, offset| Plane {
                normal: vec3(x, y, z),
                offset,
            };
            let faces = [
                plane(1.0, 0.0, 0.0, half.x),
                plane(-1.0, 0.0, 0.0, half.x),
                plane(0.0, 1.0, 0.0, half.y),
                plane(0.0, -1.0, 0.0, half.y),
                plane(0.0, 0.0, 1.0, half.z),
                plane(0.0, 0.0, -1.0, half.z),
            ];
            enter_planes(&faces, from, along)
        }
        Solid::Convex { planes, .. } => enter_planes(planes, from, along),
        Solid::Cylinder { radius, half } => enter_cylinder(from, along, *radius, *half),
        Solid::Capsule { radius, half } => enter_capsule(from, along, *radius, *half),
    }
}

fn enter_ball(from: Vec3<f32>, along: Vec3<f32>, radius: f32) -> Option<(f32, Vec3<f32>)> {
    let middle = -from.dot(along);
    let off = from + along * middle;
    let left = radius * radius - off.length_squared();
    (left > 0.0).then(|| {
        let t = middle - left.sqrt();
        (t, (from + along * t).unit_or(-along))
    })
}

fn enter_planes(
    planes: &[Plane<f32>],
    from: Vec3<f32>,
    along: Vec3<f32>,
) -> Option<(f32, Vec3<f32>)> {
    let mut first = (0.0_f32, -along);
    let mut last = f32::MAX;
    for plane in planes {
        let slope = plane.normal.dot(along);
        let ahead = plane.offset - plane.normal.dot(from);
        if slope.abs() < 1e-7 {
            if ahead < 0.0 {
                return None;
            }
        } else if slope < 0.0 {
            let t = ahead / slope;
            // Bounds touch the outermost planes, so `>=` lets a face at the very start win.
            if t >= first.0 {
                first = (t, plane.normal);
            }
        } else {
            last = last.min(ahead / slope);
        }
    }
    (first.0 < last).then_some(first)
}

fn enter_cylinder(
    from: Vec3<f32>,
    along: Vec3<f32>,
    radius: f32,
    half: f32,
) -> Option<(f32, Vec3<f32>)> {
    if along.y != 0.0 {
        let inside = from.x * from.x + from.z * from.z < radius * radius;
        return inside.then(|| (from.y.abs() - half, vec3(0.0, -along.y, 0.0)));
    }
    let (t, normal) = enter_ball(vec3(from.x, 0.0, from.z), along, radius)?;
    (from.y.abs() < half).then_some((t, normal))
}

fn enter_capsule(
    from: Vec3<f32>,
    along: Vec3<f32>,
    radius: f32,
    half: f32,
) -> Option<(f32, Vec3<f32>)> {
    // The nearest ball of the capsule: the end it comes from, or the one at the ray's own height.
    let centre = if along.y != 0.0 {
        -along.y * half
    } else {
        from.y.clamp(-half, half)
    };
    enter_ball(vec3(from.x, from.y - centre, from.z), along, radius)
}

fn pack(depth: f32, normal: Vec3<f32>, hidden: bool) -> [u32; 2] {
    let steps = (depth.clamp(0.0, 1.0) * DEPTH_STEPS as f32) as u32;
    let flags = HIT | if hidden { HIDDEN } else { 0 };
    [flags | steps, pack_normal(normal)]
}

/// Octahedral map of a unit normal, 16 bits for each of its two coordinates.
fn pack_normal(n: Vec3<f32>) -> u32 {
    let sum = n.x.abs() + n.y.abs() + n.z.abs();
    let (mut x, mut y) = (n.x / sum, n.y / sum);
    if n.z < 0.0 {
        let sign = |v: f32| if v < 0.0 { -1.0 } else { 1.0 };
        (x, y) = ((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y));
    }
    let steps = |v: f32| ((v * 0.5 + 0.5).clamp(0.0, 1.0) * 65_535.0 + 0.5) as u32;
    steps(x) | steps(y) << 16
}

/// The unit normal that a texel's second word stands for.
pub fn unpack_normal<R: Real>(word: u32) -> Vec3<R> {
    let value = |bits: u32| R::of(f64::from(bits)) * R::of(2.0 / 65_535.0) - R::ONE;
    let (mut x, mut y) = (value(word & 0xffff), value(word >> 16));
    let z = R::ONE - x.abs() - y.abs();
    if z < R::ZERO {
        let sign = |v: R| if v < R::ZERO { -R::ONE } else { R::ONE };
        (x, y) = ((R::ONE - y.abs()) * sign(x), (R::ONE - x.abs()) * sign(y));
    }
    vec3(x, y, z).unit_or(Vec3::UP)
}

#[cfg(test)]
mod tests {
    use super::super::solid::NO_FACE;
    use super::*;

    fn random(k: u32) -> Vec3<f32> {
        let at = |salt: u32| crate::base::philox::philox2x32([k, salt], 5, 7)[0];
        vec3(
            crate::base::philox::unit(at(0)) - 0.5,
            crate::base::philox::unit(at(1)) - 0.5,
            crate::base::philox::unit(at(2)) - 0.5,
        )
    }

    fn solids() -> Vec<Solid<f32>> {
        // A box of half sides 0.2, 0.3 and 0.25, turned about two axes: within 0.44 of its centre.
        let axes = [
            vec3(0.8, 0.6, 0.0),
            vec3(-0.48, 0.64, 0.6),
            vec3(0.36, -0.48, 0.8),
        ];
        let planes = axes.into_iter().zip([0.2, 0.3, 0.25]);
        let planes = planes
            .flat_map(|(normal, offset)| [normal, -normal].map(|normal| Plane { normal, offset }));
        vec![
            Solid::Ball { radius: 0.4 },
            Solid::Box {
                half: vec3(0.3, 0.2, 0.4),
            },
            Solid::Capsule {
                radius: 0.2,
                half: 0.2,
            },
            Solid::Cylinder {
                radius: 0.3,
                half: 0.2,
            },
            Solid::Convex {
                planes: planes.collect(),
                low: vec3(-0.44, -0.44, -0.44),
                high: vec3(0.44, 0.44, 0.44),
            },
        ]
    }

    #[test]
    fn normals_survive_packing() {
        for k in 0..2000 {
            let n = random(k).unit_or(Vec3::UP);
            let back: Vec3<f32> = unpack_normal(pack_normal(n));
            // Half a step of 2/65535 in x and y moves the point on the octahedron by at most √6 of
            // it (z follows both), and the way to the sphere stretches that by at most √3: 6.5e-5.
            assert!((back - n).length() < 6.5e-5, "{n:?} {back:?}");
        }
    }

    #[test]
    fn inside_and_outside_agree_with_the_shape_but_for_a_texel() {
        for solid in solids() {
            let cube = DepthCube::draw(&solid, 64, |_| false);
            let texel = cube.texel_m();
            for k in 0..20_000 {
                let p = random(k);
                let depth = solid.depth(p);
                if depth.abs() > texel {
                    assert_eq!(cube.inside(p), depth > 0.0, "{solid:?} {p:?} {depth}");
                }
            }
        }
    }

    #[test]
    fn the_way_out_leaves_at_most_a_texel_inside() {
        for solid in solids() {
            let cube = DepthCube::draw(&solid, 64, |_| false);
            for k in 0..20_000 {
                let p = random(k);
                if let Some(exit) = cube.exit(p, NO_FACE, &Reach::anywhere()) {
                    let out = p + exit.normal * exit.depth;
                    // One push may end inside next to an edge, where a texel mixes two faces; the
                    // second look at it, as every round does, must not.
                    let out = match cube.exit(out, exit.face, &Reach::anywhere()) {
                        Some(again) => out + again.normal * again.depth,
                        None => out,
                    };
                    assert!(solid.depth(out) < cube.texel_m(), "{solid:?} {p:?}");
                }
            }
        }
    }

    #[test]
    fn no_way_out_leads_through_a_hidden_face() {
        let half = vec3(0.2, 0.2, 0.2);
        let cube = DepthCube::draw(&Solid::Box { half }, 32, |p| p.x > 0.199);
        let exit = cube
            .exit(vec3(0.19, 0.1, 0.0), NO_FACE, &Reach::anywhere())
            .expect("inside");
        assert_eq!(exit.face, 2, "{exit:?}");
    }
}
