//! Where the ground is seen from, in the numbers that culling and projection need.

use crate::base::Vec3;

/// An eye, its axes and its opening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    pub eye_in_world: Vec3<f64>,
    /// Unit vectors to the right of, to the top of and into the picture.
    pub right: Vec3<f64>,
    pub up: Vec3<f64>,
    pub forward: Vec3<f64>,
    /// Tangents of half the horizontal and half the vertical field of view.
    pub half_tan: [f64; 2],
    /// Angle of a pixel in the middle of the picture, in radians.
    pub pixel_rad: f64,
}

impl Viewpoint {
    /// Inward unit normals of the picture's left, right, lower and upper side in eye axes (x to
    /// the right, y up, z into the picture). All sides pass through the eye.
    pub(super) fn sides_in_eye(&self) -> [[f32; 3]; 4] {
        let [wide, high] = self.half_tan;
        let side = |x: f64, y: f64, z: f64| {
            let length = (x * x + y * y + z * z).sqrt();
            [x / length, y / length, z / length].map(|v| v as f32)
        };
        [
            side(1.0, 0.0, wide),
            side(-1.0, 0.0, wide),
            side(0.0, 1.0, high),
            side(0.0, -1.0, high),
        ]
    }

    /// The same normals along the world's axes.
    pub(super) fn sides_in_world(&self) -> [Vec3<f64>; 4] {
        self.sides_in_eye().map(|[x, y, z]| {
            self.right * f64::from(x) + self.up * f64::from(y) + self.forward * f64::from(z)
        })
    }

    /// A direction of the world along the eye's axes.
    pub(super) fn turned(&self, v: Vec3<f64>) -> [f32; 3] {
        [self.right, self.up, self.forward].map(|axis| axis.dot(v) as f32)
    }
}
