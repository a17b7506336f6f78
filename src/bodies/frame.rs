//! Between the world's f64 and rapier's f32: the one place where poses change hands.
//!
//! Rapier's frame is the world's: same axes, same origin. A place within 1 km of the origin is
//! rounded by at most 3.1e-5 m.

use rapier3d::math::{Pose as RapierPose, Rotation, Vector};

use crate::base::trig::{cos_turns, sin_turns};
use crate::base::{Pose, Quat, Vec3};

/// Rounds a world vector, in whatever unit.
pub(super) fn to_rapier(v: Vec3<f64>) -> Vector {
    let [x, y, z] = v.to_f32();
    Vector::new(x, y, z)
}

/// Widens a rapier vector; exact.
pub(super) fn from_rapier(v: Vector) -> Vec3<f64> {
    Vec3::of_f32([v.x, v.y, v.z])
}

/// Rounds a pose.
pub(super) fn pose_to_rapier(pose: Pose<f64>) -> RapierPose {
    let q = pose.turn.to_array().map(|c| c as f32);
    RapierPose::from_parts(
        to_rapier(pose.place),
        Rotation::from_xyzw(q[0], q[1], q[2], q[3]).normalize(),
    )
}

/// Widens a pose. The turn is made of unit length again, which f32 keeps only to 1e-7: a body's
/// vertices must not swell with it.
pub(super) fn pose_from_rapier(pose: &RapierPose) -> Pose<f64> {
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
        let back = pose_from_rapier(&pose_to_rapier(pose));
        assert_eq!(back.place, pose.place);
        // Four components rounded to f32, half an ulp of 1 each.
        let p = Vec3::of([1.0, 1.0, 1.0]);
        assert!((back.turn.rotate(p) - pose.turn.rotate(p)).length() < 1e-6);
    }
}
