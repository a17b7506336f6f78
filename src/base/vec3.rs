//! A vector of three floats, generic over the float.

use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

use super::Real;

/// Three components along x, y (up) and z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3<R> {
    pub x: R,
    pub y: R,
    pub z: R,
}

/// Shorthand for [`Vec3::new`].
pub const fn vec3<R>(x: R, y: R, z: R) -> Vec3<R> {
    Vec3 { x, y, z }
}

impl<R: Real> Vec3<R> {
    pub const ZERO: Self = vec3(R::ZERO, R::ZERO, R::ZERO);
    pub const UP: Self = vec3(R::ZERO, R::ONE, R::ZERO);

    pub const fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }

    /// Rounds from `f64` components.
    pub fn of(v: [f64; 3]) -> Self {
        vec3(R::of(v[0]), R::of(v[1]), R::of(v[2]))
    }

    /// Widens `f32` components.
    pub fn of_f32(v: [f32; 3]) -> Self {
        vec3(R::of_f32(v[0]), R::of_f32(v[1]), R::of_f32(v[2]))
    }

    pub fn to_f32(self) -> [f32; 3] {
        [self.x.to_f32(), self.y.to_f32(), self.z.to_f32()]
    }

    pub fn to_f64(self) -> [f64; 3] {
        [self.x.to_f64(), self.y.to_f64(), self.z.to_f64()]
    }

    pub fn dot(self, o: Self) -> R {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    pub fn cross(self, o: Self) -> Self {
        vec3(
            self.y * o.z - self.z * o.y,
            self.z * o.x - self.x * o.z,
            self.x * o.y - self.y * o.x,
        )
    }

    pub fn length_squared(self) -> R {
        self.dot(self)
    }

    pub fn length(self) -> R {
        self.length_squared().sqrt()
    }

    /// The unit vector along `self`, or `fallback` where `self` is too short to have a direction.
    pub fn unit_or(self, fallback: Self) -> Self {
        let squared = self.length_squared();
        // 1e-24 m² is far below any segment and far above the smallest normal f32.
        if squared > R::of(1e-24) {
            self * (R::ONE / squared.sqrt())
        } else {
            fallback
        }
    }

    /// Some unit vector at right angles to this one, which has unit length.
    pub fn across(self) -> Self {
        let axis = if self.x.abs() < R::of(0.5) {
            vec3(R::ONE, R::ZERO, R::ZERO)
        } else {
            vec3(R::ZERO, R::ZERO, R::ONE)
        };
        (axis - self * self.dot(axis)).unit_or(Vec3::UP)
    }

    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
}

impl<R: Real> Add for Vec3<R> {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        vec3(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl<R: Real> Sub for Vec3<R> {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        vec3(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl<R: Real> Mul<R> for Vec3<R> {
    type Output = Self;
    fn mul(self, s: R) -> Self {
        vec3(self.x * s, self.y * s, self.z * s)
    }
}

impl<R: Real> Neg for Vec3<R> {
    type Output = Self;
    fn neg(self) -> Self {
        vec3(-self.x, -self.y, -self.z)
    }
}

impl<R: Real> AddAssign for Vec3<R> {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl<R: Real> SubAssign for Vec3<R> {
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}
