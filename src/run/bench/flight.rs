//! The flight of P15 section 4: from high above down to the grass and up again.

pub mod experiment;
pub mod ground;
pub mod plot;
pub mod seeding;
pub mod traversal;

pub use experiment::{FlightBench, FlightRequest, bench_flight};

use crate::base::Vec3;
use crate::render::View;
use crate::terrain::HeightGrid;

/// Length of the flight, in seconds, and frames in each.
pub const FLIGHT_S: u32 = 30;
pub const FRAMES_PER_S: u32 = 10;
/// Vertical field of view, in degrees.
const FOV_DEG: f32 = 55.0;
/// The flight's start and end over the ground, and its lowest part, in metres.
const HIGH_M: f64 = 400.0;
const LOW_M: f64 = 1.8;
/// When it is down, and when it rises again, in seconds.
const DOWN_S: f64 = 10.0;
const RISING_S: f64 = 20.0;
/// It goes round the terrain's middle at this distance, in metres, and with this speed.
const CIRCLE_M: f64 = 200.0;
const SPEED_M_PER_S: f64 = 15.0;

/// The view of a frame. It depends on the ground near the middle alone, not on the terrain's size.
pub fn flight_view(ground: &HeightGrid, frame: u32) -> View {
    let at_s = f64::from(frame) / f64::from(FRAMES_PER_S);
    let angle = at_s * SPEED_M_PER_S / CIRCLE_M;
    let [x, z] = [angle.cos(), angle.sin()].map(|c| c * CIRCLE_M);
    let (x, z) = (ground.centre_m[0] + x, ground.centre_m[1] + z);
    // 0 on the ground, 1 at the start and at the end.
    let off_s = (DOWN_S - at_s).max(at_s - RISING_S).max(0.0);
    let share = off_s / DOWN_S;
    let risen = share * share * (3.0 - 2.0 * share);
    let above_m = LOW_M * (HIGH_M / LOW_M).powf(risen);
    let eye = Vec3::new(x, ground.height_in_world(x, z) + above_m, z);
    let pitch_rad = -0.06 - 0.6 * risen;
    // Along the circle.
    let yaw_rad = angle + std::f64::consts::PI;
    View::fly(eye, yaw_rad, pitch_rad, FOV_DEG)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_low_from_10_s_to_20_s_and_high_at_both_ends() {
        let ground = HeightGrid::flat(201, 201, 5.0);
        let height_m = |at_s: u32| flight_view(&ground, at_s * FRAMES_PER_S).eye_in_world.y;
        assert_eq!(height_m(0), height_m(30));
        assert!((height_m(0) - HIGH_M).abs() < 1e-9);
        assert!((10..=20).all(|s| (height_m(s) - LOW_M).abs() < 1e-9));
        for frame in 0..FLIGHT_S * FRAMES_PER_S {
            let [now, next] = [frame, frame + 1].map(|f| flight_view(&ground, f));
            let step = next.eye_in_world - now.eye_in_world;
            // It flies where it looks, but for the pitch.
            let level = Vec3::new(step.x, 0.0, step.z).unit_or(Vec3::UP);
            assert!(level.dot(now.forward) > 0.7, "frame {frame}");
        }
    }
}
