use super::literal::{Term, chain_eigenvalue, power_iteration};
use super::*;
use crate::base::philox::philox2x32;
use crate::base::vec3;
use crate::field::{MAX_NODES, Nodes};

mod hard_cases;

/// A blade of 0.4 m.
fn straight(segments: usize) -> Vec<Vec3<f64>> {
    let length = 0.4 / segments as f64;
    (0..=segments)
        .map(|j| vec3(0.0, length * j as f64, 0.0))
        .collect()
}

/// A billboard in the x-y plane with cells of the given size.
fn grid(columns: usize, rows: usize, width_m: f64, height_m: f64) -> Vec<Vec3<f64>> {
    (0..columns * rows)
        .map(|j| {
            let (column, row) = (j % columns, j / columns);
            vec3(width_m * column as f64, height_m * row as f64, 0.0)
        })
        .collect()
}

fn billboard(columns: usize, rows: usize) -> Network<f64> {
    Network::billboard(&grid(columns, rows, 0.1, 0.1), columns, false)
}

/// The rest shape with every movable node moved by up to `size_m` along each axis.
fn shaken(network: &Network<f64>, seed: u32, size_m: f64) -> Vec<Vec3<f64>> {
    let mut nodes = network.rest.clone();
    for (j, node) in nodes.iter_mut().enumerate() {
        let draw = |axis: u32| {
            let [word, _] = philox2x32([3 * j as u32 + axis, seed], 7, 10);
            (f64::from(word) / f64::from(u32::MAX) - 0.5) * 2.0 * size_m
        };
        if !network.pinned[j] {
            *node += vec3(draw(0), draw(1), draw(2));
        }
    }
    nodes
}

/// λmax with weight 1 beside pins too, as the reference table has it.
fn unweighted_eigenvalue(network: &Network<f64>) -> f64 {
    let terms: Vec<_> = network
        .springs
        .iter()
        .map(|spring| Term {
            ends: spring.ends,
            weights: spring
                .shares
                .map(|share| if share > 0.0 { 1.0 } else { 0.0 }),
            direction: spring.rest_direction,
        })
        .collect();
    power_iteration(network.rest.len(), &terms)
}

#[test]
fn eigenvalues_as_tabulated() {
    // Four decimals are given; the power iteration of the largest mesh ends 1e-4 early.
    let near = |name: &str, got: f64, want: f64| {
        assert!((got - want).abs() < 2e-4, "{name}: {got} for {want}");
    };
    for (segments, want) in [(4, 3.5321), (8, 3.8649), (16, 3.9639)] {
        let network = Network::chain(&straight(segments));
        near("chain", unweighted_eigenvalue(&network), want);
    }
    for (columns, rows, want) in [
        (2, 2, 2.7071),
        (2, 4, 5.0580),
        (2, 8, 5.7815),
        (3, 3, 5.2923),
        (3, 5, 6.3126),
        (4, 4, 6.3867),
        (5, 5, 6.9005),
        (9, 9, 7.6398),
        (17, 17, 7.8972),
    ] {
        let name = format!("{columns} × {rows}");
        near(
            &name,
            unweighted_eigenvalue(&billboard(columns, rows)),
            want,
        );
    }
    let slim = Network::billboard(&grid(3, 5, 0.05, 0.1), 3, false);
    near("slim 3 × 5", unweighted_eigenvalue(&slim), 7.8722);
    // With weight 2 beside pins, 2/λmax is 0.287 on 3 × 5.
    near("weighted", 2.0 / billboard(3, 5).largest_eigenvalue, 0.2872);
}

#[test]
fn a_blades_bound_holds_in_any_pose() {
    for segments in [1, 2, 8, 16] {
        let bound = chain_eigenvalue(segments);
        let network = Network::blade(&straight(segments));
        // Straight, the two are the same number.
        assert!((network.largest_eigenvalue / bound - 1.0).abs() < 1e-4);
        for seed in 0..20 {
            let bent = Network::blade(&shaken(&network, seed, 0.05));
            assert!(
                bent.largest_eigenvalue <= bound * (1.0 + 1e-9),
                "{segments}"
            );
        }
    }
}

#[test]
fn responsibilities_add_up() {
    for pinned in [[false, false], [true, false], [false, true]] {
        let [first, second] = shares(pinned);
        assert_eq!(first + second, 1.0, "{pinned:?}");
        assert!(!pinned[0] || first == 0.0);
        assert!(!pinned[1] || second == 0.0);
    }
    assert_eq!(shares([true, true]), [0.0, 0.0]);
}

