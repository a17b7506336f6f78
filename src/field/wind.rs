//! Wind: a steady bend, gusts that travel along it, and each plant's own trembling.
//!
//! A weighted sum of sines of different frequencies (O09 section 5). Every phase is counted in
//! turns as a 32-bit fraction that wraps by itself: time enters through an `f64` that is
//! wrapped before it is rounded, place through whole anchors, so that a gust is as exact after a
//! day or at 100 km as at the start. WGSL twin: `shaders/shared/wind.wgsl`.

use crate::base::Real;
use crate::base::philox::unit;
use crate::base::trig::sin_turns;
use crate::scene::Wind;

use super::grid::Anchor;
use super::plant::Plant;

/// Sines that make a gust.
pub const WAVES: usize = 3;
/// Length of each sine relative to the gust's, its turn from the wind's direction as a slope
/// across, and its share. Shares sum to 1.
const SHAPES: [(f64, f64, f64); WAVES] = [(1.0, 0.0, 0.55), (0.53, 0.7, 0.28), (0.31, -0.9, 0.17)];
/// Trembling of a blade, in hertz.
const FLUTTER_HZ: f64 = 2.3;
/// How long a change of wind takes to fade from one to the other, in seconds.
pub const FADE_S: f64 = 1.0;

/// The wind at one instant, ready for every plant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WindNow {
    /// Unit vector along x and z.
    pub direction: [f32; 2],
    pub strength: f32,
    pub gust: f32,
    pub flutter: f32,
    pub flutter_phase: u32,
    pub waves: [Wave; WAVES],
}

/// One sine of a gust at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wave {
    /// Phase at the field's corner.
    pub phase: u32,
    /// Phase added per anchor along x and z.
    pub per_anchor: [u32; 2],
    /// Turns per metre along x and z.
    pub per_metre: [f32; 2],
    pub share: f32,
}

/// A fraction of a turn as a 32-bit fraction; whole turns wrap away.
fn wrapped(turns: f64) -> u32 {
    // 2³² itself, which a fraction close to 1 may round to, wraps to 0 as it should.
    ((turns - turns.floor()) * 4_294_967_296.0) as u64 as u32
}

impl WindNow {
    /// The wind `time_s` after the start over anchors `anchor_m` wide; `fade` scales its strength.
    pub fn at(wind: &Wind, time_s: f64, anchor_m: f64, fade: f64) -> Self {
        let turn = f64::from(wind.direction_deg) / 360.0;
        let along = [
            libm::cos(turn * std::f64::consts::TAU),
            libm::sin(turn * std::f64::consts::TAU),
        ];
        let across = [-along[1], along[0]];
        let waves = SHAPES.map(|(length, slope, share)| {
            let per_metre = 1.0 / (f64::from(wind.gust_length_m) * length);
            let k = [0, 1].map(|a| (along[a] + slope * across[a]) * per_metre);
            Wave {
                phase: wrapped(-time_s * f64::from(wind.gust_speed_m_per_s) * per_metre),
                per_anchor: k.map(|k| wrapped(k * anchor_m)),
                per_metre: k.map(|k| k as f32),
                share: share as f32,
            }
        });
        let scaled = |x: f32| (f64::from(x) * fade) as f32;
        Self {
            direction: along.map(|a| a as f32),
            strength: scaled(wind.strength),
            gust: scaled(wind.gust),
            flutter: scaled(wind.flutter),
            flutter_phase: wrapped(time_s * FLUTTER_HZ),
            waves,
        }
    }

    /// Bend of a plant's tip along x and z.
    pub fn bend<R: Real>(&self, anchor: &Anchor, plant: &Plant) -> [R; 2] {
        let root = plant.root_in_anchor;
        self.bend_at(anchor, root, plant.flexibility, plant.flutter_turns)
    }

    /// Bend of the tip of whatever stands at a place of an anchor, along x and z.
    pub fn bend_at<R: Real>(
        &self,
        anchor: &Anchor,
        root_in_anchor: [f32; 3],
        flexibility: f32,
        flutter_turns: f32,
    ) -> [R; 2] {
        let root = root_in_anchor.map(R::of_f32);
        let mut gust = R::ZERO;
        for wave in &self.waves {
            let phase = wave
                .phase
                .wrapping_add(anchor.index[0].wrapping_mul(wave.per_anchor[0]))
                .wrapping_add(anchor.index[1].wrapping_mul(wave.per_anchor[1]));
            let turns = R::of_f32(unit(phase))
                + (root[0] * R::of_f32(wave.per_metre[0]) + root[2] * R::of_f32(wave.per_metre[1]));
            gust += R::of_f32(wave.share) * sin_turns(turns);
        }
        let along = R::of_f32(self.strength) + R::of_f32(self.gust) * gust;
        let trembling = R::of_f32(unit(self.flutter_phase)) + R::of_f32(flutter_turns);
        let across = R::of_f32(self.flutter) * sin_turns(trembling);
        let [dx, dz] = self.direction.map(R::of_f32);
        let flexibility = R::of_f32(flexibility);
        [
            (dx * along - dz * across) * flexibility,
            (dz * along + dx * across) * flexibility,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_wrap() {
        assert_eq!(wrapped(0.25), 1 << 30);
        assert_eq!(wrapped(-0.25), 3 << 30);
        assert_eq!(wrapped(86_400.5), 1 << 31);
        assert_eq!(wrapped(-1e-18), 0);
    }

    #[test]
    fn calm_bends_nothing() {
        let calm = Wind {
            strength: 0.0,
            gust: 0.0,
            flutter: 0.0,
            ..Wind::default()
        };
        let now = WindNow::at(&calm, 12.3, 2.0, 1.0);
        assert_eq!((now.strength, now.gust, now.flutter), (0.0, 0.0, 0.0));
    }
}
