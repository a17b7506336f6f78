//! The camera a person moves: flying about the eye, orbiting about a point, or a scene's own view.

use crate::base::Vec3;
use crate::render::View;

/// Radians that a drag of one pixel turns the camera.
const TURN_RAD_PER_PIXEL: f64 = 0.005;
/// Highest elevation; straight up and down have no right-hand side.
const MOST_PITCH_RAD: f64 = 1.54;
/// Factor on speed or distance per notch of the wheel.
const WHEEL_FACTOR: f64 = 1.2;
/// Slowest and fastest flight, in metres per second.
const SPEEDS_M_PER_S: [f64; 2] = [0.05, 200.0];
/// Nearest and farthest that the camera orbits, in metres.
const DISTANCES_M: [f64; 2] = [0.2, 2000.0];
/// The eye stays at least this far above the ground, in metres.
const CLEARANCE_M: f64 = 0.08;

/// What a drag without modifier keys does, and who decides the view.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum CameraMode {
    Fly,
    Orbit,
    /// The scene's camera of this place in its list.
    Scene(usize),
}

/// A camera with the point it turns about.
#[derive(Clone, Debug)]
pub struct CameraRig {
    pub mode: CameraMode,
    eye_in_world: Vec3<f64>,
    /// Compass direction from −z towards +x, and elevation.
    yaw_rad: f64,
    pitch_rad: f64,
    fov_deg: f32,
    /// From the eye to the point that orbiting turns about.
    distance_m: f64,
    pub speed_m_per_s: f64,
}

impl Default for CameraRig {
    fn default() -> Self {
        Self {
            mode: CameraMode::Orbit,
            eye_in_world: Vec3::new(5.0, 2.5, 5.0),
            yaw_rad: -0.8,
            pitch_rad: -0.3,
            fov_deg: 45.0,
            distance_m: 7.0,
            speed_m_per_s: 4.0,
        }
    }
}

impl CameraRig {
    pub fn view(&self) -> View {
        View::fly(
            self.eye_in_world,
            self.yaw_rad,
            self.pitch_rad,
            self.fov_deg,
        )
    }

    /// Goes on from another view, which looks at something `distance_m` away.
    pub fn adopt(&mut self, view: &View, distance_m: f64) {
        let [x, y, z] = view.forward.to_f64();
        self.eye_in_world = view.eye_in_world;
        self.yaw_rad = x.atan2(-z);
        self.pitch_rad = y
            .clamp(-1.0, 1.0)
            .asin()
            .clamp(-MOST_PITCH_RAD, MOST_PITCH_RAD);
        self.fov_deg = view.fov_rad.to_degrees();
        self.distance_m = distance_m.clamp(DISTANCES_M[0], DISTANCES_M[1]);
    }

    /// Turns about the eye by a drag in pixels.
    pub fn look(&mut self, [across, down]: [f64; 2]) {
        self.turn(across, -down);
    }

    /// Turns about the pivot, so that the scene follows a drag in pixels.
    pub fn orbit(&mut self, [across, down]: [f64; 2]) {
        let pivot = self.pivot_in_world();
        self.turn(across, -down);
        self.eye_in_world = pivot - self.view().forward * self.distance_m;
    }

    /// Moves eye and pivot sideways, so that the pivot follows a drag in pixels over a picture
    /// `rows` pixels high.
    pub fn pan(&mut self, [across, down]: [f64; 2], rows: f64) {
        let view = self.view();
        let m_per_pixel = f64::from(view.pixel_rad(rows.max(1.0) as u32)) * self.distance_m;
        self.eye_in_world += view.right() * (-across * m_per_pixel);
        self.eye_in_world += view.up() * (down * m_per_pixel);
    }

    /// Comes nearer to the pivot by notches of the wheel.
    pub fn zoom(&mut self, notches: f64) {
        let pivot = self.pivot_in_world();
        let wished = self.distance_m * WHEEL_FACTOR.powf(-notches);
        self.distance_m = wished.clamp(DISTANCES_M[0], DISTANCES_M[1]);
        self.eye_in_world = pivot - self.view().forward * self.distance_m;
    }

    /// Flies faster by notches of the wheel.
    pub fn change_speed(&mut self, notches: f64) {
        let wished = self.speed_m_per_s * WHEEL_FACTOR.powf(notches);
        self.speed_m_per_s = wished.clamp(SPEEDS_M_PER_S[0], SPEEDS_M_PER_S[1]);
    }

