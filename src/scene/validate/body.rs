//! One body: its shape, mass and motion.

use super::check::{Check, Key, at_most, name, within, within_each};
use crate::scene::extent::extents;
use crate::scene::{Body, Mass, Motion, Part, Shape, Waypoint, limits};

/// Checks a body by itself; that its name is unique is the scene's business.
pub(super) fn body(key: &Key, body: &Body) -> Check {
    name(&key.field("name"), &body.name)?;
    shape(&key.field("shape"), &body.shape)?;
    within_each(&key.field("position_m"), &body.position_m, &limits::PLACE)?;
    within_each(
        &key.field("rotation_deg"),
        &body.rotation_deg,
        &limits::ANGLE,
    )?;
    motion(&key.field("motion"), body)?;
    mass(&key.field("mass"), body.mass)?;
    within(&key.field("friction"), body.friction, &limits::FRICTION)?;
    within(
        &key.field("restitution"),
        body.restitution,
        &limits::FRACTION,
    )?;
    within_each(&key.field("damping"), &body.damping, &limits::DAMPING)?;
    within_each(&key.field("rgb"), &body.rgb, &limits::FRACTION)?;
    match &body.coat {
        Some(coat) => super::coat::coat(&key.field("coat"), coat),
        None => Ok(()),
    }
}

fn shape(key: &Key, shape: &Shape) -> Check {
    let length = |field: &str, value: f32| within(&key.field(field), value, &limits::BODY_LENGTH);
    match shape {
        Shape::Ball { radius_m } => length("radius_m", *radius_m),
        Shape::Box { size_m } => within_each(&key.field("size_m"), size_m, &limits::BODY_LENGTH),
        Shape::Capsule { radius_m, length_m } => {
            length("radius_m", *radius_m)?;
            length("length_m", *length_m)
        }
        Shape::Cylinder { radius_m, height_m } => {
            length("radius_m", *radius_m)?;
            length("height_m", *height_m)
        }
        Shape::ConvexHull { points_m } => hull(&key.field("points_m"), points_m),
        Shape::Mesh {
            file: _,
            scale,
            max_parts,
        } => {
            within(&key.field("scale"), *scale, &limits::MESH_SCALE)?;
            within(&key.field("max_parts"), *max_parts, &limits::MESH_PARTS)
        }
        Shape::Compound { parts } => compound(&key.field("parts"), parts),
        Shape::Vehicle {
            chassis_m,
            wheel_radius_m,
            wheel_width_m,
        } => {
            within_each(&key.field("chassis_m"), chassis_m, &limits::BODY_LENGTH)?;
            length("wheel_radius_m", *wheel_radius_m)?;
            length("wheel_width_m", *wheel_width_m)?;
            let longest = 0.25 * chassis_m[2];
            if *wheel_radius_m > longest {
                let what = format!(
                    "is {wheel_radius_m}; four wheels fit under a chassis {} m long up to {longest} m",
                    chassis_m[2]
                );
                return key.field("wheel_radius_m").fail(what);
            }
            Ok(())
        }
    }
}

fn hull(key: &Key, points_m: &[[f32; 3]]) -> Check {
    let [fewest, most] = limits::HULL_POINTS;
    if !(fewest..=most).contains(&points_m.len()) {
        let count = points_m.len();
        return key
            .clone()
            .fail(format!("has {count} points; write {fewest} to {most}"));
    }
    for (i, point) in points_m.iter().enumerate() {
        within_each(&key.nth(i), point, &limits::BODY_OFFSET)?;
    }
    let [_, _, thickness] = extents(points_m);
    let least = limits::BODY_LENGTH.min;
    if thickness < least {
        let what = format!(
            "lie in one plane, or within {thickness} m of one; a hull is at least {least} m thick"
        );
        return key.clone().fail(what);
    }
    Ok(())
}

fn compound(key: &Key, parts: &[Part]) -> Check {
    if parts.is_empty() {
        return key
            .clone()
            .fail("is empty; a compound needs at least one part");
    }
    at_most(key, parts.len(), limits::COMPOUND_PARTS, "parts")?;
    for (i, part) in parts.iter().enumerate() {
        let key = key.nth(i);
        let refused = match part.shape {
            Shape::Mesh { .. } => Some("mesh"),
            Shape::Compound { .. } => Some("compound"),
            Shape::Vehicle { .. } => Some("vehicle"),
            _ => None,
        };
        if let Some(refused) = refused {
            let what =
                format!("is a {refused}; a part is a Ball, Box, Capsule, Cylinder or ConvexHull");
            return key.field("shape").fail(what);
        }
        shape(&key.field("shape"), &part.shape)?;
        within_each(
            &key.field("position_m"),
            &part.position_m,
            &limits::BODY_OFFSET,
        )?;
        within_each(
            &key.field("rotation_deg"),
            &part.rotation_deg,
            &limits::ANGLE,
        )?;
    }
    Ok(())
}

fn motion(key: &Key, body: &Body) -> Check {
    let is_vehicle = matches!(body.shape, Shape::Vehicle { .. });
    match &body.motion {
        Motion::Free => Ok(()),
        Motion::Fixed | Motion::Path { .. } if is_vehicle => key
            .clone()
            .fail("holds a vehicle, which only its wheels move; write Free or Thrown"),
        Motion::Fixed => Ok(()),
        Motion::Thrown {
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
        Motion::Path {
            waypoints,
            repeat: _,
        } => path(&key.field("waypoints"), waypoints),
    }
}

fn path(key: &Key, waypoints: &[Waypoint]) -> Check {
    if waypoints.len() < 2 {
        let count = waypoints.len();
        let what = format!("has {count} way points; a path needs 2 (a body that stays is Fixed)");
        return key.clone().fail(what);
    }
    at_most(key, waypoints.len(), limits::WAYPOINTS, "way points")?;
    let mut last: Option<&Waypoint> = None;
    for (i, point) in waypoints.iter().enumerate() {
        let key = key.nth(i);
        let time = key.field("at_s");
        if point.at_s < 0.0 {
            return time.fail(format!("is {}; a path begins at 0 or later", point.at_s));
        }
        within(
            &time,
            point.at_s,
            &limits::Range {
                min: 0.0,
                ..limits::DURATION
            },
        )?;
        within_each(&key.field("position_m"), &point.position_m, &limits::PLACE)?;
        within_each(
            &key.field("rotation_deg"),
            &point.rotation_deg,
            &limits::ANGLE,
        )?;
        if let Some(last) = last {
            step(&key, last, point)?;
        }
        last = Some(point);
    }
    Ok(())
}

fn step(key: &Key, from: &Waypoint, to: &Waypoint) -> Check {
    let seconds = to.at_s - from.at_s;
    if seconds <= 0.0 {
        let what = format!(
            "is {}, not after the {} before it; times rise",
            to.at_s, from.at_s
        );
        return key.field("at_s").fail(what);
    }
    for axis in 0..3 {
        let speed = (to.position_m[axis] - from.position_m[axis]) / seconds;
        let limit = limits::VELOCITY.max;
        if speed.abs() > limit {
            let what = format!(
                "is reached at {} m/s along one axis; at most {limit} m/s are allowed",
                speed.abs()
            );
            return key.field("position_m").fail(what);
        }
    }
    Ok(())
}

fn mass(key: &Key, mass: Mass) -> Check {
    match mass {
        Mass::Kilograms(kilograms) => within(key, kilograms, &limits::KILOGRAMS),
        Mass::Density(density) => within(key, density, &limits::MASS_DENSITY),
    }
}
