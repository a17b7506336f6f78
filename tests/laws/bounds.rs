//! Broad phase: nothing that may touch a plant is left out of a tile's list.

use sward::base::philox::{Pcg, unit};
use sward::base::{Pose, Quat, Vec3};
use sward::sim::Meadow;
use sward::sim::contact::Touch;
use sward::sim::fault::Planted;
use sward::sim::work::{Mover, Work};

use super::{meadow, scene};

const LENGTH_M: f64 = 0.3;

fn random(seed: u32) -> impl FnMut(f64) -> f64 {
    let mut words = Pcg::from_words([seed, 7]);
    move |size| (2.0 * f64::from(unit(words.next_word())) - 1.0) * size
}

fn turned(random: &mut impl FnMut(f64) -> f64) -> Pose<f64> {
    let axis = Vec3::of([random(1.0), random(1.0), random(1.0)]).unit_or(Vec3::UP);
    let half_angle = random(3.0);
    let (sin, cos) = (half_angle.sin(), half_angle.cos());
    Pose {
        turn: Quat {
            v: axis * sin,
            w: cos,
        },
        place: Vec3::of([random(2.0), random(2.0), random(2.0)]),
    }
}

/// A thin board, whose parts are known after its first move.
fn meadow_with_a_board() -> Meadow {
    let mut meadow = meadow(&scene(
        r#"(
            duration_s: 1,
            terrain: (ground: Flat(size_m: (8, 8))),
            bodies: [(name: "board", shape: Box(size_m: (0.04, 1.2, 0.1)), position_m: (0, 2, 0))],
        )"#,
    ));
    meadow.move_bodies();
    meadow
}

/// Seen from outside, because the optimiser once left corners out in some builds of the library and
/// not in others.
#[test]
fn the_bounds_of_a_turning_body_hold_its_corners() {
    let meadow = meadow_with_a_board();
    let shape = &meadow.bodies.shapes()[0];
    let [low, high] = shape.parts[0].bounds_m;
    for seed in 0..1000 {
        let mut random = random(seed);
        let mut link = meadow.bodies.links()[0].clone();
        (link.from, link.to) = (turned(&mut random), turned(&mut random));
        let swept = Mover::new(&link, 0, shape, &meadow.scene.solver, LENGTH_M).bounds;
        for pose in [link.from, link.to] {
            for corner in 0..8_u32 {
                let local = [0, 1, 2].map(|a| [low[a], high[a]][(corner >> a & 1) as usize]);
                let p = pose.point(Vec3::of(local)).to_f64();
                let inside = (0..3).all(|a| swept.low[a] <= p[a] && p[a] <= swept.high[a]);
                assert!(inside, "corner {corner}: {p:?} is outside {swept:?}");
            }
        }
    }
}

/// A plant takes its sweeps from every part that reaches it, so each of these must be on the list
/// of the plant's tile, however small that is.
#[test]
fn ball_bounds_hold_every_plant_that_a_part_reaches() {
    let meadow = meadow_with_a_board();
    let shape = &meadow.bodies.shapes()[0];
    let grown = &meadow.parts.parts[0].grown;
    let anchor = meadow.field.grid.anchor_of(0, &meadow.field.ground);
    let origin = meadow
        .field
        .grid
        .anchor_in_world(&anchor, &meadow.field.ground);
    let mut reached = 0;
    for seed in 0..2000 {
        let mut random = random(seed);
        let mut link = meadow.bodies.links()[0].clone();
        (link.from, link.to) = (turned(&mut random), turned(&mut random));
        let mover = Mover::new(&link, 0, shape, &meadow.scene.solver, LENGTH_M);
        let around = mover.ball_bounds(&meadow.parts).grown(LENGTH_M);
        let mut work = Work::default();
        work.add_contacts(
            &meadow.field,
            &meadow.parts,
            &meadow.scene.solver,
            &anchor,
            &[&mover],
            Planted::NONE,
        );
        let touch = Touch::new(0, &work.contacts[0], &meadow.parts.parts[0], grown);
        for _ in 0..20 {
            let root = [random(3.0), random(3.0), random(3.0)];
            let in_anchor = Vec3::of(root) - Vec3::<f64>::of(origin);
            if touch.reaches(Vec3::of(in_anchor.to_f64()), LENGTH_M as f32) {
                reached += 1;
                let inside = (0..3).all(|a| around.low[a] <= root[a] && root[a] <= around.high[a]);
                assert!(inside, "{root:?} is outside {around:?}");
            }
        }
    }
    assert!(reached > 1000, "{reached} roots in reach");
}
