//! Expectations: in time, over a place that has grass, with a limit that can be missed.

use super::check::{Check, Key, at_most, within, within_each};
use super::script::{in_the_run, known};
use crate::scene::budget::FieldSize;
use crate::scene::limits::Range;
use crate::scene::{Expectation, Scene, limits};

pub(super) fn expectations(key: &Key, scene: &Scene) -> Check {
    at_most(
        key,
        scene.expect.len(),
        limits::EXPECTATIONS,
        "expectations",
    )?;
    for (i, expectation) in scene.expect.iter().enumerate() {
        one(&key.nth(i), expectation, scene)?;
    }
    Ok(())
}

fn one(key: &Key, expectation: &Expectation, scene: &Scene) -> Check {
    let time = |at_s: f64| in_the_run(&key.field("at_s"), at_s, scene);
    let radius = |m: f64| within(&key.field("within_m"), m, &limits::MEASURED_RADIUS);
    match expectation {
        Expectation::Lean {
            at_s,
            near_m,
            within_m,
            at_least_deg,
            at_most_deg,
        } => {
            time(*at_s)?;
            within_each(&key.field("near_m"), near_m, &limits::PLACE)?;
            radius(*within_m)?;
            let names = ["at_least_deg", "at_most_deg"];
            bounds(key, names, [*at_least_deg, *at_most_deg], &limits::LEAN)
        }
        Expectation::Offset {
            at_s,
            near_m,
            within_m,
            at_least_m,
            at_most_m,
        } => {
            time(*at_s)?;
            within_each(&key.field("near_m"), near_m, &limits::PLACE)?;
            radius(*within_m)?;
            let names = ["at_least_m", "at_most_m"];
            bounds(
                key,
                names,
                [*at_least_m, *at_most_m],
                &limits::MEASURED_OFFSET,
            )
        }
        Expectation::Penetration { at_most_m } => at_most_m.map_or(Ok(()), |m| {
            within(&key.field("at_most_m"), m, &limits::MEASURED_OFFSET)
        }),
        Expectation::Strain { at_most } => {
            within(&key.field("at_most"), *at_most, &limits::FRACTION)
        }
        Expectation::AllRest { by_s } => in_the_run(&key.field("by_s"), *by_s, scene),
        Expectation::ActiveTiles { at_least, at_most }
        | Expectation::SimulatedPlants { at_least, at_most } => counts(key, *at_least, *at_most),
        // Any number of bytes can be asked for.
        Expectation::StateBytes { at_most: _ } => Ok(()),
        Expectation::BodyNear {
            body,
            at_s,
            position_m,
            within_m,
        } => {
            known(&key.field("body"), body, scene)?;
            time(*at_s)?;
            within_each(&key.field("position_m"), position_m, &limits::PLACE)?;
            radius(*within_m)
        }
        Expectation::Imprint {
            body,
            at_s,
            at_least,
        } => {
            known(&key.field("body"), body, scene)?;
            time(*at_s)?;
            within(&key.field("at_least"), *at_least, &limits::FRACTION)
        }
        Expectation::StateHash { is } => hash(key, is),
    }
}

fn bounds(key: &Key, names: [&str; 2], limits: [Option<f64>; 2], range: &Range) -> Check {
    for (name, limit) in names.into_iter().zip(limits) {
        if let Some(limit) = limit {
            within(&key.field(name), limit, range)?;
        }
    }
    met_by_some_value(key, names, limits)
}

fn counts(key: &Key, at_least: Option<u64>, at_most: Option<u64>) -> Check {
    met_by_some_value(key, ["at_least", "at_most"], [at_least, at_most])
}

/// Refuses an expectation that every run meets, and one that none can.
fn met_by_some_value<T>(key: &Key, names: [&str; 2], limits: [Option<T>; 2]) -> Check
where
    T: PartialOrd + std::fmt::Display,
{
    let [least, most] = names;
    match limits {
        [None, None] => key.clone().fail(format!(
            "has no limit, so nothing could miss it; give {least} or {most}"
        )),
        [Some(low), Some(high)] if low > high => key.field(least).fail(format!(
            "is {low}, above {most}, {high}; no value can be both"
        )),
        _ => Ok(()),
    }
}

fn hash(key: &Key, is: &str) -> Check {
    let hexadecimal = is.bytes().all(|b| b.is_ascii_hexdigit());
    if is.is_empty() || is.len() > 64 || !hexadecimal {
        return key
            .field("is")
            .fail("is no hash; write the 1 to 64 hexadecimal digits a run prints");
    }
    Ok(())
}

/// Checks that measured places lie on the ground: beyond it nothing grows to be measured.
pub(super) fn on_the_ground(key: &Key, scene: &Scene, field: &FieldSize) -> Check {
    for (i, expectation) in scene.expect.iter().enumerate() {
        let (Expectation::Lean { near_m, .. } | Expectation::Offset { near_m, .. }) = expectation
        else {
            continue;
        };
        for (axis, (&at, size_m)) in near_m.iter().zip(field.size_m).enumerate() {
            let centre_m = scene.terrain.centre_m[axis];
            let ground = Range {
                min: centre_m - 0.5 * size_m,
                max: centre_m + 0.5 * size_m,
                unit: "m, where the ground ends",
            };
            within(&key.nth(i).field("near_m").nth(axis), at, &ground)?;
        }
    }
    Ok(())
}
