//! How long a sub-step of many billboards takes: a measurement, to be asked for by name.

use std::time::Instant;

use rayon::prelude::*;

use super::contacts::{Ball, calm};
use super::*;

const BILLBOARDS: usize = 60_000;
/// As many as a square metre of O09's meadow has.
const PER_TILE: usize = 8;

struct Load<'a> {
    tiles: Vec<(Vec<Billboard>, Slab<f32>)>,
    touches: &'a [Touch<'a, f32>],
    weave: &'a Weave,
    ground: &'a HeightGrid,
    wind: &'a WindNow,
}

impl Load<'_> {
    fn tile<'t>(&'t self, boards: &'t [Billboard], now: u32) -> Tile<'t, f32> {
        Tile {
            weave: self.weave,
            billboards: boards,
            anchor: &ANCHOR,
            ground: self.ground,
            ground_top_m: 1e-6,
            touches: self.touches,
            wind: self.wind,
            wind_before: self.wind,
            now,
            fading: Fading {
                step_over_t: 1.0 / 240.0,
                recovery: Recovery::Lengths,
                planted: Planted::NONE,
            },
        }
    }
}

/// Every billboard of every tile is pushed by a ball in both sweeps, anew in every sub-step.
#[test]
#[ignore = "a measurement: cargo test --release --lib billboards_in_a_sub_step -- --ignored --nocapture"]
fn billboards_in_a_sub_step() {
    let weave = Weave::new(Grid::new([4, 4]).expect("a grid"), false);
    let with_bends = Weave::new(Grid::new([4, 4]).expect("a grid"), true);
    let (ground, wind) = (ground(), calm());
    // O09's four passes in the two sweeps of a sub-step, or what the solver takes.
    let solver = Settings::<f32>::new(&Solver::default());
    let four_passes = Settings {
        passes: 2,
        fewest_rounds: 1,
        most_rounds: 1,
        ..solver
    };
    for (name, tested, weave, settings) in [
        ("closed, 4 passes", Tested::Closed, &weave, four_passes),
        ("cube, 4 passes", Tested::Cube, &weave, four_passes),
        (
            "closed, bends, 4 passes",
            Tested::Closed,
            &with_bends,
            four_passes,
        ),
        (
            "closed, bends, as many as needed",
            Tested::Closed,
            &with_bends,
            solver,
        ),
        (
            "cube, bends, as many as needed",
            Tested::Cube,
            &with_bends,
            solver,
        ),
    ] {
        let ball = Ball::new(tested);
        let grown: Solid<f32> = ball.part().solid.grown_by(0.001);
        let contact = ball.contact(vec3(0.0, 0.15, 0.0), vec3(0.0, 0.15, 0.0));
        let touches = [Touch::new(0, &contact, ball.part(), &grown)];
        let tiles = (0..BILLBOARDS / PER_TILE).map(|t| {
            let boards: Vec<Billboard> = (0..PER_TILE).map(|n| beside(t * PER_TILE + n)).collect();
            (boards, Slab::new(PER_TILE, weave.grid.movable()))
        });
        let mut load = Load {
            tiles: tiles.collect(),
            touches: &touches,
            weave,
            ground: &ground,
            wind: &wind,
        };
        let mut times: Vec<[f64; 3]> = Vec::new();
        for now in 1..=12 {
            // All of them upright again, so that all are pushed anew.
            for (_, slab) in &mut load.tiles {
                slab.touched_at.fill(0);
            }
            times.push(sub_step(&mut load, now, &settings, name));
        }
        let best = |pass: usize| {
            times[1..]
                .iter()
                .map(|t| t[pass])
                .fold(f64::INFINITY, f64::min)
        };
        let median = |pass: usize| {
            let mut all: Vec<f64> = times[1..].iter().map(|t| t[pass]).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        };
        let show = |of: &dyn Fn(usize) -> f64| {
            let [c, s, r] = [0, 1, 2].map(of);
            format!(
                "collide {c:.1}, relax {s:.1}, recover {r:.1}, together {:.1} ms",
                c + s + r
            )
        };
        println!("{name}: least {}; median {}", show(&best), show(&median));
    }
}

