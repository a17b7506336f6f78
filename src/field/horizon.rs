//! What the ground hides from an eye: boxes that lie behind a hill as a whole.
//!
//! O09 section 6 leaves out tiles that occlusion queries find hidden; their answers come a frame late and
//! have to be read back. Here the processor knows the ground, and nothing is read back: in each of many
//! sectors about the eye it keeps how steeply the ground hides sight up to a distance. Everything errs
//! towards seeing: a sector counts with the lowest ground across it, and a box with its highest, nearest
//! corner over all its sectors. Plants and bodies hide nothing.

use std::f64::consts::TAU;

use crate::base::{Vec3, least, most};
use crate::terrain::HeightGrid;

/// Sectors about the eye; a multiple of 4, so that none lies across an axis.
const SECTORS: usize = 2048;
/// Rings are at least this share of their distance apart.
const GROWTH: f64 = 0.01;

/// The horizon of one eye over one ground. Sectors are looked at when a box first asks for them.
#[derive(Clone, Debug)]
pub struct Horizon<'a> {
    ground: &'a HeightGrid,
    eye: Vec3<f64>,
    highest_m: f64,
    /// Nothing is hidden from an eye that is in the ground.
    is_blind: bool,
    /// Distances at which the ground is looked at, ascending, in metres.
    rings_m: Vec<f64>,
    /// Per sector, for every ring: rays that rise less than this meet the ground up to there.
    hidden_below: Vec<Vec<f64>>,
    /// Added to the slope of every ray, for a ground that is drawn less exactly than it is.
    margin: f64,
}

impl<'a> Horizon<'a> {
    /// The horizon up to `reach_m` from the eye, of a ground that is drawn up to `error_rad` lower than it is,
    /// as seen from the eye.
    pub fn new(ground: &'a HeightGrid, eye: Vec3<f64>, reach_m: f64, error_rad: f64) -> Self {
        let spacing_m = f64::from(ground.spacing_m);
        let mut rings_m = Vec::new();
        let mut ring_m = spacing_m;
        while ring_m < reach_m {
            rings_m.push(ring_m);
            ring_m += most(spacing_m, GROWTH * ring_m);
        }
        Self {
            ground,
            eye,
            highest_m: f64::from(ground.range_m()[1]),
            is_blind: eye.y <= ground.height_in_world(eye.x, eye.z),
            rings_m,
            hidden_below: vec![Vec::new(); SECTORS],
            margin: error_rad,
        }
    }

    /// True only if no point of the box between two corners can be seen over the ground.
    pub fn hides(&mut self, low: [f64; 3], high: [f64; 3]) -> bool {
        // Over the way from the eye to the box no ray is lower than the lower end.
        if self.is_blind || self.highest_m <= least(self.eye.y, high[1]) {
            return false;
        }
        let apart = [0, 2].map(|a| {
            let eye = if a == 0 { self.eye.x } else { self.eye.z };
            [low[a] - eye, high[a] - eye]
        });
        let nearest = apart.map(|[from, to]| most(0.0, most(from, -to)));
        let near_m = nearest[0].hypot(nearest[1]);
        let farthest = apart.map(|[from, to]| most(from.abs(), to.abs()));
        let far_m = farthest[0].hypot(farthest[1]);
        let Some(ring) = self
            .rings_m
            .partition_point(|&m| m <= near_m)
            .checked_sub(1)
        else {
            return false;
        };
        let rise = high[1] - self.eye.y;
        let slope = rise / if rise > 0.0 { near_m } else { far_m };
        let wanted = slope + self.margin * (1.0 + slope * slope);
        self.sectors_of(apart).all(|sector| {
            if self.hidden_below[sector].is_empty() {
                self.hidden_below[sector] = self.look(sector);
            }
            self.hidden_below[sector][ring] >= wanted
        })
    }

    /// Sectors that a rectangle beside the eye lies in.
    fn sectors_of(&self, [x, z]: [[f64; 2]; 2]) -> impl Iterator<Item = usize> + use<> {
        let turns = |x: f64, z: f64| z.atan2(x) / TAU;
        let middle = turns(x[0] + x[1], z[0] + z[1]);
        let mut span = [0.0_f64; 2];
        for corner in [[x[0], z[0]], [x[1], z[0]], [x[0], z[1]], [x[1], z[1]]] {
            // The rectangle is seen under less than half a turn.
            let off = turns(corner[0], corner[1]) - middle;
            let off = off - off.round();
            span = [least(span[0], off), most(span[1], off)];
        }
        let sector = |turns: f64| (turns * SECTORS as f64).floor() as i64;
        // A sector more on either side forgives rounding.
        (sector(middle + span[0]) - 1..=sector(middle + span[1]) + 1)
            .map(|sector| sector.rem_euclid(SECTORS as i64) as usize)
    }

