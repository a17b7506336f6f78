//! How plants rise again: at every rate, from every bend, in gusts.

use libtest_mimic::Failed;
use sward::base::{Real, Vec3, vec3};
use sward::field::wind_pose;
use sward::run::Engine;
use sward::scene::method::Recovery;
use sward::sim::Meadow;
use sward::sim::cpu::{poses, segment_length};
use sward::sim::measure::{GrassState, Standing};
use sward::sim::recover::{Fading, offset_left};
use sward::sim::slab::Slab;
use sward::sim::weight::offset_weight;

use super::Measured;
use super::rig::{CALM, Handmade, PlantKey, Rig, Setting, all_in_wind_pose, ensure};

/// Recovery time of every case here, in seconds.
const RECOVERY_S: f64 = 2.0;
/// Shares of the offset, and when they are passed after the release, T(1 − ∛share), in seconds.
const MARKS: [(f64, f64); 3] = [(0.5, 0.413), (0.1, 1.072), (0.01, 1.569)];
const RATES_HZ: [f64; 6] = [15.0, 30.0, 60.0, 120.0, 240.0, 1000.0];

/// A body that holds plants down for three sub-steps at least, and then is gone.
pub fn held_down(setting: &Setting, wind: &str, substep_s: f64) -> Result<Rig, Failed> {
    let mut rig = setting.rig(&format!(
        "(duration_s: 10, terrain: (ground: Flat(size_m: (2, 2))), {wind}, bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.2), position_m: (0.05, 0.15, -0.05),
             motion: Fixed, collider: {})],
          solver: (recovery_s: {RECOVERY_S}, substep_s: {substep_s}))",
        setting.collider()
    ))?;
    let ticks = (0.2 / substep_s).ceil() as u32;
    rig.ticks(ticks)?;
    Ok(rig)
}

pub fn let_go(rig: &mut Rig) -> Result<(), Failed> {
    let body = "ball".to_owned();
    Ok(rig.meadow.act(&sward::scene::Action::Remove { body })?)
}

/// The weight of the offset at every rate: the sub-step is a frame. Scaling the pose in every frame
/// (O09 eq. 8) has a half life of 0.16 s at 30 Hz and 0.06 s at 240 Hz, where 0.413 s is meant.
pub fn release(setting: &Setting) -> Measured {
    let mut tips = Vec::new();
    let mut plants_followed = 0;
    for hz in RATES_HZ {
        let substep_s = 1.0 / hz;
        let mut rig = held_down(setting, CALM, substep_s)?;
        let held = bent_plants(&mut rig)?;
        plants_followed += held.len();
        let released = rig.meadow.ticks;
        let_go(&mut rig)?;
        for (share, mark_s) in MARKS {
            // No later than a frame before the mark, and no sooner than a frame after it.
            let before = released + ((mark_s - substep_s) / substep_s).floor().max(0.0) as u32;
            let after = released + ((mark_s + substep_s) / substep_s).ceil() as u32;
            for (tick, passed) in [(before, false), (after, true)] {
                rig.run_to(tick.max(rig.meadow.ticks), u32::MAX)?;
                let now = rig.plants()?;
                for (key, held) in &held {
                    let now = now.get(key).ok_or("a plant is gone too soon")?;
                    let left = offset_weight(held.into(), now.into(), Recovery::Lengths)
                        .ok_or("a pose does not tell its weight")?;
                    ensure((left <= share) == passed, || {
                        let at_s = f64::from(tick - released) * substep_s;
                        format!(
                            "{hz} Hz: {left} of the offset is left after {at_s} s, mark {mark_s}"
                        )
                    })?;
                }
            }
        }
        tips.push(format!("{hz} Hz {:?}", tip_times_s(setting, substep_s)?));
    }
    ensure(plants_followed > 100, || {
        format!("only {plants_followed} plants were bent")
    })?;
    Ok(format!(
        "t³ of {plants_followed} plants passes ½, 0.1, 0.01 at 0.413, 1.072, 1.569 s ± 1 frame; the \
         farthest tip's own times: {}",
        tips.join(", ")
    ))
}

