//! Numbers from outside that no body and no plant can have.

use std::collections::BTreeMap;

use libtest_mimic::Failed;
use sward::scene::{Action, Body, Grass, Scene, Species, parse_scene};

use super::Measured;
use super::rig::{CALM, Fnv, Rig, SECOND_TICKS, Setting, all_in_wind_pose, ensure, parse};

/// A heron that walks through the grass, and an adder that lies two metres away.
fn pair(setting: &Setting, adder: &str) -> String {
    format!(
        "(duration_s: 4, terrain: (ground: Flat(size_m: (4, 5))), {CALM}, bodies: [
            (name: \"heron\", shape: Ball(radius_m: 0.15), position_m: (-0.6, 0.2, -1.2),
             motion: Thrown(velocity_m_per_s: (1, 0, 0)), collider: {}),
            {adder}])",
        setting.collider()
    )
}

fn adder(setting: &Setting) -> String {
    format!(
        "(name: \"adder\", shape: Box(size_m: (0.3, 0.2, 0.2)), position_m: (0.2, 0.12, 1.1),
          collider: {})",
        setting.collider()
    )
}

/// Bits of the plants near the heron's way that something touched, by their roots.
fn near_heron(rig: &mut Rig) -> Result<BTreeMap<[u64; 2], u64>, Failed> {
    let plants = rig.plants()?.into_values();
    let near = plants.filter(|p| p.root_in_world()[1] < 0.0 && p.touched_at > 0);
    Ok(near
        .map(|plant| {
            let mut hash = Fnv::new();
            hash.eat(plant.touched_at);
            plant.nodes.iter().for_each(|&node| hash.point(node));
            (plant.root_in_world().map(f64::to_bits), hash.0)
        })
        .collect())
}

fn body(text: &str) -> Result<Body, Failed> {
    let scene = parse(&format!("(bodies: [{text}])"))?.scene;
    scene
        .bodies
        .into_iter()
        .next()
        .ok_or_else(|| "no body".into())
}

/// What is done to the adder. There is no way to give a quaternion from outside, so that a turn
/// that is not a number stands for one of length zero.
fn poisons(setting: &Setting) -> Result<Vec<(&'static str, Action)>, Failed> {
    let name = || "adder".to_owned();
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let teleport = |position_m, velocity_m_per_s| Action::Teleport {
        body: name(),
        position_m,
        velocity_m_per_s,
    };
    let throw = |velocity_m_per_s, spin_deg_per_s| Action::Throw {
        body: name(),
        velocity_m_per_s,
        spin_deg_per_s,
    };
    let mut all = vec![
        (
            "a place that is no number",
            teleport([f64::NAN, 0.2, 0.0], [0.0; 3]),
        ),
        (
            "an infinite place",
            teleport([0.0, f64::INFINITY, 0.0], [0.0; 3]),
        ),
        (
            "a velocity that is no number",
            teleport([0.0, 0.2, 1.0], [0.0, nan, 0.0]),
        ),
        ("an infinite velocity", throw([inf, 0.0, 0.0], [0.0; 3])),
        (
            "a throw that is no number",
            throw([0.0, 0.0, nan], [0.0; 3]),
        ),
        ("a spin that is no number", throw([0.0; 3], [nan, 0.0, 0.0])),
        ("an infinite spin", throw([0.0; 3], [0.0, -inf, 0.0])),
    ];
    for (what, impulse_kg_m_per_s) in [
        ("an infinite impulse", [0.0, inf, 0.0]),
        ("an impulse that is no number", [nan, 0.0, 0.0]),
    ] {
        let body = name();
        all.push((
            what,
            Action::Impulse {
                body,
                impulse_kg_m_per_s,
            },
        ));
    }
    let spawned = |what, change: fn(&mut Body)| -> Result<_, Failed> {
        let mut asp = body(&adder(setting).replace("adder", "asp"))?;
        change(&mut asp);
        Ok((what, Action::Spawn(Box::new(asp))))
    };
    all.push(spawned("spawned at no place", |b| {
        b.position_m[1] = f64::NAN
    })?);
    all.push(spawned("spawned with no turn", |b| {
        b.rotation_deg = [f32::NAN; 3]
    })?);
    all.push(spawned("spawned with size 0", |b| {
        b.shape = sward::scene::Shape::Ball { radius_m: 0.0 };
    })?);
    all.push(spawned("spawned with size NaN", |b| {
        b.shape = sward::scene::Shape::Box {
            size_m: [0.1, f32::NAN, 0.1],
        };
    })?);
    Ok(all)
}

