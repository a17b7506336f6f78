//! Timed events: in time, on bodies that are there, and able to act on them.

use std::collections::HashMap;

use super::check::{Check, Key, at_most, within, within_each};
use super::meadow;
use crate::scene::assets::bodies_with_keys;
use crate::scene::{Action, Body, Motion, Scene, Shape, limits};

/// Checks every event by itself, then plays the script through to see who is there when.
pub(super) fn script(key: &Key, scene: &Scene) -> Check {
    at_most(key, scene.script.len(), limits::EVENTS, "events")?;
    for (i, event) in scene.script.iter().enumerate() {
        let key = key.nth(i);
        in_the_run(&key.field("at_s"), event.at_s, scene)?;
        action(&key.field("action"), &event.action)?;
    }
    play(key, scene)
}

/// Checks that a body of this name is there at some time.
pub(super) fn known(key: &Key, name: &str, scene: &Scene) -> Check {
    if bodies_with_keys(scene).any(|(_, body)| body.name == name) {
        return Ok(());
    }
    let names: Vec<_> = bodies_with_keys(scene)
        .map(|(_, body)| body.name.as_str())
        .take(8)
        .collect();
    let there = if names.is_empty() {
        "the scene has no bodies".to_owned()
    } else {
        format!("there are {}", names.join(", "))
    };
    key.clone().fail(format!(
        "names \"{name}\", which is no body of the scene; {there}"
    ))
}

/// Checks a time against the length of the run.
pub(super) fn in_the_run(key: &Key, at_s: f64, scene: &Scene) -> Check {
    let run = limits::Range {
        min: 0.0,
        max: scene.duration_s,
        unit: "s, the length of the run (duration_s)",
    };
    within(key, at_s, &run)
}

fn action(key: &Key, action: &Action) -> Check {
    match action {
        // A spawned body is checked together with the others.
        Action::Spawn(_) | Action::Remove { .. } => Ok(()),
        Action::Teleport {
            body: _,
            position_m,
            velocity_m_per_s,
        } => {
            within_each(&key.field("position_m"), position_m, &limits::PLACE)?;
            within_each(
                &key.field("velocity_m_per_s"),
                velocity_m_per_s,
                &limits::VELOCITY,
            )
        }
        Action::Throw {
            body: _,
            velocity_m_per_s,
            spin_deg_per_s,
        } => {
            within_each(
                &key.field("velocity_m_per_s"),
                velocity_m_per_s,
                &limits::VELOCITY,
            )?;
            within_each(&key.field("spin_deg_per_s"), spin_deg_per_s, &limits::SPIN)
        }
        Action::Impulse {
            body: _,
            impulse_kg_m_per_s,
        } => within_each(
            &key.field("impulse_kg_m_per_s"),
            impulse_kg_m_per_s,
            &limits::IMPULSE,
        ),
        Action::Drive {
            body: _,
            engine_n,
            steer_deg,
            brake_n,
        } => {
            within(&key.field("engine_n"), *engine_n, &limits::ENGINE_FORCE)?;
            within(&key.field("steer_deg"), *steer_deg, &limits::STEER)?;
            within(&key.field("brake_n"), *brake_n, &limits::BRAKE_FORCE)
        }
        Action::SetWind(wind) => meadow::wind(key, wind),
    }
}

/// When a body is there.
struct Presence<'a> {
    body: &'a Body,
    from_s: f64,
    removed_s: Option<f64>,
}

fn play(key: &Key, scene: &Scene) -> Check {
    let mut presences = HashMap::new();
    for body in &scene.bodies {
        let presence = Presence {
            body,
            from_s: 0.0,
            removed_s: None,
        };
        presences.insert(body.name.as_str(), presence);
    }
    let mut in_time: Vec<_> = scene.script.iter().enumerate().collect();
    // A stable sort: events of one time act in the order of the file.
    in_time.sort_by(|(_, a), (_, b)| a.at_s.total_cmp(&b.at_s));
    for (i, event) in in_time {
        let key = key.nth(i).field("action");
        let Some(name) = event.action.body() else {
            if let Action::Spawn(body) = &event.action {
                let presence = Presence {
                    body,
                    from_s: event.at_s,
                    removed_s: None,
                };
                presences.insert(body.name.as_str(), presence);
            }
            continue;
        };
        let key = key.field("body");
        known(&key, name, scene)?;
        let Some(presence) = presences.get_mut(name) else {
            let what = format!("names \"{name}\" at {} s, before it is spawned", event.at_s);
            return key.fail(what);
        };
        if let Some(removed_s) = presence.removed_s {
            let what = format!(
                "names \"{name}\" at {} s, but it is there from {} s until its removal at {removed_s} s",
                event.at_s, presence.from_s
            );
            return key.fail(what);
        }
        able(&key, &event.action, presence.body)?;
        if matches!(event.action, Action::Remove { .. }) {
            presence.removed_s = Some(event.at_s);
        }
    }
    Ok(())
}

/// Checks that an action can have an effect on a body.
fn able(key: &Key, action: &Action, body: &Body) -> Check {
    let name = &body.name;
    match (action, &body.motion) {
        (Action::Drive { .. }, _) if !matches!(body.shape, Shape::Vehicle { .. }) => {
            key.clone().fail(format!(
                "names \"{name}\", which is no Vehicle and cannot be driven"
            ))
        }
        (
            Action::Throw { .. } | Action::Impulse { .. } | Action::Teleport { .. },
            Motion::Path { .. },
        ) => key.clone().fail(format!(
            "names \"{name}\", which keeps to its Path whatever acts on it"
        )),
        (Action::Throw { .. } | Action::Impulse { .. }, Motion::Fixed) => key
            .clone()
            .fail(format!("names \"{name}\", which is Fixed and never moves")),
        _ => Ok(()),
    }
}
