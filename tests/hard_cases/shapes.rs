//! Bodies that a coarse picture of their surface does not show: thin, long or hollow.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use libtest_mimic::Failed;
use sward::base::{Vec3, least, most};

use super::Measured;
use super::rig::{CALM, PlantKey, Rig, SECOND_TICKS, Setting, apart, ensure};

/// Share of the vertices that a body meets which may be deeper inside than its collider promises.
const MISSED_SHARE: f64 = 0.02;

/// A body that goes along x at 3 m/s and turns no further.
fn passing(shape: &str, rotation_deg: [f64; 3], y_m: f64, setting: &Setting) -> String {
    let at = |t: f64, x: f64| {
        let [a, b, c] = rotation_deg;
        format!(
            "(at_s: {t:?}, position_m: ({x:?}, {y_m:?}, 0), rotation_deg: ({a:?}, {b:?}, {c:?}))"
        )
    };
    let third = 1.0 / 3.0;
    // Between the second and the third way point the speed is even. It starts beyond the grass: a
    // blade that grows through a body has no right side of it.
    let way = [
        at(0.0, -3.5),
        at(third, -2.5),
        at(6.0 * third, 2.5),
        at(7.0 * third, 3.5),
    ];
    format!(
        "(duration_s: 2, terrain: (ground: Flat(size_m: (5, 4))), {CALM}, bodies: [
            (name: \"thing\", shape: {shape}, collider: {}, motion: Path(waypoints: [{}]))])",
        setting.collider(),
        way.join(", ")
    )
}

/// Vertices met and missed over a run, each counted once however long it was.
#[derive(Default)]
struct Met {
    /// Movable vertices that came nearer to the true shape than twice the skin, and those of them that
    /// were deeper in it than 1 mm at the end of a sub-step.
    near: BTreeSet<(PlantKey, usize)>,
    missed: BTreeSet<(PlantKey, usize)>,
    /// Vertices that went through the body, counted whenever one did.
    wrong_side: usize,
}

impl Met {
    fn share(&self) -> f64 {
        self.missed.len() as f64 / self.near.len().max(1) as f64
    }
}

/// Twice the skin.
const NEAR_M: f64 = 2e-3;
/// A vertex deeper than this is missed.
const MISSED_M: f64 = 1e-3;

/// How deep a point in the body's coordinates is in its true shape, in metres; negative outside, where
/// it need not be more than a bound of the distance.
type Depth<'a> = &'a dyn Fn(Vec3<f64>) -> f64;

/// So close to an edge a vertex may go round it within a sub-step, in metres: a segment, straight and
/// at most 0.42 m / 8 long, slips off the edge as a whole, and the body goes 25 mm.
const EDGE_M: f64 = 0.42 / 8.0 + 0.025;

/// How many nodes or segments of a plant went through a body since the sub-step before, from its nodes of now
/// in the body's coordinates.
type Crossed<'a> = &'a mut dyn FnMut(PlantKey, &[Vec3<f64>]) -> usize;

/// Where a vertex is relative to a plate across x.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Beside {
    /// Not over its faces: it may come from either side.
    Off,
    /// Between the planes of its faces.
    Within,
    Ahead,
    Behind,
}

fn beside(p: Vec3<f64>, half: [f64; 3]) -> Beside {
    let c = p.to_f64();
    if (1..3).any(|a| c[a].abs() >= half[a] - EDGE_M) {
        Beside::Off
    } else if c[0].abs() <= half[0] {
        Beside::Within
    } else if c[0] > 0.0 {
        Beside::Ahead
    } else {
        Beside::Behind
    }
}

/// The side each node of a plant was on last, since it came over the plate's faces.
type Sides = BTreeMap<PlantKey, Vec<Beside>>;

/// Nodes that were over one face of a plate and are over the other, however long they were within.
fn through_plate(sides: &mut Sides, key: PlantKey, now: &[Vec3<f64>], half: [f64; 3]) -> usize {
    let sides = sides
        .entry(key)
        .or_insert_with(|| vec![Beside::Off; now.len()]);
    let mut crossed = 0;
    for (side, &node) in sides.iter_mut().zip(now) {
        let seen = beside(node, half);
        let clear = |side| matches!(side, Beside::Ahead | Beside::Behind);
        crossed += usize::from(clear(*side) && clear(seen) && *side != seen);
        if seen != Beside::Within {
            *side = seen;
        }
    }
    crossed
}

/// Segments that swept over the axis of a rod along y. A rod has no two sides that a vertex could be
/// on, since a blade may slip off above and below; but to get through it a segment must pass over the
/// axis, and then the way round (from its lower node to its upper one, on with that, back and down
/// again) goes about the axis once.
fn through_rod(before: &[Vec3<f64>], now: &[Vec3<f64>], half_m: f64) -> usize {
    let along = |p: &Vec3<f64>| p.y.abs() < half_m - EDGE_M;
    let swept = (1..now.len()).filter(|&j| {
        let way = [before[j - 1], before[j], now[j], now[j - 1]];
        let turns = (0..4).map(|n| {
            let (a, b) = (way[n], way[(n + 1) % 4]);
            (a.z * b.x - a.x * b.z).atan2(a.x * b.x + a.z * b.z)
        });
        way.iter().all(along) && turns.sum::<f64>().abs() > PI
    });
    swept.count()
}

