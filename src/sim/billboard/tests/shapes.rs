//! Laws without a body: lengths, energy, strain, recovery, lanes.

use super::*;

const KAPPAS_PER_S: [f64; 7] = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0];
const RATES_HZ: [f64; 5] = [15.0, 30.0, 60.0, 120.0, 240.0];
const GRIDS: [[u32; 2]; 4] = [[3, 3], [4, 4], [3, 5], [9, 9]];

/// Neighbours are a length apart that takes three roundings of coordinates below a metre.
#[test]
fn columns_and_rows_keep_their_lengths_in_the_wind() {
    for [columns, rows] in GRIDS {
        let grid = Grid::new([columns, rows]).expect("a grid");
        for seed in 0..50 {
            let mut leaning = billboard(0.4, 0.6);
            let up: Vec3<f64> = vec3(chance(0, seed), 0.3, chance(1, seed)).unit_or(Vec3::UP);
            leaning.up = up.to_f32();
            let bend = [chance(2, seed) as f32, chance(3, seed) as f32];
            let quad = Quad::<f32>::bent(&leaning, bend);
            let nodes = grid_of(&quad, grid);
            let off = |a: usize, b: usize, want: f64| {
                let edge = nodes[a] - nodes[b];
                (Vec3::<f64>::of(edge.to_f64()).length() - want).abs()
            };
            for node in 0..grid.nodes() {
                let [column, row] = grid.place(node);
                if row > 0 {
                    let want = 0.6_f32 as f64 / f64::from(rows - 1);
                    assert!(off(node, node - grid.columns, want) < 6e-7, "{seed} {node}");
                }
                if column > 0 {
                    let want = 0.4_f32 as f64 / f64::from(columns - 1);
                    assert!(off(node, node - 1, want) < 6e-7, "{seed} {node}");
                }
            }
            let last = grid.nodes() - 1;
            let corners = [0, grid.columns - 1, last + 1 - grid.columns, last];
            let vertices = quad.vertices();
            assert_eq!(corners.map(|node| nodes[node]), vertices);
        }
    }
}

#[test]
fn a_grid_has_limits() {
    for nodes in [[2, 4], [4, 2], [10, 4], [4, 10], [0, 0]] {
        assert!(Grid::new(nodes).is_err(), "{nodes:?}");
    }
    assert_eq!(
        weave(4, 4)
            .springs
            .iter()
            .filter(|s| !s.side.is_bend())
            .count(),
        39
    );
}

/// At rest a spring is off by the rounding of its two ends: what a pass does about it is as small, and
/// the guard leaves nodes alone where the energy would not fall.
#[test]
fn at_rest_springs_move_nothing() {
    let weave = weave(4, 4);
    let ground = ground();
    let mut batch: Batch<f64, 1> = shaken(&weave, &ground, &[billboard(0.5, 0.5)], 0, 0.0);
    let before = batch.nodes.clone();
    batch.passes(pull(8.0), 100);
    for node in 0..weave.grid.nodes() {
        let moved = (batch.nodes.get(node, 0) - before.get(node, 0)).length();
        // A hundred passes of 53 springs, each off by two roundings at most.
        assert!(
            moved < 100.0 * 53.0 * 2.0 * f64::EPSILON,
            "{node}: {moved:e}"
        );
        if node < 4 {
            assert_eq!(batch.nodes.get(node, 0), before.get(node, 0));
        }
    }
}

#[test]
fn stiff_springs_never_gain_energy() {
    let ground = ground();
    for [columns, rows] in GRIDS {
        let weave = weave(columns, rows);
        for kappa in KAPPAS_PER_S {
            for hz in RATES_HZ {
                for (seed, size_m) in [(1, 0.01), (2, 0.05), (3, 0.2)] {
                    let boards = [billboard(0.4, 0.6), billboard(0.6, 0.3)];
                    let mut batch: Batch<f64, 2> = shaken(&weave, &ground, &boards, seed, size_m);
                    let energies = batch.passes(pull(kappa / hz), 20);
                    for pair in energies.windows(2) {
                        for l in 0..2 {
                            assert!(
                                pair[1][l] <= pair[0][l],
                                "{columns} × {rows}, κ {kappa}, {hz} Hz: {pair:?}"
                            );
                        }
                    }
                }
            }
        }
    }
}

