//! A turn and a place: what takes a point from one space to another without stretching it.

use super::{Real, Vec3};

/// A unit quaternion x, y, z, w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quat<R> {
    pub v: Vec3<R>,
    pub w: R,
}

/// `to_from`: takes a point of the inner space to the outer one, by its turn and then its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<R> {
    pub turn: Quat<R>,
    pub place: Vec3<R>,
}

impl<R: Real> Quat<R> {
    pub const IDENTITY: Self = Self {
        v: Vec3::ZERO,
        w: R::ONE,
    };

    pub fn rotate(self, p: Vec3<R>) -> Vec3<R> {
        let aside = self.v.cross(p);
        p + (aside * self.w + self.v.cross(aside)) * R::of(2.0)
    }

    pub fn inverse(self) -> Self {
        Self {
            v: -self.v,
            w: self.w,
        }
    }

    pub fn then(self, outer: Self) -> Self {
        Self {
            v: self.v * outer.w + outer.v * self.w + outer.v.cross(self.v),
            w: outer.w * self.w - outer.v.dot(self.v),
        }
    }

    /// The normalised mean at `t` in 0…1, along the shorter way. Within 0.1% of the true
    /// spherical mean for the turns of one sub-step.
    pub fn lerp(self, to: Self, t: R) -> Self {
        let same_side = self.v.dot(to.v) + self.w * to.w >= R::ZERO;
        let s = if same_side { t } else { -t };
        let v = self.v * (R::ONE - t) + to.v * s;
        let w = self.w * (R::ONE - t) + to.w * s;
        let length = (v.length_squared() + w * w).sqrt();
        if length > R::of(1e-12) {
            let k = R::ONE / length;
            Self { v: v * k, w: w * k }
        } else {
            self
        }
    }

    /// x, y, z, w.
    pub fn to_array(self) -> [R; 4] {
        [self.v.x, self.v.y, self.v.z, self.w]
    }

    pub fn of_array(q: [R; 4]) -> Self {
        Self {
            v: Vec3::new(q[0], q[1], q[2]),
            w: q[3],
        }
    }

    /// Rounds to another float.
    pub fn cast<S: Real>(self) -> Quat<S> {
        Quat {
            v: Vec3::of(self.v.to_f64()),
            w: S::of(self.w.to_f64()),
        }
    }
}

impl<R: Real> Pose<R> {
    pub const IDENTITY: Self = Self {
        turn: Quat::IDENTITY,
        place: Vec3::ZERO,
    };

    pub fn point(self, p: Vec3<R>) -> Vec3<R> {
        self.turn.rotate(p) + self.place
    }

    pub fn inverse(self) -> Self {
        let turn = self.turn.inverse();
        Self {
            turn,
            place: -turn.rotate(self.place),
        }
    }

    pub fn inverse_point(self, p: Vec3<R>) -> Vec3<R> {
        self.turn.inverse().rotate(p - self.place)
    }

    pub fn lerp(self, to: Self, t: R) -> Self {
        Self {
            turn: self.turn.lerp(to.turn, t),
            place: self.place * (R::ONE - t) + to.place * t,
        }
    }

    pub fn cast<S: Real>(self) -> Pose<S> {
        Pose {
            turn: self.turn.cast(),
            place: Vec3::of(self.place.to_f64()),
        }
    }

    pub fn is_finite(self) -> bool {
        self.place.is_finite() && self.turn.v.is_finite() && self.turn.w.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_and_its_inverse_cancel() {
        let turn = Quat {
            v: Vec3::new(0.5, -0.5, 0.5),
            w: 0.5,
        };
        let pose = Pose {
            turn,
            place: Vec3::new(1.0, 2.0, -3.0),
        };
        let p = Vec3::new(0.3, -0.7, 0.2);
        let back = pose.inverse_point(pose.point(p));
        assert!((back - p).length() < 1e-14, "{back:?}");
        let twice = turn.then(turn).rotate(p);
        assert!((twice - turn.rotate(turn.rotate(p))).length() < 1e-14);
    }
}
