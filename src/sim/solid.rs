//! The true shape of a part: how deep a point is inside, and the way out.
//!
//! Closed forms for ball, box, capsule and cylinder; for a convex polyhedron its planes. The
//! depth is the distance to the nearest *feature* (a ball's surface, one of a box's faces, a
//! cylinder's side or one of its caps, a plane). Near the medial axis two features are equally
//! near, so the feature of the last sub-step is kept until another is clearly nearer
//! (hysteresis against flipping). WGSL twin: `shaders/shared/solid.wgsl`, for the convex ones: whole
//! bodies (`whole.rs`) are for the reference, for measures and for one cube per body.

mod round;
mod whole;

use std::sync::Arc;

use crate::base::{Real, Vec3, vec3};
use crate::bodies::{self, TrueMesh};

pub use round::LEAST_SPAN_M2;
pub use whole::Member;

/// A feature is kept until another is nearer by this factor.
pub const KEEP_FACE: f64 = 0.9;
/// No feature is remembered.
pub const NO_FACE: u32 = u32::MAX;

/// A solid about its own origin, in the kernel's float. Lengths in metres.
#[derive(Clone, Debug)]
pub enum Solid<R> {
    Ball {
        radius: R,
    },
    Box {
        half: Vec3<R>,
    },
    Capsule {
        radius: R,
        half: R,
    },
    Cylinder {
        radius: R,
        half: R,
    },
    /// Planes, and a box that holds the solid.
    Convex {
        planes: Vec<Plane<R>>,
        low: Vec3<R>,
        high: Vec3<R>,
    },
    /// Everything that is in one of several convex solids.
    Union(Vec<Member<R>>),
    /// A closed triangle mesh, grown by a skin.
    Mesh {
        mesh: Arc<TrueMesh>,
        skin: R,
    },
}

/// Points with normal·p ≤ offset are inside.
#[derive(Clone, Copy, Debug)]
pub struct Plane<R> {
    pub normal: Vec3<R>,
    pub offset: R,
}

/// The segment whose upper node looks for a way out: one that the segment is too short for is no
/// way out.
#[derive(Clone, Copy, Debug)]
pub struct Reach<R> {
    /// The segment's lower node, in the space of the solid.
    pub from: Vec3<R>,
    /// Its length, in metres; less than 0 if anything can be reached.
    pub length: R,
    /// Where the upper node was before the segment was laid out, in the space of the solid.
    pub before: Vec3<R>,
}

/// A way out of reach counts as longer by this, in metres: more than any body's size.
pub const OUT_OF_REACH_M: f64 = 1000.0;
/// A way out that ends in another part of the body counts as longer by this, in metres: more than any
/// open way, less than one out of reach, which would leave the node where it is.
pub const HIDDEN_M: f64 = 300.0;

impl<R: Real> Reach<R> {
    /// Everything can be reached.
    pub fn anywhere() -> Self {
        Self {
            from: Vec3::ZERO,
            length: -R::ONE,
            before: Vec3::ZERO,
        }
    }

    /// What the way out of `p` by `depth` along `normal` costs, in metres.
    pub fn cost(&self, p: Vec3<R>, depth: R, normal: Vec3<R>) -> R {
        let rise = (p - self.from).dot(normal) + depth;
        if self.length >= R::ZERO && rise.abs() >= self.length {
            depth + R::of(OUT_OF_REACH_M)
        } else {
            depth
        }
    }

    /// True where the upper node was beyond the surface that a way out of `p` leads to: it came in
    /// that way.
    fn came_through(&self, p: Vec3<R>, exit: &Exit<R>) -> bool {
        self.length >= R::ZERO
            && (self.before - p).dot(exit.normal) > exit.depth - R::of(CAME_THROUGH_M)
    }
}

/// A node this close below a surface was beyond it, in metres: as far as one may be that a body still
/// holds ([`HOLD_M`](super::contact::HOLD_M)).
pub const CAME_THROUGH_M: f64 = 1e-3;
/// Two ways out lead to opposite sides where their normals' product is below this (120°): not those
/// through neighbouring faces of a box, but those to either side of a plate or of an edge sharper
/// than 60°.
pub const OPPOSITE: f64 = -0.5;