/// Plants held in this very sub-step and bent so far that their weight can be told from their pose.
fn bent_plants(rig: &mut Rig) -> Result<Vec<(PlantKey, Standing<f64>)>, Failed> {
    let now = rig.meadow.ticks;
    let held = rig
        .plants()?
        .into_iter()
        .filter(|(_, plant)| plant.touched_at == now);
    Ok(held
        .filter(|(_, plant)| largest_turn(plant) > 0.3)
        .collect())
}

/// The sine of the largest turn of a segment from the wind pose.
fn largest_turn(plant: &Standing<f64>) -> f64 {
    let turns = (0..plant.nodes.len() - 1).map(|j| {
        let [wind, now] = [&plant.wind, &plant.nodes].map(|nodes| segment(nodes, j));
        wind.cross(now).length() / (wind.length() * now.length())
    });
    turns.fold(0.0, f64::max)
}

pub fn segment<R: Real>(nodes: &[Vec3<R>], j: usize) -> Vec3<f64> {
    Vec3::of(nodes[j + 1].to_f64()) - Vec3::of(nodes[j].to_f64())
}

/// When the tip that was farthest from its wind pose had ½, 0.1 and 0.01 of that left, in seconds:
/// sooner than the weight, since a bent blade keeps its length.
fn tip_times_s(setting: &Setting, substep_s: f64) -> Result<[f64; 3], Failed> {
    let mut rig = held_down(setting, CALM, substep_s)?;
    let tip_m = |plant: &Standing<f64>| plant.offset_m();
    let farthest = bent_plants(&mut rig)?
        .into_iter()
        .reduce(|a, b| if tip_m(&b.1) > tip_m(&a.1) { b } else { a });
    let (key, held) = farthest.ok_or("no plant is bent")?;
    let released = rig.meadow.ticks;
    let_go(&mut rig)?;
    let mut times = [f64::NAN; 3];
    let every = ((0.01 / substep_s) as u32).max(1);
    while times[2].is_nan() && rig.meadow.ticks < released + rig.meadow.recovery_ticks() {
        rig.ticks(every)?;
        let left = rig.plants()?.get(&key).map_or(0.0, tip_m) / tip_m(&held);
        let since_s = f64::from(rig.meadow.ticks - released) * substep_s;
        for (time, (share, _)) in times.iter_mut().zip(MARKS) {
            if time.is_nan() && left <= share {
                *time = (since_s * 1000.0).round() / 1000.0;
            }
        }
    }
    Ok(times)
}

/// Angles, in degrees, by which every segment is turned from its wind pose.
const TURNS_DEG: [f64; 4] = [90.0, 150.0, 179.9, 180.0];
/// A blade is never shorter, in rest lengths.
const LEAST_LENGTH: f64 = 0.99;
/// Largest strain of a segment while its plant recovers.
const STRAIN: f64 = 1e-3;

/// Blades laid flat and turned over. Blending positions shortens them: by 29% at 90°, to nothing at
/// 180°; and what then comes up on which side is up to rounding.
pub fn flattened(setting: &Setting) -> Measured {
    let mut shortest = f64::INFINITY;
    let mut aside = f64::INFINITY;
    let mut strain = 0.0_f64;
    let mut seen = 0;
    for degrees in TURNS_DEG {
        let mut rig = held_down(setting, CALM, 1.0 / 120.0)?;
        let_go(&mut rig)?;
        rig.tick()?;
        let state = turned_state(&rig.meadow, degrees);
        for age in 1..=rig.meadow.recovery_ticks() {
            // Nothing of the state is rewritten while a plant recovers, so any age can be shown.
            let state = state.aged(&rig.meadow, age);
            let left = offset_left(age, rig.meadow.step_over_t());
            for shown in shown(&mut rig, &state)? {
                let segments = shown.nodes.len() - 1;
                let lengths = (0..segments).map(|j| segment(&shown.nodes, j).length());
                let rest = shown.height_m / segments as f64;
                strain = lengths
                    .clone()
                    .map(|length| (length / rest - 1.0).abs())
                    .fold(strain, f64::max);
                let length = lengths.sum::<f64>() / shown.height_m;
                ensure(length.is_finite(), || {
                    format!("{degrees}° age {age}: not finite")
                })?;
                shortest = shortest.min(length);
                seen += 1;
                // While a blend of opposite directions is short, rounding could turn it anywhere.
                if degrees == 180.0 && (left - 0.5).abs() < 0.2 {
                    aside = aside.min(least_aside(&shown));
                }
            }
        }
    }
    let text = format!(
        "length at least {shortest:.6} L (limit {LEAST_LENGTH}), a segment's strain {strain:.1e} \
         (limit {STRAIN}); turned right over, every segment \
         passes at least {aside:.1e} rad on its fixed side, {seen} poses"
    );
    ensure(
        shortest >= LEAST_LENGTH && strain <= STRAIN && aside > 0.0 && seen > 1000,
        || text.clone(),
    )?;
    Ok(text)
}

