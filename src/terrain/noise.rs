//! Value noise: random values at the points of a square lattice, smoothly joined.
//!
//! Only integer hashes and +, −, × enter, so the ground is the same on every platform.

use crate::base::philox::{philox2x32, unit};

/// Rounds of the hash. A lattice value is seen by eye, not tested for chance: few suffice.
const ROUNDS: u32 = 4;
/// Lattice points repeat after 2³² cells; places farther than that from the origin are refused
/// long before.
const FRACTION_LIMIT: f64 = 2_147_483_648.0;

/// Noise in −1…1 at a place in lattice cells, twice continuously differentiable.
pub(super) fn value_noise(x: f64, z: f64, key: u32) -> f64 {
    let (i, u) = cell(x);
    let (j, v) = cell(z);
    let at = |di: u32, dj: u32| {
        let counter = [i.wrapping_add(di), j.wrapping_add(dj)];
        f64::from(unit(philox2x32(counter, key, ROUNDS)[0]))
    };
    let (u, v) = (ease(u), ease(v));
    let low = at(0, 0) + u * (at(1, 0) - at(0, 0));
    let high = at(0, 1) + u * (at(1, 1) - at(0, 1));
    2.0 * (low + v * (high - low)) - 1.0
}

/// Octaves of noise, each half as high and half as long; the first is within ±1.
pub(super) fn octaves(x: f64, z: f64, count: u32, key: u32) -> f64 {
    let mut sum = 0.0;
    let (mut height, mut scale) = (1.0, 1.0);
    for octave in 0..count {
        // A key of its own, or the lattice points of all octaves at the origin would agree.
        sum += height * value_noise(x * scale, z * scale, key.wrapping_add(octave));
        height *= 0.5;
        scale *= 2.0;
    }
    sum
}

/// The lattice cell of a coordinate, modulo 2³², and the fraction in it.
fn cell(x: f64) -> (u32, f64) {
    let x = x.clamp(-FRACTION_LIMIT, FRACTION_LIMIT - 1.0);
    let floor = x.floor();
    (floor as i64 as u32, x - floor)
}

/// 6t⁵ − 15t⁴ + 10t³ (Perlin 2002): its first two derivatives vanish at 0 and 1.
fn ease(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_stays_in_range_and_has_no_steps() {
        let e = 1e-4;
        let (mut low, mut high) = (1.0_f64, -1.0_f64);
        for k in 0..20_000 {
            let (x, z) = (-30.0 + 0.003 * f64::from(k), 0.0017 * f64::from(k) - 9.0);
            let here = value_noise(x, z, 5);
            low = low.min(here);
            high = high.max(here);
            // The easing's slope is at most 15/8 and a lattice step at most 2.
            let step = (value_noise(x + e, z, 5) - here).abs();
            assert!(step <= 2.0 * 1.875 * e + 1e-12, "{x} {z}: {step}");
        }
        assert!(
            (-1.0..-0.8).contains(&low) && (0.8..1.0).contains(&high),
            "{low} {high}"
        );
    }

    #[test]
    fn keys_and_octaves_differ() {
        assert_ne!(value_noise(0.5, 0.5, 1), value_noise(0.5, 0.5, 2));
        assert_eq!(octaves(1.3, 2.4, 1, 7), value_noise(1.3, 2.4, 7));
        let second = octaves(1.3, 2.4, 2, 7) - octaves(1.3, 2.4, 1, 7);
        assert!((second - 0.5 * value_noise(2.6, 4.8, 8)).abs() < 1e-15);
    }
}
