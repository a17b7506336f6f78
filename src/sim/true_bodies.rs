//! How deep a point is inside the bodies near it, by their true shapes, whatever the grass itself
//! collided with: closed forms, the union of a compound's parts, the triangles of a closed mesh.

use std::collections::BTreeMap;

use crate::base::{Pose, Vec3, least};

use super::meadow::Meadow;
use super::parts::{Parts, Tested};
use super::solid::Solid;
use super::work::{Contact, TileWork};

/// A node this close to the ground lies on it, in metres: on a slope the last segment is laid down by
/// the height at its end before it is turned.
pub const ON_GROUND_M: f64 = 1e-3;

/// A depth and what its collider promises: one texel of a depth cube, 1 mm for a closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    pub depth_m: f64,
    pub limit_m: f64,
}

impl Default for Depth {
    fn default() -> Self {
        Self {
            depth_m: 0.0,
            limit_m: ANALYTIC_LIMIT_M,
        }
    }
}

/// Depth an analytic collider may leave, in metres.
const ANALYTIC_LIMIT_M: f64 = 1e-3;

impl Depth {
    /// The one that exceeds its promise by more.
    pub fn worse(self, other: Self) -> Self {
        if other.depth_m / other.limit_m > self.depth_m / self.limit_m {
            other
        } else {
            self
        }
    }
}

/// The true shapes of the bodies near a tile, at the end of the sub-step and on
/// their way there.
pub struct TrueBodies<'a> {
    parts: &'a Parts,
    bodies: Vec<TrueBody<'a>>,
    /// Middles, at the end, and radii of balls around the bodies' parts.
    balls: Vec<(Vec3<f64>, f64)>,
}

struct TrueBody<'a> {
    solid: &'a Solid<f64>,
    contact: &'a Contact,
    /// `anchor_from_body` at the end of the sub-step.
    end: Pose<f64>,
    limit_m: f64,
}

impl TrueBody<'_> {
    /// The least distance of some points from the body at a pose, 0 or less inside.
    fn least_gap_m(&self, anchor_from_body: &Pose<f64>, points: &[Vec3<f64>]) -> f64 {
        let gaps = (points.iter()).map(|&p| self.solid.gap(anchor_from_body.inverse_point(p)));
        gaps.fold(f64::INFINITY, least)
    }
}

impl<'a> TrueBodies<'a> {
    pub fn near(meadow: &'a Meadow, tile: &TileWork) -> Self {
        let contacts = meadow.work.contacts_of(tile);
        let mut bodies: BTreeMap<u32, TrueBody<'a>> = BTreeMap::new();
        for contact in contacts {
            let part = &meadow.parts.parts[contact.part as usize];
            let limit_m = match contact.tested {
                Tested::Closed => ANALYTIC_LIMIT_M,
                Tested::Cube | Tested::Voxels => part.texel_m(meadow.scene.solver.cube_resolution),
            };
            let Some(whole) = meadow.truth.whole(contact.shape) else {
                continue;
            };
            let body = bodies.entry(contact.link).or_insert_with(|| TrueBody {
                solid: &whole.solid,
                contact,
                end: contact.anchor_from_body(&meadow.parts, contact.sweeps),
                limit_m,
            });
            body.limit_m = body.limit_m.max(limit_m);
        }
        let balls = contacts
            .iter()
            .map(|contact| (contact.to.place, contact.radius_m));
        Self {
            parts: &meadow.parts,
            bodies: bodies.into_values().collect(),
            balls: balls.collect(),
        }
    }

    /// Whether a plant of some length may reach a body at the end of the sub-step.
    pub fn may_reach(&self, root: Vec3<f64>, length_m: f64) -> bool {
        let mut balls = self.balls.iter();
        balls.any(|&(middle, radius_m)| (root - middle).length() <= radius_m + length_m)
    }

    /// How far off the nearest of some points was from the nearest body, where that came closest at the
    /// end of one of its sweeps: 0 or less inside, infinite without bodies. Once it is not more than
    /// `enough_m` no more sweeps are looked at.
    pub fn least_gap_m(&self, points: &[Vec3<f64>], enough_m: f64) -> f64 {
        let mut found = f64::INFINITY;
        for body in &self.bodies {
            // From the end on, where most plants are at the body.
            for sweep in (1..=body.contact.sweeps).rev() {
                let pose = body.contact.anchor_from_body(self.parts, sweep);
                found = least(found, body.least_gap_m(&pose, points));
                if found <= enough_m {
                    return found;
                }
            }
        }
        found
    }

    /// The body a point is deepest in; a negative depth is how far off the nearest one is. `None`
    /// where there is no body.
    pub fn deepest(&self, p: Vec3<f64>) -> Option<Depth> {
        let depths = self.bodies.iter().map(|body| {
            let p = body.end.inverse_point(p);
            let depth_m = body.solid.depth(p);
            Depth {
                depth_m: if depth_m > 0.0 {
                    depth_m
                } else {
                    -body.solid.gap(p)
                },
                limit_m: body.limit_m,
            }
        });
        depths.reduce(|a, b| if b.depth_m > a.depth_m { b } else { a })
    }

    /// What is left of a depth where body and ground overlap: the ground wins there, so what they
    /// share is no fault, nor is the height by which the point lies above the ground.
    pub fn beyond_pinch(&self, p: Vec3<f64>, found: Depth, ground: f64) -> Depth {
        if p.y > ground + ON_GROUND_M {
            return found;
        }
        let shared = self.deepest(Vec3::new(p.x, ground, p.z));
        let shared = shared.map_or(0.0, |depth| depth.depth_m.max(0.0));
        Depth {
            depth_m: found.depth_m - shared - (p.y - ground).max(0.0),
            ..found
        }
    }
}