/// Where a node is, from where it rests and its number.
type Change<'a> = &'a dyn Fn(Vec3<f64>, usize) -> Vec3<f64>;

/// Crumpled, inverted and stretched ones: down to 1% within a second of sub-steps with the fewest rounds.
/// (One of 9 × 9 nodes drawn to a point has 3.4% left then: its slowest mode takes longer.)
#[test]
fn strain_falls_within_a_second() {
    let ground = ground();
    for [columns, rows] in [[3, 3], [4, 4], [3, 5], [5, 5]] {
        let weave = weave(columns, rows);
        let grid = weave.grid;
        let cases: [(&str, Change); 5] = [
            ("one point", &|_, _| vec3(0.1, 0.3, 0.0)),
            ("on the root", &|_, _| Vec3::ZERO),
            ("mirrored", &|v, _| vec3(-v.x, v.y, v.z)),
            ("upside down", &|v, _| vec3(v.x, -v.y, v.z)),
            ("corner pulled", &|v, n| {
                if n + 1 == grid.nodes() { v * 3.0 } else { v }
            }),
        ];
        for (name, change) in cases {
            let mut batch: Batch<f64, 1> = shaken(&weave, &ground, &[billboard(0.5, 0.5)], 0, 0.0);
            for node in grid.columns..grid.nodes() {
                let place = change(batch.nodes.get(node, 0), node);
                batch.nodes.set(node, 0, place);
            }
            let start = batch.strain(0);
            let settings = Settings::<f64>::new(&Solver::default());
            for _ in 0..120 {
                batch.put_in_order(&[true]);
                // As many passes as the fewest rounds make.
                batch.passes(settings.pull(1), 2 * settings.passes);
            }
            let strain = batch.strain(0);
            println!("{columns} × {rows}, {name}: strain {start:.2} to {strain:.1e}");
            assert!(strain <= 0.01, "{columns} × {rows}, {name}: {strain}");
        }
    }
}

#[test]
fn nothing_becomes_nan() {
    let ground = ground();
    let weave = weave(4, 4);
    let sizes = [0.0, 1e-6, 1.0, 1e3, 1e18, 1e30];
    for (w, h) in sizes.iter().flat_map(|&w| sizes.map(|h| (w, h))) {
        for size_m in [0.0, 1e-20, 1.0, 1e15, 1e30] {
            let mut batch: Batch<f32, 1> = shaken(&weave, &ground, &[billboard(w, h)], 4, size_m);
            for _ in 0..4 {
                batch.put_in_order(&[true]);
                batch.passes(pull(8.0), 2);
            }
            let finite = (0..16).all(|node| batch.nodes.get(node, 0).is_finite());
            assert!(finite, "{w} × {h} m shaken by {size_m} m");
        }
    }
    let mut batch: Batch<f32, 1> = shaken(&weave, &ground, &[billboard(0.5, 0.5)], 4, 0.0);
    batch.nodes.set(9, 0, vec3(f32::NAN, f32::INFINITY, 0.0));
    assert!(batch.put_in_order(&[true])[0] > 0);
    assert!((0..16).all(|node| batch.nodes.get(node, 0).is_finite()));
}

#[test]
fn a_lane_is_a_billboard_by_itself() {
    let ground = ground();
    let weave = weave(4, 4);
    let boards: Vec<Billboard> = (0..8)
        .map(|n| billboard(0.3 + 0.05 * n as f32, 0.7 - 0.06 * n as f32))
        .collect();
    let mut together: Batch<f32, 8> = shaken(&weave, &ground, &boards, 5, 0.1);
    together.passes(pull(8.0), 8);
    for l in 0..8 {
        // The same shake as the lane's: it depends on the place in the list.
        let mut alone: Batch<f32, 8> = shaken(&weave, &ground, &boards, 5, 0.1);
        let mut single: Batch<f32, 1> = shaken(&weave, &ground, &boards[l..=l], 5, 0.0);
        for node in 0..16 {
            single.nodes.set(node, 0, alone.nodes.get(node, l));
        }
        alone.clear();
        single.passes(pull(8.0), 8);
        for node in 0..16 {
            let [a, b] = [together.nodes.get(node, l), single.nodes.get(node, 0)];
            assert_eq!(a.to_f32().map(f32::to_bits), b.to_f32().map(f32::to_bits));
        }
    }
}