/// Runs a passing body of one part and counts.
fn pass_through(rig: &mut Rig, depth: Depth, crossed: Crossed, ticks: u32) -> Result<Met, Failed> {
    let mut met = Met::default();
    while rig.meadow.ticks < ticks {
        rig.tick()?;
        for (key, now) in in_the_body(rig)? {
            met.wrong_side += crossed(key, &now);
            for (vertex, &node) in now.iter().enumerate().skip(1) {
                let depth_m = depth(node);
                if depth_m > -NEAR_M {
                    met.near.insert((key, vertex));
                }
                if depth_m > MISSED_M {
                    met.missed.insert((key, vertex));
                }
            }
        }
    }
    Ok(met)
}

/// The nodes of every plant near the body, in the body's coordinates.
fn in_the_body(rig: &mut Rig) -> Result<BTreeMap<PlantKey, Vec<Vec3<f64>>>, Failed> {
    let plants = rig.look()?;
    let work = &rig.meadow.work;
    let mut found = BTreeMap::new();
    for tile in &work.tiles {
        let contacts = &work.contacts[tile.contacts.start as usize..tile.contacts.end as usize];
        let Some(contact) = contacts.first() else {
            continue;
        };
        for (key, plant) in plants.range((tile.tile, 0)..(tile.tile + 1, 0)) {
            let nodes = plant
                .nodes
                .iter()
                .map(|node| contact.to.inverse_point(*node));
            found.insert(*key, nodes.collect());
        }
    }
    Ok(found)
}

fn told(met: &Met, rig: &Rig) -> Measured {
    let text = format!(
        "{:.4} of {} vertices missed (limit {MISSED_SHARE}), {} on the wrong side, farther from an edge \
         than {EDGE_M} m, deepest node at {:.2} of its limit, strain {:.4}",
        met.share(),
        met.near.len(),
        met.wrong_side,
        rig.seen.depth_over_limit,
        rig.seen.strain
    );
    ensure(met.near.len() > 1000, || {
        format!("too little was touched: {text}")
    })?;
    ensure(met.wrong_side == 0, || format!("gone through: {text}"))?;
    ensure(met.share() <= MISSED_SHARE, || text.clone())?;
    rig.nothing_is_inside()?;
    Ok(text)
}

/// A plate 10 mm thick, tilted by 37°, at 3 m/s. The nearest texel misses nine vertices in ten
/// there, and a body that goes 25 mm in a sub-step passes over those it does not miss.
pub fn plate(setting: &Setting) -> Measured {
    let shape = "Box(size_m: (0.01, 0.5, 0.6))";
    let mut rig = setting.rig(&passing(shape, [0.0, 0.0, -37.0], 0.24, setting))?;
    let half = [0.005, 0.25, 0.3];
    let mut sides = Sides::new();
    let mut crossed = |key, now: &[_]| through_plate(&mut sides, key, now, half);
    let depth = |node: Vec3<f64>| {
        let [x, y, z] = node.to_f64();
        least(
            half[0] - x.abs(),
            least(half[1] - y.abs(), half[2] - z.abs()),
        )
    };
    let met = pass_through(&mut rig, &depth, &mut crossed, 7 * SECOND_TICKS / 3)?;
    told(&met, &rig)
}

/// A rod of 30 mm radius, 2 m long, drawn sideways through the grass at an angle. A texel of its
/// cube is as wide as the rod: plain bilinear sampling erases it.
pub fn rod(setting: &Setting) -> Measured {
    let shape = "Capsule(radius_m: 0.03, length_m: 1.94)";
    let mut rig = setting.rig(&passing(shape, [90.0, 20.0, 0.0], 0.15, setting))?;
    let mut before: BTreeMap<PlantKey, Vec<Vec3<f64>>> = BTreeMap::new();
    let mut crossed = |key, now: &[Vec3<f64>]| {
        let before = before.insert(key, now.to_vec());
        before.map_or(0, |before| through_rod(&before, now, 1.0))
    };
    let depth = |node: Vec3<f64>| {
        let [x, y, z] = node.to_f64();
        0.03 - x.hypot(z).hypot(most(y.abs() - 0.97, 0.0))
    };
    let met = pass_through(&mut rig, &depth, &mut crossed, 7 * SECOND_TICKS / 3)?;
    told(&met, &rig)
}

