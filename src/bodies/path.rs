//! A body that follows way points by time.
//!
//! Between two way points each coordinate is a cubic Hermite curve. Its slope at a way point is
//! that of the parabola through the point and its two neighbours (Catmull-Rom for even times), so
//! the velocity is continuous. The slope is zero at both ends of an open path, and at a way point
//! whose neighbour is at the same place and turn: the body stands still between the two.
//! Angles run through the degrees as written, so that a turn by 720° is two whole turns.

use crate::base::{Pose, Vec3};
use crate::scene::Waypoint;
use crate::terrain::HeightGrid;

use super::frame::turn_of_degrees;

/// x, y, z in metres, then three angles in degrees.
type Knot = [f64; 6];

/// A path that has been checked.
#[derive(Clone, Debug)]
pub(super) struct Path {
    times_s: Vec<f64>,
    knots: Vec<Knot>,
    slopes: Vec<Knot>,
    repeat: bool,
    above_ground: bool,
}

impl Path {
    /// # Errors
    /// What is wrong with the way points, to follow the words 'its path'.
    pub fn new(waypoints: &[Waypoint], repeat: bool, above_ground: bool) -> Result<Self, String> {
        if waypoints.is_empty() {
            return Err("has no way points; give it at least one".into());
        }
        let times_s: Vec<f64> = waypoints.iter().map(|w| w.at_s).collect();
        let knots: Vec<Knot> = waypoints.iter().map(knot).collect();
        for (k, pair) in times_s.windows(2).enumerate() {
            // Written so that NaN fails too.
            let rises = pair[1] > pair[0];
            if !rises {
                return Err(format!(
                    "has way point {} at {} s after way point {k} at {} s; times must rise",
                    k + 1,
                    pair[1],
                    pair[0]
                ));
            }
        }
        for (k, (t, knot)) in times_s.iter().zip(&knots).enumerate() {
            if !t.is_finite() || !knot.iter().all(|v| v.is_finite()) {
                return Err(format!("has a number that is not finite in way point {k}"));
            }
        }
        let mut path = Self {
            slopes: vec![[0.0; 6]; knots.len()],
            times_s,
            knots,
            repeat: repeat && waypoints.len() > 1,
            above_ground,
        };
        path.find_slopes();
        Ok(path)
    }

    /// `world_from_body` at a time since the start of the scene.
    pub fn pose(&self, at_s: f64, ground: &HeightGrid) -> Pose<f64> {
        let [x, y, z, a, b, c] = self.knot_at(self.wrapped(at_s).0);
        let mut place = Vec3::new(x, y, z);
        if self.above_ground {
            place.y += ground.height_in_world(x, z);
        }
        Pose {
            turn: turn_of_degrees([a, b, c]),
            place,
        }
    }

    /// True if the body jumps from the last way point back to the first between two times: a
    /// teleport, which sweeps nothing.
    pub fn jumps(&self, from_s: f64, to_s: f64) -> bool {
        !self.closed() && self.wrapped(from_s).1 != self.wrapped(to_s).1
    }

    /// The time on the path, and how many times it was run through before.
    fn wrapped(&self, at_s: f64) -> (f64, f64) {
        let (first, last) = (self.times_s[0], self.times_s[self.times_s.len() - 1]);
        if !self.repeat || at_s < last {
            return (at_s, 0.0);
        }
        let period = last - first;
        let laps = ((at_s - first) / period).floor();
        (at_s - laps * period, laps)
    }

    /// True if a repeated path ends where it starts, whole turns apart.
    fn closed(&self) -> bool {
        let (first, last) = (&self.knots[0], &self.knots[self.knots.len() - 1]);
        self.repeat
            && first[..3] == last[..3]
            && (3..6).all(|k| (last[k] - first[k]) % 360.0 == 0.0)
    }

    fn find_slopes(&mut self) {
        let last = self.knots.len() - 1;
        for i in 1..last {
            self.slopes[i] = self.slope([i - 1, i], [i, i + 1]);
        }
        if self.closed() && last > 1 {
            let round = self.slope([last - 1, last], [0, 1]);
            self.slopes[0] = round;
            self.slopes[last] = round;
        }
    }

    /// The slope at the knot between two segments, each given by its ends.
    fn slope(&self, before: [usize; 2], after: [usize; 2]) -> Knot {
        let span = |[a, b]: [usize; 2]| self.times_s[b] - self.times_s[a];
        let stands = |[a, b]: [usize; 2]| self.knots[a] == self.knots[b];
        if stands(before) || stands(after) {
            return [0.0; 6];
        }
        let (h0, h1) = (span(before), span(after));
        std::array::from_fn(|c| {
            let d0 = (self.knots[before[1]][c] - self.knots[before[0]][c]) / h0;
            let d1 = (self.knots[after[1]][c] - self.knots[after[0]][c]) / h1;
            (h1 * d0 + h0 * d1) / (h0 + h1)
        })
    }

