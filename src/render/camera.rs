//! Where a picture is taken from.
//!
//! The eye is kept in `f64`; everything the device gets is relative to it, so that a scene far
//! from the origin looks like one at the origin. Depth runs backwards, 1 at the near plane to 0
//! at infinity, which spends the float's precision evenly over distance.

use glam::camera::rh::{proj::directx, view::look_to_mat4};
use glam::{Mat4, Vec4};

use crate::base::Vec3;
use crate::terrain::bintree::Viewpoint;

/// Distance of the near plane, in metres: closer than any blade is worth looking at.
const NEAR_M: f32 = 0.03;

/// A camera: where it stands, where it looks, how wide. Up in the picture is +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    pub eye_in_world: Vec3<f64>,
    /// Unit vector.
    pub forward: Vec3<f64>,
    /// Vertical field of view, in radians.
    pub fov_rad: f32,
}

impl View {
    /// Looks from `eye` at `target`; along −z if the two coincide.
    pub fn look_at(eye: Vec3<f64>, target: Vec3<f64>, fov_deg: f32) -> Self {
        Self {
            eye_in_world: eye,
            forward: (target - eye).unit_or(Vec3::new(0.0, 0.0, -1.0)),
            fov_rad: fov_deg.to_radians(),
        }
    }

    /// Looks along a compass direction (`yaw`, from −z towards +x) and an elevation (`pitch`,
    /// up), both in radians.
    pub fn fly(eye: Vec3<f64>, yaw_rad: f64, pitch_rad: f64, fov_deg: f32) -> Self {
        let (sin_yaw, cos_yaw) = yaw_rad.sin_cos();
        let (sin_pitch, cos_pitch) = pitch_rad.sin_cos();
        Self {
            eye_in_world: eye,
            forward: Vec3::new(cos_pitch * sin_yaw, sin_pitch, -cos_pitch * cos_yaw),
            fov_rad: fov_deg.to_radians(),
        }
    }

    /// Vector to the right of the picture, of unit length. Straight up or down, +x.
    pub fn right(&self) -> Vec3<f64> {
        self.forward
            .cross(Vec3::UP)
            .unit_or(Vec3::new(1.0, 0.0, 0.0))
    }

    /// Vector to the top of the picture, of unit length.
    pub fn up(&self) -> Vec3<f64> {
        self.right().cross(self.forward).unit_or(Vec3::UP)
    }

    /// How much farther than its middle a ball of radius 1 reaches in clip space, across and up.
    pub(super) fn clip_reach(&self, aspect: f32) -> [f32; 2] {
        let rows = self.clip_from_eye(aspect).transpose();
        let length = |row: glam::Vec4| row.truncate().length();
        [rows.x_axis, rows.y_axis].map(|row| length(row) + length(rows.w_axis))
    }

    /// Projection of a point relative to the eye, for a picture of this width over height.
    pub fn clip_from_eye(&self, aspect: f32) -> Mat4 {
        let [forward, up] = [self.forward, self.up()].map(|v| glam::Vec3::from(v.to_f32()));
        directx::perspective_infinite_reverse(self.fov_rad, aspect, NEAR_M)
            * look_to_mat4(glam::Vec3::ZERO, forward, up)
    }

    /// Unit vector from the eye through a place in the picture, 0…1 from the left and the top.
    pub fn ray(&self, aspect: f64, across: f64, down: f64) -> Vec3<f64> {
        let half_height = (0.5 * f64::from(self.fov_rad)).tan();
        let x = (2.0 * across - 1.0) * half_height * aspect;
        let y = (1.0 - 2.0 * down) * half_height;
        (self.forward + self.right() * x + self.up() * y).unit_or(self.forward)
    }

    /// Angle of a pixel in the middle of a picture with this many rows, in radians.
    pub fn pixel_rad(&self, rows: u32) -> f32 {
        2.0 * (0.5 * self.fov_rad).tan() / rows.max(1) as f32
    }

    /// What the picture can show.
    pub fn frustum(&self, aspect: f32) -> Frustum {
        let rows = self.clip_from_eye(aspect).transpose();
        let [x, y, w] = [rows.x_axis, rows.y_axis, rows.w_axis];
        Frustum {
            eye_in_world: self.eye_in_world,
            inward: [w + x, w - x, w + y, w - y].map(Vec4::truncate),
        }
    }

