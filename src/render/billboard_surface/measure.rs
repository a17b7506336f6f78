//! O09 section 8's two ways to a better surface, measured against each other at equal error: more simulated
//! nodes, and a smooth surface through few. Asked for by name:
//! `cargo test --release --lib surfaces_beside -- --ignored --nocapture`.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::*;
use crate::base::Vec3;
use crate::field::TileId;
use crate::scene::Scene;
use crate::sim::measure::standing_billboards;
use crate::sim::{Grass, Meadow, tick};

/// Nodes along each side of the finest grid.
const FINEST: u32 = 9;

/// A wheel-sized ball, a thin post and a slanting board go through clumps.
const SCENE: &str = r#"(
    terrain: (ground: Flat(size_m: (12, 8))), grass: (species: []),
    billboards: Some((density_per_m2: 36, nodes: (N, N))),
    bodies: [
        (name: "ball", shape: Ball(radius_m: 0.3), position_m: (-4, 0.32, -2), motion: Path(waypoints: [(at_s: 0, position_m: (-4, 0.32, -2)), (at_s: 4, position_m: (4, 0.32, -2))])),
        (name: "post", shape: Capsule(radius_m: 0.06, length_m: 0.8), position_m: (-4, 0.4, 0), motion: Path(waypoints: [(at_s: 0, position_m: (-4, 0.4, 0)), (at_s: 4, position_m: (4, 0.4, 0))])),
        (name: "box", shape: Box(size_m: (0.5, 0.3, 0.5)), position_m: (-4, 0.3, 2), rotation_deg: (20, 30, 0), motion: Path(waypoints: [(at_s: 0, position_m: (-4, 0.3, 2)), (at_s: 4, position_m: (4, 0.3, 2))])),
    ],
)"#;

/// Places of every touched billboard's nodes, at some sub-steps.
type Poses = BTreeMap<(u32, TileId, u32), Vec<Vec<f64>>>;

struct Run {
    poses: Poses,
    /// Of collide and relax, per sub-step, in milliseconds, and billboards touched in one.
    ms: f64,
    touched: f64,
}

fn run(nodes: u32) -> Run {
    let scene: Scene = ron::from_str(&SCENE.replace('N', &nodes.to_string())).expect("a scene");
    let mut meadow = Meadow::new(scene, &Default::default()).expect("a meadow");
    let mut grass = Grass::<f32>::new();
    let mut poses = Poses::new();
    let ticks = 600;
    let mut touched = 0;
    for now in 1..=ticks {
        tick(&mut meadow, &mut grass).expect("a sub-step");
        touched += grass.pushed;
        if now % 60 != 0 {
            continue;
        }
        for tile in &meadow.work.tiles {
            let Some(slab) = grass.billboards().slab(tile.slab) else {
                continue;
            };
            for board in standing_billboards(&meadow, tile, slab) {
                if board.touched_at == now {
                    let places = board.nodes.iter().map(|node| node.to_f64().to_vec());
                    poses.insert((now, tile.tile, board.place), places.collect());
                }
            }
        }
    }
    let times = grass.times.in_ms();
    let of = |name| {
        times
            .iter()
            .find(|time| time.0 == name)
            .map_or(0.0, |time| time.1)
    };
    Run {
        poses,
        ms: (of("collide") + of("relax")) / f64::from(ticks),
        touched: touched as f64 / f64::from(ticks),
    }
}

/// A grid's point at shares of its width and height, on straight segments or on the smooth surface.
fn point(nodes: &[Vec<f64>], along: u32, at: [f64; 2], smooth: bool) -> Vec3<f64> {
    let taps = at.map(|share| {
        let x = share * f64::from(along - 1);
        let cell = (x.floor() as u32).min(along - 2);
        let t = x - f64::from(cell);
        if smooth {
            let tap = tap(along as usize, cell as usize, t);
            (tap.first, tap.place.map(f64::from).to_vec())
        } else {
            (cell, vec![1.0 - t, t])
        }
    });
    let [(left, columns), (low, rows)] = &taps;
    let mut sum = Vec3::ZERO;
    for (row, of_row) in (*low..along).zip(rows) {
        for (column, of_column) in (*left..along).zip(columns) {
            let node = &nodes[(row * along + column) as usize];
            sum += Vec3::new(node[0], node[1], node[2]) * (of_row * of_column);
        }
    }
    sum
}

/// Distances of a grid's surface from the finest grid's nodes: the root mean square, in mm.
fn apart_mm(nodes: &[Vec<f64>], along: u32, finest: &[Vec<f64>], smooth: bool) -> f64 {
    let last = FINEST - 1;
    let mut squares = 0.0;
    for row in 0..FINEST {
        for column in 0..FINEST {
            let at = [column, row].map(|n| f64::from(n) / f64::from(last));
            let own = &finest[(row * FINEST + column) as usize];
            let place = Vec3::new(own[0], own[1], own[2]);
            squares += (point(nodes, along, at, smooth) - place).length_squared();
        }
    }
    1e3 * (squares / f64::from(FINEST * FINEST)).sqrt()
}

/// Root mean square over billboards, and the median one.
fn of_all(mut apart: Vec<f64>) -> [f64; 2] {
    apart.sort_by(f64::total_cmp);
    let count = apart.len().max(1) as f64;
    let squares: f64 = apart.iter().map(|mm| mm * mm).sum();
    [
        (squares / count).sqrt(),
        apart.get(apart.len() / 2).copied().unwrap_or(0.0),
    ]
}

/// The nodes of a coarser grid that are nodes of the finest.
fn sampled(finest: &[Vec<f64>], along: u32) -> Vec<Vec<f64>> {
    let step = (FINEST - 1) / (along - 1);
    let places = (0..along * along).map(|n| ((n / along) * FINEST + n % along) * step);
    places.map(|place| finest[place as usize].clone()).collect()
}

#[test]
#[ignore = "a measurement"]
fn surfaces_beside_a_finer_grid() {
    let finest = run(FINEST);
    let mut table = String::from(
        "nodes,springs_ms,touched,straight_rms_mm,smooth_rms_mm,straight_median_mm,smooth_median_mm,\
         sampled_straight_rms_mm,sampled_smooth_rms_mm\n",
    );
    for along in 3..=FINEST {
        let coarse = run(along);
        let all = |smooth| {
            let both = (finest.poses.iter())
                .filter_map(|(key, fine)| Some((coarse.poses.get(key)?, fine)));
            of_all(
                both.map(|(nodes, fine)| apart_mm(nodes, along, fine, smooth))
                    .collect(),
            )
        };
        let nested = (FINEST - 1) % (along - 1) == 0;
        let from_finest = |smooth| {
            if !nested {
                return String::new();
            }
            let apart = (finest.poses.values())
                .map(|fine| apart_mm(&sampled(fine, along), along, fine, smooth));
            format!("{:.2}", of_all(apart.collect())[0])
        };
        let [straight, smooth] = [false, true].map(all);
        let _ = writeln!(
            table,
            "{along}x{along},{:.3},{:.1},{:.2},{:.2},{:.2},{:.2},{},{}",
            coarse.ms,
            coarse.touched,
            straight[0],
            smooth[0],
            straight[1],
            smooth[1],
            from_finest(false),
            from_finest(true),
        );
    }
    println!("{} touched billboards\n{table}", finest.poses.len());
}
