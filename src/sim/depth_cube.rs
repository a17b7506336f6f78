//! Depth cubes: six orthographic depth faces around a convex part.
//!
//! O09 section 5.2, after Kolb et al. 2004: a point is inside where it lies behind the stored
//! surface on ALL six faces (eq. 3), and leaves along the stored normal of the face with the
//! shortest way. Deviations, each for accuracy:
//! - one cube per convex part, in the part's own space, so that nothing concave is filled;
//! - a ray through each texel's centre meets the part exactly, instead of a rasterised mesh;
//! - the way out is |d|·|n·a| along n (a the face's axis), not |d|: pushing by |d| overshoots by
//!   up to √3 (eq. 4-5 count the normal twice);
//! - a texel stands for its *tangent plane*, and the distances of a point to the planes of the
//!   texels around it that were hit are mixed by bilinear weights. A supporting plane of a convex
//!   part is never inside it, so that nothing of the part is lost at a silhouette, and a surface of
//!   radius R is met to h²/4R at most with texels of side h (0.04 mm for a ball of 15 cm at 64);
//!   depths alone, mixed over hit texels (*masked*), know the silhouette to half a texel;
//! - the plane is looked up once more where the way out ends, since the one below the point is not the
//!   nearest of a round part;
//! - a texel whose surface point lies inside a neighbouring part of the same body is *hidden*: it
//!   tells inside from outside, but no way out leads through it.
//!
//! [`Sampling`] and [`Push`] select masked and plain bilinear depths, nearest texels and |d| where a
//! comparison needs them (in the cpu engine alone).
//!
//! Limits: an edge between two faces is rounded off by up to a texel, which is as far as a point may
//! stay inside; other samplings know the silhouette to half a texel.
//! WGSL twin: `shaders/depth_cube.wgsl` (drawing), `shaders/shared/cube.wgsl` (sampling).

mod draw;

use crate::base::{Real, Vec3, vec3};
use crate::scene::method::{Push, Sampling};

use super::solid::{Choice, Exit, Reach, Solid};
use draw::{enter, pack, ray};

/// Set where a texel's ray met the part.
pub const HIT: u32 = 1 << 31;
/// Set where the surface point lies inside another part of the body.
pub const HIDDEN: u32 = 1 << 30;
/// Depth is stored as a fraction of the face's extent in units of 2⁻²⁹.
pub const DEPTH_STEPS: f64 = 536_870_912.0;
/// A surface point this deep inside a neighbouring part is hidden, in metres: faces that merely
/// meet do not hide each other.
pub const COVER_MARGIN_M: f64 = 1e-4;

/// The same for parts that are known grown by a skin only, whose depth grows by as much.
pub fn cover_m(skin_m: f64) -> f32 {
    (COVER_MARGIN_M + skin_m) as f32
}

/// A surface is hidden where more than this share of its texels is. One that is hidden in part borders on
/// the inner corner of a body: to take it for hidden would leave a node in the corner without a way out,
/// to take it for open costs it a texel at most, out of which the neighbour pushes it.
pub const HIDDEN_SHARE: f64 = 0.99;
const DEPTH_MASK: u32 = HIDDEN - 1;
/// Weight of the texels that were hit below which a point is outside a face's silhouette: it keeps
/// the division by it away from rounding.
pub const LEAST_WEIGHT: f64 = 1e-3;

/// The six faces of one part. Face 2a looks along −axis a from the upper bound, face 2a + 1 along
/// +axis a from the lower one; its columns run along axis a + 1, its rows along axis a + 2.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthCube {
    /// Bounds in the part's space.
    pub low: Vec3<f32>,
    pub high: Vec3<f32>,
    /// Texels along the edge of a face.
    pub resolution: u32,
    pub sampling: Sampling,
    pub push: Push,
    /// Six faces of `resolution`² texels: flags and depth, and the packed normal.
    pub texels: Vec<[u32; 2]>,
    /// Their normals, unpacked once: done anew at each of the 24 corners that a point looks up, that costs
    /// more than the rest of the look-up.
    normals: Vec<Vec3<f32>>,
}

