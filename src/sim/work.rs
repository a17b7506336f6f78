//! What one sub-step asks of the passes: plain lists, the same for every engine.

use crate::base::Pose;
use crate::bodies::{Link, RigidShape};
use crate::field::{Anchor, Bounds, Field, TileId, WindNow};
use crate::scene::Solver;

use super::fault::{Fault, Planted};
use super::parts::{Parts, Tested};

/// The work of one sub-step.
#[derive(Clone, Debug, Default)]
pub struct Work {
    /// Tick at the end of the sub-step; the first is 1.
    pub now: u32,
    pub wind: WindNow,
    /// The wind at the start of the sub-step.
    pub wind_before: WindNow,
    /// Active tiles, in the order of their ids.
    pub tiles: Vec<TileWork>,
    /// Runs of contacts, one run per colliding tile.
    pub contacts: Vec<Contact>,
}

/// An active tile.
#[derive(Clone, Debug)]
pub struct TileWork {
    pub tile: TileId,
    pub slab: u32,
    pub anchor: Anchor,
    /// The tile's run of contacts; empty for a recovering tile.
    pub contacts: std::ops::Range<u32>,
}

/// One convex part that may touch a tile during the sub-step, in the coordinates of the tile's
/// anchor. Parts come in the order of their bodies' names.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// Index into [`Parts::parts`].
    pub part: u32,
    /// Rank of the body.
    pub body: u32,
    /// Number of the contact's part within its body, to tell its faces from another part's.
    pub part_in_body: u32,
    /// Parts of the body, which follow one another in the list.
    pub parts_of_body: u32,
    pub tested: Tested,
    /// Index into [`Bodies::links`](crate::bodies::Bodies::links).
    pub link: u32,
    /// Index into [`Bodies::shapes`](crate::bodies::Bodies::shapes).
    pub shape: u32,
    /// Pieces the sub-step is cut into for this body: it travels at most a share of its half
    /// thickness in each, a sixteenth of it unless the method says otherwise.
    pub sweeps: u32,
    /// `anchor_from_part` at the start and the end of the sub-step.
    pub from: Pose<f64>,
    pub to: Pose<f64>,
    /// Radius about the part's origin that holds the part, in metres.
    pub radius_m: f64,
}

/// A link that may touch grass in this sub-step, with what follows from its motion.
#[derive(Clone, Debug)]
pub struct Mover {
    pub link: Link,
    /// Place of the link in the list of links.
    pub number: u32,
    /// Bounds swept from start to end.
    pub bounds: Bounds,
    pub sweeps: u32,
    /// True if more sweeps were needed than the solver allows.
    pub capped: bool,
}

/// Grows bounds by what a turning body's corners may bulge between two poses.
fn bulge_m(link: &Link, radius_m: f64) -> f64 {
    let (a, b) = (link.from.turn, link.to.turn);
    let half_cos = (a.v.dot(b.v) + a.w * b.w).abs().min(1.0);
    // The sagitta of an arc of angle φ is r(1 − cos(φ/2)); |a·b| is that very cosine.
    radius_m * (1.0 - half_cos)
}

/// Longest way any point of a link goes in the sub-step, in metres.
fn travel_m(link: &Link, radius_m: f64) -> f64 {
    let (a, b) = (link.from.turn, link.to.turn);
    let half_cos = (a.v.dot(b.v) + a.w * b.w).abs().min(1.0);
    let turned = 2.0 * libm::acos(half_cos) * radius_m;
    (link.to.place - link.from.place).length() + turned
}

/// A link's motion as the grass meets it. One that was put somewhere is let down on the grass from
/// above: which way a blade leaves a body that is suddenly around it would hang on millimetres.
/// It starts as high over its place as plants are tall, or [`LIFT`] of its half thickness, which
/// sweeps can cover. Not let down are a body that goes farther than that in its first sub-step, which
/// has come from aside, and one of several parts, which would sweep what its hollows leave alone.
fn let_down(link: &Link, shape: &RigidShape, tallest_m: f64) -> Link {
    let mut link = link.clone();
    let lift_m = tallest_m.min(LIFT * shape.half_thickness_m);
    let convex = shape.parts.len() == 1;
    if link.placed && convex && travel_m(&link, shape.bounding_radius_m) <= lift_m {
        link.from.place.y += lift_m;
    }
    link
}

/// Highest a body is let down from, over its half thickness: 512 sweeps of the default's share, half
/// of those it may take. The same for every method, so that all meet the same motion.
const LIFT: f64 = 32.0;

