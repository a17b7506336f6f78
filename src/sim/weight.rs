//! Weight: the share of a contact's offset that a pose still shows, measured from the pose alone.
//!
//! The formula of the recovery is not used, so that a recovery that forgets too soon or stalls is told
//! from one that keeps the law t³. A blend w + s·d of the wind pose w with the offset
//! d = v − w of the held pose leaves every segment along w_j + s·d_j, whatever is done to its length
//! afterwards. With u_j the segment as it is,
//!
//! ```text
//! u_j × (w_j + s d_j) = 0   →   s = − Σ (u_j × w_j)·(u_j × d_j) / Σ |u_j × d_j|²
//! ```
//!
//! is the least squares over the segments. Where angles are blended instead, s is the angle of a
//! segment from the wind pose over that of w_j + d_j, again in least squares.

use crate::base::Vec3;
use crate::scene::method::Recovery;

use super::measure::Standing;

/// Below this share of a blade's squared length the pose tells nothing of the weight.
const LEAST_SQUARES: f64 = 1e-6;

/// The nodes of a plant beside those of its wind pose at the same instant.
#[derive(Clone, Copy, Debug)]
pub struct Bend<'a> {
    pub wind: &'a [Vec3<f64>],
    pub nodes: &'a [Vec3<f64>],
}

impl<'a> From<&'a Standing<f64>> for Bend<'a> {
    fn from(plant: &'a Standing<f64>) -> Self {
        Self {
            wind: &plant.wind,
            nodes: &plant.nodes,
        }
    }
}

/// The share of the offset of a held plant that it still has now; `None` if the plant was hardly
/// bent, or turned right over, so that its pose does not tell.
pub fn offset_weight(held: Bend<'_>, now: Bend<'_>, recovery: Recovery) -> Option<f64> {
    let segments = held.nodes.len().min(now.nodes.len()).checked_sub(1)?;
    let mut products = 0.0;
    let mut squares = 0.0;
    let mut lengths = 0.0;
    for j in 0..segments {
        let [held_wind, bent] = [held.wind, held.nodes].map(|nodes| segment(nodes, j));
        let [wind, along] = [now.wind, now.nodes].map(|nodes| segment(nodes, j));
        let square = wind.length_squared();
        lengths += square;
        if recovery == Recovery::Angles {
            let whole = wind + (bent - held_wind);
            let [from, to] = [angle_rad(wind, whole), angle_rad(wind, along)];
            products += square * from * to;
            squares += square * from * from;
        } else {
            let along = along.unit_or(Vec3::UP);
            let off = along.cross(bent - held_wind);
            products -= along.cross(wind).dot(off);
            squares += off.length_squared();
        }
    }
    (squares > LEAST_SQUARES * lengths).then(|| products / squares)
}

fn segment(nodes: &[Vec3<f64>], j: usize) -> Vec3<f64> {
    nodes[j + 1] - nodes[j]
}

fn angle_rad(a: Vec3<f64>, b: Vec3<f64>) -> f64 {
    libm::atan2(a.cross(b).length(), a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::vec3;
    use crate::field::{MAX_NODES, Nodes};
    use crate::sim::fault::Planted;
    use crate::sim::recover::{Fading, fade_literally, offset_left, recovering_pose};

    const SEGMENTS: usize = 8;
    const LENGTH_M: f64 = 0.05;
    const STEP_OVER_T: f64 = 1.0 / 240.0;

    /// A blade that leans by an angle more with every segment.
    fn blade(turn_rad: f64) -> Nodes<f64> {
        let mut nodes = [Vec3::ZERO; MAX_NODES];
        for j in 0..SEGMENTS {
            let (sin, cos) = (turn_rad * (j + 1) as f64).sin_cos();
            nodes[j + 1] = nodes[j] + vec3(sin, cos, 0.1) * LENGTH_M;
        }
        nodes
    }

    fn bend<'a>(wind: &'a Nodes<f64>, nodes: &'a Nodes<f64>) -> Bend<'a> {
        Bend {
            wind: &wind[..=SEGMENTS],
            nodes: &nodes[..=SEGMENTS],
        }
    }

    fn offsets(wind: &Nodes<f64>, nodes: &Nodes<f64>) -> Vec<Vec3<f64>> {
        (1..=SEGMENTS).map(|j| nodes[j] - wind[j]).collect()
    }

    fn fading(recovery: Recovery) -> Fading<f64> {
        Fading {
            step_over_t: STEP_OVER_T,
            recovery,
            planted: Planted::NONE,
        }
    }

    #[test]
    fn a_pose_tells_the_weight_it_was_made_with() {
        let (calm, held) = (blade(0.05), blade(0.25));
        let offsets = offsets(&calm, &held);
        for recovery in [Recovery::Lengths, Recovery::Positions, Recovery::Angles] {
            for age in 1..240 {
                let left: f64 = offset_left(age, STEP_OVER_T);
                let nodes = recovering_pose(&calm, &offsets, age, &fading(recovery), LENGTH_M);
                let found = offset_weight(bend(&calm, &held), bend(&calm, &nodes), recovery)
                    .expect("a bent blade");
                // Rounding of a segment's direction, 1e-16 over its turn of 0.2 rad and more.
                assert!(
                    (found - left).abs() < 1e-13,
                    "{recovery:?} {age}: {found} for {left}"
                );
            }
        }
    }

    #[test]
    fn wind_that_turned_since_changes_nothing() {
        let (then, now, held) = (blade(0.05), blade(-0.03), blade(0.25));
        let offsets = offsets(&then, &held);
        for recovery in [Recovery::Lengths, Recovery::Angles] {
            for age in [10, 100, 200] {
                let nodes = recovering_pose(&now, &offsets, age, &fading(recovery), LENGTH_M);
                let [held, seen] = [bend(&then, &held), bend(&now, &nodes)];
                let found = offset_weight(held, seen, recovery).expect("a bent blade");
                let left: f64 = offset_left(age, STEP_OVER_T);
                assert!(
                    (found - left).abs() < 1e-13,
                    "{recovery:?} {age}: {found} for {left}"
                );
            }
        }
    }

    #[test]
    fn the_printed_form_is_seen_to_forget_sooner() {
        let (calm, held) = (blade(0.05), blade(0.25));
        let mut left = offsets(&calm, &held);
        let half = (1..240).find(|&age| {
            fade_literally(&mut left, age, STEP_OVER_T);
            let nodes = recovering_pose(&calm, &left, age, &fading(Recovery::Literal), LENGTH_M);
            let [held, now] = [bend(&calm, &held), bend(&calm, &nodes)];
            offset_weight(held, now, Recovery::Literal).expect("a bent blade") <= 0.5
        });
        // √((2 ln2 / 3)·T·Δt) = 0.0877 s = 10.5 sub-steps of 1/120 s, where t³ takes 50.
        assert!(half.is_some_and(|age| (10..=12).contains(&age)), "{half:?}");
    }

    #[test]
    fn a_blade_that_was_not_bent_tells_nothing() {
        let calm = blade(0.05);
        for recovery in [Recovery::Lengths, Recovery::Angles] {
            assert_eq!(
                offset_weight(bend(&calm, &calm), bend(&calm, &calm), recovery),
                None
            );
        }
    }
}