/// The least component of a segment's direction along the fixed side of its wind pose: x, made
/// perpendicular to it, or z where it lies along x.
fn least_aside(shown: &Shown) -> f64 {
    let segments = shown.nodes.len() - 1;
    let aside = (0..segments).map(|j| {
        let rest = segment(&shown.wind, j).unit_or(Vec3::UP);
        let axis = if rest.x.abs() < 0.5 {
            vec3(1.0, 0.0, 0.0)
        } else {
            vec3(0.0, 0.0, 1.0)
        };
        let side = (axis - rest * rest.dot(axis)).unit_or(Vec3::UP);
        segment(&shown.nodes, j).unit_or(rest).dot(side)
    });
    aside.fold(f64::INFINITY, f64::min)
}

impl Handmade {
    /// The same offsets, stored `age` ticks ago.
    fn aged(&self, meadow: &Meadow, age: u32) -> Self {
        // A stored tick of 0 means never; later ticks wrap below it, as their difference counts.
        let at = meadow.work.now.wrapping_sub(age);
        let slabs = self.slabs.iter().map(|slab| {
            let mut slab = slab.clone()?;
            slab.touched_at.fill(at);
            Some(slab)
        });
        Self {
            slabs: slabs.collect(),
        }
    }
}

/// Every plant of the active tiles with its segments turned by an angle about z, which takes a
/// blade's top towards +x.
fn turned_state(meadow: &Meadow, degrees: f64) -> Handmade {
    let field = &meadow.field;
    let segments = field.table.segments as usize;
    let plants = field.grid.plants_per_tile();
    let (sin, cos) = degrees.to_radians().sin_cos();
    let mut slabs = vec![None; meadow.tiles.slabs.high_water() as usize];
    for tile in &meadow.work.tiles {
        let mut slab = Slab::<f32>::new(plants as usize, segments);
        for place in 0..plants {
            let Some(plant) = field.plant(&tile.anchor, tile.tile, place) else {
                continue;
            };
            let wind = wind_pose::<f32>(
                &plant,
                &field.table,
                meadow.work.wind.bend(&tile.anchor, &plant),
            );
            let mut turned = Vec3::<f64>::of(wind[0].to_f64());
            for j in 0..segments {
                let s = segment(&wind, j);
                turned += vec3(s.x * cos + s.y * sin, s.y * cos - s.x * sin, s.z * cos);
                let offset = turned - Vec3::of(wind[j + 1].to_f64());
                slab.offsets[place as usize * segments + j] = Vec3::of(offset.to_f64());
            }
        }
        slabs[tile.slab as usize] = Some(slab);
    }
    Handmade { slabs }
}

/// A plant as the engine shows it.
pub struct Shown {
    pub nodes: Vec<Vec3<f32>>,
    pub wind: Vec<Vec3<f32>>,
    pub height_m: f64,
}

