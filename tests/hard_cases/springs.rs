//! Springs and lengths of the blade engine itself, from poses that no contact leaves: the states are
//! made by hand and given to the running engine.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_2;

use libtest_mimic::Failed;
use sward::base::philox::philox2x32;
use sward::base::{Vec3, vec3};
use sward::field::wind_pose;
use sward::sim::Meadow;
use sward::sim::measure::{GrassState, Standing};
use sward::sim::slab::Slab;

use super::Measured;
use super::recovery::{held_down, let_go, segment, shown};
use super::rig::{CALM, FRAME_TICKS, Handmade, PlantKey, Rig, Setting, all_in_wind_pose, ensure};

/// Turns the nodes of a wind pose into those of a start; `plant` is a number of its own.
type Start = fn(wind: &[Vec3<f64>], plant: u32) -> Vec<Vec3<f64>>;

/// The starts of the row, and a tangle.
const STARTS: [(&str, Start); 6] = [
    ("tip pulled to 3 L", tip_pulled),
    ("all at the root", |wind, _| vec![wind[0]; wind.len()]),
    ("all at one point", |wind, _| {
        let point = (wind[0] + wind[wind.len() - 1]) * 0.5;
        let mut nodes = vec![point; wind.len()];
        nodes[0] = wind[0];
        nodes
    }),
    ("mirrored", |wind, _| {
        wind.iter().map(|&node| wind[0] * 2.0 - node).collect()
    }),
    ("thrown about", thrown_about),
    ("every other node at the root", |wind, _| {
        let place = |(j, &node)| if j % 2 == 0 { wind[0] } else { node };
        wind.iter().enumerate().map(place).collect()
    }),
];

fn tip_pulled(wind: &[Vec3<f64>], _: u32) -> Vec<Vec3<f64>> {
    let mut nodes = wind.to_vec();
    let tip = wind.len() - 1;
    nodes[tip] = wind[0] + (wind[tip] - wind[0]) * 3.0;
    nodes
}

/// Every node anywhere in a ball of the blade's length about its root.
fn thrown_about(wind: &[Vec3<f64>], plant: u32) -> Vec<Vec3<f64>> {
    let length = (wind[wind.len() - 1] - wind[0]).length();
    let mut nodes = wind.to_vec();
    for (j, node) in nodes.iter_mut().enumerate().skip(1) {
        let draw = |axis: u32| {
            let word = philox2x32([3 * j as u32 + axis, plant], 5, 10)[0];
            2.0 * f64::from(word) / f64::from(u32::MAX) - 1.0
        };
        let aside = vec3(draw(0), draw(1), draw(2));
        *node = wind[0] + aside * (length / aside.length().max(1.0));
    }
    nodes
}

/// Every plant of the active tiles in a start, as if a body had left it so in this sub-step.
fn all_in(meadow: &Meadow, start: Start) -> Handmade {
    let field = &meadow.field;
    let segments = field.table.segments as usize;
    let plants = field.grid.plants_per_tile();
    let mut slabs = vec![None; meadow.tiles.slabs.high_water() as usize];
    for tile in &meadow.work.tiles {
        let mut slab = Slab::<f32>::new(plants as usize, segments);
        for place in 0..plants {
            let Some(plant) = field.plant(&tile.anchor, tile.tile, place) else {
                continue;
            };
            let bend = meadow.work.wind.bend::<f32>(&tile.anchor, &plant);
            let wind = wind_pose(&plant, &field.table, bend);
            let wind: Vec<_> = wind[..=segments]
                .iter()
                .map(|v| Vec3::of(v.to_f64()))
                .collect();
            let nodes = start(&wind, tile.tile * plants + place);
            slab.touched_at[place as usize] = meadow.work.now;
            let offsets = &mut slab.offsets[place as usize * segments..][..segments];
            for (j, offset) in offsets.iter_mut().enumerate() {
                *offset = Vec3::of((nodes[j + 1] - wind[j + 1]).to_f64());
            }
        }
        slabs[tile.slab as usize] = Some(slab);
    }
    Handmade { slabs }
}

/// Largest relative change of a segment's length of any plant as the engine shows it.
fn shown_strain(rig: &mut Rig) -> Result<f64, Failed> {
    let state = rig.state()?;
    let mut worst = 0.0_f64;
    for plant in shown(rig, &state)? {
        let segments = plant.nodes.len() - 1;
        let rest = plant.height_m / segments as f64;
        for j in 0..segments {
            let strain = (segment(&plant.nodes, j).length() / rest - 1.0).abs();
            worst = worst.max(if strain.is_nan() {
                f64::INFINITY
            } else {
                strain
            });
        }
    }
    Ok(worst)
}

