//! Ground, plants, wind and solver settings.

use super::check::{Check, Key, at_most, name, ordered, within, within_each};
use crate::base::most;
use crate::scene::{Form, Grass, Ground, Likes, Response, Solver, Species, Terrain, Wind, limits};

pub(super) fn terrain(key: &Key, terrain: &Terrain) -> Check {
    ground(&key.field("ground"), &terrain.ground)?;
    within_each(&key.field("centre_m"), &terrain.centre_m, &limits::PLACE)?;
    for (field, rgb) in [
        ("lush_rgb", terrain.lush_rgb),
        ("dry_rgb", terrain.dry_rgb),
        ("soil_rgb", terrain.soil_rgb),
    ] {
        within_each(&key.field(field), &rgb, &limits::FRACTION)?;
    }
    within(&key.field("friction"), terrain.friction, &limits::FRICTION)
}

fn ground(key: &Key, ground: &Ground) -> Check {
    match ground {
        Ground::Flat { size_m, spacing_m } => plan(key, size_m, *spacing_m),
        Ground::Rolling {
            size_m,
            spacing_m,
            amplitude_m,
            wavelength_m,
            octaves,
            seed: _,
        } => {
            plan(key, size_m, *spacing_m)?;
            within(&key.field("amplitude_m"), *amplitude_m, &limits::AMPLITUDE)?;
            within(
                &key.field("wavelength_m"),
                *wavelength_m,
                &limits::WAVELENGTH,
            )?;
            within(&key.field("octaves"), *octaves, &limits::OCTAVES)
        }
        Ground::HeightMap {
            file: _,
            spacing_m,
            height_m,
        } => {
            within(&key.field("spacing_m"), *spacing_m, &limits::HEIGHT_SPACING)?;
            within(&key.field("height_m"), *height_m, &limits::HEIGHT)
        }
    }
}

fn plan(key: &Key, size_m: &[f32; 2], spacing_m: f32) -> Check {
    within_each(&key.field("size_m"), size_m, &limits::TERRAIN_SIDE)?;
    within(&key.field("spacing_m"), spacing_m, &limits::HEIGHT_SPACING)
}

pub(super) fn grass(key: &Key, grass: &Grass) -> Check {
    let density = grass.density_per_m2;
    within(
        &key.field("density_per_m2"),
        density,
        &limits::PLANT_DENSITY,
    )?;
    within(&key.field("cluster"), grass.cluster, &limits::CLUSTER)?;
    let bare = key.field("bare");
    let key = key.field("species");
    at_most(&key, grass.species.len(), limits::SPECIES, "species")?;
    for (i, one) in grass.species.iter().enumerate() {
        species(&key.nth(i), one)?;
    }
    let shares: f32 = grass.species.iter().map(|s| s.share).sum();
    if !grass.species.is_empty() && shares <= 0.0 {
        return key.fail("has no share above 0; give at least one species a positive share");
    }
    tastes(&key, &bare, grass)
}

/// Either every kind says what ground it likes, or none does.
fn tastes(species: &Key, bare: &Key, grass: &Grass) -> Check {
    at_most(bare, grass.bare.len(), limits::BARE_GROUNDS, "bare grounds")?;
    for (i, one) in grass.bare.iter().enumerate() {
        likes(&bare.nth(i), one)?;
    }
    if !grass.grows_by_colour() {
        if grass.bare.is_empty() {
            return Ok(());
        }
        return bare
            .clone()
            .fail("is given, but no species has `likes`; give every species one");
    }
    for (i, one) in grass.species.iter().enumerate() {
        if one.likes.is_none() {
            let what = "is missing, but another species has one; give it to all or to none";
            return species.nth(i).field("likes").fail(what);
        }
        if one.share <= 0.0 {
            let what = "is 0, and a score of 0 is never chosen; leave the species out";
            return species.nth(i).field("share").fail(what);
        }
    }
    Ok(())
}

fn likes(key: &Key, likes: &Likes) -> Check {
    let ranges = [&limits::HUE, &limits::FRACTION, &limits::FRACTION];
    for (i, (&value, range)) in likes.hsv.iter().zip(ranges).enumerate() {
        within(&key.field("hsv").nth(i), value, range)?;
    }
    let weights = key.field("weights");
    within_each(&weights, &likes.weights, &limits::COLOUR_WEIGHT)?;
    // Hues are at most half a turn apart, saturations and values 1.
    let [hue, others @ ..] = likes.weights;
    let farthest = others.into_iter().fold(0.5 * hue, most);
    if farthest <= limits::LEAST_DISTANCE {
        let what = "are so small that no colour differs from another: distances up to 1/128 count as none; \
                    write more than 1/64 for the hue, or more than 1/128 for saturation or value";
        return weights.fail(what);
    }
    let exponent = key.field("exponent");
    within(&exponent, likes.exponent, &limits::SCORE_EXPONENT)?;
    let threshold = key.field("threshold");
    within(&threshold, likes.threshold, &limits::SCORE_THRESHOLD)?;
    within(&key.field("dwindle"), likes.dwindle, &limits::FRACTION)
}

