//! How deep a point is inside the bodies near it, by their true shapes, whatever the grass itself
//! collided with: closed forms, the union of a compound's parts, the triangles of a closed mesh.

use std::collections::BTreeMap;

use crate::base::{Pose, Vec3};

use super::meadow::Meadow;
use super::parts::Tested;
use super::solid::Solid;
use super::work::TileWork;

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

/// The true shapes of the bodies near a tile at the end of the sub-step.
pub struct TrueBodies<'a> {
    bodies: Vec<TrueBody<'a>>,
}

struct TrueBody<'a> {
    solid: &'a Solid<f64>,
    anchor_from_body: Pose<f64>,
    limit_m: f64,
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
                anchor_from_body: contact.anchor_from_body(&meadow.parts),
                limit_m,
            });
            body.limit_m = body.limit_m.max(limit_m);
        }
        Self {
            bodies: bodies.into_values().collect(),
        }
    }

    /// The body a point is deepest in; a negative depth is how far off the nearest one is. `None`
    /// where there is no body.
    pub fn deepest(&self, p: Vec3<f64>) -> Option<Depth> {
        let depths = self.bodies.iter().map(|body| {
            let p = body.anchor_from_body.inverse_point(p);
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
