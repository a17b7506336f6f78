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
//! enter again.
//!
//! [`Recovery`] selects what else can be done, for comparison and in the cpu engine alone: positions
//! without lengths, angles, and the printed form, which rewrites the offset in every sub-step.
//! WGSL twin: `shaders/recover.wgsl`, `shaders/shared/pose.wgsl`.

use crate::base::{Real, Vec3};
use crate::field::Nodes;
use crate::scene::method::Recovery;

use super::fault::Planted;
use super::meadow::Meadow;

/// How offsets fade.
#[derive(Clone, Copy, Debug)]
pub struct Fading<R> {
    /// Δt/T.
    pub step_over_t: R,
    pub recovery: Recovery,
    pub planted: Planted,
}

impl<R: Real> Fading<R> {
    pub fn new(meadow: &Meadow) -> Self {
        Self {
            step_over_t: R::of(meadow.step_over_t()),
            recovery: meadow.scene.solver.method.recovery,
            planted: meadow.planted,
        }
    }
}

/// The share t³ of the offset that is left, `age` ticks after the last contact. `step_over_t` is
/// Δt/T.
pub fn offset_left<R: Real>(age: u32, step_over_t: R) -> R {
    let t = (R::ONE - R::of(f64::from(age)) * step_over_t).max(R::ZERO);
    t * t * t
}

/// Whether nothing is left of an offset, `age` ticks after the last contact. Half a sub-step
/// forgives rounding.
pub fn is_back(age: u32, step_over_t: f32) -> bool {
    1.0 - age as f32 * step_over_t < 0.5 * step_over_t
}

/// Gives segments their rest length, from root to tip, keeping each one's own direction. Pulling
/// every node after the moved one below it would fold a blade that the blend has shortened.
///
/// A segment that was turned right over is blended along its own line and would flip from down to up
/// between two sub-steps: it takes a fixed side instead.
pub fn restore_lengths<R: Real>(nodes: &mut Nodes<R>, wind: &Nodes<R>, segments: usize, length: R) {
    let mut below = nodes[0];
    for j in 0..segments {
        let rest = wind[j + 1] - wind[j];
        let mut segment = nodes[j + 1] - below;
        below = nodes[j + 1];
        if is_turned_over(segment, rest) {
            segment += rest.unit_or(Vec3::UP).across() * (length * R::of(ASIDE));
        }
        let direction = segment.unit_or(rest.unit_or(Vec3::UP));
        nodes[j + 1] = nodes[j] + direction * length;
    }
}

/// Sine of the angle within which a segment counts as turned right over, and the part of its length
/// by which it then keeps aside.
pub const ASIDE: f64 = 1e-3;

/// True of a blend of opposite directions: short, and along the line of both.
fn is_turned_over<R: Real>(segment: Vec3<R>, rest: Vec3<R>) -> bool {
    let square = rest.length_squared();
    let off_line = segment.cross(rest).length_squared();
    segment.length_squared() < R::of(0.25) * square
        && off_line < R::of(ASIDE * ASIDE) * square * square
}

/// The nodes of a plant touched `age` ticks ago with the given offsets (one per segment).
pub fn recovering_pose<R: Real>(
    wind: &Nodes<R>,
    offsets: &[Vec3<R>],
    age: u32,
    fading: &Fading<R>,
    length: R,
) -> Nodes<R> {
    let left = offset_left(age, fading.step_over_t);
    let mut nodes = *wind;
    if left <= R::ZERO {
        return nodes;
    }
    let share = match fading.recovery {
        Recovery::Lengths | Recovery::Positions => left,
        Recovery::Angles | Recovery::Literal => R::ONE,
    };
    for (node, &offset) in nodes[1..].iter_mut().zip(offsets) {
        *node += offset * share;
    }
    if age > 0 {
        match fading.recovery {
            Recovery::Lengths => restore_lengths(&mut nodes, wind, offsets.len(), length),
            Recovery::Angles => blend_angles(&mut nodes, wind, offsets.len(), length, left),
            Recovery::Positions | Recovery::Literal => {}
        }
    }
    nodes
}

/// Turns every segment from the wind pose's direction to its own by the share `left` of the angle
/// between them, from root to tip.
fn blend_angles<R: Real>(
    nodes: &mut Nodes<R>,
    wind: &Nodes<R>,
    segments: usize,
    length: R,
    left: R,
) {
    let contact = *nodes;
    for j in 0..segments {
        let rest = (wind[j + 1] - wind[j]).unit_or(Vec3::UP);
        let bent = (contact[j + 1] - contact[j]).unit_or(rest);
        let turned = turned(rest, bent, left);
        nodes[j + 1] = nodes[j] + turned * length;
    }
}