/// The way out of a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit<R> {
    /// Distance to the surface along the normal, positive inside.
    pub depth: R,
    pub normal: Vec3<R>,
    /// The feature that the way leads through.
    pub face: u32,
}

impl<R: Real> Solid<R> {
    /// The solid of a part.
    pub fn of_part(part: &bodies::Solid) -> Self {
        match part {
            bodies::Solid::Ball { radius } => Self::Ball {
                radius: R::of(*radius),
            },
            bodies::Solid::Box { half } => Self::Box {
                half: Vec3::of(*half),
            },
            bodies::Solid::Capsule { radius, half } => Self::Capsule {
                radius: R::of(*radius),
                half: R::of(*half),
            },
            bodies::Solid::Cylinder { radius, half } => Self::Cylinder {
                radius: R::of(*radius),
                half: R::of(*half),
            },
            bodies::Solid::Convex { planes, vertices } => {
                let extreme = |a: usize, pick: fn(f64, f64) -> f64| {
                    vertices.iter().map(|v| v[a]).reduce(pick).unwrap_or(0.0)
                };
                Self::Convex {
                    planes: planes
                        .iter()
                        .map(|&[x, y, z, d]| Plane {
                            normal: Vec3::of([x, y, z]),
                            offset: R::of(d),
                        })
                        .collect(),
                    low: Vec3::of([0, 1, 2].map(|a| extreme(a, f64::min))),
                    high: Vec3::of([0, 1, 2].map(|a| extreme(a, f64::max))),
                }
            }
        }
    }

    /// The same solid in another float, grown by `skin_m` on all sides.
    pub fn grown_by<S: Real>(&self, skin_m: f64) -> Solid<S> {
        let skin = |r: R| S::of(r.to_f64() + skin_m);
        let same = |r: R| S::of(r.to_f64());
        match self {
            Self::Ball { radius } => Solid::Ball {
                radius: skin(*radius),
            },
            Self::Box { half } => Solid::Box {
                half: vec3(skin(half.x), skin(half.y), skin(half.z)),
            },
            Self::Capsule { radius, half } => Solid::Capsule {
                radius: skin(*radius),
                half: same(*half),
            },
            Self::Cylinder { radius, half } => Solid::Cylinder {
                radius: skin(*radius),
                half: skin(*half),
            },
            Self::Convex { planes, low, high } => Solid::Convex {
                planes: planes
                    .iter()
                    .map(|plane| Plane {
                        normal: Vec3::of(plane.normal.to_f64()),
                        offset: skin(plane.offset),
                    })
                    .collect(),
                low: Vec3::of(low.to_f64().map(|x| x - skin_m)),
                high: Vec3::of(high.to_f64().map(|x| x + skin_m)),
            },
            Self::Union(members) => {
                Solid::Union(members.iter().map(|m| m.grown_by(skin_m)).collect())
            }
            Self::Mesh { mesh, skin: own } => Solid::Mesh {
                mesh: Arc::clone(mesh),
                skin: skin(*own),
            },
        }
    }

    /// Bounds of the solid in its own space.
    pub fn bounds(&self) -> [Vec3<R>; 2] {
        let high = match *self {
            Self::Ball { radius } => vec3(radius, radius, radius),
            Self::Box { half } => half,
            Self::Capsule { radius, half } => vec3(radius, half + radius, radius),
            Self::Cylinder { radius, half } => vec3(radius, half, radius),
            Self::Convex { low, high, .. } => return [low, high],
            Self::Union(ref members) => return whole::bounds(members),
            Self::Mesh { ref mesh, skin } => {
                let [low, high] = mesh.bounds_m.map(Vec3::of);
                let skin = vec3(skin, skin, skin);
                return [low - skin, high + skin];
            }
        };
        [-high, high]
    }