/// A body whose pose or velocity is no number, given through the library at run time. Without a
/// guard the physics spreads it to whatever it touches, and every blade near it is gone for good.
pub fn poison(setting: &Setting) -> Measured {
    let last = SECOND_TICKS;
    let mut alone = setting.rig(&pair(setting, ""))?;
    alone.run_to(last, 20)?;
    let wanted = near_heron(&mut alone)?;
    ensure(wanted.len() > 50, || {
        format!("only {} plants touched", wanted.len())
    })?;
    let (mut named, mut refused) = (0, 0);
    for (what, action) in poisons(setting)? {
        let victim = if matches!(action, Action::Spawn(_)) {
            "asp"
        } else {
            "adder"
        };
        let mut rig = setting.rig(&pair(setting, &adder(setting)))?;
        rig.ticks(30)?;
        match rig.meadow.act(&action) {
            Ok(()) => named += 1,
            Err(error) => {
                let told = error.to_string();
                ensure(told.contains(victim), || {
                    format!("{what}: not named in: {told}")
                })?;
                refused += 1;
            }
        }
        rig.ticks(last - 30)?;
        let told = rig.meadow.bodies.quarantined();
        let there = rig.meadow.bodies.info().any(|info| info.name == victim);
        let named_or_refused = told == [victim] || (told.is_empty() && victim == "asp");
        ensure(named_or_refused && !there, || {
            format!("{what}: quarantined {told:?}, still there: {there}")
        })?;
        let finite = rig.engine.snapshot(&rig.meadow)?.not_finite == 0;
        ensure(finite, || format!("{what}: a plant is not finite"))?;
        ensure(near_heron(&mut rig)? == wanted, || {
            format!("{what}: the other body's plants are not as if it were alone")
        })?;
    }
    Ok(format!(
        "{named} bodies quarantined and named, {refused} refused and named, {} plants of the other \
         body with the bits they have without it",
        wanted.len()
    ))
}

/// A body taken away while it holds blades down. A method that keeps a list of contacts across
/// sub-steps pushes them away from a body that is no more.
pub fn removed_while_touching(setting: &Setting) -> Measured {
    let last = SECOND_TICKS;
    let mut alone = setting.rig(&pair(setting, ""))?;
    alone.run_to(last, 20)?;
    let wanted = near_heron(&mut alone)?;
    let mut rig = setting.rig(&pair(setting, &adder(setting)))?;
    rig.run_to(60, 20)?;
    let now = rig.meadow.ticks;
    let held = |rig: &mut Rig| -> Result<usize, Failed> {
        let plants = rig.plants()?;
        let held = plants
            .values()
            .filter(|p| p.root_in_world()[1] > 0.0 && p.touched_at >= now);
        Ok(held.count())
    };
    let before = held(&mut rig)?;
    let body = "adder".to_owned();
    rig.meadow.act(&Action::Remove { body })?;
    rig.tick()?;
    let after = rig.plants()?;
    let pushed = after
        .values()
        .filter(|p| p.root_in_world()[1] > 0.0 && p.touched_at > now);
    let pushed = pushed.count();
    rig.run_to(last, 20)?;
    ensure(near_heron(&mut rig)? == wanted, || {
        "the other body's plants have changed".into()
    })?;
    rig.run_to(now + rig.meadow.recovery_ticks(), 20)?;
    let mut plants = rig.look()?;
    plants.retain(|_, plant| plant.root_in_world()[1] > 0.0);
    let back = all_in_wind_pose(&plants);
    let text = format!("{before} plants held, {pushed} pushed after the removal");
    ensure(before > 20 && pushed == 0 && back, || {
        format!("{text}, all back: {back}")
    })?;
    Ok(text)
}

