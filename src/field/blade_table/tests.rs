use super::super::blade_shape::tests::REFERENCE_TIPS;
use super::*;
use proptest::prelude::*;

/// Entries as a scene has them that does not say.
const USUAL: Option<[u32; 2]> = None;

fn grass(stiffness: [f32; 2], lean_deg: [f32; 2]) -> Grass {
    let kind = Species {
        stiffness,
        lean_deg,
        ..Species::default()
    };
    Grass {
        species: vec![kind],
        ..Grass::default()
    }
}

#[test]
fn default_grass_within_a_thousandth_of_a_blade() {
    for root in [Root::Double, Root::Paper] {
        let table = BladeTable::new(&Grass::default(), 8, root, USUAL).expect("the default grass");
        let error = table.max_error().expect("the default grass");
        assert!(error <= 1e-3, "{root:?}: {error:e}");
    }
    // The head of this file states this figure.
    let table =
        BladeTable::new(&Grass::default(), 8, Root::Double, USUAL).expect("the default grass");
    let error = table.max_error().expect("the default grass");
    assert!((1.8e-4..2.0e-4).contains(&error), "{error:e}");
}

#[test]
fn the_error_falls_with_the_square_of_the_entries() {
    // Bilinear mixing is of second order; halved steps must divide the error by about 4.
    let error = |entries| {
        let grass = grass([100.0, 160.0], [8.0, 16.0]);
        let table = BladeTable::new(&grass, 8, Root::Double, Some(entries)).expect("valid");
        table.max_error().expect("valid")
    };
    let ratio = error([9, 5]) / error([17, 9]);
    assert!((3.0..5.0).contains(&ratio), "{ratio}");
}

#[test]
fn entries_are_the_solvers_answers() {
    let table = BladeTable::new(&Grass::default(), 5, Root::Paper, Some([4, 3]));
    let table = table.expect("the default grass");
    assert_eq!(table.directions.len(), 4 * 3 * 5);
    let k = stiffness_for_segments(160.0, 5);
    let shape = blade_shape::solve(5, k, Root::Paper, 16.0_f64.to_radians()).expect("valid");
    let place = table.place(1.0_f32, 1.0);
    for (j, angle) in shape.angles_rad.iter().enumerate() {
        let [x, y] = table.direction(place, j);
        // Half an ulp of a number below 1, and log₂ and 2^x in between.
        assert!((f64::from(x) - angle.sin()).abs() < 1e-7, "{j}");
        assert!((f64::from(y) - angle.cos()).abs() < 1e-7, "{j}");
    }
}

#[test]
fn kinds_share_the_table() {
    let mut grass = grass([20.0, 40.0], [0.0, 10.0]);
    grass.species.push(Species {
        stiffness: [80.0, 320.0],
        lean_deg: [5.0, 5.0],
        ..Species::default()
    });
    let table = BladeTable::new(&grass, 2, Root::Double, Some([16, 4])).expect("valid");
    assert_eq!(table.species[0].stiffness, [0.0, 0.25]);
    assert_eq!(table.species[1].stiffness, [0.5, 1.0]);
    assert_eq!(table.species[1].lean, [0.5, 0.5]);
}

#[test]
fn one_stiffness_one_lean() {
    let table =
        BladeTable::new(&grass([100.0; 2], [5.0; 2]), 8, Root::Double, USUAL).expect("valid");
    assert_eq!(table.species[0].stiffness, [0.0, 0.0]);
    assert!(table.max_error().expect("valid") < 1e-6);
}

#[test]
fn no_species_still_make_a_table() {
    let bare = Grass {
        species: Vec::new(),
        ..Grass::default()
    };
    let table = BladeTable::new(&bare, 8, Root::Double, Some([2, 2])).expect("valid");
    assert_eq!(table.directions.len(), 2 * 2 * 8);
}

#[test]
fn what_is_no_range_is_named() {
    for (stiffness, lean) in [
        ([2.0, 1.0], [0.0, 1.0]),
        ([0.0, 1.0], [0.0, 1.0]),
        ([1.0, f32::NAN], [0.0, 1.0]),
        ([1.0, 2.0], [-1.0, 1.0]),
        ([1.0, 2.0], [0.0, 91.0]),
    ] {
        let error = BladeTable::new(&grass(stiffness, lean), 8, Root::Double, USUAL);
        let text = error.expect_err("no range").to_string();
        assert!(
            text.contains("meadow grass") && text.contains("is no range"),
            "{text}"
        );
    }
}

