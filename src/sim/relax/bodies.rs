//! The bodies around a plant at one instant of a sub-step, and how its nodes get out of them.

use crate::base::{Pose, Real, Vec3};
use crate::sim::contact::{Laid, Moment, Touch};

use super::Ground;

/// The bodies around a plant at one instant of a sub-step.
#[derive(Clone, Debug)]
pub struct Bodies<'a, R> {
    moment: Moment<'a, R>,
    /// Touches that reach the plant, with their `anchor_from_part` of this instant.
    posed: Vec<(&'a Touch<'a, R>, Pose<R>)>,
}

/// Where a node was pushed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pushed<R> {
    pub to: Vec3<R>,
    /// The way out it took; `None` if it was pressed onto the ground.
    pub normal: Option<Vec3<R>>,
    /// How far inside it was, in metres.
    pub depth: R,
}

impl<'a, R: Real> Bodies<'a, R> {
    /// The touches of a moment that reach a plant.
    pub fn at(moment: Moment<'a, R>, root: Vec3<R>, reach: R) -> Self {
        let near = (moment.touches.iter()).filter(|touch| touch.reaches(root, reach));
        Self {
            posed: near.map(|touch| (touch, moment.pose_of(touch))).collect(),
            moment,
        }
    }

    /// Moves on to another share of the sub-step.
    pub fn set_share(&mut self, share: R) {
        self.moment.share = share;
        for (touch, pose) in &mut self.posed {
            *pose = self.moment.pose_of(touch);
        }
    }

    /// Parts in reach.
    pub fn len(&self) -> usize {
        self.posed.len()
    }

    pub fn is_empty(&self) -> bool {
        self.posed.is_empty()
    }

    /// False where a place is outside every part in reach.
    #[inline(always)]
    pub fn may_hold(&self, node: Vec3<R>) -> bool {
        let mut posed = self.posed.iter();
        posed.any(|(touch, pose)| {
            let near = (node - pose.place).length_squared() <= touch.radius_m * touch.radius_m;
            near && !touch.is_clear_of(pose, node)
        })
    }

    /// Pushes a node out of a part in reach: along the way out, or straight down to the ground where it is
    /// pressed onto it. `None` where it stays as it is.
    pub fn push(
        &self,
        part: usize,
        node: Vec3<R>,
        face: &mut u32,
        ground: &Ground,
    ) -> Option<Pushed<R>> {
        let (touch, pose) = &self.posed[part];
        let exit = touch.exit(&self.moment, pose, node, face, None)?;
        let out = node + exit.normal * exit.depth;
        let depth = exit.depth;
        if !ground.is_pressed(out, exit.normal) {
            return Some(Pushed {
                to: out,
                normal: Some(exit.normal),
                depth,
            });
        }
        (!ground.is_on_ground(node)).then(|| Pushed {
            to: ground.below(node),
            normal: None,
            depth,
        })
    }

    /// Turns a segment about its lower node until its upper one is out of every part, where its
    /// length allows that: both constraints hold after one step, which pushing and restoring
    /// lengths in turn reaches slowly where a blade meets a body head on. The way out of one part may
    /// lead into an earlier one, in the inner corner of a body above all: those are asked once more.
    pub fn turn_out(
        &self,
        laid: &Laid<R>,
        to: Vec3<R>,
        rest: Vec3<R>,
        face: &mut u32,
        ground: &Ground,
    ) -> (Vec3<R>, bool) {
        let mut to = to;
        let mut turned_at = None;
        let parts = self.posed.len();
        for (step, (touch, pose)) in self.posed.iter().cycle().take(LOOKS * parts).enumerate() {
            if step >= parts && turned_at.is_none_or(|at| step - at >= parts) {
                break;
            }
            let Some(exit) = touch.exit(&self.moment, pose, to, face, Some(laid)) else {
                continue;
            };
            if let Some(out) = ground.turned_out(laid, to, rest, &exit) {
                to = out;
                turned_at = Some(step);
            }
        }
        (to, turned_at.is_some())
    }
}

/// How often a segment that is laid out asks the parts, the later times only those that it has not
/// asked since one turned it. In a corner the ways out of two parts lead into each other a few times,
/// less far every time.
pub const LOOKS: usize = 4;
