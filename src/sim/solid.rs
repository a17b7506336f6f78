//! The true shape of a convex part: how deep a point is inside, and the way out.
//!
//! Closed forms for ball, box, capsule and cylinder; for a convex polyhedron its planes. The
//! depth is the distance to the nearest *feature* (a ball's surface, one of a box's faces, a
//! cylinder's side or one of its caps, a plane). Near the medial axis two features are equally
//! near, so the feature of the last sub-step is kept until another is clearly nearer
//! (hysteresis against flipping). WGSL twin: `shaders/shared/solid.wgsl`.

use crate::base::{Real, Vec3, vec3};
use crate::bodies;

/// A feature is kept until another is nearer by this factor.
pub const KEEP_FACE: f64 = 0.9;
/// No feature is remembered.
pub const NO_FACE: u32 = u32::MAX;

/// A convex solid about its own origin, in the kernel's float. Lengths in metres.
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
}

/// A way out of reach counts as longer by this, in metres: more than any body's size.
pub const OUT_OF_REACH_M: f64 = 1000.0;

impl<R: Real> Reach<R> {
    /// Everything can be reached.
    pub fn anywhere() -> Self {
        Self {
            from: Vec3::ZERO,
            length: -R::ONE,
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
}

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
        }
    }

    /// The way out for a point inside, or `None` outside. `kept` is the feature of the last
    /// sub-step or [`NO_FACE`].
    pub fn exit(&self, p: Vec3<R>, kept: u32, reach: &Reach<R>) -> Option<Exit<R>> {
        let cost = |depth, normal| reach.cost(p, depth, normal);
        let sideways = vec3(R::ONE, R::ZERO, R::ZERO);
        let single = |out: Vec3<R>, radius: R| {
            let depth = radius - out.length();
            (depth > R::ZERO).then(|| Exit {
                depth,
                normal: out.unit_or(sideways),
                face: 0,
            })
        };
        match self {
            Self::Ball { radius } => single(p, *radius),
            Self::Capsule { radius, half } => single(from_axis(p, *half), *radius),
            Self::Box { half } => nearest(6, kept, cost, |face| box_face(p, *half, face)),
            Self::Cylinder { radius, half } => nearest(3, kept, cost, |face| match face {
                0 => {
                    let out = across(p);
                    (*radius - out.length(), out.unit_or(sideways))
                }
                1 => (*half - p.y, Vec3::UP),
                _ => (*half + p.y, -Vec3::UP),
            }),
            Self::Convex { planes, .. } => nearest(planes.len() as u32, kept, cost, |face| {
                let plane = planes[face as usize];
                (plane.offset - plane.normal.dot(p), plane.normal)
            }),
        }
    }
}

/// The cheapest of `count` features that all have the point on their inner side.
fn nearest<R: Real>(
    count: u32,
    kept: u32,
    cost: impl Fn(R, Vec3<R>) -> R,
    feature: impl Fn(u32) -> (R, Vec3<R>),
) -> Option<Exit<R>> {
    let mut choice = Choice::new(kept);
    for face in 0..count {
        let (depth, normal) = feature(face);
        if depth <= R::ZERO {
            return None;
        }
        choice.offer(
            cost(depth, normal),
            Exit {
                depth,
                normal,
                face,
            },
        );
    }
    choice.take()
}

/// The cheapest way out among those offered, or the kept one while no other is clearly cheaper.
pub(super) struct Choice<R> {
    kept: u32,
    best: Option<(R, Exit<R>)>,
    keep: Option<(R, Exit<R>)>,
}

impl<R: Real> Choice<R> {
    pub fn new(kept: u32) -> Self {
        Self {
            kept,
            best: None,
            keep: None,
        }
    }

    pub fn offer(&mut self, cost: R, exit: Exit<R>) {
        if exit.face == self.kept {
            self.keep = Some((cost, exit));
        }
        if self.best.is_none_or(|(least, _)| cost < least) {
            self.best = Some((cost, exit));
        }
    }

    pub fn take(self) -> Option<Exit<R>> {
        let (least, best) = self.best?;
        Some(match self.keep {
            Some((cost, keep)) if cost * R::of(KEEP_FACE) <= least => keep,
            _ => best,
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
mod tests {
    use super::*;

    fn solids() -> Vec<Solid<f64>> {
        let s = 0.5_f64.sqrt();
        let plane = |x, y, z| Plane {
            normal: vec3(x, y, z),
            offset: 0.3,
        };
        vec![
            Solid::Ball { radius: 0.4 },
            Solid::Box {
                half: vec3(0.3, 0.2, 0.4),
            },
            Solid::Capsule {
                radius: 0.2,
                half: 0.3,
            },
            Solid::Cylinder {
                radius: 0.3,
                half: 0.2,
            },
            Solid::Convex {
                planes: vec![
                    plane(s, s, 0.0),
                    plane(-s, s, 0.0),
                    plane(0.0, -1.0, 0.0),
                    plane(0.0, 0.0, 1.0),
                    plane(0.0, 0.0, -1.0),
                ],
                low: vec3(-1.0, -0.3, -0.3),
                high: vec3(1.0, 0.5, 0.3),
            },
        ]
    }

    #[test]
    fn the_way_out_ends_on_the_surface() {
        for solid in solids() {
            let mut inside = 0;
            for k in 0..4000_u32 {
                let word = |salt: u32| crate::base::philox::philox2x32([k, salt], 3, 7)[0];
                let at = |salt: u32| f64::from(crate::base::philox::unit(word(salt))) - 0.5;
                let p = vec3(at(1), at(2), at(3));
                let exit = solid.exit(p, NO_FACE, &Reach::anywhere());
                assert_eq!(exit.is_some(), solid.depth(p) > 0.0, "{solid:?} {p:?}");
                if let Some(exit) = exit {
                    inside += 1;
                    assert!((exit.depth - solid.depth(p)).abs() < 1e-12);
                    let out = p + exit.normal * exit.depth;
                    assert!(solid.depth(out).abs() < 1e-12, "{solid:?} {p:?}");
                }
            }
            assert!(inside > 100, "{solid:?}: {inside}");
        }
    }

    #[test]
    fn centres_and_axes_have_a_finite_way_out() {
        for solid in solids() {
            for p in [Vec3::ZERO, vec3(0.0, 0.1, 0.0)] {
                let exit = solid.exit(p, NO_FACE, &Reach::anywhere()).expect("inside");
                assert!(exit.normal.is_finite() && (exit.normal.length() - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_way_out_must_be_in_the_segments_reach() {
        let plank = Solid::Box {
            half: vec3(1.0, 0.05, 0.2),
        };
        let face = |length: f64| {
            let from = vec3(0.0, -0.05, 0.1);
            let reach = Reach { from, length };
            plank
                .exit(vec3(0.0, 0.0, 0.17), NO_FACE, &reach)
                .map(|e| e.face)
        };
        assert_eq!(face(0.12), Some(4), "3 cm to the side");
        assert_eq!(
            face(0.09),
            Some(3),
            "the side is 10 cm from the lower node, the bottom near"
        );
    }

    #[test]
    fn a_face_is_kept_until_another_is_a_tenth_nearer() {
        let cube = Solid::Box {
            half: vec3(1.0, 1.0, 1.0),
        };
        let face = |x: f64, kept| {
            cube.exit(vec3(x, 0.5, 0.0), kept, &Reach::anywhere())
                .map(|e| e.face)
        };
        assert_eq!(face(0.51, NO_FACE), Some(0));
        assert_eq!(face(0.51, 2), Some(2));
        assert_eq!(face(0.56, 2), Some(0));
    }
}