/// Kinds: name, stiffness, lean in degrees, and the error of the default size.
const KINDS: [(&str, [f32; 2], [f32; 2], f64); 7] = [
    ("default kind", [60.0, 160.0], [2.0, 16.0], 2e-4),
    ("lean 5°", [8.0, 160.0], [5.0, 5.0], 4.1e-4),
    ("lean 0.5 … 16°", [8.0, 160.0], [0.5, 16.0], 5e-4),
    ("lean 0 … 16°", [8.0, 160.0], [0.0, 16.0], 1.3e-3),
    ("lean 0 … 90°", [8.0, 160.0], [0.0, 90.0], 2.3e-3),
    ("no lean", [8.0, 160.0], [0.0, 0.0], 5e-4),
    ("no lean, any stiffness", [0.5, 2000.0], [0.0, 0.0], 8e-4),
];

fn error(kind: &Grass, segments: u32, root: Root, entries: Option<[u32; 2]>) -> f64 {
    let table = BladeTable::new(kind, segments, root, entries).expect("valid");
    table.max_error().expect("valid")
}

#[test]
fn errors_by_size() {
    // The head of the file has these figures.
    for (name, stiffness, lean, limit) in KINDS {
        let kind = grass(stiffness, lean);
        let leans = |entries: u32| if lean[0] == lean[1] { 2 } else { entries };
        let [half, even] = [[64, leans(32)], [128, leans(64)]]
            .map(|entries| error(&kind, 8, Root::Double, Some(entries)));
        println!("{name}: 64 × 32 entries {half:.1e}, 128 × 64 entries {even:.1e}");
        assert!(even <= limit, "{name}: {even:e}");
        // Of second order, but for the one cell between no lean and the critical stiffness.
        assert!(half / even > 2.0, "{name}: {half:e} to {even:e}");
    }
}

/// A scene that does not say how large its table is gets one large enough.
#[test]
fn the_usual_size_keeps_every_kind_within_a_thousandth() {
    for root in [Root::Double, Root::Paper] {
        for (name, stiffness, lean, _) in KINDS {
            let kind = grass(stiffness, lean);
            let table = BladeTable::new(&kind, 8, root, USUAL).expect("valid");
            let error = table.max_error().expect("valid");
            assert!(error <= 1e-3, "{name}, {root:?}: {error:e}");
            let leans = table.lean_rad.entries;
            assert_eq!(leans == 2, lean[0] == lean[1], "{name}: {leans} leans");
        }
    }
}

#[test]
fn any_count_and_root_within_a_thousandth() {
    for segments in [1, 2, 3, 5, 8, 13, 16, 32, 64] {
        for root in [Root::Double, Root::Paper] {
            // 64 segments are the dearest to solve.
            for (lean, entries) in [([0.0, 0.0], [128, 2]), ([0.5, 16.0], [96, 48])] {
                let kind = grass([20.0, 160.0], lean);
                let error = error(&kind, segments, root, Some(entries));
                assert!(
                    error <= 1e-3,
                    "N = {segments}, {root:?}, lean {lean:?}: {error:e}"
                );
            }
        }
    }
}

#[test]
fn the_reference_shapes_within_a_thousandth() {
    let kind = grass([0.5, 160.0], [0.0, 0.0]);
    let table = BladeTable::new(&kind, 8, Root::Paper, USUAL).expect("valid");
    let mut largest: f64 = 0.0;
    for [k_prime, x, y] in REFERENCE_TIPS {
        let place = table.place(table.log2_k.fraction(libm::log2(k_prime)), 0.0_f32);
        let tip = (0..8).fold([0.0; 2], |tip, j| {
            let [across, up] = table.direction(place, j).map(f64::from);
            let length = 8.0 * across.hypot(up);
            [tip[0] + across / length, tip[1] + up / length]
        });
        let gap = (tip[0] - x).hypot(tip[1] - y);
        assert!(gap <= 1e-3, "k′ = {k_prime}: {tip:?}, off by {gap:e}");
        largest = largest.max(gap);
    }
    println!("tips of the reference shapes: {largest:.1e} of a blade off at most");
}