/// What the engine shows of a state: the cpu engine's pose, or what the device draws.
pub fn shown(rig: &mut Rig, state: &Handmade) -> Result<Vec<Shown>, Failed> {
    let meadow = &rig.meadow;
    let field = &meadow.field;
    let segments = field.table.segments as usize;
    let plants = field.grid.plants_per_tile();
    let drawn = match &mut rig.engine {
        Engine::Cpu(_) | Engine::Reference(_) => None,
        Engine::Gpu(engine) => {
            engine.grass.upload(meadow, state)?;
            engine.grass.recover()?;
            Some(engine.grass.read_drawn(meadow)?)
        }
    };
    let mut found = Vec::new();
    for (n, tile) in meadow.work.tiles.iter().enumerate() {
        let slab = state.slab(tile.slab).ok_or("a slab is missing")?;
        for place in 0..plants {
            let Some(plant) = field.plant(&tile.anchor, tile.tile, place) else {
                continue;
            };
            let fading = Fading::new(meadow);
            let (wind, pose) = poses(field, &meadow.work, &fading, tile, &plant, slab, place);
            let row = (n * plants as usize + place as usize) * (segments + 1);
            let nodes = match &drawn {
                None => pose[..=segments].to_vec(),
                Some(rows) => {
                    let rows = &rows[row..=row + segments];
                    rows.iter().map(|&[x, y, z, _]| vec3(x, y, z)).collect()
                }
            };
            found.push(Shown {
                nodes,
                height_m: f64::from(segment_length::<f32>(&plant, segments)) * segments as f64,
                wind: wind[..=segments].to_vec(),
            });
        }
    }
    Ok(found)
}

/// Recovering in gusts of 0.5, 0.94 and 1.6 Hz. A method that stores the blended pose drags the
/// wind of the contact along and never quite arrives; one on quantised state stalls short of it.
pub fn gusty(setting: &Setting) -> Measured {
    let wind = "wind: (strength: 0.3, gust: 0.6, gust_length_m: 2, gust_speed_m_per_s: 1, \
                flutter: 0.1)";
    let mut rig = held_down(setting, wind, 1.0 / 120.0)?;
    rig.look()?;
    let moved = bent_plants(&mut rig)?.len();
    let_go(&mut rig)?;
    rig.tick()?;
    rig.seen = Default::default();
    let released = rig.meadow.ticks - 1;
    let last = released + rig.meadow.recovery_ticks();
    rig.run_to(last - 1, 8)?;
    let plants = rig.look()?;
    let strain = rig.seen.strain;
    ensure(strain <= STRAIN, || {
        format!("strain {strain} while recovering, limit {STRAIN}")
    })?;
    let short = plants
        .values()
        .filter(|p| p.touched_at == released && p.nodes != p.wind)
        .count();
    rig.tick()?;
    let plants = rig.look()?;
    ensure(moved > 20 && short > 20 && !plants.is_empty(), || {
        format!("{moved} plants bent, {short} not yet back a tick before the end")
    })?;
    ensure(all_in_wind_pose(&plants), || {
        let off = plants
            .values()
            .filter(|plant| plant.nodes != plant.wind)
            .count();
        format!("{off} plants are not in their wind pose at t = 0")
    })?;
    drawn_as_untouched(&mut rig)?;
    Ok(format!(
        "{moved} plants bent, {short} of them off a tick before t = 0, none at t = 0: {} wind poses \
         bit for bit; strain {strain:.1e} while recovering (limit {STRAIN})",
        plants.len()
    ))
}

/// On the device: what is drawn has the bits of what would be drawn had nothing been touched.
fn drawn_as_untouched(rig: &mut Rig) -> Result<(), Failed> {
    let Engine::Gpu(engine) = &mut rig.engine else {
        return Ok(());
    };
    let meadow = &rig.meadow;
    let bits = |rows: Vec<[f32; 4]>| -> Vec<[u32; 4]> {
        rows.iter().map(|row| row.map(f32::to_bits)).collect()
    };
    engine.grass.recover()?;
    let drawn = bits(engine.grass.read_drawn(meadow)?);
    let plants = meadow.field.grid.plants_per_tile() as usize;
    let segments = meadow.field.table.segments as usize;
    let blank = Some(Slab::<f32>::new(plants, segments));
    let slabs = vec![blank; meadow.tiles.slabs.high_water() as usize];
    engine.grass.upload(meadow, &Handmade { slabs })?;
    engine.grass.recover()?;
    let untouched = bits(engine.grass.read_drawn(meadow)?);
    ensure(drawn == untouched, || {
        "a drawn plant is not in its wind pose at t = 0".into()
    })
}