impl Mover {
    /// `tallest_m` is the length of the longest blade, in metres.
    pub fn new(
        link: &Link,
        number: u32,
        shape: &RigidShape,
        solver: &Solver,
        tallest_m: f64,
    ) -> Self {
        let link = let_down(link, shape, tallest_m);
        let skin = f64::from(solver.skin_m);
        let bounds_at = |pose: Pose<f64>| {
            let boxes = shape
                .parts
                .iter()
                .map(|part| turned_box(pose, part.bounds_m));
            boxes.reduce(Bounds::union).unwrap_or(Bounds {
                low: pose.place.to_f64(),
                high: pose.place.to_f64(),
            })
        };
        let swept = bounds_at(link.from).union(bounds_at(link.to));
        let step = solver.method.sweep_share * shape.half_thickness_m;
        let wished = (travel_m(&link, shape.bounding_radius_m) / step)
            .ceil()
            .max(1.0);
        Self {
            number,
            bounds: swept.grown(skin + bulge_m(&link, shape.bounding_radius_m)),
            link,
            sweeps: wished.min(f64::from(solver.max_sweeps)) as u32,
            capped: wished > f64::from(solver.max_sweeps),
        }
    }

    /// Bounds of the balls around the link's parts, swept. Every plant that a part
    /// [reaches](super::contact::Touch::reaches) has its root in them, once they are grown by its
    /// length. Lists of contacts go by these, so that a plant takes its sweeps from the same
    /// bodies in a tile of any size.
    pub fn ball_bounds(&self, parts: &Parts) -> Bounds {
        let balls = parts.of_shape(self.link.shape).flat_map(|part| {
            let part = &parts.parts[part];
            [self.link.from, self.link.to].map(|world_from_body| {
                let middle = world_from_body.point(part.pose.place).to_f64();
                let point = Bounds {
                    low: middle,
                    high: middle,
                };
                point.grown(part.radius_m + BALL_MARGIN_M)
            })
        });
        balls.reduce(Bounds::union).unwrap_or(self.bounds)
    }
}

/// What the kernels' `f32` may add to a distance between a root and a part, in metres: a hundred
/// roundings of coordinates below 16 m.
const BALL_MARGIN_M: f64 = 1e-4;

/// World bounds of a box in a body's space.
fn turned_box(world_from_body: Pose<f64>, [low, high]: [[f64; 3]; 2]) -> Bounds {
    let mut bounds: Option<Bounds> = None;
    for corner in 0..8 {
        let p = [0, 1, 2].map(|a| {
            if corner >> a & 1 == 0 {
                low[a]
            } else {
                high[a]
            }
        });
        let p = world_from_body.point(crate::base::Vec3::of(p)).to_f64();
        let here = Bounds { low: p, high: p };
        bounds = Some(bounds.map_or(here, |b| b.union(here)));
    }
    bounds.unwrap_or(Bounds { low, high })
}

impl Contact {
    /// `anchor_from_body` at the end of a sweep, counted from 1.
    pub fn anchor_from_body(&self, parts: &Parts, sweep: u32) -> Pose<f64> {
        let part_from_body = parts.parts[self.part as usize].pose.inverse();
        // The last one is the end itself, to the last bit.
        let anchor_from_part = if sweep >= self.sweeps {
            self.to
        } else {
            let share = f64::from(sweep) / f64::from(self.sweeps);
            self.from.lerp(self.to, share)
        };
        Pose {
            turn: part_from_body.turn.then(anchor_from_part.turn),
            place: anchor_from_part.point(part_from_body.place),
        }
    }
}

impl Work {
    /// The parts near a tile; none for a recovering one.
    pub fn contacts_of(&self, tile: &TileWork) -> &[Contact] {
        &self.contacts[tile.contacts.start as usize..tile.contacts.end as usize]
    }

    /// Lists the contacts of one colliding tile with the movers whose bounds reach its plants.
    pub fn add_contacts(
        &mut self,
        field: &Field,
        parts: &Parts,
        solver: &Solver,
        anchor: &Anchor,
        movers: &[&Mover],
        planted: Planted,
    ) -> std::ops::Range<u32> {
        let first = self.contacts.len() as u32;
        let origin = crate::base::Vec3::of(field.grid.anchor_in_world(anchor, &field.ground));
        for mover in movers {
            let link = &mover.link;
            let range = parts.of_shape(link.shape);
            for part in range.clone() {
                let local = |world_from_body: Pose<f64>| {
                    let world_from_body = if planted.is(Fault::WorldCoordinatesInF32) {
                        world_from_body.cast::<f32>().cast()
                    } else {
                        world_from_body
                    };
                    let part_pose = parts.parts[part].pose;
                    Pose {
                        turn: part_pose.turn.then(world_from_body.turn),
                        place: world_from_body.point(part_pose.place) - origin,
                    }
                };
                self.contacts.push(Contact {
                    part: part as u32,
                    body: link.body,
                    part_in_body: (part - range.start) as u32,
                    parts_of_body: range.len() as u32,
                    tested: parts.tested(part, link.collider, solver),
                    link: mover.number,
                    shape: link.shape,
                    sweeps: mover.sweeps,
                    from: local(link.from),
                    to: local(link.to),
                    radius_m: parts.parts[part].radius_m,
                });
            }
        }
        first..self.contacts.len() as u32
    }
}