fn form(key: &Key, form: &Form) -> Check {
    match form {
        Form::Blade | Form::Leaf | Form::Twig | Form::Gravel => Ok(()),
        Form::Flower {
            head_m,
            petals,
            petal_rgb,
            centre_rgb,
        } => {
            within(&key.field("head_m"), *head_m, &limits::PLANT_WIDTH)?;
            within(&key.field("petals"), *petals, &limits::PETALS)?;
            within_each(&key.field("petal_rgb"), petal_rgb, &limits::FRACTION)?;
            within_each(&key.field("centre_rgb"), centre_rgb, &limits::FRACTION)
        }
    }
}

/// Stones keep their shape, and nothing else does.
fn response(key: &Key, species: &Species) -> Check {
    let is_stone = species.form == Form::Gravel;
    let what = match species.response {
        Response::Bends if is_stone => {
            "is Bends (so it is where none is given), but the form Gravel, a stone, does not bend; \
             write Shoved if bodies push it aside, Stays if they pass through it"
        }
        Response::Shoved if !is_stone => {
            "is Shoved, but only the form Gravel, a stone, keeps its shape; \
             write Bends if bodies push it aside, Stays if they pass through it"
        }
        Response::Bends | Response::Shoved | Response::Stays => return Ok(()),
    };
    key.clone().fail(what)
}

fn species(key: &Key, species: &Species) -> Check {
    name(&key.field("name"), &species.name)?;
    form(&key.field("form"), &species.form)?;
    response(&key.field("response"), species)?;
    if let Some(taste) = &species.likes {
        likes(&key.field("likes"), taste)?;
    }
    within(&key.field("share"), species.share, &limits::SHARE)?;
    ordered(
        &key.field("height_m"),
        species.height_m,
        &limits::PLANT_HEIGHT,
    )?;
    ordered(&key.field("width_m"), species.width_m, &limits::PLANT_WIDTH)?;
    ordered(
        &key.field("stiffness"),
        species.stiffness,
        &limits::STIFFNESS,
    )?;
    ordered(&key.field("lean_deg"), species.lean_deg, &limits::ROOT_LEAN)?;
    if let Some(towards) = &species.phototropic {
        let key = key.field("phototropic");
        within(&key.field("light_deg"), towards.light_deg, &limits::ANGLE)?;
        let spread = key.field("spread_deg");
        within(&spread, towards.spread_deg, &limits::AZIMUTH_SPREAD)?;
    }
    within(
        &key.field("flexibility"),
        species.flexibility,
        &limits::FLEXIBILITY,
    )?;
    within_each(&key.field("tint_rgb"), &species.tint_rgb, &limits::TINT)
}

pub(super) fn wind(key: &Key, wind: &Wind) -> Check {
    within(
        &key.field("direction_deg"),
        wind.direction_deg,
        &limits::ANGLE,
    )?;
    within(&key.field("strength"), wind.strength, &limits::WIND_BEND)?;
    within(&key.field("gust"), wind.gust, &limits::WIND_BEND)?;
    within(
        &key.field("gust_length_m"),
        wind.gust_length_m,
        &limits::GUST_LENGTH,
    )?;
    within(
        &key.field("gust_speed_m_per_s"),
        wind.gust_speed_m_per_s,
        &limits::GUST_SPEED,
    )?;
    within(&key.field("flutter"), wind.flutter, &limits::WIND_BEND)
}

pub(super) fn solver(key: &Key, solver: &Solver) -> Check {
    within(&key.field("substep_s"), solver.substep_s, &limits::SUBSTEP)?;
    within(
        &key.field("recovery_s"),
        solver.recovery_s,
        &limits::RECOVERY,
    )?;
    within(&key.field("segments"), solver.segments, &limits::SEGMENTS)?;
    within(
        &key.field("cube_resolution"),
        solver.cube_resolution,
        &limits::CUBE_RESOLUTION,
    )?;
    within(&key.field("skin_m"), solver.skin_m, &limits::SKIN)?;
    within(
        &key.field("spring_rate_per_s"),
        solver.spring_rate_per_s,
        &limits::SPRING_RATE,
    )?;
    ordered(&key.field("rounds"), solver.rounds, &limits::ROUNDS)?;
    within(
        &key.field("strain_limit"),
        solver.strain_limit,
        &limits::STRAIN_LIMIT,
    )?;
    within(&key.field("max_sweeps"), solver.max_sweeps, &limits::SWEEPS)?;
    within(&key.field("tile_m"), solver.tile_m, &limits::TILE_SIDE)?;
    within(
        &key.field("seeding_cell_m"),
        solver.seeding_cell_m,
        &limits::SEEDING_CELL,
    )?;
    within(
        &key.field("method").field("sweep_share"),
        solver.method.sweep_share,
        &limits::SWEEP_SHARE,
    )?;
    within(
        &key.field("method").field("grass_steps"),
        solver.method.grass_steps,
        &limits::GRASS_STEPS,
    )?;
    within_each(
        &key.field("blade_table"),
        solver.blade_table.as_slice().as_flattened(),
        &limits::BLADE_TABLE,
    )
}