/// Largest strain after one frame without a body, and while a body is in the way.
const STRAIN: [f64; 2] = [0.01, 0.02];

/// Blades stretched, crumpled and turned over, free and under a ball. A method that divides by a
/// spring's length leaves no number of them, and one that relaxes lengths by shares keeps them long
/// for many frames.
pub fn stretched(setting: &Setting) -> Measured {
    let mut told = Vec::new();
    let (mut holds, mut touched) = (true, 0);
    for (what, start) in STARTS {
        let (free, _) = after_a_frame(setting, start, true)?;
        let (under, pushed) = after_a_frame(setting, start, false)?;
        holds &= free <= STRAIN[0] && under <= STRAIN[1];
        touched += pushed;
        told.push(format!(
            "{what}: strain {free:.1e} free, {under:.1e} under a ball"
        ));
    }
    let text = format!(
        "{} after a frame (limits {STRAIN:?}), {touched} plants pushed",
        told.join("; ")
    );
    ensure(holds && touched > 30, || text.clone())?;
    Ok(text)
}

/// The strain a frame after a start, with the ball taken away before or left where it is, and how many
/// plants it pushed; and then the wind pose, bit for bit, once it is gone.
fn after_a_frame(setting: &Setting, start: Start, free: bool) -> Result<(f64, usize), Failed> {
    let mut rig = held_down(setting, CALM, 1.0 / 120.0)?;
    let state = all_in(&rig.meadow, start);
    rig.take_over(&state)?;
    if free {
        let_go(&mut rig)?;
    }
    rig.ticks(FRAME_TICKS)?;
    let plants = rig.look()?;
    let pushed = pushed_plants(&rig)?;
    // A plant that the ball merely holds keeps the pose it was given.
    let counts = |key: &PlantKey| free || pushed.contains(key);
    let counted = plants.iter().filter(|(key, _)| counts(key));
    let mut strain = counted
        .map(|(_, plant)| largest_strain(plant))
        .fold(0.0, f64::max);
    if free {
        strain = strain.max(shown_strain(&mut rig)?);
    }
    if !free {
        let_go(&mut rig)?;
    }
    rig.ticks(rig.meadow.recovery_ticks() - if free { FRAME_TICKS } else { 0 })?;
    let plants = rig.look()?;
    ensure(!plants.is_empty() && all_in_wind_pose(&plants), || {
        "not every plant is back in its wind pose".into()
    })?;
    Ok((strain, pushed.len()))
}

/// The plants that a body has pushed since the state was given: its nodes remember no face before.
fn pushed_plants(rig: &Rig) -> Result<BTreeSet<PlantKey>, Failed> {
    let state = rig.state()?;
    let segments = rig.meadow.scene.solver.segments as usize;
    let mut found = BTreeSet::new();
    for tile in &rig.meadow.work.tiles {
        let slab = state.slab(tile.slab).ok_or("a tile has no slab")?;
        // Every place has its plant at a whole density, so ranks are places.
        for (place, faces) in slab.faces.chunks(segments).enumerate() {
            if faces.iter().any(|&face| face != 0) {
                found.insert((tile.tile, place));
            }
        }
    }
    Ok(found)
}

fn largest_strain(plant: &Standing<f64>) -> f64 {
    let segments = plant.nodes.len() - 1;
    let rest = f64::from(plant.plant.height_m) / segments as f64;
    let strains = (0..segments).map(|j| (segment(&plant.nodes, j).length() / rest - 1.0).abs());
    strains.fold(0.0, f64::max)
}

/// Rates of springs and of sub-steps.
const KAPPAS_PER_S: [f64; 3] = [1.0, 30.0, 1000.0];
const RATES_HZ: [f64; 3] = [15.0, 60.0, 240.0];
/// A blade bent by hand is turned by so much at its tip, in even steps from the root.
const TIP_TURN_RAD: f64 = FRAC_PI_2;

/// Springs of 1 to 1000 per second in sub-steps of 1/15 to 1/240 s: a ball rolls through the grass,
/// and blades bent by hand rise alone. A spring that moves its ends by κΔt of its extension throws
/// the blade about from κΔt = 1 on.
pub fn stiff(setting: &Setting) -> Measured {
    let mut strain = 0.0_f64;
    let mut growth = f64::NEG_INFINITY;
    for kappa in KAPPAS_PER_S {
        for hz in RATES_HZ {
            let what = format!("κ {kappa} at {hz} Hz");
            let named = |error: Failed| -> Failed {
                format!("{what}: {}", error.message().unwrap_or_default()).into()
            };
            strain = strain.max(rolled_through(setting, kappa, hz).map_err(named)?);
            // A plant that nothing touches has no springs: one rate of them shows it.
            if kappa == KAPPAS_PER_S[2] {
                growth = growth.max(rising(setting, kappa, hz).map_err(named)?);
            }
        }
    }
    Ok(format!(
        "strain {strain:.1e} (limit {}) under the ball; rising alone, the bend springs' extension \
         grows by {growth:.1e} m in a sub-step (rounding {ROUNDING_M:.0e})",
        STRAIN[1]
    ))
}

