//! Between the world's f64 and rapier's f32: the one place where poses change hands.
//!
//! Rapier's frame has the world's axes, and the ground's middle as its origin unless the bodies are
//! more than [`NEAR_M`] from it: then its origin is next to them and follows them. A place is rounded
//! by 2⁻²⁴ of its distance from the origin, by 3.8e-6 m at most near it, wherever in the world it is.
//! With bodies far apart the origin is next to most of them.

use rapier3d::math::{Pose as RapierPose, Rotation, Vector};

use crate::base::trig::{cos_turns, sin_turns};
use crate::base::{Pose, Quat, Vec3};

/// Along an axis on which the bodies' middle is no farther than this from the ground's, the origin is
/// the ground's middle; it also is how far bodies may go before the origin follows.
const NEAR_M: f64 = 64.0;

/// Where rapier's origin is in the world: a whole number of metres from the ground's middle, so that
/// a scene moved as a whole, or by whole metres on a level ground, has the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    origin: Vec3<f64>,
}

impl Frame {
    /// The frame near the middle of some places; `ground_m` is the middle of the ground. Places
    /// that are not finite do not count; without a place the frame is the ground's own.
    pub fn around(places: &[Vec3<f64>], ground_m: [f64; 2]) -> Self {
        let ground = Vec3::new(ground_m[0], 0.0, ground_m[1]);
        let middle = middle_of(places).unwrap_or(ground) - ground;
        let steps = middle
            .to_f64()
            .map(|x| if x.abs() <= NEAR_M { 0.0 } else { x.round() });
        Self {
            origin: ground + Vec3::of(steps),
        }
    }

    /// True while the middle of some places is near enough to the origin.
    pub fn is_near(&self, places: &[Vec3<f64>]) -> bool {
        middle_of(places).is_none_or(|middle| {
            let off = (middle - self.origin).to_f64();
            off.iter().all(|x| x.abs() <= NEAR_M)
        })
    }

    /// What to add to a place in this frame to have it in another; exact for places near both.
    pub fn shift_to(&self, other: &Self) -> Vector {
        to_rapier(self.origin - other.origin)
    }

    /// Rounds a place.
    pub fn place_to_rapier(&self, place: Vec3<f64>) -> Vector {
        to_rapier(place - self.origin)
    }

    /// Rounds a pose.
    pub fn pose_to_rapier(&self, pose: Pose<f64>) -> RapierPose {
        local_pose_to_rapier(Pose {
            place: pose.place - self.origin,
            ..pose
        })
    }

    /// Widens a pose.
    pub fn pose_from_rapier(&self, pose: &RapierPose) -> Pose<f64> {
        let local = local_pose_from_rapier(pose);
        Pose {
            place: local.place + self.origin,
            ..local
        }
    }
}

/// The median of the places along each axis: near most of them, where a mean may be near none.
fn middle_of(places: &[Vec3<f64>]) -> Option<Vec3<f64>> {
    let median = |axis: usize| {
        let finite = places.iter().filter(|place| place.is_finite());
        let mut along: Vec<f64> = finite.map(|place| place.to_f64()[axis]).collect();
        let middle = along.len().checked_sub(1)? / 2;
        Some(*along.select_nth_unstable_by(middle, f64::total_cmp).1)
    };
    Some(Vec3::new(median(0)?, median(1)?, median(2)?))
}

/// Rounds a vector that is not a place, in whatever unit.
pub(super) fn to_rapier(v: Vec3<f64>) -> Vector {
    let [x, y, z] = v.to_f32();
    Vector::new(x, y, z)
}

/// Widens a rapier vector; exact.
pub(super) fn from_rapier(v: Vector) -> Vec3<f64> {
    Vec3::of_f32([v.x, v.y, v.z])
}

/// Rounds the pose of a part within its body.
pub(super) fn local_pose_to_rapier(pose: Pose<f64>) -> RapierPose {
    let q = pose.turn.to_array().map(|c| c as f32);
    RapierPose::from_parts(
        to_rapier(pose.place),
        Rotation::from_xyzw(q[0], q[1], q[2], q[3]).normalize(),
    )
}