#[test]
fn one_spring_shrinks_by_the_same_share_at_any_step() {
    // A single spring, pinned below: 1 − 2a in a step. The exponential form is exact for any
    // division of a second; the rational one to first order in κΔt.
    let left = |form: fn(f64) -> f64, hz: i32| (1.0 - 2.0 * form(3.0 / f64::from(hz))).powi(hz);
    for hz in [15, 30, 60, 120, 240] {
        let exact = (-6.0_f64).exp();
        assert!((left(step::exponential, hz) / exact - 1.0).abs() < 1e-12);
        // (1 + 2x)^(−1/x) ≈ e^(−2)·(1 + 2x), x = κΔt, and κ·1 s = 3 of those factors.
        let x = 3.0 / f64::from(hz);
        let off = left(step::rational, hz) / exact - 1.0;
        assert!(
            off > 0.0 && off < 3.0 * 2.0 * x * (1.0 + 3.0 * x),
            "{hz}: {off}"
        );
    }
}

#[test]
fn steps_are_bounded() {
    for rate_step in [0.0, 1e-300, 1.0, 1e6, f64::MAX, f64::INFINITY] {
        for form in [step::rational, step::exponential] {
            let a = form(rate_step);
            assert!((0.0..=0.5).contains(&a), "{rate_step}: {a}");
        }
    }
    for nonsense in [-1.0, f64::NAN, f64::NEG_INFINITY] {
        assert_eq!(step::rational(nonsense), 0.0);
        assert_eq!(step::exponential(nonsense), 0.0);
        assert_eq!(step::literal(nonsense, 4.0).step, 0.0);
    }
    let free = step::literal(0.1, 4.0);
    assert_eq!((free.step, free.clamped), (0.05, false));
    let bound = step::literal(1.0, 4.0);
    assert_eq!((bound.step, bound.clamped), (0.225, true));
    assert_eq!(step::literal(1.0, 0.0).step, 0.0);
}

#[test]
fn a_turned_hinge_changes_its_own_spring_alone() {
    let rest = shaken(&Network::blade(&straight(8)), 1, 0.005);
    let start = shaken(&Network::blade(&straight(8)), 2, 0.01);
    // The same lengths as at rest, so that every extension can be undone.
    let mut line = vec![rest[0]];
    for j in 1..9 {
        let direction = (start[j] - start[j - 1]).unit_or(Vec3::UP);
        line.push(line[j - 1] + direction * (rest[j] - rest[j - 1]).length());
    }
    let before = line.clone();
    hinge::turn(&rest, &mut line, 0.4);
    let length =
        |nodes: &[Vec3<f64>], j: usize, reach: usize| (nodes[j + reach] - nodes[j]).length();
    for j in 0..8 {
        assert!(
            (length(&line, j, 1) - length(&before, j, 1)).abs() < 1e-15,
            "segment {j}"
        );
    }
    for j in 0..7 {
        let extension = |nodes: &[Vec3<f64>]| length(nodes, j, 2) - length(&rest, j, 2);
        assert!(
            (extension(&line) - 0.6 * extension(&before)).abs() < 1e-15,
            "bend {j}"
        );
    }
    assert_eq!(line[..2], before[..2]);
}

/// ½Σw(‖l‖ − l₀)², what a literal pass descends on.
fn weighted_energy(network: &Network<f64>, nodes: &[Vec3<f64>]) -> f64 {
    let weight = |spring: &Spring<f64>| {
        if spring.shares == [0.5, 0.5] {
            0.5
        } else {
            1.0
        }
    };
    let term = |spring: &Spring<f64>| {
        let [a, b] = spring.ends;
        let longer = (nodes[a] - nodes[b]).length() - spring.rest_length;
        weight(spring) * longer * longer
    };
    network.springs.iter().map(term).sum()
}

#[test]
fn a_literal_blade_descends_on_its_weighted_energy() {
    let network = Network::blade(&straight(8));
    let wind = as_nodes(&network.rest);
    for kappa in [1.0, 30.0, 1000.0] {
        let settings = LiteralBlade::<f64>::new(kappa / 15.0, 8);
        for seed in 0..50 {
            let mut nodes = as_nodes(&shaken(&network, seed, 0.03));
            let mut energy = f64::INFINITY;
            for _ in 0..100 {
                relax_blade(&mut nodes, &wind, &settings);
                let now = weighted_energy(&network, &nodes[..9]);
                assert!(
                    now <= energy,
                    "κ {kappa}, seed {seed}: {now:e} after {energy:e}"
                );
                energy = now;
            }
        }
    }
}