fn solver(kappa: f64, hz: f64) -> String {
    format!(
        "solver: (spring_rate_per_s: {kappa:?}, substep_s: {:?})",
        1.0 / hz
    )
}

/// The largest strain while a ball rolls a metre at 1 m/s.
fn rolled_through(setting: &Setting, kappa: f64, hz: f64) -> Result<f64, Failed> {
    let mut rig = setting.rig(&format!(
        "(duration_s: 2, terrain: (ground: Flat(size_m: (3, 2))), {CALM}, bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.15), collider: {}, motion: Path(waypoints: [
                (at_s: 0, position_m: (-0.5, 0.15, 0)), (at_s: 1, position_m: (0.5, 0.15, 0))]))],
          {})",
        setting.collider(),
        solver(kappa, hz)
    ))?;
    let plants = rig
        .run_to(hz as u32, (hz / 15.0) as u32)
        .and_then(|()| rig.look())?;
    let bent = plants
        .values()
        .filter(|plant| plant.offset_m() > 0.02)
        .count();
    ensure(bent > 50, || format!("only {bent} plants were bent"))?;
    rig.nothing_is_inside()?;
    let strain = rig.seen.strain;
    ensure(strain <= STRAIN[1], || format!("strain {strain}"))?;
    Ok(strain)
}

/// A length is off by some roundings of coordinates below 4 m, 2.4e-7 m each, and a plant has seven
/// bend springs: √7·3·2.4e-7 m.
const ROUNDING_M: f64 = 2e-6;

/// The most by which √Σ(‖l‖ − l₀)² over a blade's bend springs grows in a sub-step, in metres, for
/// blades bent by hand and left alone. No spring acts then; the offset fades, and where no segment
/// is turned by more than a right angle that bends every hinge less. (Beyond it need not: a segment
/// turned right over passes from down to up within a few sub-steps.)
fn rising(setting: &Setting, kappa: f64, hz: f64) -> Result<f64, Failed> {
    let mut rig = setting.rig(&format!(
        "(duration_s: 10, terrain: (ground: Flat(size_m: (1, 1))), {CALM},
          grass: (density_per_m2: 64), bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.2), position_m: (0.05, 0.15, -0.05),
             motion: Fixed, collider: {})],
          {})",
        setting.collider(),
        solver(kappa, hz)
    ))?;
    rig.ticks(2)?;
    let state = all_in(&rig.meadow, |wind, _| turned_evenly(wind));
    rig.take_over(&state)?;
    let_go(&mut rig)?;
    let mut growth = f64::NEG_INFINITY;
    let mut before = None;
    for _ in 0..rig.meadow.recovery_ticks() {
        rig.tick()?;
        let now: Vec<f64> = rig.look()?.values().map(extension_m).collect();
        if let Some(before) = before.replace(now.clone()) {
            let grown = now.iter().zip(&before).map(|(now, before)| now - before);
            growth = grown.fold(growth, f64::max);
        }
    }
    ensure(growth <= ROUNDING_M, || {
        format!("the springs' extension grows by {growth:e} m")
    })?;
    Ok(growth)
}

/// Turned about z, each segment by as much more than the one below it.
fn turned_evenly(wind: &[Vec3<f64>]) -> Vec<Vec3<f64>> {
    let segments = wind.len() - 1;
    let mut nodes = vec![wind[0]];
    for j in 0..segments {
        let (sin, cos) = (TIP_TURN_RAD * (j + 1) as f64 / segments as f64).sin_cos();
        let s = segment(wind, j);
        nodes.push(nodes[j] + vec3(s.x * cos + s.y * sin, s.y * cos - s.x * sin, s.z));
    }
    nodes
}

/// √Σ(‖l‖ − l₀)² over a plant's bend springs, in metres.
fn extension_m(plant: &Standing<f64>) -> f64 {
    let longer = (0..plant.nodes.len() - 2).map(|j| {
        let [now, rest] = [&plant.nodes, &plant.wind].map(|line| (line[j + 2] - line[j]).length());
        (now - rest) * (now - rest)
    });
    longer.sum::<f64>().sqrt()
}