    /// Depth of a point: positive inside, and then the distance to the surface. Outside it is
    /// negative and at most the distance in size.
    pub fn depth(&self, p: Vec3<R>) -> R {
        match self {
            Self::Ball { radius } => *radius - p.length(),
            Self::Box { half } => {
                let d = vec3(half.x - p.x.abs(), half.y - p.y.abs(), half.z - p.z.abs());
                d.x.min(d.y).min(d.z)
            }
            Self::Capsule { radius, half } => *radius - from_axis(p, *half).length(),
            Self::Cylinder { radius, half } => {
                (*radius - across(p).length()).min(*half - p.y.abs())
            }
            Self::Convex { planes, .. } => planes.iter().fold(R::of(1e30), |least, plane| {
                least.min(plane.offset - plane.normal.dot(p))
            }),
            Self::Union(members) => whole::depth(members, p),
            Self::Mesh { mesh, skin } => whole::mesh_depth(mesh, p) + *skin,
        }
    }

    /// The way out for a point inside, or `None` outside. `kept` is the feature of the last
    /// sub-step or [`NO_FACE`]. `covered` says whether a point is in another part of the body.
    pub fn exit(
        &self,
        p: Vec3<R>,
        kept: u32,
        reach: &Reach<R>,
        covered: impl Fn(Vec3<R>) -> bool,
    ) -> Option<Exit<R>> {
        match self {
            Self::Union(members) => whole::exit(members, p, kept, reach),
            Self::Mesh { mesh, skin } => whole::mesh_exit(mesh, p, *skin),
            _ => self.nearest(Choice::new(p, kept, reach), covered),
        }
    }

    /// The cheapest way out through a feature; a point in front of one of them is outside.
    fn nearest(&self, mut choice: Choice<R>, covered: impl Fn(Vec3<R>) -> bool) -> Option<Exit<R>> {
        let p = choice.p;
        for face in 0..self.feature_count() {
            let way = self.feature(p, face);
            if way.0 <= R::ZERO {
                return None;
            }
            let (depth, normal) = self.way_in_reach(p, face, way, choice.reach);
            let exit = Exit {
                depth,
                normal,
                face,
            };
            choice.offer(exit, covered(p + normal * depth));
        }
        choice.take()
    }

    /// Features of a convex solid that a way out may lead through.
    pub(crate) fn feature_count(&self) -> u32 {
        match self {
            Self::Ball { .. } | Self::Capsule { .. } => 1,
            Self::Box { .. } => 6,
            Self::Cylinder { .. } => 3,
            Self::Convex { planes, .. } => planes.len() as u32,
            Self::Union(_) | Self::Mesh { .. } => 0,
        }
    }

    /// Depth of a point behind a feature of a convex solid, and the feature's outward normal.
    fn feature(&self, p: Vec3<R>, face: u32) -> (R, Vec3<R>) {
        let round = |out: Vec3<R>, radius: R| {
            let sideways = vec3(R::ONE, R::ZERO, R::ZERO);
            (radius - out.length(), out.unit_or(sideways))
        };
        match self {
            Self::Ball { radius } => round(p, *radius),
            Self::Capsule { radius, half } => round(from_axis(p, *half), *radius),
            Self::Box { half } => box_face(p, *half, face),
            Self::Cylinder { radius, half } => match face {
                0 => round(across(p), *radius),
                1 => (*half - p.y, Vec3::UP),
                _ => (*half + p.y, -Vec3::UP),
            },
            Self::Convex { planes, .. } => {
                let plane = planes[face as usize];
                (plane.offset - plane.normal.dot(p), plane.normal)
            }
            Self::Union(_) | Self::Mesh { .. } => (R::ZERO, Vec3::UP),
        }
    }

    /// The shortest way out of a convex solid through a feature that is in a segment's reach; only through
    /// round ones another than the shortest of all.
    fn way_in_reach(
        &self,
        p: Vec3<R>,
        face: u32,
        way: (R, Vec3<R>),
        reach: &Reach<R>,
    ) -> (R, Vec3<R>) {
        match self {
            Self::Ball { radius } | Self::Capsule { radius, .. } => {
                round::way_in_reach(p, way, *radius, reach)
            }
            Self::Cylinder { radius, .. } if face == 0 => {
                round::way_in_reach(p, way, *radius, reach)
            }
            _ => way,
        }
    }