fn as_nodes(line: &[Vec3<f64>]) -> Nodes<f64> {
    let mut nodes = [Vec3::ZERO; MAX_NODES];
    nodes[..line.len()].copy_from_slice(line);
    nodes
}

#[test]
fn a_blade_in_place_is_the_network_pass() {
    for segments in [1, 2, 8, 16] {
        let network = Network::blade(&straight(segments));
        let wind = as_nodes(&network.rest);
        for rate_step in [0.01, 0.5, 10.0] {
            let settings = LiteralBlade::<f64>::new(rate_step, segments);
            let mut line = shaken(&network, 3, 0.02);
            let mut nodes = as_nodes(&line);
            let reset = relax_blade(&mut nodes, &wind, &settings);
            literal::pass(&network, &mut line, settings.step, &mut Vec::new());
            assert_eq!((reset, nodes[0]), (0, Vec3::ZERO));
            for (node, want) in nodes.iter().zip(&line) {
                // The same terms in another order.
                assert!((*node - *want).length() < 1e-15, "{segments} {rate_step}");
            }
        }
    }
}

#[test]
fn a_blade_says_when_its_step_is_cut() {
    // 0.9/λmax of eight segments is 0.1455, so from κΔt = 0.291 on.
    assert!(!LiteralBlade::<f32>::new(0.28, 8).clamped);
    assert!(LiteralBlade::<f32>::new(0.30, 8).clamped);
}

#[test]
fn a_crumpled_blade_in_place_unfolds() {
    let wind = as_nodes(&straight(8));
    let settings = LiteralBlade::<f64>::new(0.5, 8);
    let mut nodes = [Vec3::ZERO; MAX_NODES];
    assert_eq!(relax_blade(&mut nodes, &wind, &settings), 8);
    for (node, want) in nodes.iter().zip(&wind) {
        assert!((*node - *want).length() < 1e-15);
    }
}

#[test]
fn finite_nodes_stay_finite() {
    let sizes = [
        0.0,
        f32::MIN_POSITIVE,
        1e-30,
        1e-12,
        1.0,
        1e12,
        1e18,
        1e30,
        f32::MAX,
    ];
    let line: Vec<Vec3<f32>> = straight(8).iter().map(|v| Vec3::of(v.to_f64())).collect();
    let mesh: Vec<Vec3<f32>> = grid(3, 5, 0.1, 0.1)
        .iter()
        .map(|v| Vec3::of(v.to_f64()))
        .collect();
    let wind: Nodes<f32> = as_nodes(&straight(8)).map(|v| Vec3::of(v.to_f64()));
    for network in [Network::blade(&line), Network::billboard(&mesh, 3, true)] {
        for size in sizes {
            for seed in 0..30 {
                let mut nodes = network.rest.clone();
                for (j, node) in nodes
                    .iter_mut()
                    .enumerate()
                    .filter(|(j, _)| !network.pinned[*j])
                {
                    let [a, b] = philox2x32([j as u32, seed], 1, 10);
                    let part = |word: u32, shift: u32| (word >> shift & 3) as f32 - 1.5;
                    *node = vec3(part(a, 0), part(a, 8), part(b, 0)) * (size / 1.5);
                }
                let mut blade = [Vec3::ZERO; MAX_NODES];
                blade[..9].copy_from_slice(&nodes[..9]);
                for method in [Method::Sequential, Method::Literal] {
                    let mut nodes = nodes.clone();
                    for _ in 0..4 {
                        relax(&network, &mut nodes, method, 8.0, 2, &mut Vec::new());
                    }
                    assert!(
                        nodes.iter().all(|v| v.is_finite()),
                        "{method:?} {size:e} {seed}"
                    );
                }
                relax_blade(&mut blade, &wind, &LiteralBlade::new(8.0, 8));
                assert!(blade.iter().all(|v| v.is_finite()), "{size:e} {seed}");
            }
        }
    }
}

#[test]
fn too_few_nodes_are_left_alone() {
    let network = billboard(3, 5);
    let mut nodes = vec![vec3(1.0, 2.0, 3.0); 4];
    relax(
        &network,
        &mut nodes,
        Method::Sequential,
        1.0,
        1,
        &mut Vec::new(),
    );
    assert_eq!(nodes, vec![vec3(1.0, 2.0, 3.0); 4]);
}

#[test]
fn a_small_network_is_harmless() {
    for columns in [0, 1, 2] {
        let network = Network::<f64>::billboard(&grid(1, 1, 0.1, 0.1), columns, true);
        assert!(network.springs.is_empty());
        assert_eq!(network.largest_eigenvalue, 0.0);
    }
    assert!(Network::<f64>::blade(&[]).springs.is_empty());
}
