//! Bodies that lie still: the grass under them does not creep.

use std::collections::BTreeMap;

use libtest_mimic::Failed;
use sward::scene::Collider;

use super::Measured;
use super::rig::{CALM, FRAME_TICKS, PlantKey, Rig, SECOND_TICKS, Setting, apart, ensure};

/// A plant at rest under a body moves no more than this per displayed frame, in metres.
const REST_M_PER_FRAME: f64 = 1e-5;
/// Largest relative change of a segment's length while a body lies still.
const REST_STRAIN: f64 = 0.02;
/// Depth that a closed form may leave in `rest`, in metres.
const REST_DEPTH_M: f64 = 1e-4;

fn ball_scene(setting: &Setting, place: &str, motion: &str) -> String {
    scene(setting, &[("Ball(radius_m: 0.15)", place, motion)])
}

/// A calm meadow with bodies of a shape, a place with whatever else they say, and a motion each.
fn scene(setting: &Setting, bodies: &[(&str, &str, &str)]) -> String {
    let bodies = bodies.iter().enumerate().map(|(n, (shape, place, motion))| {
        format!(
            "(name: \"body {n}\", shape: {shape}, position_m: {place}, motion: {motion}, collider: {})",
            setting.collider()
        )
    });
    format!(
        "(duration_s: 20, terrain: (ground: Flat(size_m: (4, 3))), {CALM}, bodies: [{}])",
        bodies.collect::<Vec<_>>().join(", ")
    )
}

/// Ten seconds of a ball laid into the grass. A method that pushes out and then restores lengths
/// leaves the blades inside by turns and creeps for ever.
pub fn rest_laid(setting: &Setting) -> Measured {
    rest(setting, &ball_scene(setting, "(0.1, 0.15, -0.05)", "Free"))
}

/// Dropped from twice its radius. Recovery starts anew after every bounce, so blades that are held
/// only by turns sink in and are pushed out again.
pub fn rest_dropped(setting: &Setting) -> Measured {
    rest(setting, &ball_scene(setting, "(-0.3, 0.45, 0.2)", "Free"))
}

/// Rolled in at 1 m/s and stopped. Blades that were overrun lie in a heap, which a solver of few
/// rounds never quite sorts out.
pub fn rest_rolled(setting: &Setting) -> Measured {
    let way = "Path(waypoints: [(at_s: 0, position_m: (-0.8, 0.15, 0)),
        (at_s: 0.8, position_m: (0, 0.15, 0), rotation_deg: (0, 0, -305)),
        (at_s: 1, position_m: (0.1, 0.15, 0), rotation_deg: (0, 0, -344))])";
    rest(setting, &ball_scene(setting, "(-0.8, 0.15, 0)", way))
}

/// A box and a cylinder, pushed in upright at 0.85 m/s and stopped, their blades pressed head on and
/// wrapped around the box's edge. A node that was put onto the surface is inside or outside of it by
/// a rounding: a method that pushes it whenever it is inside creeps by 0.3 mm in a sub-step.
pub fn rest_pushed(setting: &Setting) -> Measured {
    let way = |z: f64| {
        format!(
            "Path(waypoints: [(at_s: 0, position_m: (-1, 0.151, {z})),
            (at_s: 1, position_m: (-0.15, 0.151, {z})), (at_s: 1.1, position_m: (-0.15, 0.151, {z}))])"
        )
    };
    let bodies = [
        (
            "Box(size_m: (0.3, 0.3, 0.4))",
            "(-1, 0.151, 0.5)",
            &*way(0.5),
        ),
        (
            "Cylinder(radius_m: 0.15, height_m: 0.3)",
            "(-1, 0.151, -0.5)",
            &*way(-0.5),
        ),
    ];
    rest(setting, &scene(setting, &bodies))
}

/// Two boxes a hand's breadth apart, put into standing grass: what one pushes out the other pushes
/// back.
pub fn rest_between(setting: &Setting) -> Measured {
    let shape = "Box(size_m: (0.2, 0.4, 0.6))";
    let bodies = [
        (shape, "(-0.12, 0.2, 0)", "Fixed"),
        (shape, "(0.12, 0.2, 0)", "Fixed"),
    ];
    rest(setting, &scene(setting, &bodies))
}