    /// The view for a picture of this width over height and this many rows, as the ground's
    /// bintree takes it.
    pub fn viewpoint(&self, aspect: f32, rows: u32) -> Viewpoint {
        let half_high = (0.5 * f64::from(self.fov_rad)).tan();
        Viewpoint {
            eye_in_world: self.eye_in_world,
            right: self.right(),
            up: self.up(),
            forward: self.forward,
            half_tan: [half_high * f64::from(aspect), half_high],
            pixel_rad: f64::from(self.pixel_rad(rows)),
        }
    }

    /// A point's place relative to the eye, as the device gets it.
    pub fn from_eye(&self, in_world: Vec3<f64>) -> [f32; 3] {
        (in_world - self.eye_in_world).to_f32()
    }
}

/// The four sides of a view; it has no far end, and the near one is too near to matter.
#[derive(Clone, Copy, Debug)]
pub struct Frustum {
    eye_in_world: Vec3<f64>,
    /// Normals of the sides, pointing in; all sides pass through the eye.
    inward: [glam::Vec3; 4],
}

impl Frustum {
    /// False only if no point of the box between two corners can be seen.
    pub fn may_see(&self, low_in_world: [f64; 3], high_in_world: [f64; 3]) -> bool {
        let low = (Vec3::of(low_in_world) - self.eye_in_world).to_f32();
        let high = (Vec3::of(high_in_world) - self.eye_in_world).to_f32();
        self.inward.iter().all(|n| {
            // The corner farthest along the normal.
            let along = |axis: usize| n[axis] * if n[axis] > 0.0 { high[axis] } else { low[axis] };
            along(0) + along(1) + along(2) >= 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> View {
        let eye = Vec3::new(100_000.0, 1.7, -40_000.0);
        View::look_at(eye, eye + Vec3::new(3.0, -0.4, 2.0), 50.0)
    }

    #[test]
    fn rays_project_where_they_start() {
        let view = view();
        let clip_from_eye = view.clip_from_eye(1.5);
        for (across, down) in [(0.5, 0.5), (0.0, 0.0), (0.9, 0.2), (0.3, 1.0)] {
            let ray = view.ray(1.5, across, down) * 7.0;
            let clip = clip_from_eye * glam::Vec3::from(ray.to_f32()).extend(1.0);
            // f32 rounding of a product of two matrices with entries of order 1.
            assert!((clip.x / clip.w - (2.0 * across as f32 - 1.0)).abs() < 1e-5);
            assert!((clip.y / clip.w - (1.0 - 2.0 * down as f32)).abs() < 1e-5);
        }
    }

    #[test]
    fn nearer_is_a_larger_depth() {
        let view = view();
        let depth = |m: f64| {
            let p = glam::Vec3::from((view.forward * m).to_f32());
            let clip = view.clip_from_eye(1.0) * p.extend(1.0);
            clip.z / clip.w
        };
        assert!(depth(1.0) > depth(10.0) && depth(10.0) > depth(1e4));
        assert!(depth(1e4) > 0.0 && (depth(f64::from(NEAR_M)) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn the_frustum_keeps_what_rays_meet_and_drops_what_is_behind() {
        let view = view();
        let frustum = view.frustum(1.5);
        let cube = |centre: Vec3<f64>, half: f64| {
            let [x, y, z] = centre.to_f64();
            (
                [x - half, y - half, z - half],
                [x + half, y + half, z + half],
            )
        };
        for (across, down) in [(0.01, 0.01), (0.99, 0.5), (0.5, 0.99)] {
            let (low, high) = cube(
                view.eye_in_world + view.ray(1.5, across, down) * 20.0,
                0.001,
            );
            assert!(frustum.may_see(low, high), "{across} {down}");
        }
        for away in [
            view.forward * -5.0,
            view.right() * 9.0 + view.forward * 5.0,
            view.up() * -4.0 + view.forward * 5.0,
        ] {
            let (low, high) = cube(view.eye_in_world + away, 0.5);
            assert!(!frustum.may_see(low, high), "{away:?}");
        }
        let (low, high) = cube(view.eye_in_world, 1.0);
        assert!(frustum.may_see(low, high));
    }

    #[test]
    fn looking_straight_down_is_defined() {
        let view = View::look_at(Vec3::new(0.0, 9.0, 0.0), Vec3::ZERO, 45.0);
        assert!(view.clip_from_eye(1.0).is_finite());
        assert!((view.right().length() - 1.0).abs() < 1e-12);
        assert!((view.up().length() - 1.0).abs() < 1e-12);
    }
}
