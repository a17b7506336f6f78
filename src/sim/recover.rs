//! Recover: where a plant is now, from its wind pose and the offset of its last contact.
//!
//! O09 section 5.5 blends v ← (1 − t³)w + t³v on the already blended v, which depends on the frame
//! rate and loses length. Here the offset d₀ = v − w of the last contact is kept and read:
//!
//! ```text
//! v = lengths( w(now) + t³ d₀ ),   t = max(0, 1 − ticks·Δt/T)
//! ```
//!
//! Nothing is written back, so the curve is the same at every rate; at t = 0 the wind pose
//! itself is returned, bit for bit. In the very tick of a contact (t = 1) the pose is the one the
//! contact left: within the strain limit, and outside the body, which a restored length might
//! enter again. WGSL twin: `shaders/recover.wgsl`, `shaders/shared/pose.wgsl`.

use crate::base::Real;
use crate::field::Nodes;

/// The share t³ of the offset that is left, `age` ticks after the last contact. `step_over_t` is
/// Δt/T.
pub fn offset_left<R: Real>(age: u32, step_over_t: R) -> R {
    let t = (R::ONE - R::of(f64::from(age)) * step_over_t).max(R::ZERO);
    t * t * t
}

/// Moves nodes onto the rest length of their segments, from root to tip, keeping directions
/// (follow the leader). A segment without a direction takes the wind pose's.
pub fn restore_lengths<R: Real>(nodes: &mut Nodes<R>, wind: &Nodes<R>, segments: usize, length: R) {
    for j in 0..segments {
        let rest = (wind[j + 1] - wind[j]).unit_or(crate::base::Vec3::UP);
        let direction = (nodes[j + 1] - nodes[j]).unit_or(rest);
        nodes[j + 1] = nodes[j] + direction * length;
    }
}

/// The nodes of a plant touched `age` ticks ago with the given offsets (one per segment).
pub fn recovering_pose<R: Real>(
    wind: &Nodes<R>,
    offsets: &[crate::base::Vec3<R>],
    age: u32,
    step_over_t: R,
    length: R,
) -> Nodes<R> {
    let left = offset_left(age, step_over_t);
    let mut nodes = *wind;
    if left <= R::ZERO {
        return nodes;
    }
    for (node, &offset) in nodes[1..].iter_mut().zip(offsets) {
        *node += offset * left;
    }
    if age > 0 {
        restore_lengths(&mut nodes, wind, offsets.len(), length);
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Vec3, vec3};
    use crate::field::MAX_NODES;

    fn upright() -> Nodes<f64> {
        let mut nodes = [Vec3::ZERO; MAX_NODES];
        for (j, node) in nodes.iter_mut().enumerate().take(9) {
            *node = vec3(0.0, 0.05 * j as f64, 0.0);
        }
        nodes
    }

    #[test]
    fn the_weight_passes_its_marks_at_every_rate() {
        // t³ = ½, 0.1, 0.01 at T(1 − ∛share): 0.413, 1.072, 1.569 s for T = 2 s.
        for hz in [15.0, 30.0, 60.0, 120.0, 240.0, 1000.0] {
            for share in [0.5, 0.1, 0.01] {
                let want = 2.0 * (1.0 - libm::cbrt(share));
                let age = (0..)
                    .find(|&age| offset_left(age, 1.0 / (hz * 2.0)) <= share)
                    .map(|age| f64::from(age) / hz);
                let got = age.unwrap_or(f64::INFINITY);
                assert!(
                    (got - want).abs() <= 1.0 / hz + 1e-9,
                    "{hz} Hz: {got} for {want}"
                );
            }
        }
    }

    #[test]
    fn lengths_hold_from_any_bend() {
        let wind = upright();
        for degrees in [90.0, 150.0, 179.9, 180.0_f64] {
            let a = degrees.to_radians();
            let bent: Vec<_> = (1..=8)
                .map(|j| vec3(a.sin(), a.cos(), 0.0) * (0.05 * f64::from(j)))
                .collect();
            let offsets: Vec<_> = bent.iter().zip(&wind[1..]).map(|(&b, &w)| b - w).collect();
            for age in 1..=240 {
                let nodes = recovering_pose(&wind, &offsets, age, 1.0 / 240.0, 0.05);
                for j in 0..8 {
                    let length = (nodes[j + 1] - nodes[j]).length();
                    assert!(
                        (length - 0.05).abs() < 1e-12,
                        "{degrees}° age {age}: {length}"
                    );
                }
            }
        }
    }

    #[test]
    fn at_the_end_it_is_the_wind_pose_itself() {
        let wind = upright();
        let offsets = vec![vec3(0.1, -0.2, 0.3); 8];
        assert_eq!(
            recovering_pose(&wind, &offsets, 240, 1.0 / 240.0, 0.05),
            wind
        );
    }
}
