//! As much as there may be, and one more.

use std::collections::BTreeMap;

use libtest_mimic::Failed;
use sward::field::TileId;
use sward::run::judge::exceeded_limits;
use sward::run::watch::Watch;
use sward::scene::{Action, limits};

use super::Measured;
use super::rig::{CALM, Fnv, Rig, SECOND_TICKS, Setting, ensure, parse};

fn rolling(setting: &Setting) -> String {
    format!(
        "(duration_s: 4, terrain: (ground: Flat(size_m: (6, 4))), {CALM}, bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.15), position_m: (-1.5, 0.15, 0.1),
             motion: Thrown(velocity_m_per_s: (2, 0, 0)), collider: {})])",
        setting.collider()
    )
}

/// Bits of every active tile's plants.
fn by_tile(rig: &mut Rig) -> Result<BTreeMap<TileId, u64>, Failed> {
    let mut found = BTreeMap::new();
    for ((tile, _), plant) in rig.plants()? {
        let hash: &mut Fnv = found.entry(tile).or_insert_with(Fnv::new);
        hash.eat(plant.touched_at);
        plant.nodes.iter().for_each(|&node| hash.point(node));
    }
    Ok(found
        .into_iter()
        .map(|(tile, hash)| (tile, hash.0))
        .collect())
}

/// As many slabs of state as the scene needs, and one less. A method that writes past its pool
/// overwrites another tile's plants.
pub fn tiles(setting: &Setting) -> Measured {
    let ticks = SECOND_TICKS;
    let mut free = setting.rig(&rolling(setting))?;
    free.run_to(ticks, 10)?;
    let wanted = by_tile(&mut free)?;
    let needed = free.meadow.tiles.slabs.high_water();

    let mut full = setting.rig(&rolling(setting))?;
    full.meadow.tiles.slabs.lower_limit(needed);
    full.run_to(ticks, 10)?;
    ensure(by_tile(&mut full)? == wanted, || {
        "at the maximum something has changed".into()
    })?;

    let mut over = setting.rig(&rolling(setting))?;
    over.meadow.tiles.slabs.lower_limit(needed - 1);
    over.ticks(ticks)?;
    let refused = over.meadow.counters.refused_tiles;
    let told = exceeded_limits(&over.meadow, &Watch::default());
    ensure(refused > 0 && told.len() == 1, || {
        format!("{refused} refused, {} told of", told.len())
    })?;
    let kept = by_tile(&mut over)?;
    let same = kept
        .iter()
        .filter(|(tile, bits)| wanted.get(tile) == Some(bits))
        .count();
    ensure(kept.len() + 1 >= wanted.len() && same == kept.len(), || {
        format!("{same} of {} tiles have their bits", kept.len())
    })?;
    Ok(format!(
        "{needed} tiles fit; with room for one less {refused} refusals ({}), the other {same} tiles \
         have the same bits",
        told[0].what
    ))
}

/// As many bodies as a scene may have, and one more at run time.
pub fn bodies(setting: &Setting) -> Measured {
    let side = (limits::BODIES as f64).sqrt() as usize;
    let mut scene =
        parse("(terrain: (ground: Flat(size_m: (16, 16))), grass: (density_per_m2: 16))")?.scene;
    let ball = parse("(bodies: [(name: \"ball\", shape: Ball(radius_m: 0.05))])")?.scene;
    let ball = ball.bodies.into_iter().next().ok_or("no body")?;
    for n in 0..limits::BODIES {
        let mut body = ball.clone();
        body.name = format!("ball {n:04}");
        let place = |n: usize| (n as f64 - 0.5 * side as f64) * 0.24;
        body.position_m = [place(n % side), 0.2, place(n / side)];
        scene.bodies.push(body);
    }
    let mut more = scene.clone();
    more.bodies.push(ball.clone());
    let told = match Rig::of_scene(setting.device, more) {
        Ok(_) => return Err("one body more than the maximum was accepted".into()),
        Err(error) => error.message().unwrap_or_default().to_owned(),
    };
    ensure(told.contains("4096") && told.contains("bodies"), || {
        told.clone()
    })?;

    let mut rig = setting.rig_of(scene)?;
    rig.ticks(3)?;
    let before = (rig.meadow.bodies.hash(), rig.bits()?);
    let spawn = Action::Spawn(Box::new(ball.clone()));
    let told = match rig.meadow.act(&spawn) {
        Ok(()) => return Err("one body more than the maximum was spawned".into()),
        Err(error) => error.to_string(),
    };
    ensure(told.contains("4096"), || told.clone())?;
    ensure(rig.meadow.bodies.drop_body(&ball, 0.0).is_err(), || {
        "one more was dropped".into()
    })?;
    let refused = rig.meadow.bodies.refused();
    let after = (rig.meadow.bodies.hash(), rig.bits()?);
    ensure(refused == 2 && before == after, || {
        format!("{refused} counted, before {before:x?}, after {after:x?}")
    })?;
    rig.ticks(2)?;
    let snapshot = rig.engine.snapshot(&rig.meadow)?;
    ensure(
        snapshot.not_finite == 0 && snapshot.pushed_nodes > 1000,
        || {
            format!(
                "{} not finite, {} pushed",
                snapshot.not_finite, snapshot.pushed_nodes
            )
        },
    )?;
    Ok(format!(
        "{} bodies run; 2 more refused and counted: {told}",
        limits::BODIES
    ))
}

/// As many plants in a tile as a slab holds, and one more.
pub fn plants(setting: &Setting) -> Measured {
    // A tile of 4 m has 32 triangles of half a square metre: 2,048 plants on each are 65,536.
    let scene = |density: f64| {
        format!(
            "(duration_s: 1, terrain: (ground: Flat(size_m: (4, 4))), {CALM},
              grass: (density_per_m2: {density}), bodies: [
                (name: \"ball\", shape: Ball(radius_m: 0.05), position_m: (0, 0.05, 0))],
              solver: (seeding_cell_m: 1, tile_m: 4))"
        )
    };
    let mut rig = setting.rig(&scene(4096.0))?;
    rig.run_to(6, 3)?;
    let plants = rig.meadow.counters.plants_peak;
    ensure(plants == limits::PLANTS_PER_TILE, || {
        format!("{plants} plants")
    })?;
    let told = match parse(&scene(4096.5)) {
        Ok(_) => return Err("one plant more than a tile holds was accepted".into()),
        Err(error) => error.message().unwrap_or_default().to_owned(),
    };
    ensure(told.contains("65536") || told.contains("65,536"), || {
        told.clone()
    })?;
    Ok(format!(
        "{plants} plants of one tile run; more are refused: {told}"
    ))
}
