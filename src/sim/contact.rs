//! A contact as the kernels see it: in the engine's float, with a way out for points inside.
//!
//! WGSL twin: `shaders/shared/contact.wgsl`.

use std::ops::Range;

use crate::base::{Pose, Real, Vec3};

use super::depth_cube::DepthCube;
use super::parts::{Part, Tested};
use super::solid::{Exit, NO_FACE, Reach, Solid};
use super::voxel_field::VoxelField;
use super::work::Contact;

/// One part near a tile, ready for its vertices.
#[derive(Clone, Debug)]
pub struct Touch<'a, R> {
    pub from: Pose<R>,
    pub to: Pose<R>,
    pub radius_m: R,
    pub sweeps: u32,
    /// A vertex that was pushed before is held while it is no farther off, in metres.
    hold_m: R,
    grown: &'a Solid<R>,
    /// Place in the tile's list, and the places of all parts of the same body.
    number: usize,
    body: Range<usize>,
    /// Body and part, in the upper bits of a vertex's memory of its face.
    key: u32,
    collider: ColliderOf<'a, R>,
}

/// The parts near a tile at one instant of a sub-step.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a, R> {
    pub touches: &'a [Touch<'a, R>],
    /// Share of the sub-step.
    pub share: R,
    /// A point this deep in a grown part is inside the part, in metres.
    pub cover_m: R,
}

impl<'a, R: Real> Moment<'a, R> {
    /// `anchor_from_part` of a touch.
    pub fn pose_of(&self, touch: &Touch<R>) -> Pose<R> {
        touch.from.lerp(touch.to, self.share)
    }

    /// True where a point of the anchor's space is in another part of a touch's body.
    fn is_covered(&self, touch: &Touch<R>, p: Vec3<R>) -> bool {
        let mut others = touch.body.clone().filter(|&n| n != touch.number);
        others.any(|n| {
            let other = &self.touches[n];
            other.grown.depth(self.pose_of(other).inverse_point(p)) > self.cover_m
        })
    }
}