#[test]
fn places_of_an_axis_run_from_end_to_end() {
    for spacing in [Spacing::Even, Spacing::Knee(0.3), Spacing::FourthPower] {
        let axis = Axis {
            min: 2.0,
            max: 5.0,
            entries: 9,
            spacing,
        };
        for entry in 0..9 {
            let (below, rest) = axis.entry_and_rest(axis.fraction_at(f64::from(entry)));
            // Fourth roots of a rounding: the place of an entry is known to ε^¼ of a step there.
            let at = below as f64 + rest;
            assert!(
                (at - f64::from(entry)).abs() < 1e-3,
                "{spacing:?}: {entry} at {at}"
            );
        }
        assert_eq!(axis.entry_and_rest(-1.0), (0, 0.0));
        assert_eq!(axis.entry_and_rest(2.0), (7, 1.0));
    }
}

/// k′ is given for eight segments and grows with N³, so that a plant keeps its shape at any count. The
/// error of N segments falls with N²; without the scaling four would stand upright and sixteen hang.
#[test]
fn the_segment_count_keeps_a_plants_shape() {
    let tables = [4, 8, 16].map(|segments| {
        BladeTable::new(&Grass::default(), segments, Root::Double, Some([64, 32]))
            .expect("a plain kind")
    });
    let tip = |table: &BladeTable, stiffness: f64, lean: f64| {
        let place = table.place(stiffness, lean);
        let mut tip = [0.0; 2];
        for segment in 0..table.segments as usize {
            let [across, up] = table.direction(place, segment);
            let length = across.hypot(up) * f64::from(table.segments);
            tip = [tip[0] + across / length, tip[1] + up / length];
        }
        tip
    };
    let mut most = [0.0_f64; 2];
    for step in 0..=40 {
        let at = f64::from(step) / 40.0;
        for lean in [0.0, 0.5, 1.0] {
            let [four, eight, sixteen] = tables.each_ref().map(|table| tip(table, at, lean));
            let gap = |a: [f64; 2]| (a[0] - sixteen[0]).hypot(a[1] - sixteen[1]);
            most = [most[0].max(gap(four)), most[1].max(gap(eight))];
        }
    }
    assert!(most[1] < 0.02 && most[0] < 5.0 * most[1] + 0.02, "{most:?}");
}

/// The critical stiffness is felt from outside a kind's range: even axes erred there by up to 0.18.
#[test]
fn beside_the_critical_stiffness_within_a_thousandth() {
    for root in [Root::Double, Root::Paper] {
        let critical = libm::log2(critical_stiffness(8, root).expect("a plain count"));
        for octaves_away in [-1.01, -0.9, -0.003, 0.0, 0.003, 0.9, 1.01] {
            for octaves_wide in [0.0, 2.0_f64] {
                let end = critical + octaves_away;
                let far = end + octaves_wide.copysign(octaves_away);
                let kind = grass(
                    [least(end, far), most(end, far)].map(|k| libm::exp2(k) as f32),
                    [0.0, 90.0],
                );
                let error = error(&kind, 8, root, None);
                assert!(
                    error <= 1e-3,
                    "{octaves_wide} octaves, {octaves_away} away, {root:?}: {error:e}"
                );
            }
        }
    }
}

/// log₂ k′ of all sizes, and as often about the critical stiffness.
fn stiffness() -> impl Strategy<Value = f64> {
    prop_oneof![-4.0..16.0, 5.0..7.5]
}

/// Leans of all sizes in degrees, and as often small ones and none.
fn leans() -> impl Strategy<Value = f32> {
    prop_oneof![0.0_f32..90.0, 0.0_f32..2.0, Just(0.0)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Whatever a kind draws from, and however far apart its ends are.
    #[test]
    fn any_kind_within_a_thousandth(
        mut log2_k in [stiffness(), stiffness()],
        mut lean_deg in [leans(), leans()],
        paper in any::<bool>(),
    ) {
        log2_k.sort_by(f64::total_cmp);
        lean_deg.sort_by(f32::total_cmp);
        let kind = grass(log2_k.map(|k| libm::exp2(k) as f32), lean_deg);
        let root = if paper { Root::Paper } else { Root::Double };
        let table = BladeTable::new(&kind, 8, root, USUAL).expect("valid");
        let error = table.max_error().expect("valid");
        prop_assert!(error <= 1e-3, "{kind:?}, {root:?}: {error:e}");
    }
}
