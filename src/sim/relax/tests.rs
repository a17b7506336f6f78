//! The springs and lengths of a simulated blade with no body near.

use super::*;
use crate::base::philox::philox2x32;
use crate::base::vec3;
use crate::field::{Field, MAX_NODES};
use crate::scene::{Grass, Solver};
use crate::sim::springs;
use crate::terrain::HeightGrid;

const SEGMENTS: usize = 8;
/// Length of a segment, and the height of the root over a ground that no blade can reach, in metres.
const LENGTH_M: f64 = 0.05;
const ROOT_M: f64 = 1.0;
/// Rates of springs and of sub-steps of the stiff cases.
const KAPPAS_PER_S: [f64; 7] = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0];
const RATES_HZ: [f64; 5] = [15.0, 30.0, 60.0, 120.0, 240.0];
/// Most by which one segment may turn from the one below it, from a stir to a tangle, in radians.
const BENDS_RAD: [f64; 4] = [0.1, 0.3, 1.0, 3.0];

/// A centre line whose segments turn by chance.
fn bent<R: Real>(seed: u32, most_rad: f64) -> Nodes<R> {
    let turn = |n: usize| {
        let word = philox2x32([n as u32, seed], 7, 10)[0];
        most_rad * (2.0 * f64::from(word) / f64::from(u32::MAX) - 1.0)
    };
    let mut node = vec3(0.0, ROOT_M, 0.0);
    let mut nodes = [Vec3::of(node.to_f64()); MAX_NODES];
    let (mut lean, mut round) = (0.0_f64, 0.0_f64);
    for j in 0..SEGMENTS {
        (lean, round) = (lean + turn(2 * j), round + turn(2 * j + 1));
        let across = vec3(round.cos(), 0.0, round.sin()) * lean.sin();
        node += (across + Vec3::UP * lean.cos()) * LENGTH_M;
        nodes[j + 1] = Vec3::of(node.to_f64());
    }
    nodes
}

/// √Σ(‖l‖ − l₀)² over segments and bend springs, in metres: the root of twice the energy.
fn extension<R: Real>(nodes: &Nodes<R>, wind: &Nodes<R>) -> f64 {
    let pairs = springs::network::blade_pairs(SEGMENTS);
    let longer = pairs.map(|[a, b]| {
        let length = |line: &Nodes<R>| (line[b] - line[a]).to_f64();
        let [now, rest] = [length(nodes), length(wind)].map(|v| Vec3::<f64>::of(v).length());
        now - rest
    });
    longer.map(|longer| longer * longer).sum::<f64>().sqrt()
}

/// One sweep without contacts: bend springs, then the fewest rounds of lengths and ground.
fn sweep<R: Real>(nodes: &mut Nodes<R>, place: &Place<R>, rate: f64) {
    let moment = Moment {
        touches: &[],
        share: R::ONE,
        cover_m: R::ZERO,
    };
    let nothing = Bodies::at(moment, Vec3::ZERO, R::ONE);
    bend_springs(nodes, place, R::of(rate), Planted::NONE);
    for _ in 0..Solver::default().rounds[0] {
        lay_out(nodes, &mut [0; SEGMENTS], &nothing, place);
        keep_above_ground(nodes, place);
    }
}

/// A sweep never raises the energy. A chord of two nodes below 1.5 m is off by four roundings of
/// 1.5·`epsilon` in a sweep, fifteen springs together by √15 of that: `epsilon`·24.
fn never_gains_energy<R: Real>(epsilon: f64) {
    let ground = HeightGrid::flat(5, 5, 1.0);
    let field = Field::new(ground, &Grass::default(), &Solver::default()).expect("a field");
    let anchor = field.grid.anchor_of(0, &field.ground);
    let rates = KAPPAS_PER_S.map(|kappa| RATES_HZ.map(|hz| kappa / hz));
    for (rate, most_rad) in rates
        .into_iter()
        .flatten()
        .flat_map(|r| BENDS_RAD.map(|b| (r, b)))
    {
        for seed in 0..20 {
            let wind = bent::<R>(seed + 1000, 0.15);
            let mut nodes = bent::<R>(seed, most_rad);
            let place = Place {
                ground: Ground {
                    heights: &field.ground,
                    anchor: &anchor,
                },
                wind: &wind,
                segments: SEGMENTS,
                length: R::of(LENGTH_M),
            };
            let mut before_m = extension(&nodes, &wind);
            for _ in 0..20 {
                sweep(&mut nodes, &place, rate);
                let now_m = extension(&nodes, &wind);
                assert!(
                    now_m <= before_m + 24.0 * epsilon,
                    "κΔt {rate}, bends {most_rad}, seed {seed}: {now_m:e} m after {before_m:e} m"
                );
                before_m = now_m;
            }
        }
    }
}

#[test]
fn stiff_springs_of_a_blade_never_gain_energy_in_single_precision() {
    never_gains_energy::<f32>(f64::from(f32::EPSILON));
}

#[test]
fn stiff_springs_of_a_blade_never_gain_energy_in_double_precision() {
    never_gains_energy::<f64>(f64::EPSILON);
}

/// At the default's rate the springs do pull bends back, if slowly: chords of a blade that is nearly straight
/// hardly change with its bend. After a second of sub-steps with one sweep each 0.956 of the extension is
/// left; a guard that refuses every step leaves all of it.
#[test]
fn springs_of_the_default_rate_straighten_a_bent_blade() {
    let ground = HeightGrid::flat(5, 5, 1.0);
    let field = Field::new(ground, &Grass::default(), &Solver::default()).expect("a field");
    let anchor = field.grid.anchor_of(0, &field.ground);
    let solver = Solver::default();
    let rate = f64::from(solver.spring_rate_per_s) * solver.substep_s;
    let (mut first_m, mut last_m) = (0.0, 0.0);
    for seed in 0..20 {
        let wind = bent::<f64>(seed + 1000, 0.15);
        let mut nodes = bent::<f64>(seed, 0.3);
        let place = Place {
            ground: Ground {
                heights: &field.ground,
                anchor: &anchor,
            },
            wind: &wind,
            segments: SEGMENTS,
            length: LENGTH_M,
        };
        first_m += extension(&nodes, &wind);
        for _ in 0..120 {
            sweep(&mut nodes, &place, rate);
        }
        last_m += extension(&nodes, &wind);
    }
    println!(
        "{:.3} of the extension is left after a second",
        last_m / first_m
    );
    assert!(last_m < 0.97 * first_m, "{last_m} of {first_m} m");
}
