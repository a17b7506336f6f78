use super::*;

const LEANS_DEG: [f64; 4] = [0.0, 1.0, 5.0, 90.0];
const ROOTS: [Root; 2] = [Root::Paper, Root::Double];

/// The same equations from the other end. With ψ = π − θ the opening of a hinge is the weighted
/// sum of sin ψ above it, so that the tip's ψ gives every angle down to the root; it is bisected
/// until the root leans as asked. No derivative, no linear system, no common code. None where a
/// long soft blade's tip hangs straighter than the smallest float.
fn by_shooting(segments: u32, k_prime: f64, root: Root, lean_rad: f64) -> Option<Vec<f64>> {
    let n = segments as usize;
    // Angles from the tip down, and ψ_0; None once the chain turns past upright.
    let shoot = |psi_tip: f64| -> Option<(Vec<f64>, f64)> {
        let (mut psi, mut torque, mut all) = (psi_tip, 0.0, Vec::new());
        for j in (1..=n).rev() {
            if psi >= PI {
                return None;
            }
            all.push(psi);
            torque += ((n - j) as f64 + 0.5) * libm::sin(psi);
            let spring = match (j, root) {
                (1, Root::Double) => 2.0 * k_prime,
                _ => k_prime,
            };
            psi += torque / spring;
        }
        Some((all, psi))
    };
    // Bisects the logarithm: a soft blade's tip hangs straight within 1e-60 and less.
    let (mut low, mut high) = (-700.0, PI.ln());
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        match shoot(libm::exp(middle)) {
            Some((_, psi_root)) if psi_root < PI - lean_rad => low = middle,
            _ => high = middle,
        }
    }
    let (all, psi_root) = shoot(libm::exp(low))?;
    if (PI - lean_rad - psi_root).abs() > 1e-6 {
        return None;
    }
    Some(all.iter().rev().map(|psi| PI - psi).collect())
}

fn largest_node_gap<R: Real>(shape: &BladeShape<R>, want: &[f64]) -> f64 {
    let want: Vec<[f64; 2]> = nodes(want);
    let gap = |(a, b): (&[R; 2], &[f64; 2])| (a[0].to_f64() - b[0]).hypot(a[1].to_f64() - b[1]);
    shape.nodes.iter().zip(&want).map(gap).fold(0.0, f64::max)
}

/// A decade at a time over the range that is promised.
fn stiffnesses() -> impl Iterator<Item = f64> {
    (-12..=12).map(|i| 10.0_f64.powf(f64::from(i) * 0.5))
}

#[test]
fn printed_figures() {
    // N = 8 with the paper's root: tip in units of the length, ten digits.
    for (k, tip) in [
        (16.0, [0.468_668_189_6, -0.718_826_696_2]),
        (32.0, [0.757_528_809_4, -0.395_421_155_6]),
        (64.0, [0.809_487_066_9, 0.491_039_849_4]),
    ] {
        let shape = solve::<f64>(8, k, Root::Paper, 0.0).expect("a plain blade");
        let got = shape.nodes[8];
        let gap = (got[0] - tip[0]).hypot(got[1] - tip[1]);
        assert!(gap < 1e-10, "k′ = {k}: {got:?}");
    }
    check_tips_of_the_reference();
    // Tip angle, energy at k′ = 0.5 and 2, and every opening at 2.
    let soft = solve(8, 0.5, Root::Paper, 0.0).expect("a plain blade");
    assert!((soft.angles_rad[7] - 3.141592488907).abs() < 1e-11);
    assert!((soft.energy - -29.67868819919).abs() < 1e-10);
    let shape = solve(8, 2.0, Root::Paper, 0.0).expect("a plain blade");
    let openings = [
        2.553063780849,
        0.4712962739964,
        0.09116245329965,
        0.01947767409381,
        0.004644720996683,
        0.001236160032113,
        0.0003466722046322,
        7.298362265188e-5,
    ];
    let mut angle = 0.0;
    for (j, opening) in openings.iter().enumerate() {
        angle += opening;
        assert!((shape.angles_rad[j] - angle).abs() < 1e-11, "segment {j}");
    }
    assert!((shape.energy - -23.94262958209).abs() < 1e-10);
}

