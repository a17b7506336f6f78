//! Results that must not depend on how the work is divided or in which order it is done.

use std::collections::BTreeMap;

use libtest_mimic::Failed;
use sward::base::philox::philox2x32;
use sward::gpu::GrassKernels;
use sward::run::{Device, Engine};
use sward::sim::state_hash::state_hash;

use super::Measured;
use super::rig::{CALM, Fnv, Rig, Setting, ensure, parse};

const TICKS: u32 = 90;

/// A ball that rolls over the corner of four tiles and stops on it.
fn on_a_corner(setting: &Setting, tile_m: f64) -> String {
    format!(
        "(duration_s: 4, terrain: (ground: Rolling(size_m: (4, 4), amplitude_m: 0.05,
          wavelength_m: 3, seed: 2)), wind: (strength: 0.2), bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.15), position_m: (-0.8, 0.14, 0.02),
             above_ground: true, collider: {}, motion: Path(waypoints: [
                (at_s: 0, position_m: (-0.8, 0.14, 0.02)),
                (at_s: 0.5, position_m: (0, 0.14, 0))]))],
          solver: (tile_m: {tile_m}))",
        setting.collider()
    )
}

/// Bits of every touched plant, by the bits of its root's place in the world.
type ByRoot = BTreeMap<[u64; 2], u64>;

/// Tiles of 0.5, 1 and 2 m, worked on in any order, with a ball on a corner of four. A method that
/// keeps coordinates or timers per tile gives every tile size a result of its own, and pushes the
/// plants at a border twice.
pub fn sharded(setting: &Setting) -> Measured {
    let mut first: Option<ByRoot> = None;
    for tile_m in [0.5, 1.0, 2.0] {
        for seed in [None, Some(5), Some(6)] {
            let mut rig = setting.rig(&on_a_corner(setting, tile_m))?;
            for tick in 0..TICKS {
                match seed {
                    None => rig.tick()?,
                    Some(seed) => tick_shuffled(&mut rig, seed + tick)?,
                }
            }
            rig.look()?;
            let plants = by_root(&mut rig)?;
            handled_once(&mut rig, &plants)?;
            let wanted = first.get_or_insert_with(|| plants.clone());
            ensure(plants == *wanted, || {
                let differ = wanted
                    .iter()
                    .filter(|(key, bits)| plants.get(*key) != Some(*bits));
                let differ = differ.count();
                format!("tiles of {tile_m} m, seed {seed:?}: {differ} plants differ")
            })?;
        }
    }
    let plants = first.map_or(0, |plants| plants.len());
    ensure(plants > 50, || format!("only {plants} plants were touched"))?;
    Ok(format!(
        "3 tile sizes in 3 orders: {plants} touched plants of equal bits, none twice"
    ))
}

fn by_root(rig: &mut Rig) -> Result<ByRoot, Failed> {
    let mut found = ByRoot::new();
    for plant in rig.plants()?.values().filter(|plant| plant.touched_at > 0) {
        let mut hash = Fnv::new();
        hash.eat(plant.touched_at);
        plant.nodes.iter().for_each(|&node| hash.point(node));
        let twin = found.insert(plant.root_in_world().map(f64::to_bits), hash.0);
        ensure(twin.is_none(), || "a plant is in two tiles".into())?;
    }
    Ok(found)
}

/// The passes' own count of plants pushed in the last sub-step is that of the plants touched in it.
fn handled_once(rig: &mut Rig, plants: &ByRoot) -> Result<(), Failed> {
    let now = rig.meadow.ticks;
    let touched = rig
        .plants()?
        .values()
        .filter(|plant| plant.touched_at == now)
        .count() as u64;
    let counted = match &rig.engine {
        Engine::Cpu(grass) => grass.pushed,
        Engine::Reference(grass) => grass.pushed,
        Engine::Gpu(engine) => u64::from(engine.grass.read_counts()?.touched),
    };
    ensure(counted == touched && touched > 0, || {
        format!(
            "{counted} plants were handled, {touched} of {} are touched",
            plants.len()
        )
    })
}

/// A sub-step with the list of tiles in another order.
fn tick_shuffled(rig: &mut Rig, seed: u32) -> Result<(), Failed> {
    let meadow = &mut rig.meadow;
    meadow.script()?;
    meadow.move_bodies();
    meadow.broad_phase();
    let mut keyed: Vec<_> = std::mem::take(&mut meadow.work.tiles)
        .into_iter()
        .map(|tile| (philox2x32([tile.tile, seed], 1, 7)[0], tile))
        .collect();
    keyed.sort_by_key(|(key, _)| *key);
    meadow.work.tiles = keyed.into_iter().map(|(_, tile)| tile).collect();
    match &mut rig.engine {
        Engine::Cpu(grass) => {
            grass.assign_slabs(meadow);
            grass.draw_depth_cubes(meadow);
            grass.collide(meadow);
            grass.relax(meadow);
        }
        Engine::Reference(_) => return Err("the reference engine is no trial's device".into()),
        Engine::Gpu(engine) => {
            engine.grass.assign_slabs(meadow)?;
            engine.grass.draw_depth_cubes(meadow)?;
            engine.grass.collide(meadow)?;
            engine.grass.relax();
            engine.grass.submit();
        }
    }
    Ok(())
}