/// A meadow of one kind of plant with a ball that falls into it.
fn meadow_of(setting: &Setting, species: Species, density_per_m2: f32) -> Result<Scene, Failed> {
    let mut scene = parse(&format!(
        "(duration_s: 2, terrain: (ground: Flat(size_m: (2, 2))), bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.1), position_m: (0.1, 0.2, 0),
             collider: {})])",
        setting.collider()
    ))?
    .scene;
    scene.grass = Grass {
        density_per_m2,
        seed: 3,
        species: vec![species],
        ..Grass::default()
    };
    Ok(scene)
}

fn with(change: impl FnOnce(&mut Species)) -> Species {
    let mut species = Species::default();
    change(&mut species);
    species
}

/// Plants without height or width, none at all, and as many as there may be: a segment of no length
/// has no direction, and its strain is 0/0.
pub fn degenerate_plants(setting: &Setting) -> Measured {
    let refused = [
        ("height 0", with(|s| s.height_m = [0.0; 2]), 256.0),
        ("height 1e-6", with(|s| s.height_m = [1e-6; 2]), 256.0),
        ("height 1e3", with(|s| s.height_m = [1e3; 2]), 256.0),
        ("height NaN", with(|s| s.height_m = [f32::NAN; 2]), 256.0),
        ("width 0", with(|s| s.width_m = [0.0; 2]), 256.0),
        ("density −1", Species::default(), -1.0),
        ("density beyond the maximum", Species::default(), 10_001.0),
        ("density NaN", Species::default(), f32::NAN),
    ];
    let count = refused.len();
    for (what, species, density) in refused {
        let scene = meadow_of(setting, species, density)?;
        let told = match setting.rig_of(scene) {
            Ok(_) => return Err(format!("{what}: accepted").into()),
            Err(error) => error.message().unwrap_or_default().to_owned(),
        };
        ensure(told.contains("grass."), || format!("{what}: {told}"))?;
    }
    let text = "(grass: (species: [(height_m: (0, 0))]))";
    ensure(parse_scene("flat", text, &[]).is_err(), || {
        "a scene's height 0 is accepted".into()
    })?;

    let allowed = [
        ("density 0", Species::default(), 0.0),
        ("density at the maximum", Species::default(), 10_000.0),
        ("the shortest", with(|s| s.height_m = [0.001; 2]), 256.0),
        ("the tallest", with(|s| s.height_m = [10.0; 2]), 16.0),
        ("the thinnest", with(|s| s.width_m = [1e-4; 2]), 256.0),
        ("the softest", with(|s| s.stiffness = [1e-6; 2]), 256.0),
        ("the stiffest", with(|s| s.stiffness = [1e6; 2]), 256.0),
        ("lying", with(|s| s.lean_deg = [90.0; 2]), 256.0),
    ];
    let mut plants = Vec::new();
    for (what, species, density) in allowed {
        let mut rig = setting.rig_of(meadow_of(setting, species, density)?)?;
        let run = rig.run_to(SECOND_TICKS / 2, 10);
        run.map_err(|error| format!("{what}: {}", error.message().unwrap_or_default()))?;
        plants.push(rig.plants()?.len());
    }
    ensure(plants[0] == 0 && plants[1] > 10_000, || {
        format!("plants: {plants:?}")
    })?;
    Ok(format!(
        "{count} refused with a sentence, the others finite with {plants:?} active plants"
    ))
}
