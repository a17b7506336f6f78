//! The directions of the sky that every cell looks into.

use crate::base::Vec3;

/// Unit vectors over the upper half of the sphere, each for an equal part of it: Hammersley's points,
/// whose heights are the middles of equal steps and whose azimuths are van der Corput's sequence, turned
/// as a seed says. All cells have the same, so that what they see changes smoothly from cell to cell.
pub fn sky_directions(count: u32, seed: u32) -> Vec<Vec3<f64>> {
    // 2³² over the golden ratio: seeds that follow each other turn far.
    let turn = seed.wrapping_mul(0x9e37_79b9);
    let direction = |n: u32| {
        let up = (f64::from(n) + 0.5) / f64::from(count);
        let turns = f64::from(n.reverse_bits().wrapping_add(turn)) / 4_294_967_296.0;
        let (sin, cos) = (libm::sin(turns * TAU), libm::cos(turns * TAU));
        let level = (1.0 - up * up).sqrt();
        Vec3::new(level * cos, up, level * sin)
    };
    (0..count).map(direction).collect()
}

const TAU: f64 = std::f64::consts::TAU;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_unit_vectors_of_the_upper_half_and_their_heights_are_even() {
        for (count, seed) in [(16, 0), (100, 3), (4096, 9)] {
            let all = sky_directions(count, seed);
            assert_eq!(all.len(), count as usize);
            assert!(all.iter().all(|d| (d.length() - 1.0).abs() < 1e-12));
            assert!(all.iter().all(|d| d.y > 0.0));
            // The mean of the middles of equal steps of 0 to 1, to the rounding of so many sums.
            let mean = all.iter().map(|d| d.y).sum::<f64>() / f64::from(count);
            assert!((mean - 0.5).abs() < 1e-12, "{mean}");
        }
    }
}