/// From one unit vector towards another by a share of the angle between them.
fn turned<R: Real>(from: Vec3<R>, to: Vec3<R>, share: R) -> Vec3<R> {
    let cos = from.dot(to).to_f64().clamp(-1.0, 1.0);
    let off = to - from * R::of(cos);
    // Opposite directions have no plane of their own: the one through a fixed axis.
    let sideways = from.across();
    let angle = libm::atan2(off.length().to_f64(), cos) * share.to_f64();
    let aside = off.unit_or(sideways);
    from * R::of(libm::cos(angle)) + aside * R::of(libm::sin(angle))
}

/// The printed form (O09 eq. 8): the offset of a plant touched `age` ticks ago is scaled by t³
/// upon what earlier sub-steps left of it. Its half life √((2 ln2 / 3)·T·Δt) depends on the rate.
pub fn fade_literally<R: Real>(offsets: &mut [Vec3<R>], age: u32, step_over_t: R) {
    let left = offset_left(age, step_over_t);
    for offset in offsets {
        *offset = *offset * left;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::vec3;
    use crate::field::MAX_NODES;

    const LENGTHS: Fading<f64> = Fading {
        step_over_t: 1.0 / 240.0,
        recovery: Recovery::Lengths,
        planted: Planted::NONE,
    };

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
            for (age, recovery) in (1..=240).flat_map(|age| {
                [Recovery::Lengths, Recovery::Angles].map(|recovery| (age, recovery))
            }) {
                let fading = Fading {
                    recovery,
                    ..LENGTHS
                };
                let nodes = recovering_pose(&wind, &offsets, age, &fading, 0.05);
                for j in 0..8 {
                    let length = (nodes[j + 1] - nodes[j]).length();
                    assert!(
                        (length - 0.05).abs() < 1e-12,
                        "{recovery:?} {degrees}° age {age}: {length}"
                    );
                }
            }
        }
    }

    #[test]
    fn angles_fade_by_their_share() {
        let wind = upright();
        let bent: Vec<_> = (1..=8)
            .map(|j| vec3(0.05 * f64::from(j), 0.0, 0.0))
            .collect();
        let offsets: Vec<_> = bent.iter().zip(&wind[1..]).map(|(&b, &w)| b - w).collect();
        let fading = Fading {
            recovery: Recovery::Angles,
            ..LENGTHS
        };
        let nodes = recovering_pose(&wind, &offsets, 80, &fading, 0.05);
        let tip = nodes[8];
        let want = 90.0 * (2.0_f64 / 3.0).powi(3);
        assert!((tip.x.atan2(tip.y).to_degrees() - want).abs() < 1e-9);
    }

    #[test]
    fn the_printed_form_forgets_sooner_at_a_higher_rate() {
        let half_life = |hz: f64| {
            let mut offset = [vec3(1.0, 0.0, 0.0)];
            let mut age = 0;
            while offset[0].x > 0.5 {
                age += 1;
                fade_literally(&mut offset, age, 1.0 / (2.0 * hz));
            }
            f64::from(age) / hz
        };
        // √((2 ln2 / 3)·T·Δt) for T = 2 s, to a frame.
        for (hz, want) in [(30.0, 0.157), (60.0, 0.115), (240.0, 0.060)] {
            assert!(
                (half_life(hz) - want).abs() <= 1.5 / hz,
                "{hz} Hz: {}",
                half_life(hz)
            );
        }
    }

    #[test]
    fn a_straight_blade_rises_straight_and_to_one_side() {
        let wind = upright();
        for degrees in [90.0, 150.0, 179.9, 180.0_f64] {
            let a = degrees.to_radians();
            let offsets: Vec<_> = (1..=8)
                .map(|j| vec3(a.sin(), a.cos(), 0.0) * (0.05 * f64::from(j)) - wind[j as usize])
                .collect();
            for age in 1..=240 {
                let nodes = recovering_pose(&wind, &offsets, age, &LENGTHS, 0.05);
                // A straight blade is as long from root to tip as along its segments.
                let length = (nodes[8] - nodes[0]).length();
                assert!(
                    (length - 0.4).abs() < 1e-9,
                    "{degrees}° age {age}: {length}"
                );
                assert!(nodes[8].x > -1e-9, "{degrees}° age {age}: {:?}", nodes[8]);
            }
        }
    }

    #[test]
    fn at_the_end_it_is_the_wind_pose_itself() {
        let wind = upright();
        let offsets = vec![vec3(0.1, -0.2, 0.3); 8];
        assert_eq!(recovering_pose(&wind, &offsets, 240, &LENGTHS, 0.05), wind);
    }
}