/// Widens a pose within rapier's frame. The turn is made of unit length again, which f32 keeps only to 1e-7: a body's
/// vertices must not swell with it.
fn local_pose_from_rapier(pose: &RapierPose) -> Pose<f64> {
    let q = pose.rotation;
    Pose {
        turn: unit([q.x, q.y, q.z, q.w].map(f64::from)),
        place: from_rapier(pose.translation),
    }
}

/// Turns about x, then y, then z of the outer space, in degrees.
pub fn turn_of_degrees(degrees: [f64; 3]) -> Quat<f64> {
    let about = |axis: usize| {
        // A quaternion holds half the angle; a turn has 360 degrees.
        let half_turns = degrees[axis] / 720.0;
        let mut v = [0.0; 3];
        v[axis] = sin_turns(half_turns);
        Quat {
            v: Vec3::of(v),
            w: cos_turns(half_turns),
        }
    };
    unit(about(0).then(about(1)).then(about(2)).to_array())
}

/// A quaternion of unit length; one that is not finite stays so and is found by its user.
fn unit(q: [f64; 4]) -> Quat<f64> {
    let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    Quat::of_array(q.map(|c| c / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Vec3<f64>, b: [f64; 3]) -> bool {
        // The polynomial sine is right to 1e-11.
        (a - Vec3::of(b)).length() < 1e-10
    }

    #[test]
    fn turns_follow_one_another_in_the_outer_space() {
        let z = Vec3::of([0.0, 0.0, 1.0]);
        assert!(close(
            turn_of_degrees([0.0, 90.0, 0.0]).rotate(z),
            [1.0, 0.0, 0.0]
        ));
        // z to −y about x, and from there to x about z.
        assert!(close(
            turn_of_degrees([90.0, 0.0, 90.0]).rotate(z),
            [1.0, 0.0, 0.0]
        ));
    }

    #[test]
    fn a_pose_survives_the_way_to_rapier_and_back() {
        let pose = Pose {
            turn: turn_of_degrees([20.0, -130.0, 70.0]),
            place: Vec3::of([1.5, -0.25, 1000.0]),
        };
        let frame = Frame::around(&[pose.place], [0.0; 2]);
        let back = frame.pose_from_rapier(&frame.pose_to_rapier(pose));
        assert_eq!(back.place, pose.place);
        // Four components rounded to f32, half an ulp of 1 each.
        let p = Vec3::of([1.0, 1.0, 1.0]);
        assert!((back.turn.rotate(p) - pose.turn.rotate(p)).length() < 1e-6);
    }

    #[test]
    fn a_place_far_away_is_as_exact_as_one_near_the_origin() {
        for far in [0.0, 1e3, 1e4, 1e5, -4.9e5] {
            let place = Vec3::of([far + 1.234_567, 0.765_432_1, far - 3.041_592]);
            let frame = Frame::around(&[place], [0.0; 2]);
            let pose = Pose {
                turn: turn_of_degrees([0.0; 3]),
                place,
            };
            let back = frame.pose_from_rapier(&frame.pose_to_rapier(pose));
            // No more than 4 m from the origin: rounded by 2⁻²² along each axis.
            assert!(
                (back.place - place).length() <= 3f64.sqrt() * 2.4e-7,
                "{far}"
            );
        }
    }

    #[test]
    fn the_origin_is_near_most_bodies_and_stays_until_they_leave() {
        let at = |x: f64| Vec3::of([x, 0.0, 0.0]);
        let frame = Frame::around(&[at(1000.0), at(1004.0), at(90_000.0)], [0.0; 2]);
        assert_eq!(frame.origin, at(1004.0));
        assert!(frame.is_near(&[at(941.0)]) && !frame.is_near(&[at(939.0)]));
        assert_eq!(Frame::around(&[at(40.0)], [0.0; 2]).origin, at(0.0));
        assert_eq!(Frame::around(&[at(f64::NAN)], [7.0, 0.0]).origin, at(7.0));
    }
}