/// Where a point is between the texels of the faces along one axis.
#[derive(Clone, Copy, Debug)]
struct Between<R> {
    /// The texels before and after it, their weights, and the way from their middles to the point in metres.
    texel: [usize; 2],
    weight: [R; 2],
    off_m: [R; 2],
}

/// A face's surface as a point sees it.
#[derive(Clone, Copy, Debug)]
struct Surface<R> {
    /// How far the point is behind it: from the surface's planes, where `sampling` takes those,
    /// else along the face's axis.
    behind: R,
    along_axis: R,
    /// Not of unit length.
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
        Self::of_texels([low, high], resolution, texels)
    }

    /// The cube whose six faces hold these texels, with the default sampling and push.
    pub fn of_texels([low, high]: [Vec3<f32>; 2], resolution: u32, texels: Vec<[u32; 2]>) -> Self {
        let normals = texels.iter().map(|&[_, packed]| unpack_normal(packed));
        Self {
            low,
            high,
            resolution,
            sampling: Sampling::default(),
            push: Push::default(),
            normals: normals.collect(),
            texels,
        }
    }

    /// Longest edge of a texel, in metres.
    pub fn texel_m(&self) -> f32 {
        let size = self.high - self.low;
        size.x.max(size.y).max(size.z) / self.resolution as f32
    }

    /// True where a point is farther behind all six faces than `depth_m`.
    pub fn is_deeper<R: Real>(&self, p: Vec3<R>, depth_m: R) -> bool {
        if !self.bounds_hold(p) {
            return false;
        }
        let between = self.between(p);
        let mut faces = 0..6;
        faces.all(|face| {
            let surface = self.sample(p, &between, face);
            surface.is_some_and(|s| s.behind > depth_m)
        })
    }

    fn bounds_hold<R: Real>(&self, p: Vec3<R>) -> bool {
        (0..3).all(|a| {
            axis(p, a) > R::of_f32(axis(self.low, a)) && axis(p, a) < R::of_f32(axis(self.high, a))
        })
    }

    /// The way out for a point inside, or `None` outside. `kept` is the face of the last sub-step
    /// or [`NO_FACE`](super::solid::NO_FACE).
    pub fn exit<R: Real>(&self, p: Vec3<R>, kept: u32, reach: &Reach<R>) -> Option<Exit<R>> {
        if !self.bounds_hold(p) {
            return None;
        }
        let between = self.between(p);
        let mut surfaces = [const { None }; 6];
        for (surface, face) in surfaces.iter_mut().zip(0..) {
            let found = self.sample(p, &between, face);
            *surface = Some(found.filter(|s| s.behind > R::ZERO)?);
        }
        let mut choice = Choice::new(p, kept, reach);
        for (surface, face) in surfaces.into_iter().flatten().zip(0..) {
            let normal = surface.normal.unit_or(face_normal(face));
            let depth = match (self.push, self.sampling) {
                (Push::Literal, _) => surface.along_axis,
                (Push::Ratio, Sampling::Planes) => surface.behind,
                (Push::Ratio, _) => surface.along_axis * axis(normal, face / 2).abs(),
            };
            let exit = Exit {
                depth,
                normal,
                face,
            };
            choice.offer(exit, surface.hidden);
        }
        let exit = choice.take()?;
        Some(match (self.push, self.sampling) {
            (Push::Ratio, Sampling::Planes) => self.nearer(p, exit),
            _ => exit,
        })
    }

    /// The way out to the surface where `exit` ends, if that is shorter. A face is read below the
    /// point, not where its way out ends: on a round part the plane found there is tilted by the way's
    /// sideways share over the radius and too far by half its square (1 mm for 2 cm in a ball of
    /// 15 cm; 0.03 mm after this step). No plane of a convex part cuts into it, so that the shorter way
    /// still leads outside.
    fn nearer<R: Real>(&self, p: Vec3<R>, exit: Exit<R>) -> Exit<R> {
        let way = exit.normal * exit.depth;
        let end = p + way;
        let Some(surface) = self.sample(end, &self.between(end), exit.face) else {
            return exit;
        };
        let normal = surface.normal.unit_or(face_normal(exit.face));
        let depth = surface.behind + normal.dot(way);
        if surface.hidden || depth <= R::ZERO || depth >= exit.depth {
            return exit;
        }
        Exit {
            depth,
            normal,
            ..exit
        }
    }

    /// Along each axis, which all faces but two share.
    fn between<R: Real>(&self, p: Vec3<R>) -> [Between<R>; 3] {
        let per_edge = R::of(f64::from(self.resolution));
        let last = i64::from(self.resolution) - 1;
        [0, 1, 2].map(|a| {
            let span = self.span(a);
            let mut place =
                (axis(p, a) - R::of_f32(axis(self.low, a))) / span * per_edge - R::of(0.5);
            if self.sampling == Sampling::Nearest {
                place = (place + R::of(0.5)).floor();
            }
            let before = place.floor();
            let after_share = place - before;
            let texel = [0, 1].map(|more| (before.to_f64() as i64 + more).clamp(0, last));
            Between {
                texel: texel.map(|n| n as usize),
                weight: [R::ONE - after_share, after_share],
                off_m: texel.map(|n| (place - R::of(n as f64)) / per_edge * span),
            }
        })
    }

    /// Extent along an axis, in metres.
    fn span<R: Real>(&self, a: u32) -> R {
        R::of_f32(axis(self.high, a)) - R::of_f32(axis(self.low, a))
    }

    /// A face's surface over a point, between its texels as `sampling` says; `None` outside the
    /// face's silhouette.
    fn sample<R: Real>(
        &self,
        p: Vec3<R>,
        between: &[Between<R>; 3],
        face: u32,
    ) -> Option<Surface<R>> {
        let a = face / 2;
        let [across, along] = [a + 1, a + 2].map(|b| &between[(b % 3) as usize]);
        let span: R = self.span(a);
        let below = if face & 1 == 0 {
            R::of_f32(axis(self.high, a)) - axis(p, a)
        } else {
            axis(p, a) - R::of_f32(axis(self.low, a))
        };
        let per_edge = self.resolution as usize;
        let mut weight = R::ZERO;
        let mut hidden = R::ZERO;
        let mut along_axis = R::ZERO;
        let mut distance = R::ZERO;
        let mut normal = Vec3::ZERO;
        for corner in 0..4 {
            let (right, down) = (corner & 1, corner >> 1);
            let w = across.weight[right] * along.weight[down];
            let row = face as usize * per_edge + along.texel[down];
            let at = row * per_edge + across.texel[right];
            let [word, _] = self.texels[at];
            if word & HIT == 0 {
                if self.sampling == Sampling::Bilinear {
                    weight += w;
                    along_axis += w * (below - span);
                }
                continue;
            }
            let depth = R::of(f64::from(word & DEPTH_MASK) / DEPTH_STEPS) * span;
            let n: Vec3<R> = Vec3::of_f32(self.normals[at].to_f32());
            // From the texel's surface point to `p`, over the face.
            let sideways =
                axis(n, a + 1) * across.off_m[right] + axis(n, a + 2) * along.off_m[down];
            weight += w;
            along_axis += w * (below - depth);
            distance += w * ((below - depth) * axis(n, a).abs() - sideways);
            normal += n * w;
            if word & HIDDEN != 0 {
                hidden += w;
            }
        }
        let enough = match self.sampling {
            Sampling::Planes => R::of(LEAST_WEIGHT),
            _ => R::of(0.5),
        };
        if weight < enough {
            return None;
        }
        let along_axis = along_axis / weight;
        Some(Surface {
            behind: match self.sampling {
                Sampling::Planes => distance / weight,
                _ => along_axis,
            },
            along_axis,
            normal,
            hidden: hidden > R::of(HIDDEN_SHARE) * weight,
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
mod tests;
