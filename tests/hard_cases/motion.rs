//! A ball that rolls, at every displayed rate.

use std::collections::BTreeMap;

use libtest_mimic::Failed;
use sward::run::Timeline;
use sward::sim::measure::Standing;

use super::Measured;
use super::rig::{CALM, PlantKey, Rig, Setting, apart, ensure};

/// Displayed frames per second.
const RATES_HZ: [f64; 4] = [120.0, 60.0, 30.0, 15.0];
/// Most by which a pose may differ between two rates, in metres.
const RATES_LIMIT_M: f64 = 1e-5;
/// The ball is rolled for so long: a whole number of frames at every rate, in seconds.
const ROLLED_S: f64 = 1.2;

/// A ball that rolls along x at an even speed, from 1 m before the middle of the way.
pub fn rolling(setting: &Setting, speed_m_per_s: f64, substep_s: f64) -> String {
    // It is up to speed at the second way point, half a metre from the start.
    let reach = 0.6 * speed_m_per_s;
    let turn = |x: f64| -(x / 0.15).to_degrees();
    let at = |t: f64, x: f64| {
        format!(
            "(at_s: {t:?}, position_m: ({x:?}, 0.15, 0), rotation_deg: (0, 0, {:?}))",
            turn(x)
        )
    };
    let run_up = 0.5 / speed_m_per_s;
    let way = [
        at(0.0, -reach - 0.5),
        at(run_up, -reach),
        at(run_up + 1.2, reach),
        at(2.0 * run_up + 1.2, reach + 0.5),
    ];
    format!(
        "(duration_s: 2, terrain: (ground: Flat(size_m: ({:?}, 2))), {CALM}, bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.15), collider: {},
             motion: Path(waypoints: [{}]))],
          solver: (substep_s: {substep_s:?}))",
        (2.0 * reach + 3.0).ceil(),
        setting.collider(),
        way.join(", ")
    )
}

/// Rolled at 1 and 3 m/s and displayed at 15, 30, 60 and 120 Hz. A method whose sub-step is the
/// displayed frame leaves another track at every rate.
pub fn roll_rates(setting: &Setting) -> Measured {
    let mut told = Vec::new();
    for speed in [1.0, 3.0] {
        let mut first: Option<BTreeMap<PlantKey, Standing<f32>>> = None;
        let mut worst_m = 0.0_f64;
        for hz in RATES_HZ {
            let plants = displayed(setting, speed, hz)?;
            let Some(wanted) = &first else {
                first = Some(plants);
                continue;
            };
            ensure(plants.len() == wanted.len(), || {
                format!("{hz} Hz: other tiles are active")
            })?;
            for (key, plant) in wanted {
                let other = plants
                    .get(key)
                    .map_or(f64::INFINITY, |o| apart(&o.nodes, &plant.nodes));
                worst_m = worst_m.max(other);
            }
        }
        let bent = first
            .iter()
            .flat_map(BTreeMap::values)
            .filter(|p| p.offset_m() > 0.02)
            .count();
        let text = format!("{speed} m/s: {worst_m:.1e} m apart (limit {RATES_LIMIT_M:.0e})");
        ensure(bent > 50 && worst_m <= RATES_LIMIT_M, || {
            format!("{text}, {bent} plants bent")
        })?;
        told.push(text);
    }
    Ok(told.join("; "))
}

fn displayed(
    setting: &Setting,
    speed: f64,
    hz: f64,
) -> Result<BTreeMap<PlantKey, Standing<f32>>, Failed> {
    let mut rig = setting.rig(&rolling(setting, speed, 1.0 / 120.0))?;
    run_at(&mut rig, hz)?;
    rig.nothing_is_inside()?;
    rig.plants()
}

fn run_at(rig: &mut Rig, hz: f64) -> Result<(), Failed> {
    let mut timeline = Timeline::unlimited(rig.meadow.scene.solver.substep_s);
    for _ in 0..(ROLLED_S * hz).round() as u32 {
        let due = timeline.advance(1.0 / hz);
        rig.ticks(due)?;
        rig.look()?;
    }
    Ok(())
}