/// Every kind of convex body, dropped askew.
pub fn rest_shapes(setting: &Setting) -> Measured {
    let bodies = [
        (
            "Box(size_m: (0.3, 0.2, 0.25))",
            "(-1.2, 0.5, -0.6), rotation_deg: (20, 30, 10)",
            "Free",
        ),
        (
            "Capsule(radius_m: 0.1, length_m: 0.3)",
            "(1.2, 0.5, -0.6), rotation_deg: (80, 0, 20)",
            "Free",
        ),
        (
            "Cylinder(radius_m: 0.12, height_m: 0.25)",
            "(-1.2, 0.5, 0.6), rotation_deg: (15, 0, 10)",
            "Free",
        ),
        (
            "Compound(parts: [(shape: Box(size_m: (0.5, 0.06, 0.06))), (shape: Box(size_m: (0.06, 0.06, 0.5)))])",
            "(1.2, 0.5, 0.6), rotation_deg: (10, 20, 0)",
            "Free",
        ),
    ];
    rest(setting, &scene(setting, &bodies))
}

/// Runs until 10 s after the bodies stopped and measures from the second second on: every plant that
/// the body still touches, and once all others have recovered, every plant.
fn rest(setting: &Setting, scene: &str) -> Measured {
    let mut rig = setting.rig(scene)?;
    let stopped = run_until_still(&mut rig)?;
    let settled = stopped + SECOND_TICKS;
    rig.run_to(settled, FRAME_TICKS)?;
    rig.seen = Default::default();
    let recovered = settled + rig.meadow.recovery_ticks();
    let mut before = rig.look()?;
    let (mut largest_m, mut compared) = (0.0_f64, 0_u32);
    let mut restless: BTreeMap<PlantKey, f64> = BTreeMap::new();
    while rig.meadow.ticks < stopped + 10 * SECOND_TICKS {
        rig.ticks(FRAME_TICKS)?;
        let now = rig.look()?;
        for (key, plant) in &now {
            let Some(old) = before.get(key) else {
                continue;
            };
            if old.touched_at < settled && rig.meadow.ticks <= recovered {
                continue;
            }
            let moved = apart(&plant.nodes, &old.nodes);
            compared += 1;
            largest_m = largest_m.max(moved);
            if moved > REST_M_PER_FRAME {
                let most = restless.entry(*key).or_default();
                *most = most.max(moved);
            }
        }
        before = now;
    }
    let depth_m = rig.seen.depth_m;
    let strain = rig.seen.strain;
    let text = format!(
        "{largest_m:.1e} m per frame (limit {REST_M_PER_FRAME:.0e}), strain {strain:.4} (limit \
         {REST_STRAIN}), {depth_m:.1e} m deep, {} of {} plants restless",
        restless.len(),
        before.len(),
    );
    ensure(compared > 1000, || {
        format!("only {compared} plants seen at rest")
    })?;
    let shallow = setting.collider != Collider::Analytic || depth_m <= REST_DEPTH_M;
    ensure(strain <= REST_STRAIN, || format!("strained: {text}"))?;
    ensure(shallow, || format!("sunk in: {text}"))?;
    ensure(largest_m <= REST_M_PER_FRAME, || {
        format!("restless: {text}")
    })?;
    rig.nothing_is_inside()?;
    Ok(text)
}

/// Runs until no body has moved for a tenth of a second, and gives the tick since which they stand.
fn run_until_still(rig: &mut Rig) -> Result<u32, Failed> {
    let mut still = 0;
    while still < SECOND_TICKS / 10 {
        rig.tick()?;
        let links = rig.meadow.bodies.links();
        let moves = links.iter().any(|link| link.from != link.to);
        still = if moves { 0 } else { still + 1 };
        ensure(rig.meadow.ticks < 20 * SECOND_TICKS, || {
            "the bodies do not come to rest within 20 s".into()
        })?;
    }
    Ok(rig.meadow.ticks - still)
}