    fn knot_at(&self, at_s: f64) -> Knot {
        let last = self.knots.len() - 1;
        let after = self.times_s.partition_point(|&t| t <= at_s);
        if after == 0 {
            return self.knots[0];
        }
        if after > last {
            return self.knots[last];
        }
        let (i, j) = (after - 1, after);
        let h = self.times_s[j] - self.times_s[i];
        let s = (at_s - self.times_s[i]) / h;
        let (s2, s3) = (s * s, s * s * s);
        // The cubic Hermite basis.
        let to = 3.0 * s2 - 2.0 * s3;
        let (leave, reach) = (s3 - 2.0 * s2 + s, s3 - s2);
        std::array::from_fn(|c| {
            self.knots[i][c] * (1.0 - to)
                + self.knots[j][c] * to
                + h * (self.slopes[i][c] * leave + self.slopes[j][c] * reach)
        })
    }
}

fn knot(waypoint: &Waypoint) -> Knot {
    let [x, y, z] = waypoint.position_m;
    let [a, b, c] = waypoint.rotation_deg.map(f64::from);
    [x, y, z, a, b, c]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(at_s: f64, x: f64, z: f64, yaw: f32) -> Waypoint {
        Waypoint {
            at_s,
            position_m: [x, 0.25, z],
            rotation_deg: [0.0, yaw, 0.0],
        }
    }

    fn flat() -> HeightGrid {
        HeightGrid::flat(5, 5, 4.0)
    }

    #[test]
    fn it_passes_its_way_points_and_stands_at_the_ends() {
        let points = [
            at(1.0, 0.0, 0.0, 0.0),
            at(2.0, 1.0, 3.0, 30.0),
            at(4.0, -2.0, 5.0, 400.0),
        ];
        let path = Path::new(&points, false, false).expect("times rise");
        for w in &points {
            let pose = path.pose(w.at_s, &flat());
            assert!((pose.place - Vec3::of(w.position_m)).length() < 1e-12);
            let turn = turn_of_degrees(w.rotation_deg.map(f64::from));
            assert!((pose.turn.v - turn.v).length() < 1e-9);
        }
        assert_eq!(path.pose(-5.0, &flat()), path.pose(1.0, &flat()));
        assert_eq!(path.pose(99.0, &flat()), path.pose(4.0, &flat()));
    }

    #[test]
    fn its_velocity_has_no_steps() {
        let points = [
            at(0.0, 0.0, 0.0, 0.0),
            at(1.0, 1.0, 3.0, 0.0),
            at(3.0, -2.0, 5.0, 0.0),
            at(3.5, 0.0, 0.0, 0.0),
        ];
        for repeat in [false, true] {
            let path = Path::new(&points, repeat, false).expect("times rise");
            let e = 1e-6;
            let speed = |t: f64| {
                let step = path.pose(t + e, &flat()).place - path.pose(t, &flat()).place;
                step * (1.0 / e)
            };
            // Accelerations stay below 200 m/s²: over 2e-6 s the velocity changes by 4e-4 m/s;
            // rounding adds 1e-9 m/s.
            let mut kinks: Vec<f64> = points[1..3].iter().map(|w| w.at_s).collect();
            if repeat {
                kinks.extend([3.5, 4.5, 7.0]);
            }
            for t in kinks {
                let jump = (speed(t) - speed(t - 2.0 * e)).length();
                assert!(jump < 1e-3, "{repeat} {t}: {jump}");
            }
        }
    }

    #[test]
    fn a_pause_is_a_pause_and_an_open_lap_ends_in_a_jump() {
        let points = [
            at(0.0, 0.0, 0.0, 0.0),
            at(1.0, 2.0, 0.0, 0.0),
            at(2.0, 2.0, 0.0, 0.0),
            at(3.0, 4.0, 0.0, 0.0),
        ];
        let path = Path::new(&points, true, false).expect("times rise");
        for k in 0..=10 {
            let place = path.pose(1.0 + 0.1 * f64::from(k), &flat()).place;
            assert!((place.x - 2.0).abs() < 1e-12);
        }
        assert!(path.jumps(2.99, 3.01));
        assert!(!path.jumps(1.0, 2.99) && !path.jumps(3.0, 5.9));
        assert_eq!(path.pose(6.5, &flat()), path.pose(0.5, &flat()));
    }

    #[test]
    fn above_ground_follows_the_ground_between_the_way_points() {
        let mut grid = flat();
        for (k, h) in grid.heights_m.iter_mut().enumerate() {
            *h = (k % 3) as f32;
        }
        let points = [at(0.0, -6.0, 1.0, 0.0), at(5.0, 7.0, 2.0, 0.0)];
        let path = Path::new(&points, false, true).expect("times rise");
        for k in 0..50 {
            let p = path.pose(0.1 * f64::from(k), &grid).place;
            assert!((p.y - 0.25 - grid.height_in_world(p.x, p.z)).abs() < 1e-12);
        }
    }

    #[test]
    fn bad_way_points_are_refused() {
        assert!(Path::new(&[], false, false).is_err());
        let twice = [at(1.0, 0.0, 0.0, 0.0), at(1.0, 1.0, 0.0, 0.0)];
        assert!(Path::new(&twice, false, false).is_err());
        assert!(Path::new(&[at(f64::NAN, 0.0, 0.0, 0.0)], false, false).is_err());
        assert!(Path::new(&[at(0.0, f64::INFINITY, 0.0, 0.0)], false, false).is_err());
    }
}