/// Rods thinner than a segment is long, at several heights and angles. A segment runs right through such a
/// rod, and is too short to take its end out on the far side: pushed that way alone, the end stays
/// inside by a sixth of the radius.
pub fn thin_rods(setting: &Setting) -> Measured {
    let rods = [
        ("Capsule(radius_m: 0.02, length_m: 0.8)", 0.2, -1.5, 0.0),
        ("Cylinder(radius_m: 0.02, height_m: 0.8)", 0.1, -0.5, 10.0),
        ("Capsule(radius_m: 0.015, length_m: 0.8)", 0.05, 0.5, 45.0),
        ("Capsule(radius_m: 0.025, length_m: 0.8)", 0.3, 1.5, -20.0),
    ];
    let body = |(shape, y, z, angle): (&str, f64, f64, f64)| {
        let at = |t: f64, x: f64| {
            format!(
                "(at_s: {t:?}, position_m: ({x:?}, {y:?}, {z:?}), rotation_deg: (90.0, {angle:?}, 0.0))"
            )
        };
        format!(
            "(name: \"rod {z}\", shape: {shape}, collider: {}, motion: Path(waypoints: [{}, {}]))",
            setting.collider(),
            at(0.0, -2.5),
            at(2.0, 2.5)
        )
    };
    let mut rig = setting.rig(&format!(
        "(duration_s: 2, terrain: (ground: Flat(size_m: (4, 4))), {CALM}, bodies: [{}])",
        rods.map(body).join(", ")
    ))?;
    rig.run_to(2 * SECOND_TICKS, 1)?;
    let seen = rig.seen;
    ensure(seen.pushed_nodes > 10_000, || {
        format!("only {} nodes of pushed plants", seen.pushed_nodes)
    })?;
    rig.nothing_is_inside()?;
    Ok(format!(
        "deepest node at {:.2} of its limit, strain {:.4}, {} nodes of pushed plants",
        seen.depth_over_limit, seen.strain, seen.pushed_nodes
    ))
}

/// Inner half width and inner height of the cup, and the thickness of its walls, in metres.
const CUP: [f64; 3] = [0.4, 0.55, 0.05];
/// Most that a blade in the cavity may be moved, in metres.
const CAVITY_M: f64 = 2e-3;

/// A cup put over the grass upside down, and tilted by 40°. Six depth faces around the whole body
/// see a solid block: everything in the cavity counts as inside.
pub fn cup(setting: &Setting) -> Measured {
    let mut told = Vec::new();
    for tilt_deg in [0.0_f64, 40.0] {
        let (moved_m, inside, outside) = cup_at(setting, tilt_deg)?;
        let text = format!(
            "{tilt_deg}°: {inside} blades in the cavity moved {moved_m:.1e} m at most, {outside} \
             others pushed"
        );
        ensure(inside > 30 && outside > 30 && moved_m <= CAVITY_M, || {
            text.clone()
        })?;
        told.push(text);
    }
    Ok(told.join("; "))
}

/// Largest move of a blade that stands free in the cavity, how many do, and how many others were
/// pushed.
fn cup_at(setting: &Setting, tilt_deg: f64) -> Result<(f64, usize, usize), Failed> {
    let [half, height, wall] = CUP;
    let side = |size: [f64; 3], at: [f64; 3]| {
        format!(
            "(shape: Box(size_m: ({:?}, {:?}, {:?})), position_m: ({:?}, {:?}, {:?}))",
            size[0], size[1], size[2], at[0], at[1], at[2]
        )
    };
    // The origin is the middle of the open end; walls overlap at the corners.
    let (width, middle) = (2.0 * (half + wall), 0.5 * height);
    let off = half + 0.5 * wall;
    let parts = [
        side([wall, height, width], [off, middle, 0.0]),
        side([wall, height, width], [-off, middle, 0.0]),
        side([width, height, wall], [0.0, middle, off]),
        side([width, height, wall], [0.0, middle, -off]),
        side([width, wall, width], [0.0, height + 0.5 * wall, 0.0]),
    ];
    // Tilted about z the lower edge of the rim is sunk into the ground, the other one stands free.
    let lift = (half + wall) * tilt_deg.to_radians().sin() * 0.5;
    let mut rig = setting.rig(&format!(
        "(duration_s: 2, terrain: (ground: Flat(size_m: (4, 4))), {CALM}, bodies: [
            (name: \"cup\", shape: Compound(parts: [{}]), position_m: (0.05, {lift:?}, -0.05),
             rotation_deg: (0, 0, {tilt_deg:?}), motion: Fixed, collider: {})])",
        parts.join(", "),
        setting.collider()
    ))?;
    rig.run_to(SECOND_TICKS / 2, 10)?;
    let cup = rig
        .meadow
        .bodies
        .info_of("cup")
        .ok_or("the cup is gone")?
        .pose;
    let mut moved_m = 0.0_f64;
    let (mut inside, mut outside) = (0, 0);
    for plant in rig.look()?.values() {
        let origin = Vec3::of(plant.origin);
        // A little more than the skin away from every wall, and from the plane of the rim up or
        // below it, where nothing is.
        let free = plant.wind.iter().all(|&node| {
            let [x, y, z] = cup.inverse_point(origin + Vec3::of(node.to_f64())).to_f64();
            x.abs() < half - 0.005 && z.abs() < half - 0.005 && y < height - 0.005
        });
        let far = apart(&plant.nodes, &plant.wind);
        if free {
            inside += 1;
            moved_m = moved_m.max(far);
        } else if far > CAVITY_M {
            outside += 1;
        }
    }
    Ok((moved_m, inside, outside))
}