    /// How steeply the ground of a sector hides sight, up to every ring.
    fn look(&self, sector: usize) -> Vec<f64> {
        let sides = [sector, sector + 1].map(|n| (n as f64 / SECTORS as f64 * TAU).sin_cos());
        let mut steepest = f64::NEG_INFINITY;
        let rings = self.rings_m.iter().map(|&ring_m| {
            let ends =
                sides.map(|(sin, cos)| [self.eye.x + ring_m * cos, self.eye.z + ring_m * sin]);
            let low = [0, 1].map(|a| least(ends[0][a], ends[1][a]));
            let high = [0, 1].map(|a| most(ends[0][a], ends[1][a]));
            if self.ground.contains(low[0], low[1]) && self.ground.contains(high[0], high[1]) {
                let lowest_m = f64::from(self.ground.lowest_in_world(low, high));
                steepest = most(steepest, (lowest_m - self.eye.y) / ring_m);
            }
            steepest
        });
        rings.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::philox::{philox2x32, unit};

    /// Two ridges and a hollow, 60 m by 60 m.
    fn hills() -> HeightGrid {
        let mut ground = HeightGrid::flat(121, 121, 0.5);
        for (k, h) in ground.heights_m.iter_mut().enumerate() {
            let (x, z) = ((k % 121) as f32 * 0.5, (k / 121) as f32 * 0.5);
            *h = 2.5 * (0.21 * x).sin() * (0.17 * z).cos() + 0.4 * (0.9 * x + 0.5 * z).sin();
        }
        ground
    }

    /// Whether the ground leaves a straight way from the eye to a place, looked at every 2 cm.
    fn sees(ground: &HeightGrid, eye: Vec3<f64>, place: Vec3<f64>) -> bool {
        let steps = ((place - eye).length() / 0.02) as u32;
        (1..steps).all(|step| {
            let at = eye + (place - eye) * (f64::from(step) / f64::from(steps));
            at.y > ground.height_in_world(at.x, at.z) || !ground.contains(at.x, at.z)
        })
    }

    /// No point of a box that counts as hidden is seen, and of the boxes without a seen point most do.
    #[test]
    fn what_is_hidden_is_not_seen() {
        let ground = hills();
        let (mut hidden, mut unseen, mut seen) = (0, 0, 0);
        for k in 0..12 {
            let [a, b] = philox2x32([k, 0], 5, 7).map(|word| f64::from(unit(word)));
            let (x, z) = (56.0 * a - 28.0, 56.0 * b - 28.0);
            let eye_m = ground.height_in_world(x, z) + [0.3, 1.7][k as usize % 2];
            let eye = Vec3::new(x, eye_m, z);
            let mut horizon = Horizon::new(&ground, eye, 90.0, 0.0);
            for n in 0..150 {
                let [c, d] = philox2x32([k, n + 1], 5, 7).map(|word| f64::from(unit(word)));
                let (x, z) = (58.0 * c - 29.0, 58.0 * d - 29.0);
                let lows = [-0.5, 0.0, 0.5].map(|a| ground.height_in_world(x + a, z + a));
                let low = [
                    x - 0.5,
                    lows.into_iter().fold(f64::INFINITY, least),
                    z - 0.5,
                ];
                let high = [x + 0.5, low[1] + 0.8, z + 0.5];
                let points = (0..27).map(|p| {
                    let share = [p % 3, p / 3 % 3, p / 9].map(|n| f64::from(n) / 2.0);
                    Vec3::of([0, 1, 2].map(|a| low[a] + share[a] * (high[a] - low[a])))
                });
                let is_seen = points.into_iter().any(|place| sees(&ground, eye, place));
                let is_hidden = horizon.hides(low, high);
                assert!(!(is_seen && is_hidden), "eye {k}, box {n}");
                hidden += u32::from(is_hidden);
                unseen += u32::from(!is_seen);
                seen += u32::from(is_seen);
            }
        }
        println!("{hidden} of {unseen} unseen boxes are found, {seen} are seen");
        assert!(seen > 100 && unseen > 100 && 2 * hidden > unseen);
    }

    #[test]
    fn nothing_is_hidden_from_above_or_from_within_the_ground() {
        let ground = hills();
        for y in [40.0, -40.0] {
            let mut horizon = Horizon::new(&ground, Vec3::new(1.0, y, 2.0), 90.0, 0.0);
            for k in 0..25 {
                let (x, z) = (
                    f64::from(k % 5) * 10.0 - 20.0,
                    f64::from(k / 5) * 10.0 - 20.0,
                );
                assert!(!horizon.hides([x, -3.0, z], [x + 1.0, 3.5, z + 1.0]));
            }
        }
    }
}