/// A billboard beside the ball, which presses two of its nodes aside by a millimetre or so.
fn beside(n: usize) -> Billboard {
    let turn = chance(n, 1) * std::f64::consts::PI;
    let away = 0.133 + 5e-4 * chance(n, 2);
    Billboard {
        root_in_anchor: [(away * turn.cos()) as f32, 0.0, (away * turn.sin()) as f32],
        across: [-turn.sin() as f32, turn.cos() as f32],
        ..billboard(0.4, 0.5)
    }
}

fn sub_step(load: &mut Load, now: u32, settings: &Settings<f32>, name: &str) -> [f64; 3] {
    let ms = |since: Instant| since.elapsed().as_secs_f64() * 1e3;
    let start = Instant::now();
    let mut found: Vec<Vec<Touched>> = load
        .tiles
        .par_iter()
        .with_min_len(64)
        .map_init(
            || Poses::new(load.weave),
            |poses, (boards, slab)| {
                let mut found = Vec::new();
                load.tile(boards, now).touched(slab, poses, &mut found);
                found
            },
        )
        .collect();
    let collide_ms = ms(start);
    let start = Instant::now();
    let mut tiles = std::mem::take(&mut load.tiles);
    let (weave, load_ref) = (load.weave, &*load);
    let done: Vec<Responded> = tiles
        .par_iter_mut()
        .zip(&mut found)
        .with_min_len(64)
        .map_init(
            || (Batch::new(weave), Poses::new(weave)),
            |(batch, poses), ((boards, slab), found)| {
                let tile = load_ref.tile(boards, now);
                tile.respond(found, slab, (batch, poses), settings)
            },
        )
        .collect();
    load.tiles = tiles;
    let relax_ms = ms(start);
    let start = Instant::now();
    // A later tick, so that all of them recover.
    let sum: f32 = load
        .tiles
        .par_iter()
        .with_min_len(64)
        .map_init(
            || Poses::new(load.weave),
            |poses, (boards, slab)| {
                let mut sum = 0.0;
                load.tile(boards, now + 20)
                    .poses(slab, poses, |_, lane, poses| {
                        sum += poses.nodes.get(15, lane).y;
                    });
                sum
            },
        )
        .sum();
    let recover_ms = ms(start);
    let touched: u64 = done.iter().map(|d| d.touched).sum();
    let pushed = found.iter().flatten().filter(|t| t.sweeps > 0).count();
    let rounds = done.iter().map(|d| d.rounds).max().unwrap_or(0);
    if now == 2 {
        println!("{name}: {pushed} pushed, {touched} touched, {rounds} rounds at most, {sum:.0}");
    }
    [collide_ms, relax_ms, recover_ms]
}

/// The springs alone: four passes over 39 of them (42 with those between pinned nodes) and one measure of
/// what they are off, on one core.
#[test]
#[ignore = "a measurement"]
fn springs_alone() {
    fn run<const L: usize>() {
        let weave = Weave::new(Grid::new([4, 4]).expect("a grid"), false);
        let ground = ground();
        let boards = vec![billboard(0.4, 0.5); L];
        let mut batch: Batch<f32, L> = shaken(&weave, &ground, &boards, 1, 0.05);
        let pull = pull(8.0);
        let mut best = f64::INFINITY;
        for _ in 0..5 {
            let start = Instant::now();
            for _ in 0..BILLBOARDS / L {
                for _ in 0..4 {
                    springs::pass(&weave, &batch.rest, pull, &mut batch.nodes);
                }
            }
            best = best.min(start.elapsed().as_secs_f64() * 1e3);
        }
        let start = Instant::now();
        let mut sum = 0.0;
        for _ in 0..BILLBOARDS / L {
            sum += springs::measure(&weave, &batch.rest, pull, &batch.nodes).energy[0];
        }
        let measure_ms = start.elapsed().as_secs_f64() * 1e3;
        println!(
            "{L} lanes: {best:.1} ms for four passes, {measure_ms:.1} ms for one measure ({sum:.0})"
        );
    }
    run::<1>();
    run::<4>();
    run::<8>();
    run::<16>();
}