/// One spring's move is off by at most 8 roundings of a coordinate below a metre, and moves of springs do
/// not grow in later ones: 4 passes of 53 springs in a row make 8·4·53 of them.
#[test]
fn single_precision_is_near_double() {
    let ground = ground();
    let weave = weave(4, 4);
    let mut worst: f64 = 0.0;
    for seed in 0..20 {
        let boards = [billboard(0.5, 0.5)];
        let mut double: Batch<f64, 1> = shaken(&weave, &ground, &boards, seed, 0.05);
        let mut single: Batch<f32, 1> = shaken(&weave, &ground, &boards, seed, 0.05);
        double.passes(pull(8.0), 4);
        single.passes(pull(8.0), 4);
        for node in 0..16 {
            let off =
                Vec3::<f64>::of(single.nodes.get(node, 0).to_f64()) - double.nodes.get(node, 0);
            worst = worst.max(off.length());
        }
    }
    println!("f32 against f64: {worst:.1e} m");
    assert!(
        worst < 8.0 * 4.0 * 53.0 * f64::from(f32::EPSILON) * 0.5,
        "{worst:e}"
    );
}

fn fading(step_over_t: f64) -> Fading<f64> {
    Fading {
        step_over_t,
        recovery: Recovery::Lengths,
        planted: Planted::NONE,
    }
}

/// A quad that lies on the ground, as offsets from the quad upright.
fn lying(quad: &Quad<f64>, grid: Grid, degrees: f64) -> Vec<Vec3<f64>> {
    let angle = degrees.to_radians();
    (grid.columns..grid.nodes())
        .map(|node| {
            let at = grid_of(quad, grid)[node];
            let turned = vec3(at.x, at.y * angle.cos(), at.y * angle.sin());
            turned - at
        })
        .collect()
}

#[test]
fn recovery_keeps_lengths_and_ends_in_the_wind_bit_for_bit() {
    let weave = weave(4, 4);
    let quad = Quad::<f64>::bent(&billboard(0.5, 0.5), [0.0; 2]);
    let mut poses: Poses<f64, 1> = Poses::new(&weave);
    for degrees in [30.0, 90.0, 150.0, 179.9, 180.0] {
        let offsets = lying(&quad, weave.grid, degrees);
        let mut top = f64::NEG_INFINITY;
        for age in 0..=240 {
            let fade = Fade {
                quad,
                offsets: &offsets,
                age,
            };
            poses.recover(&weave, [&fade], &fading(1.0 / 240.0));
            for node in 4..16 {
                let column = (poses.nodes.get(node, 0) - poses.nodes.get(node - 4, 0)).length();
                assert!(
                    (column * 6.0 - 1.0).abs() < 1e-9,
                    "{degrees}° age {age}: {column}"
                );
                if node % 4 > 0 {
                    let row = (poses.nodes.get(node, 0) - poses.nodes.get(node - 1, 0)).length();
                    assert!(
                        (row * 6.0 - 1.0).abs() < 1e-9,
                        "{degrees}° age {age}: {row}"
                    );
                }
                if age == 240 {
                    assert_eq!(poses.nodes.get(node, 0), grid_of(&quad, weave.grid)[node]);
                }
            }
            // It rises all the while.
            let now = poses.nodes.get(12, 0).y;
            assert!(now >= top - 1e-9, "{degrees}° age {age}");
            top = now;
        }
    }
}

/// The offset's weight does not depend on the rate at which it is asked for: t³ at 1 s of 2 s is ⅛.
#[test]
fn recovery_is_the_same_at_every_rate() {
    let weave = weave(4, 4);
    let quad = Quad::<f64>::bent(&billboard(0.5, 0.5), [0.0; 2]);
    let offsets = lying(&quad, weave.grid, 80.0);
    let at = |hz: u32| {
        let mut poses: Poses<f64, 1> = Poses::new(&weave);
        let fade = Fade {
            quad,
            offsets: &offsets,
            age: hz,
        };
        poses.recover(&weave, [&fade], &fading(1.0 / f64::from(2 * hz)));
        poses.nodes.get(15, 0)
    };
    for hz in [15, 30, 60, 240, 1000] {
        assert!((at(hz) - at(120)).length() < 1e-12, "{hz} Hz");
    }
}
