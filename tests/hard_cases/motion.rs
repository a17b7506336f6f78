//! A ball that rolls or flies, at every displayed rate, and beside the reference engine.

use std::collections::BTreeMap;

use libtest_mimic::Failed;
use sward::run::against::{Against, Difference};
use sward::run::swept::{BENT_M, Swept};
use sward::run::{Device, Timeline};
use sward::sim::measure::Standing;

use super::Measured;
use super::rig::{CALM, PlantKey, Rig, Setting, apart, ensure, parse};

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
        let mut first: Option<BTreeMap<PlantKey, Standing<f64>>> = None;
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
) -> Result<BTreeMap<PlantKey, Standing<f64>>, Failed> {
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

/// Most by which poses may differ from the reference's at a sub-step, as a root mean square over
/// touched plants on the same side of the body, in metres.
const RMS_LIMIT: (f64, f64) = (1.0 / 120.0, 0.010);
/// The same at a fine sub-step.
const FINE_RMS_LIMIT: (f64, f64) = (1.0 / 480.0, 0.003);
/// Share of the touched plants that may end on another side of the body.
const FLIPPED_SHARE: f64 = 0.01;

/// The rolled track beside the reference engine's. A method that pushes blades to the nearest side
/// of wherever the body is at the end of a frame lays them the other way.
pub fn roll_reference(setting: &Setting) -> Measured {
    rolled(setting, RMS_LIMIT)
}

/// The same at a sub-step of 1/480 s.
pub fn roll_reference_fine(setting: &Setting) -> Measured {
    rolled(setting, FINE_RMS_LIMIT)
}

fn rolled(setting: &Setting, (substep_s, limit_m): (f64, f64)) -> Measured {
    let mut told = Vec::new();
    let mut holds = true;
    for speed in [1.0, 3.0] {
        let found = beside_reference(setting, speed, substep_s)?;
        let flips = found.side_flips as f64 / found.touched_plants.max(1) as f64;
        holds &= found.pose_rms_m <= limit_m && flips <= FLIPPED_SHARE;
        ensure(found.touched_plants > 100, || {
            "too few plants were touched".into()
        })?;
        told.push(format!(
            "{speed} m/s at 1/{:.0} s: rms {:.2} mm (limit {:.0}), {} of {} plants on another \
             side ({flips:.4}, limit {FLIPPED_SHARE}) at {:.2?}",
            1.0 / substep_s,
            found.pose_rms_m * 1e3,
            limit_m * 1e3,
            found.side_flips,
            found.touched_plants,
            found.flipped_roots_m
        ));
    }
    let text = told.join("; ");
    ensure(holds, || text.clone())?;
    Ok(text)
}

fn beside_reference(setting: &Setting, speed: f64, substep_s: f64) -> Result<Difference, Failed> {
    let mut rig = setting.rig(&rolling(setting, speed, substep_s))?;
    let truth = parse(&rolling(setting, speed, 1.0 / 480.0))?;
    let truth = Rig::new(&Device::Reference, truth)?;
    let mut against = Against::new(truth.meadow, truth.engine);
    let mut timeline = Timeline::unlimited(substep_s);
    for _ in 0..(ROLLED_S * 30.0).round() as u32 {
        let due = timeline.advance(1.0 / 30.0);
        rig.ticks(due)?;
        against.catch_up(rig.meadow.time_s())?;
        against.frame(&rig.meadow, &mut rig.engine)?;
    }
    Ok(against.finish())
}

/// Overlap with the reference's imprint, share of the swept plants that are bent, strain.
const BULLET: [f64; 3] = [0.95, 0.99, 0.03];

/// A ball at 10, 30, 100 and 400 m/s. At 60 Hz it goes 6.7 m per frame: a method that looks only at
/// its places at the ends of frames presses a row of separate dents, and stretches what it meets
/// fivefold.
pub fn bullet(setting: &Setting) -> Measured {
    let mut told = Vec::new();
    let mut holds = true;
    for speed in [10.0, 30.0, 100.0, 400.0] {
        let [overlap, bent, strain] = shot(setting, speed)?;
        holds &= overlap >= BULLET[0] && bent >= BULLET[1] && strain <= BULLET[2];
        told.push(format!(
            "{speed} m/s: overlap {overlap:.4}, {bent:.4} of the swept plants bent, strain {strain:.4}"
        ));
    }
    let text = format!("{} (limits {BULLET:?})", told.join("; "));
    ensure(holds, || text.clone())?;
    Ok(text)
}

fn shot(setting: &Setting, speed: f64) -> Result<[f64; 3], Failed> {
    let at = |t: f64, x: f64| format!("(at_s: {t:?}, position_m: ({x:?}, 0.15, 0))");
    let way = [
        at(0.0, -5.0),
        at(1.0 / speed, -4.0),
        at(9.0 / speed, 4.0),
        at(10.0 / speed, 5.0),
    ];
    let text = format!(
        "(duration_s: 3, terrain: (ground: Flat(size_m: (6, 2))), {CALM}, bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.15), collider: {},
             motion: Path(waypoints: [{}]))])",
        setting.collider(),
        way.join(", ")
    );
    let mut rig = setting.rig(&text)?;
    let truth = parse(&text)?;
    let truth = Rig::new(&Device::Reference, truth)?;
    let mut against = Against::new(truth.meadow, truth.engine);
    let body = rig.meadow.bodies.id_of("ball").ok_or("no ball")?;
    let mut swept = Swept::default();
    let last = (120.0 * 10.0 / speed) as u32 + 12;
    while rig.meadow.ticks < last {
        rig.tick()?;
        swept.tick(&rig.meadow, body);
        rig.look()?;
        against.catch_up(rig.meadow.time_s())?;
        if rig.meadow.ticks.is_multiple_of(2) {
            against.frame(&rig.meadow, &mut rig.engine)?;
        }
    }
    let ticks = rig.meadow.recovery_ticks();
    let bent = rig.engine.bent(&rig.meadow, body, ticks, BENT_M)?;
    let swept = swept.since(rig.meadow.ticks, ticks);
    ensure(swept.len() > 50, || {
        format!("only {} plants were swept", swept.len())
    })?;
    let share = swept.intersection(&bent).count() as f64 / swept.len() as f64;
    let overlap = against.finish().imprint_iou.unwrap_or(0.0);
    rig.nothing_is_inside()?;
    Ok([overlap, share, rig.seen.strain])
}
