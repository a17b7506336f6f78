//! Whole bodies: the union of several convex solids, and a closed mesh.
//!
//! Where convex parts meet, the nearest face of a part may lie inside its neighbour: no way out
//! leads through it. The way out of a union is the shortest one whose end is in no other member;
//! where each end is in another member, the shortest of all is taken, and the next look goes on
//! from there.

use crate::base::{Pose, Real, Vec3, vec3};
use crate::bodies::{RigidShape, TrueMesh};

use super::{Choice, Exit, OUT_OF_REACH_M, Reach, Solid};

/// An end this deep in another member is in it, in metres: members that merely touch do not block
/// each other.
const COVERED_M: f64 = 1e-6;

/// Below this distance to the surface of a mesh, in metres, its triangle's normal is taken: that is
/// where `f32` leaves a direction nothing to go by.
const ON_SURFACE_M: f64 = 1e-6;

/// Faces of a mesh that a vertex can remember.
const FACES: u32 = 254;

/// One of several solids.
#[derive(Clone, Debug)]
pub struct Member<R> {
    pub solid: Solid<R>,
    /// `whole_from_member`.
    pub pose: Pose<R>,
}

impl<R: Real> Member<R> {
    pub(super) fn grown_by<S: Real>(&self, skin_m: f64) -> Member<S> {
        Member {
            solid: self.solid.grown_by(skin_m),
            pose: self.pose.cast(),
        }
    }
}

impl Solid<f64> {
    /// The true shape of a whole body, in the body's space.
    pub fn of_body(shape: &RigidShape) -> Self {
        match &shape.true_mesh {
            Some(mesh) => Self::Mesh {
                mesh: mesh.clone(),
                skin: 0.0,
            },
            None => Self::Union(
                (shape.parts.iter())
                    .map(|part| Member {
                        solid: Self::of_part(&part.solid),
                        pose: part.pose,
                    })
                    .collect(),
            ),
        }
    }
}

pub(super) fn bounds<R: Real>(members: &[Member<R>]) -> [Vec3<R>; 2] {
    let far = R::of(f64::from(f32::MAX));
    let mut bounds = [vec3(far, far, far), vec3(-far, -far, -far)];
    for member in members {
        let [low, high] = member.solid.bounds();
        for corner in 0..8 {
            let pick = |bit: u32, low, high| if corner >> bit & 1 == 0 { low } else { high };
            let p = vec3(
                pick(0, low.x, high.x),
                pick(1, low.y, high.y),
                pick(2, low.z, high.z),
            );
            let p = member.pose.point(p);
            let [low, high] = bounds;
            bounds = [
                vec3(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z)),
                vec3(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z)),
            ];
        }
    }
    bounds
}

/// Depth in the member that a point is deepest in: positive inside the union, and then a lower
/// bound of the distance to its surface.
pub(super) fn depth<R: Real>(members: &[Member<R>], p: Vec3<R>) -> R {
    let depths = members
        .iter()
        .map(|member| member.solid.depth(member.pose.inverse_point(p)));
    depths.reduce(R::max).unwrap_or(R::of(-OUT_OF_REACH_M))
}

pub(super) fn gap<R: Real>(members: &[Member<R>], p: Vec3<R>) -> R {
    let gaps = members
        .iter()
        .map(|member| member.solid.gap(member.pose.inverse_point(p)));
    gaps.reduce(R::min).unwrap_or(R::of(OUT_OF_REACH_M))
}

pub(super) fn exit<R: Real>(
    members: &[Member<R>],
    p: Vec3<R>,
    kept: u32,
    reach: &Reach<R>,
) -> Option<Exit<R>> {
    let mut choice = Choice::new(p, kept, reach);
    let mut first_face = 0;
    for (n, member) in members.iter().enumerate() {
        let local = member.pose.inverse_point(p);
        let local_reach = Reach {
            from: member.pose.inverse_point(reach.from),
            before: member.pose.inverse_point(reach.before),
            ..*reach
        };
        let faces = member.solid.feature_count();
        if member.solid.depth(local) > R::ZERO {
            for face in 0..faces {
                let way = member.solid.feature(local, face);
                let (depth, normal) = (member.solid).way_in_reach(local, face, way, &local_reach);
                let normal = member.pose.turn.rotate(normal);
                let end = p + normal * depth;
                let covered = members.iter().enumerate().any(|(other, member)| {
                    other != n
                        && member.solid.depth(member.pose.inverse_point(end)) > R::of(COVERED_M)
                });
                let exit = Exit {
                    depth,
                    normal,
                    face: (first_face + face) % FACES,
                };
                choice.offer(exit, covered);
            }
        }
        first_face += faces;
    }
    choice.take()
}

pub(super) fn mesh_depth<R: Real>(mesh: &TrueMesh, p: Vec3<R>) -> R {
    let p = Vec3::<f64>::of(p.to_f64());
    let found = mesh.nearest(p.to_f64());
    let distance = (p - Vec3::of(found.point)).length();
    R::of(if found.inside { distance } else { -distance })
}

pub(super) fn mesh_exit<R: Real>(mesh: &TrueMesh, p: Vec3<R>, skin: R) -> Option<Exit<R>> {
    let p = Vec3::<f64>::of(p.to_f64());
    let found = mesh.nearest(p.to_f64());
    let away = p - Vec3::of(found.point);
    let distance = away.length();
    let outward = if found.inside { -away } else { away };
    let depth = skin.to_f64() + if found.inside { distance } else { -distance };
    let normal = if distance > ON_SURFACE_M {
        outward.unit_or(Vec3::of(found.normal))
    } else {
        Vec3::of(found.normal)
    };
    (depth > 0.0).then(|| Exit {
        depth: R::of(depth),
        normal: Vec3::of(normal.to_f64()),
        face: found.triangle % FACES,
    })
}