/// Five bodies that meet in the grass.
fn crowd(setting: &Setting) -> String {
    let collider = setting.collider();
    let shapes = [
        "Ball(radius_m: 0.12)",
        "Box(size_m: (0.25, 0.2, 0.2))",
        "Capsule(radius_m: 0.08, length_m: 0.2)",
        "Cylinder(radius_m: 0.1, height_m: 0.2)",
        "Ball(radius_m: 0.15)",
    ];
    let bodies: Vec<String> = (shapes.iter().enumerate())
        .map(|(n, shape)| {
            let x = 0.22 * n as f64 - 0.5;
            format!(
                "(name: \"{}\", shape: {shape}, position_m: ({x}, 0.3, {}), collider: {collider},
                  motion: Thrown(velocity_m_per_s: ({}, 0, 0.5)))",
                ["heron", "adder", "newt", "bittern", "otter"][n],
                0.05 * n as f64,
                1.0 - 0.5 * n as f64,
            )
        })
        .collect();
    format!(
        "(duration_s: 4, terrain: (ground: Flat(size_m: (4, 4))), {CALM}, bodies: [{}])",
        bodies.join(", ")
    )
}

/// What a run of the crowd comes to: bodies and grass.
fn crowd_hash(rig: &mut Rig) -> Result<[u64; 2], Failed> {
    rig.run_to(TICKS, 15)?;
    let grass = match &rig.engine {
        Engine::Cpu(grass) => state_hash(&rig.meadow, grass),
        Engine::Gpu(_) | Engine::Reference(_) => rig.bits()?,
    };
    Ok([rig.meadow.bodies.hash(), grass])
}

/// The bodies in any order in the file. The physics' result depends on the order in which bodies
/// are put in, and a blade between two bodies on which pushes first.
pub fn bodies(setting: &Setting) -> Measured {
    let scene = parse(&crowd(setting))?.scene;
    let mut wanted = None;
    // A device gets its bodies from the same hands; every order once, forwards or backwards, has to do.
    let both_ways = matches!(setting.device, Device::Processor);
    let mut orders = 0;
    for turn in 0..scene.bodies.len() {
        for reversed in [false, true] {
            if !both_ways && reversed != (turn % 2 == 1) {
                continue;
            }
            orders += 1;
            let mut scene = scene.clone();
            scene.bodies.rotate_left(turn);
            if reversed {
                scene.bodies.reverse();
            }
            let mut rig = setting.rig_of(scene)?;
            let hash = crowd_hash(&mut rig)?;
            let wanted = *wanted.get_or_insert(hash);
            ensure(hash == wanted, || {
                format!("order {turn}, reversed {reversed}: {hash:x?} instead of {wanted:x?}")
            })?;
        }
    }
    Ok(format!(
        "{orders} orders of 5 bodies, hash {:x?}",
        wanted.unwrap_or_default()
    ))
}

/// Any number of threads, and on a device workgroups of any size.
pub fn threads(setting: &Setting) -> Measured {
    let mut hashes = Vec::new();
    if let Device::Graphics(gpu, _) = setting.device {
        for workgroup in [1, 32, 128, 256] {
            let kernels = Box::new(GrassKernels::with_workgroup(gpu, workgroup)?);
            let device = &Device::Graphics(gpu.clone(), kernels);
            let setting = Setting { device, ..*setting };
            hashes.push(crowd_hash(&mut setting.rig(&crowd(&setting))?)?);
        }
    }
    let threads: &[usize] = match setting.device {
        Device::Graphics(..) => &[1, 3],
        Device::Processor | Device::Reference => &[1, 2, 3, 5, 8],
    };
    for &threads in threads {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        hashes.push(pool.install(|| crowd_hash(&mut setting.rig(&crowd(setting))?))?);
    }
    let same = hashes.iter().all(|hash| *hash == hashes[0]);
    ensure(same, || format!("the hashes differ: {hashes:x?}"))?;
    Ok(format!(
        "{} numbers of threads and sizes of workgroups, hash {:x?}",
        hashes.len(),
        hashes[0]
    ))
}