/// k′, x and y of the tip of the reference shapes: N = 8, the paper's root, no lean.
pub(in crate::field) const REFERENCE_TIPS: [[f64; 3]; 13] = [
    [0.5, 0.02487172884937, -0.9978228888192],
    [1.0, 0.04761448518885, -0.9927338542602],
    [2.0, 0.0885097577964, -0.9780663233046],
    [4.0, 0.1584805427318, -0.9414940303698],
    [8.0, 0.2747126504943, -0.8645877428407],
    [16.0, 0.4686681896262, -0.7188266962111],
    [32.0, 0.7575288093649, -0.3954211555763],
    [64.0, 0.8094870669112, 0.4910398493686],
    [70.0, 0.6795369233538, 0.6893058574308],
    [75.0, 0.4797669744034, 0.8612407932042],
    [78.0, 0.24060605055, 0.9672045575392],
    [78.5, 0.1631956532385, 0.9850642562814],
    [78.9, 0.03304603951878, 0.9993924840766],
];

fn check_tips_of_the_reference() {
    for [k, x, y] in REFERENCE_TIPS {
        let shape = solve::<f64>(8, k, Root::Paper, 0.0).expect("a plain blade");
        let [got_x, got_y] = shape.nodes[8];
        // Thirteen digits are given.
        let gap = (got_x - x).hypot(got_y - y);
        assert!(gap < 2e-12, "k′ = {k}: {:?}", shape.nodes[8]);
    }
}

#[test]
fn critical_stiffness_as_tabulated() {
    for (n, root, want) in [
        (1, Root::Paper, 0.5),
        (1, Root::Double, 0.25),
        (3, Root::Paper, 5.697519191807005),
        (3, Root::Double, 3.6583123951777),
        (8, Root::Paper, 78.91693787279554),
        (8, Root::Double, 65.85949519903748),
        (64, Root::Paper, 34242.373138868),
        (64, Root::Double, 33452.26180664366),
    ] {
        let got = critical_stiffness(n, root).expect("a valid count");
        // The table has 13 digits.
        assert!((got / want - 1.0).abs() < 1e-12, "{n} {root:?}: {got}");
    }
}

#[test]
fn every_stiffness_count_and_lean() {
    for segments in 1..=MAX_SEGMENTS {
        for root in ROOTS {
            let critical = critical_stiffness(segments, root).expect("a valid count");
            for near in [0.9, 0.98, 0.998, 1.002, 1.02, 1.1] {
                check_all_leans(segments, critical * near, root, critical);
            }
            for k in stiffnesses() {
                check_all_leans(segments, k, root, critical);
            }
        }
    }
}

fn check_all_leans(segments: u32, k_prime: f64, root: Root, critical: f64) {
    for lean_deg in LEANS_DEG {
        let k32 = k_prime as f32;
        let lean32 = (lean_deg as f32).to_radians();
        let case = Case {
            segments,
            // The f64 run takes the rounded numbers, so that both have the same right answer.
            k_prime: f64::from(k32),
            root,
            lean_rad: f64::from(lean32),
            critical,
        };
        let wide = solve(segments, case.k_prime, root, case.lean_rad).expect("in range");
        let narrow = solve(segments, k32, root, lean32).expect("in range");
        let away = (case.k_prime / critical - 1.0).abs();
        check_laws(&wide, case.lean_rad, 1e-13, &case);
        check_laws(&narrow, case.lean_rad, 1e-6, &case);
        if lean_deg >= 1.0 || away > 1e-2 {
            assert!(wide.iterations <= 20, "{case:?}: {} steps", wide.iterations);
        }
        if lean_deg >= 1.0 || away > 1e-3 {
            check_nodes(&wide, &narrow, &case);
        }
    }
}

#[derive(Debug)]
struct Case {
    segments: u32,
    k_prime: f64,
    root: Root,
    lean_rad: f64,
    critical: f64,
}

fn check_laws<R: Real>(shape: &BladeShape<R>, lean: f64, residual: f64, case: &Case) {
    assert!(
        shape.residual.to_f64() <= residual,
        "{case:?}: {:?}",
        shape.residual
    );
    // The lean is rounded to the result's float as well.
    let mut below = lean - 1e-7;
    for angle in &shape.angles_rad {
        let angle = angle.to_f64();
        assert!(
            (0.0..=PI).contains(&angle) && angle >= below,
            "{case:?}: {:?}",
            shape.angles_rad
        );
        below = angle;
    }
    let n = shape.angles_rad.len();
    assert_eq!(shape.nodes.len(), n + 1, "{case:?}");
}

