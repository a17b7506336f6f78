//! Bodies of several parts that are not convex, moving: their inner corners, where the way out of one part
//! leads into its neighbour.

use sward::run::Device;

use super::Measured;
use super::rig::{CALM, Setting, ensure};

/// A body by its parts: their sizes and middles, in metres.
struct Hollow {
    name: &'static str,
    parts: &'static [([f64; 3], [f64; 3])],
}

const BODIES: [Hollow; 4] = [
    // Two prongs before a bar; they overlap by 20 mm.
    Hollow {
        name: "fork",
        parts: &[
            ([0.5, 0.2, 0.14], [0.0, 0.0, -0.22]),
            ([0.5, 0.2, 0.14], [0.0, 0.0, 0.22]),
            ([0.14, 0.2, 0.58], [-0.3, 0.0, 0.0]),
        ],
    },
    // A channel that is open below; walls meet without overlap.
    Hollow {
        name: "channel",
        parts: &[
            ([0.6, 0.2, 0.08], [0.0, 0.0, -0.2]),
            ([0.6, 0.2, 0.08], [0.0, 0.0, 0.2]),
            ([0.6, 0.08, 0.48], [0.0, 0.14, 0.0]),
        ],
    },
    // Two bars through each other: four inner corners.
    Hollow {
        name: "cross",
        parts: &[
            ([0.6, 0.2, 0.12], [0.0, 0.0, 0.0]),
            ([0.12, 0.2, 0.6], [0.0, 0.0, 0.0]),
        ],
    },
    // A step: a low block behind which a high one stands.
    Hollow {
        name: "step",
        parts: &[
            ([0.4, 0.1, 0.4], [0.1, -0.05, 0.0]),
            ([0.2, 0.3, 0.4], [-0.2, 0.05, 0.0]),
        ],
    },
];

/// Waypoints of a body, given the height of its middle where it stands.
type Way = fn(f64) -> String;

/// Ways through the grass, for a body whose middle is `rest` above the ground when it stands.
const WAYS: [(&str, Way); 3] = [
    ("pushed", |rest| {
        format!(
            "(at_s: 0, position_m: (-0.6, {rest}, 0.1)), (at_s: 1.2, position_m: (0.6, {rest}, 0.1))"
        )
    }),
    ("pushed and turned", |rest| {
        format!(
            "(at_s: 0, position_m: (-0.5, {rest}, 0.1)), \
             (at_s: 0.6, position_m: (0, {rest}, 0.1), rotation_deg: (0, 100, 0)), \
             (at_s: 1.2, position_m: (0.5, {rest}, 0.1), rotation_deg: (0, 200, 0))"
        )
    }),
    ("let down and lifted", |rest| {
        format!(
            "(at_s: 0, position_m: (0, 0.8, 0.1), rotation_deg: (0, 30, 0)), \
             (at_s: 0.6, position_m: (0, {rest}, 0.1), rotation_deg: (0, 30, 0)), \
             (at_s: 1.2, position_m: (0, 0.8, 0.1), rotation_deg: (0, 30, 0))"
        )
    }),
];

/// Sub-steps in which a body moves.
const MOTION_TICKS: u32 = 144;
/// Sub-steps from one look at the grass to the next on the processor, and on a device, whose state has to be
/// read for each.
const LOOK_TICKS: [u32; 2] = [2, 12];
/// Ways that a device runs: the rest is left to the comparison of engines, which has the fork.
const WAYS_OF_A_DEVICE: std::ops::Range<usize> = 1..2;
/// Largest strain while a body is in the way.
const STRAIN: f64 = 0.02;

/// A fork, a channel, a cross and a step, pushed, turned, and let down on the grass. A method that asks part
/// after part leaves blades in the corners, where each part pushes them into the other.
pub fn moving(setting: &Setting) -> Measured {
    let (ways, look_ticks) = match setting.device {
        Device::Graphics(..) => (&WAYS[WAYS_OF_A_DEVICE], LOOK_TICKS[1]),
        Device::Processor | Device::Reference => (&WAYS[..], LOOK_TICKS[0]),
    };
    let mut worst = (0.0, String::new());
    let (mut strain, mut pushed, mut failed) = (0.0_f64, 0_u64, Vec::new());
    for body in &BODIES {
        for &(way, waypoints) in ways {
            let mut rig = setting.rig(&scene(setting, body, waypoints))?;
            rig.run_to(MOTION_TICKS, look_ticks)?;
            let what = format!("{} {way}", body.name);
            if rig.seen.depth_over_limit > worst.0 {
                worst = (rig.seen.depth_over_limit, what.clone());
            }
            strain = strain.max(rig.seen.strain);
            pushed += rig.seen.pushed_nodes;
            if rig.seen.depth_over_limit > 1.0 {
                let depth_mm = 1e3 * rig.seen.depth_m;
                failed.push(format!("{what}: {depth_mm:.1} mm"));
            }
        }
    }
    let text = format!(
        "deepest node at {:.2} of its limit ({}), strain {strain:.1e} (limit {STRAIN}), {pushed} nodes of pushed plants",
        worst.0, worst.1
    );
    ensure(failed.is_empty(), || {
        format!("{text}; beyond it: {}", failed.join(", "))
    })?;
    ensure(strain <= STRAIN && pushed > 10_000, || text.clone())?;
    Ok(text)
}

fn scene(setting: &Setting, body: &Hollow, waypoints: fn(f64) -> String) -> String {
    let lowest = body.parts.iter().map(|(size, at)| at[1] - 0.5 * size[1]);
    // A millimetre above the ground, so that nothing but the skin is pinched.
    let rest = 0.001 - lowest.fold(0.0, f64::min);
    let parts = body.parts.iter().map(|(size, at)| {
        let ([x, y, z], [a, b, c]) = (size, at);
        format!("(shape: Box(size_m: ({x:?}, {y:?}, {z:?})), position_m: ({a:?}, {b:?}, {c:?}))")
    });
    format!(
        "(duration_s: 3, terrain: (ground: Flat(size_m: (4, 2))), {CALM}, bodies: [
            (name: \"hollow\", shape: Compound(parts: [{}]), collider: {},
             motion: Path(waypoints: [{}]))])",
        parts.collect::<Vec<_>>().join(", "),
        setting.collider(),
        waypoints(rest)
    )
}
