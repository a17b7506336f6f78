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

/// How a billboard is: pressed by one of the bodies, or on its way back.
const GROUPS: [&str; 4] = ["ball", "post", "box", "recovering"];

/// Places of every bent billboard's nodes, at some sub-steps, by group.
type Poses = BTreeMap<(usize, u32, TileId, u32), Vec<Vec<f64>>>;

/// The group of a billboard, from its place across the bodies' ways and its last contact.
fn group_of(z_m: f64, age: u32) -> Option<usize> {
    match age {
        0 => Some(((z_m + 3.0) / 2.0).clamp(0.0, 2.0) as usize),
        1..=160 => Some(3),
        _ => None,
    }
}

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
        if now % 30 != 0 {
            continue;
        }
        for tile in &meadow.work.tiles {
            let Some(slab) = grass.billboards().slab(tile.slab) else {
                continue;
            };
            for board in standing_billboards(&meadow, tile, slab) {
                let [_, z_m] = board.root_in_world();
                let group = (board.touched_at > 0).then(|| group_of(z_m, now - board.touched_at));
                if let Some(group) = group.flatten() {
                    let places = board.nodes.iter().map(|node| node.to_f64().to_vec());
                    poses.insert((group, now, tile.tile, board.place), places.collect());
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

/// Errors of a group: against the finest run, of straight segments and smooth; and of the finest run's own
/// nodes, sampled as the coarser grid has them. Root mean squares and medians of each.
fn errors(group: usize, along: u32, coarse: &Poses, finest: &Poses) -> (usize, [[f64; 2]; 4]) {
    let of_group = || finest.iter().filter(|(key, _)| key.0 == group);
    let of_run = |smooth| {
        let both = of_group().filter_map(|(key, fine)| Some((coarse.get(key)?, fine)));
        of_all(
            both.map(|(nodes, fine)| apart_mm(nodes, along, fine, smooth))
                .collect(),
        )
    };
    let of_samples = |smooth| {
        if !(FINEST - 1).is_multiple_of(along - 1) {
            return [f64::NAN; 2];
        }
        let all = of_group().map(|(_, fine)| apart_mm(&sampled(fine, along), along, fine, smooth));
        of_all(all.collect())
    };
    let count = of_group()
        .filter(|(key, _)| coarse.contains_key(*key))
        .count();
    let all = [
        of_run(false),
        of_run(true),
        of_samples(false),
        of_samples(true),
    ];
    (count, all)
}

#[test]
#[ignore = "a measurement"]
fn surfaces_beside_a_finer_grid() {
    let finest = run(FINEST);
    let mut table = String::from("group,nodes,billboards,collide_and_relax_ms,touched");
    for of in ["run", "sampled"] {
        for form in ["straight", "smooth"] {
            let _ = write!(table, ",{of}_{form}_rms_mm,{of}_{form}_median_mm");
        }
    }
    table.push('\n');
    for along in [3, 4, 5, 7, FINEST] {
        let coarse = run(along);
        for (group, name) in GROUPS.into_iter().enumerate() {
            let (count, all) = errors(group, along, &coarse.poses, &finest.poses);
            let (ms, touched) = (coarse.ms, coarse.touched);
            let _ = write!(table, "{name},{along}x{along},{count},{ms:.3},{touched:.1}");
            for mm in all.as_flattened() {
                let text = if mm.is_nan() {
                    String::new()
                } else {
                    format!("{mm:.2}")
                };
                let _ = write!(table, ",{text}");
            }
            table.push('\n');
        }
    }
    println!("{table}");
}
