//! The ground under a plant: what keeps its nodes above, and where a segment lies down.

use crate::base::{Real, Vec3, vec3};
use crate::field::Anchor;
use crate::field::grid::{GroundPlane, ground_plane_in_anchor};
use crate::sim::contact::Laid;
use crate::sim::solid::Exit;
use crate::terrain::HeightGrid;

use super::{ON_GROUND_M, STICKS};

/// The ground about an anchor, in whose coordinates all places here are.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a> {
    pub heights: &'a HeightGrid,
    pub anchor: &'a Anchor,
}

impl Ground<'_> {
    /// The ground's plane under a node.
    pub fn plane_below<R: Real>(&self, node: Vec3<R>) -> GroundPlane<R> {
        ground_plane_in_anchor(self.heights, self.anchor, node.x, node.z)
    }

    /// The ground under a node.
    pub fn below<R: Real>(&self, node: Vec3<R>) -> Vec3<R> {
        vec3(node.x, self.plane_below(node).height, node.z)
    }

    /// True for a node that a body presses onto the ground: its way out leads below it, and into it
    /// rather than along. Such a node goes straight down and stays. Sliding along the body's
    /// normal as well would creep on in every round and sweep, until the node lies beside the
    /// place where body and ground overlap: the pose would tell their number.
    pub fn is_pressed<R: Real>(&self, out: Vec3<R>, normal: Vec3<R>) -> bool {
        let GroundPlane { height, slope } = self.plane_below(out);
        let steepness = R::ONE + slope[0] * slope[0] + slope[1] * slope[1];
        let into = slope[0] * normal.x + slope[1] * normal.z - normal.y;
        into > R::of(STICKS) * steepness.sqrt() && out.y < height
    }

    /// The upper node of a segment, turned about the lower one until it is at the end of a way out of
    /// a part, or of the way between the part and the ground; `None` where it is too short for both,
    /// or lies there already.
    pub fn turned_out<R: Real>(
        &self,
        laid: &Laid<R>,
        to: Vec3<R>,
        rest: Vec3<R>,
        exit: &Exit<R>,
    ) -> Option<Vec3<R>> {
        let Laid { from, length, .. } = *laid;
        let n = exit.normal;
        let along = (to - from).dot(n);
        let rise = along + exit.depth;
        let run = length * length - rise * rise;
        if run <= R::ZERO {
            // Too short for every way out, as where its lower node is held under the body: it stays on
            // the ground with that.
            let is_under = self.is_on_ground(from) && !self.is_on_ground(to);
            return is_under.then(|| self.turn_to(from, to, &self.plane_below(to), rest, length));
        }
        let sideways = (rest - n * rest.dot(n)).unit_or(n.across());
        let flat = ((to - from) - n * along).unit_or(sideways);
        let out = from + n * rise + flat * run.sqrt();
        if !self.is_pressed(out, n) {
            Some(out)
        } else if self.is_on_ground(to) {
            None
        } else {
            Some(self.turn_to(from, to, &self.plane_below(to), rest, length))
        }
    }

    pub fn is_on_ground<R: Real>(&self, node: Vec3<R>) -> bool {
        node.y - self.below(node).y <= R::of(ON_GROUND_M)
    }

    /// Turns a segment about its lower node until its upper one is on the ground, if it is below.
    pub fn lay_on_ground<R: Real>(
        &self,
        from: Vec3<R>,
        to: Vec3<R>,
        rest: Vec3<R>,
        length: R,
    ) -> Vec3<R> {
        let plane = self.plane_below(to);
        if to.y >= plane.height {
            return to;
        }
        self.turn_to(from, to, &plane, rest, length)
    }

    /// Turns a segment about its lower node, up or down, until its upper one is on the plane of the
    /// ground below it, as far as its length allows.
    fn turn_to<R: Real>(
        &self,
        from: Vec3<R>,
        to: Vec3<R>,
        plane: &GroundPlane<R>,
        rest: Vec3<R>,
        length: R,
    ) -> Vec3<R> {
        let sideways = vec3(rest.x, R::ZERO, rest.z).unit_or(vec3(R::ONE, R::ZERO, R::ZERO));
        let aside = vec3(to.x - from.x, R::ZERO, to.z - from.z);
        let flat = aside.unit_or(sideways);
        // Along `flat` the plane is `start + slope·run` above the lower node, and the upper one is
        // where run² + rise² is the square of the length.
        let slope = plane.slope[0] * flat.x + plane.slope[1] * flat.z;
        let square = R::ONE + slope * slope;
        let reach = length * square.sqrt();
        let start = plane.height - slope * aside.dot(flat) - from.y;
        let start = start.clamp(-reach, reach);
        let left = (reach * reach - start * start).max(R::ZERO).sqrt();
        let run = (left - start * slope) / square;
        from + flat * run + Vec3::UP * (start + slope * run)
    }
}