fn check_nodes(wide: &BladeShape<f64>, narrow: &BladeShape<f32>, case: &Case) {
    let want = if case.lean_rad == 0.0 && case.k_prime > case.critical {
        vec![0.0; case.segments as usize]
    } else if let Some(angles) = by_shooting(case.segments, case.k_prime, case.root, case.lean_rad)
    {
        angles
    } else {
        let soft_and_long = case.segments >= 32 && case.k_prime < 1e-2;
        assert!(soft_and_long, "{case:?}: no independent answer");
        return;
    };
    let gap = largest_node_gap(wide, &want);
    assert!(gap <= 1e-10, "{case:?}: f64 nodes off by {gap:e}");
    let gap = largest_node_gap(narrow, &want);
    assert!(gap <= 1e-6, "{case:?}: f32 nodes off by {gap:e}");
}

#[test]
fn the_descent_on_the_energy_ends_at_the_same_shape() {
    let mut floor: f64 = 0.0;
    for segments in [1, 2, 3, 5, 8] {
        for root in ROOTS {
            let critical = critical_stiffness(segments, root).expect("a valid count");
            for share in [0.3, 0.9, 1.3] {
                for lean_deg in [0.0_f64, 5.0, 90.0] {
                    let (k, lean) = (critical * share, lean_deg.to_radians());
                    let case = format!("N = {segments}, {share} k′c, {root:?}, {lean_deg}°");
                    let found = descent::least_energy(segments, k, root, lean, 2);
                    let found = found.expect("a plain blade");
                    let shape = solve::<f64>(segments, k, root, lean).expect("a plain blade");
                    // Sweeps shrink what is left by 1 − λmin/(2k′) or more slowly, λmin/k′ above
                    // 2e-3 in these cases, so a last move of an ulp of π leaves below 1e-12.
                    assert!(found.spread_rad < 1e-11, "{case}: {found:?}");
                    assert!((found.energy - shape.energy).abs() <= 1e-12 * (k * PI).max(1.0));
                    let apart = descent::noise_floor(segments, k, root, lean, 2);
                    let apart = apart.expect("a plain blade");
                    assert!(apart < 1e-11, "{case}: {apart:e}");
                    floor = floor.max(apart);
                }
            }
        }
    }
    println!("Newton and descent are {floor:.1e} of a blade apart at most");
}

#[test]
fn at_the_critical_stiffness_the_search_ends() {
    for segments in [1, 8, 64] {
        for root in ROOTS {
            let k = critical_stiffness(segments, root).expect("a valid count");
            for nudge in [1.0 - 1e-6, 1.0 - 1e-12, 1.0, 1.0 + 1e-12, 1.0 + 1e-6] {
                let shape = solve(segments, k * nudge, root, 0.0).expect("it settles");
                let case = Case {
                    segments,
                    k_prime: k * nudge,
                    root,
                    lean_rad: 0.0,
                    critical: k,
                };
                check_laws(&shape, 0.0, 1e-13, &case);
            }
        }
    }
}

#[test]
fn the_tip_hangs_below_the_root_when_soft() {
    // Where the tip is level with the root, N = 8.
    for (root, level) in [(Root::Paper, 47.67), (Root::Double, 37.88)] {
        let tip_y = |k: f64| solve(8, k, root, 0.0).expect("a plain blade").nodes[8][1];
        assert!(
            tip_y(level - 0.01) < 0.0 && tip_y(level + 0.01) > 0.0,
            "{root:?}"
        );
    }
}

#[test]
fn the_same_material_keeps_its_shape_at_another_count() {
    // With root stiffness 2k the error falls with N²: to 0.017 L at 8 segments, a quarter at 16.
    let tip = |n: u32| {
        let k = stiffness_for_segments(50.0, n);
        solve(n, k, Root::Double, 0.1).expect("a plain blade").nodes[n as usize]
    };
    let gap = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let (eight, sixteen, beam) = (gap(tip(8), tip(64)), gap(tip(16), tip(64)), tip(64));
    assert!(
        eight < 0.017 && sixteen < 0.3 * eight,
        "{eight} {sixteen} {beam:?}"
    );
}

#[test]
fn nonsense_is_refused() {
    let plain = |n, k, lean: f64| solve::<f64>(n, k, Root::Double, lean);
    assert_eq!(plain(0, 1.0, 0.0), Err(ShapeError::Segments(0)));
    assert_eq!(plain(65, 1.0, 0.0), Err(ShapeError::Segments(65)));
    for k in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e10] {
        assert!(
            matches!(plain(8, k, 0.0), Err(ShapeError::Stiffness(_))),
            "{k}"
        );
    }
    for lean in [-0.1, 4.0, f64::NAN] {
        assert!(
            matches!(plain(8, 1.0, lean), Err(ShapeError::Lean(_))),
            "{lean}"
        );
    }
}
