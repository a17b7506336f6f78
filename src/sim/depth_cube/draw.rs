//! What a texel of a depth cube stores: the first meeting of its ray with the solid.

use crate::base::{Vec3, least, vec3};

use super::super::solid::{NO_FACE, Plane, Reach, Solid};
use super::{DEPTH_STEPS, HIDDEN, HIT, face_normal};

/// Start and direction of the ray through a texel of a face.
pub(super) fn ray(
    face: u32,
    low: Vec3<f32>,
    high: Vec3<f32>,
    s: f32,
    t: f32,
) -> (Vec3<f32>, Vec3<f32>) {
    let from = if face & 1 == 0 { high } else { low };
    let from = match face / 2 {
        0 => vec3(from.x, s, t),
        1 => vec3(t, from.y, s),
        _ => vec3(s, t, from.z),
    };
    (from, -face_normal(face))
}

/// First meeting of a ray along a coordinate axis with a solid: distance and outward normal.
pub(super) fn enter(
    solid: &Solid<f32>,
    from: Vec3<f32>,
    along: Vec3<f32>,
) -> Option<(f32, Vec3<f32>)> {
    match solid {
        Solid::Ball { radius } => enter_ball(from, along, *radius),
        Solid::Box { half } => {
            let plane = |x, y, z, offset| Plane {
                normal: vec3(x, y, z),
                offset,
            };
            let faces = [
                plane(1.0, 0.0, 0.0, half.x),
                plane(-1.0, 0.0, 0.0, half.x),
                plane(0.0, 1.0, 0.0, half.y),
                plane(0.0, -1.0, 0.0, half.y),
                plane(0.0, 0.0, 1.0, half.z),
                plane(0.0, 0.0, -1.0, half.z),
            ];
            enter_planes(&faces, from, along)
        }
        Solid::Convex { planes, .. } => enter_planes(planes, from, along),
        Solid::Cylinder { radius, half } => enter_cylinder(from, along, *radius, *half),
        Solid::Capsule { radius, half } => enter_capsule(from, along, *radius, *half),
        Solid::Union(_) | Solid::Mesh { .. } => march(solid, from, along),
    }
}

/// Steps along a ray by the distance to the solid, which no step can leap over.
fn march(solid: &Solid<f32>, from: Vec3<f32>, along: Vec3<f32>) -> Option<(f32, Vec3<f32>)> {
    /// Of a step, in metres: below it the surface is met.
    const NEAR_M: f32 = 2e-5;
    let [low, high] = solid.bounds();
    let end = (high - low).dot(along).abs();
    let mut t = 0.0;
    while t < end {
        let p = from + along * t;
        let outside = -solid.depth(p);
        if outside < NEAR_M {
            let below = p + along * (2.0 * NEAR_M);
            let exit = solid.exit(below, NO_FACE, &Reach::anywhere(), |_| false);
            return Some((t, exit.map_or(-along, |exit| exit.normal)));
        }
        t += outside;
    }
    None
}

fn enter_ball(from: Vec3<f32>, along: Vec3<f32>, radius: f32) -> Option<(f32, Vec3<f32>)> {
    let middle = -from.dot(along);
    let off = from + along * middle;
    let left = radius * radius - off.length_squared();
    (left > 0.0).then(|| {
        let t = middle - left.sqrt();
        (t, (from + along * t).unit_or(-along))
    })
}

fn enter_planes(
    planes: &[Plane<f32>],
    from: Vec3<f32>,
    along: Vec3<f32>,
) -> Option<(f32, Vec3<f32>)> {
    let mut first = (0.0_f32, -along);
    let mut last = f32::MAX;
    for plane in planes {
        let slope = plane.normal.dot(along);
        let ahead = plane.offset - plane.normal.dot(from);
        if slope.abs() < 1e-7 {
            if ahead < 0.0 {
                return None;
            }
        } else if slope < 0.0 {
            let t = ahead / slope;
            // Bounds touch the outermost planes, so `>=` lets a face at the very start win.
            if t >= first.0 {
                first = (t, plane.normal);
            }
        } else {
            last = least(last, ahead / slope);
        }
    }
    (first.0 < last).then_some(first)
}

fn enter_cylinder(
    from: Vec3<f32>,
    along: Vec3<f32>,
    radius: f32,
    half: f32,
) -> Option<(f32, Vec3<f32>)> {
    if along.y != 0.0 {
        let inside = from.x * from.x + from.z * from.z < radius * radius;
        return inside.then(|| (from.y.abs() - half, vec3(0.0, -along.y, 0.0)));
    }
    let (t, normal) = enter_ball(vec3(from.x, 0.0, from.z), along, radius)?;
    (from.y.abs() < half).then_some((t, normal))
}

fn enter_capsule(
    from: Vec3<f32>,
    along: Vec3<f32>,
    radius: f32,
    half: f32,
) -> Option<(f32, Vec3<f32>)> {
    // The nearest ball of the capsule: the end it comes from, or the one at the ray's own height.
    let centre = if along.y != 0.0 {
        -along.y * half
    } else {
        from.y.clamp(-half, half)
    };
    enter_ball(vec3(from.x, from.y - centre, from.z), along, radius)
}

pub(super) fn pack(depth: f32, normal: Vec3<f32>, hidden: bool) -> [u32; 2] {
    let steps = (depth.clamp(0.0, 1.0) * DEPTH_STEPS as f32) as u32;
    let flags = HIT | if hidden { HIDDEN } else { 0 };
    [flags | steps, pack_normal(normal)]
}

/// Octahedral map of a unit normal, 16 bits for each of its two coordinates.
pub(super) fn pack_normal(n: Vec3<f32>) -> u32 {
    let sum = n.x.abs() + n.y.abs() + n.z.abs();
    let (mut x, mut y) = (n.x / sum, n.y / sum);
    if n.z < 0.0 {
        let sign = |v: f32| if v < 0.0 { -1.0 } else { 1.0 };
        (x, y) = ((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y));
    }
    let steps = |v: f32| ((v * 0.5 + 0.5).clamp(0.0, 1.0) * 65_535.0 + 0.5) as u32;
    steps(x) | steps(y) << 16
}