    /// Distance of a point outside to the surface, 0 or less inside. Exact but for a convex
    /// polyhedron's edges and corners, where it is at most the distance.
    pub fn gap(&self, p: Vec3<R>) -> R {
        let beyond = |x: R, y: R, z: R| {
            let deepest = x.max(y).max(z);
            let out = vec3(x.max(R::ZERO), y.max(R::ZERO), z.max(R::ZERO));
            if deepest > R::ZERO {
                out.length()
            } else {
                deepest
            }
        };
        match self {
            Self::Box { half } => {
                beyond(p.x.abs() - half.x, p.y.abs() - half.y, p.z.abs() - half.z)
            }
            Self::Cylinder { radius, half } => {
                let side = across(p).length() - *radius;
                beyond(side, p.y.abs() - *half, side.min(R::ZERO))
            }
            Self::Union(members) => whole::gap(members, p),
            _ => -self.depth(p),
        }
    }
}

/// The cheapest way out among those offered, or the kept one while no other is clearly cheaper. A
/// node that a segment's length has drawn into a body does not leave it on the far side while it
/// can go back where it came in: it would have gone through.
pub(super) struct Choice<'a, R> {
    p: Vec3<R>,
    kept: u32,
    reach: &'a Reach<R>,
    best: Option<(R, Exit<R>)>,
    keep: Option<(R, Exit<R>)>,
    back: Option<(R, Exit<R>)>,
}

impl<'a, R: Real> Choice<'a, R> {
    /// For a point that left through the feature `kept` last.
    pub fn new(p: Vec3<R>, kept: u32, reach: &'a Reach<R>) -> Self {
        Self {
            p,
            kept,
            reach,
            best: None,
            keep: None,
            back: None,
        }
    }

    /// A `hidden` way ends in another part of the body.
    pub fn offer(&mut self, exit: Exit<R>, hidden: bool) {
        let surcharge = R::of(if hidden { HIDDEN_M } else { 0.0 });
        let cost = self.reach.cost(self.p, exit.depth, exit.normal) + surcharge;
        let is_less = |than: &Option<(R, Exit<R>)>| than.is_none_or(|(least, _)| cost < least);
        if exit.face == self.kept {
            self.keep = Some((cost, exit));
        }
        if is_less(&self.best) {
            self.best = Some((cost, exit));
        }
        let is_open = cost < R::of(HIDDEN_M);
        if is_open && is_less(&self.back) && self.reach.came_through(self.p, &exit) {
            self.back = Some((cost, exit));
        }
    }

    pub fn take(self) -> Option<Exit<R>> {
        let (least, best) = self.best?;
        let cheapest = match self.keep {
            Some((cost, keep)) if cost * R::of(KEEP_FACE) <= least => keep,
            _ => best,
        };
        Some(match self.back {
            Some((_, back)) if back.normal.dot(cheapest.normal) < R::of(OPPOSITE) => back,
            _ => cheapest,
        })
    }
}

/// Face 0 is +x, 1 is −x, and so on: its depth and outward normal.
fn box_face<R: Real>(p: Vec3<R>, half: Vec3<R>, face: u32) -> (R, Vec3<R>) {
    let (o, i) = (R::ZERO, R::ONE);
    match face {
        0 => (half.x - p.x, vec3(i, o, o)),
        1 => (half.x + p.x, vec3(-i, o, o)),
        2 => (half.y - p.y, vec3(o, i, o)),
        3 => (half.y + p.y, vec3(o, -i, o)),
        4 => (half.z - p.z, vec3(o, o, i)),
        _ => (half.z + p.z, vec3(o, o, -i)),
    }
}

/// From the nearest point of a capsule's axis to the point.
fn from_axis<R: Real>(p: Vec3<R>, half: R) -> Vec3<R> {
    vec3(p.x, p.y - p.y.clamp(-half, half), p.z)
}

fn across<R: Real>(p: Vec3<R>) -> Vec3<R> {
    vec3(p.x, R::ZERO, p.z)
}

#[cfg(test)]
mod tests;