    /// Flies for `frame_s` to the right, up and ahead, each −1…1.
    pub fn fly(&mut self, [right, up, ahead]: [f64; 3], frame_s: f64) {
        let view = self.view();
        let way = view.right() * right + Vec3::UP * up + view.forward * ahead;
        self.eye_in_world += way.unit_or(Vec3::ZERO) * (self.speed_m_per_s * frame_s);
    }

    /// Shows a ball of space as a whole, from where the camera looks now.
    pub fn frame(&mut self, centre_in_world: Vec3<f64>, radius_m: f64) {
        let half_fov = 0.5 * f64::from(self.fov_deg).to_radians();
        let wished = 1.3 * radius_m.max(0.1) / half_fov.sin();
        self.distance_m = wished.clamp(DISTANCES_M[0], DISTANCES_M[1]);
        // From below the horizon nothing of a meadow shows.
        self.pitch_rad = self.pitch_rad.clamp(-MOST_PITCH_RAD, -0.25);
        self.eye_in_world = centre_in_world - self.view().forward * self.distance_m;
    }

    /// Keeps the eye above the ground, whose height is given by place.
    pub fn stay_above(&mut self, height_m: impl Fn(f64, f64) -> f64) {
        let least = height_m(self.eye_in_world.x, self.eye_in_world.z) + CLEARANCE_M;
        self.eye_in_world.y = self.eye_in_world.y.max(least);
    }

    fn pivot_in_world(&self) -> Vec3<f64> {
        self.eye_in_world + self.view().forward * self.distance_m
    }

    fn turn(&mut self, right: f64, up: f64) {
        self.yaw_rad += right * TURN_RAD_PER_PIXEL;
        let pitch = self.pitch_rad + up * TURN_RAD_PER_PIXEL;
        self.pitch_rad = pitch.clamp(-MOST_PITCH_RAD, MOST_PITCH_RAD);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Roundings of a few steps with numbers of order 10.
    const CLOSE: f64 = 1e-12;

    #[test]
    fn orbiting_keeps_the_pivot_and_looking_keeps_the_eye() {
        let mut rig = CameraRig::default();
        let pivot = rig.pivot_in_world();
        rig.orbit([130.0, -40.0]);
        assert!((rig.pivot_in_world() - pivot).length() < CLOSE);
        let eye = rig.eye_in_world;
        rig.look([-50.0, 20.0]);
        assert_eq!(rig.eye_in_world, eye);
        assert!((rig.pivot_in_world() - pivot).length() > 0.5);
    }

    #[test]
    fn a_pan_moves_the_pivot_with_the_pointer() {
        let mut rig = CameraRig::default();
        let before = rig.view();
        let pivot = rig.pivot_in_world();
        rig.pan([100.0, 0.0], 500.0);
        // The old pivot now lies to the right of the middle.
        let from_eye = pivot - rig.view().eye_in_world;
        assert!(from_eye.dot(before.right()) > 0.1);
        assert!(from_eye.dot(before.up()).abs() < CLOSE);
    }

    #[test]
    fn zoom_and_speed_stay_in_their_limits() {
        let mut rig = CameraRig::default();
        let pivot = rig.pivot_in_world();
        for notches in [500.0, -1000.0] {
            rig.zoom(notches);
            rig.change_speed(notches);
            // Two thousand metres away a rounding is 1000 times larger.
            assert!((rig.pivot_in_world() - pivot).length() < 1e3 * CLOSE);
            assert!(DISTANCES_M.contains(&rig.distance_m));
            assert!(SPEEDS_M_PER_S.contains(&rig.speed_m_per_s));
        }
    }

    #[test]
    fn an_adopted_view_is_the_same_view() {
        let eye = Vec3::new(1.0, 2.0, 3.0);
        let view = View::look_at(eye, Vec3::new(-4.0, 0.5, 1.0), 40.0);
        let mut rig = CameraRig::default();
        rig.adopt(&view, 5.0);
        assert!((rig.view().forward - view.forward).length() < CLOSE);
        assert_eq!(rig.view().eye_in_world, eye);
    }

    #[test]
    fn a_framed_ball_fits_the_picture() {
        let mut rig = CameraRig::default();
        let centre = Vec3::new(10.0, 0.0, -3.0);
        rig.frame(centre, 2.0);
        let view = rig.view();
        let away = centre - view.eye_in_world;
        assert!((away.unit_or(Vec3::ZERO) - view.forward).length() < CLOSE);
        assert!((2.0 / away.length()).asin() < 0.5 * f64::from(view.fov_rad));
    }

    #[test]
    fn the_eye_stays_above_ground() {
        let mut rig = CameraRig::default();
        rig.stay_above(|_, _| 40.0);
        assert_eq!(rig.view().eye_in_world.y, 40.0 + CLEARANCE_M);
    }
}