#[derive(Clone, Debug)]
enum ColliderOf<'a, R> {
    Cube(&'a DepthCube),
    Analytic(&'a Solid<R>),
    Voxels(&'a VoxelField),
}

/// A segment that was laid out at its length, in the anchor's coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Laid<R> {
    /// Its lower node.
    pub from: Vec3<R>,
    pub length: R,
    /// Where its upper node was before.
    pub before: Vec3<R>,
}

/// Bits of a vertex's memory that hold the face; 0 there means none, others are the face + 1.
const FACE_BITS: u32 = 8;
/// The bits of the face.
pub const FACE_MASK: u32 = (1 << FACE_BITS) - 1;
/// Bits that tell the parts of a body apart.
const PART_BITS: u32 = 8;

impl<'a, R: Real> Touch<'a, R> {
    /// Prepares the contact at place `number` of a tile's list. A part whose cube is not drawn yet is
    /// tested by its closed form. `grown` is the part's solid with the skin, in the engine's float.
    pub fn new(number: usize, contact: &Contact, part: &'a Part, grown: &'a Solid<R>) -> Self {
        let first = number - contact.part_in_body as usize;
        let collider = match (contact.tested, &part.cube, &part.voxels) {
            (Tested::Cube, Some(cube), _) => ColliderOf::Cube(cube),
            (Tested::Voxels, _, Some(voxels)) => ColliderOf::Voxels(voxels),
            _ => ColliderOf::Analytic(grown),
        };
        Self {
            from: contact.from.cast(),
            to: contact.to.cast(),
            radius_m: R::of(contact.radius_m),
            sweeps: contact.sweeps,
            hold_m: R::of(hold_m(part, contact.tested)),
            grown,
            number,
            body: first..first + contact.parts_of_body as usize,
            key: memory_key(contact),
            collider,
        }
    }

    /// True where the swept ball around the part may reach a ball around a plant's root.
    pub fn reaches(&self, root: Vec3<R>, reach: R) -> bool {
        let way = self.to.place - self.from.place;
        let length_squared = way.length_squared();
        let t = if length_squared > R::of(1e-12) {
            ((root - self.from.place).dot(way) / length_squared).clamp(R::ZERO, R::ONE)
        } else {
            R::ZERO
        };
        let nearest = self.from.place + way * t;
        let distance = self.radius_m + reach;
        (root - nearest).length_squared() <= distance * distance
    }

    /// True where a vertex is inside the part at `pose`, and not merely on its surface.
    pub fn holds(&self, pose: &Pose<R>, vertex: Vec3<R>) -> bool {
        let p = pose.inverse_point(vertex);
        let on_surface_m = on_surface_m();
        match self.collider {
            ColliderOf::Cube(cube) => cube.is_deeper(p, on_surface_m),
            ColliderOf::Analytic(solid) => solid.depth(p) > on_surface_m,
            ColliderOf::Voxels(voxels) => voxels.is_deeper(p, on_surface_m),
        }
    }

    /// True where a vertex is certainly outside the part at `pose`, so that it has no way out: far
    /// cheaper to know than the way out of a depth cube, which reaches beyond a convex part by less than
    /// a texel. Of other colliders the way out asks for the depth itself, and first.
    pub fn is_clear_of(&self, pose: &Pose<R>, vertex: Vec3<R>) -> bool {
        let outside_m = match self.collider {
            _ if matches!(self.grown, Solid::Union(_) | Solid::Mesh { .. }) => return false,
            ColliderOf::Voxels(_) | ColliderOf::Analytic(_) => return false,
            ColliderOf::Cube(cube) => R::of_f32(cube.texel_m()),
        };
        self.grown.depth(pose.inverse_point(vertex)) <= -outside_m
    }

    /// True where a vertex is inside the part at the end of the sub-step or so close to it that a
    /// plant the body pushed before is still held.
    pub fn nearly_holds(&self, vertex: Vec3<R>) -> bool {
        self.depth_at_end(vertex) > -self.hold_m
    }

    /// True where a vertex would be inside the part at the end of the sub-step.
    pub fn will_hold(&self, vertex: Vec3<R>) -> bool {
        self.depth_at_end(vertex) > on_surface_m()
    }

    fn depth_at_end(&self, vertex: Vec3<R>) -> R {
        self.grown.depth(self.to.inverse_point(vertex))
    }

    /// The way out for a vertex inside the part at `pose`, with its normal turned into the anchor's
    /// coordinates. `memory` is the vertex's word about the face it left through last; it is kept
    /// up to date. Where the vertex was laid out at the end of a `segment`, only ways out in the
    /// segment's reach count.
    pub fn exit(
        &self,
        moment: &Moment<R>,
        pose: &Pose<R>,
        vertex: Vec3<R>,
        memory: &mut u32,
        segment: Option<&Laid<R>>,
    ) -> Option<Exit<R>> {
        let p = pose.inverse_point(vertex);
        let reach = segment.map_or_else(Reach::anywhere, |laid| Reach {
            from: pose.inverse_point(laid.from),
            length: laid.length,
            before: pose.inverse_point(laid.before),
        });
        let kept = if *memory & !FACE_MASK == self.key && *memory & FACE_MASK != 0 {
            (*memory & FACE_MASK) - 1
        } else {
            NO_FACE
        };
        let exit = match self.collider {
            ColliderOf::Cube(cube) => cube.exit(p, kept, &reach),
            ColliderOf::Analytic(solid) => solid.exit(p, kept, &reach, |end| {
                self.body.len() > 1 && moment.is_covered(self, pose.point(end))
            }),
            ColliderOf::Voxels(voxels) => voxels.exit(p),
        }?;
        *memory = self.key | ((exit.face + 1) & FACE_MASK);
        Some(Exit {
            normal: pose.turn.rotate(exit.normal),
            ..exit
        })
    }
}

/// How far off a body still holds a plant it pushed before, in metres: as far as a push may
/// overshoot, which is half a texel for a depth cube and half a cell for a voxel field.
pub fn hold_m(part: &Part, tested: Tested) -> f64 {
    let step_m = match tested {
        Tested::Closed => None,
        Tested::Cube => part.cube.as_ref().map(DepthCube::texel_m),
        Tested::Voxels => part.voxels.as_ref().map(VoxelField::cell_m),
    };
    HOLD_M + 0.5 * f64::from(step_m.unwrap_or(0.0))
}

/// See [`hold_m`].
pub const HOLD_M: f64 = 0.001;

/// The body through whose face a vertex was pushed out last, from the vertex's memory; `None` if
/// none was.
pub fn body_of(memory: u32) -> Option<u32> {
    (memory & FACE_MASK != 0).then_some(memory >> (FACE_BITS + PART_BITS))
}

/// A vertex is on a surface where it is no deeper than this many roundings of a coordinate of a metre.
/// One that was pushed onto the surface is inside or outside of it by chance; were it pushed anew each
/// time, its plant would creep for as long as the body lies there.
pub const ON_SURFACE_ROUNDINGS: f64 = 16.0;
fn on_surface_m<R: Real>() -> R {
    R::of(ON_SURFACE_ROUNDINGS) * R::EPSILON
}

/// The same for the float of the shaders, in metres.
pub const ON_SURFACE_M: f32 = ON_SURFACE_ROUNDINGS as f32 * f32::EPSILON;

/// Body and part of a contact as the upper bits of a vertex's memory. Bodies share keys beyond
/// 65,536 and parts beyond 256: a shared key costs a steady face at worst.
pub fn memory_key(contact: &Contact) -> u32 {
    let part = contact.part_in_body & ((1 << PART_BITS) - 1);
    (contact.body << (FACE_BITS + PART_BITS)) | (part << FACE_BITS)
}
