// The closed form of a convex part. Twin: src/sim/solid.rs.
#import "shared/field.wgsl"

struct SolidRecord {
    // SOLID_BALL, SOLID_BOX, SOLID_CAPSULE, SOLID_CYLINDER or SOLID_CONVEX.
    kind: u32,
    // Run of `planes` of a convex one.
    first_plane: u32,
    plane_count: u32,
    // Texels along the edge of a face of its depth cube, and where the cube begins.
    resolution: u32,
    // Ball: radius. Box: half sides. Capsule, cylinder: radius, half length.
    dims: vec3f,
    first_texel: u32,
    // Bounds.
    low: vec3f,
    spare_a: u32,
    high: vec3f,
    spare_b: u32,
}

// Normal and offset: points with normal·p ≤ offset are inside.
@group(1) @binding(6) var<storage, read> planes: array<vec4f>;

// The way out of a solid.
struct Exit {
    // Distance to the surface along the normal; 0 or less: the point is outside.
    depth: f32,
    normal: vec3f,
    face: u32,
}

fn outside() -> Exit {
    return Exit(0.0, UP, NO_FACE);
}

// The segment whose upper node looks for a way out.
struct Reach {
    // The segment's lower node, in the space of the solid.
    start: vec3f,
    // Its length; less than 0 if anything can be reached.
    length: f32,
    // Where the upper node was before the segment was laid out.
    before: vec3f,
}

// What the way out of p by `depth` along a normal costs.
fn cost(reach: Reach, p: vec3f, depth: f32, normal: vec3f) -> f32 {
    let rise = dot(p - reach.start, normal) + depth;
    let far = reach.length >= 0.0 && abs(rise) >= reach.length;
    return select(depth, depth + OUT_OF_REACH_M, far);
}

// True where the upper node was beyond the surface that a way out of p leads to.
fn came_through(reach: Reach, p: vec3f, exit: Exit) -> bool {
    return reach.length >= 0.0
        && dot(reach.before - p, exit.normal) > exit.depth - CAME_THROUGH_M;
}

// The cheapest way out among those offered, the one through the kept face, and the cheapest back
// where a laid out node came in.
struct Choice {
    best: Exit,
    least: f32,
    keep: Exit,
    keep_cost: f32,
    back: Exit,
    back_cost: f32,
}

fn no_choice() -> Choice {
    return Choice(outside(), 0.0, outside(), 0.0, outside(), 0.0);
}

// A `hidden` way ends in another part of the body.
fn offer(
    choice: ptr<function, Choice>,
    p: vec3f,
    kept: u32,
    reach: Reach,
    exit: Exit,
    hidden: bool,
) {
    let price = cost(reach, p, exit.depth, exit.normal) + select(0.0, HIDDEN_M, hidden);
    if exit.face == kept {
        (*choice).keep = exit;
        (*choice).keep_cost = price;
    }
    if (*choice).best.face == NO_FACE || price < (*choice).least {
        (*choice).best = exit;
        (*choice).least = price;
    }
    let cheaper = (*choice).back.face == NO_FACE || price < (*choice).back_cost;
    if price < HIDDEN_M && cheaper && came_through(reach, p, exit) {
        (*choice).back = exit;
        (*choice).back_cost = price;
    }
}

// The kept way out while no other is cheaper by KEEP_FACE; never to the far side of where a laid out
// node can go back.
fn take(choice: Choice) -> Exit {
    var exit = choice.best;
    if choice.keep.face != NO_FACE && choice.keep_cost * KEEP_FACE <= choice.least {
        exit = choice.keep;
    }
    if choice.back.face != NO_FACE && dot(choice.back.normal, exit.normal) < OPPOSITE {
        return choice.back;
    }
    return exit;
}

// Features that a way out may lead through.
fn face_count(solid: SolidRecord) -> u32 {
    switch solid.kind {
        case SOLID_BOX: {
            return 6u;
        }
        case SOLID_CYLINDER: {
            return 3u;
        }
        case SOLID_CONVEX: {
            return solid.plane_count;
        }
        default: {
            return 1u;
        }
    }
}

// Outward normal of a depth cube's or box's face: 0 is +x, 1 is −x, and so on.
fn face_normal(face: u32) -> vec3f {
    let sign = select(-1.0, 1.0, (face & 1u) == 0u);
    let a = face >> 1u;
    return sign * vec3f(f32(a == 0u), f32(a == 1u), f32(a == 2u));
}

// From the nearest point of a capsule's axis to the point.
fn from_axis(p: vec3f, half: f32) -> vec3f {
    return vec3f(p.x, p.y - clamp(p.y, -half, half), p.z);
}

fn round_face(out: vec3f, radius: f32) -> vec4f {
    return vec4f(unit_or(out, vec3f(1.0, 0.0, 0.0)), radius - length(out));
}

// Outward normal of a feature, and the depth of a point behind it.
fn solid_face(solid: SolidRecord, p: vec3f, face: u32) -> vec4f {
    let dims = solid.dims;
    switch solid.kind {
        case SOLID_BOX: {
            let n = face_normal(face);
            return vec4f(n, dot(abs(n), dims) - dot(n, p));
        }
        case SOLID_CYLINDER: {
            if face == 0u {
                return round_face(vec3f(p.x, 0.0, p.z), dims.x);
            }
            let up = select(-1.0, 1.0, face == 1u);
            return vec4f(0.0, up, 0.0, dims.y - up * p.y);
        }
        case SOLID_CONVEX: {
            let plane = planes[solid.first_plane + face];
            return vec4f(plane.xyz, plane.w - dot(plane.xyz, p));
        }
        case SOLID_CAPSULE: {
            return round_face(from_axis(p, dims.y), dims.x);
        }
        default: {
            return round_face(p, dims.x);
        }
    }
}

// Radius of a round feature; 0 of a flat one.
fn round_radius(solid: SolidRecord, face: u32) -> f32 {
    let round = solid.kind != SOLID_BOX && solid.kind != SOLID_CONVEX
        && (solid.kind != SOLID_CYLINDER || face == 0u);
    return select(0.0, solid.dims.x, round);
}

// The way out through a round feature, the shortest in the reach of a segment. Twin:
// src/sim/solid/round.rs.
fn way_in_reach(p: vec3f, way: vec4f, radius: f32, reach: Reach) -> vec4f {
    let n = way.xyz;
    let rise = dot(p - reach.start, n) + way.w;
    if abs(rise) < reach.length || reach.length <= 0.0 {
        return way;
    }
    let centre = p + n * (way.w - radius);
    let to_centre = centre - reach.start;
    let axis = unit_or(to_centre, n);
    let along = dot(to_centre, axis);
    let span = along * reach.length;
    let cosine = 0.5 * (along * along + reach.length * reach.length - radius * radius)
        / max(span, LEAST_SPAN_M2);
    if abs(cosine) >= 1.0 {
        return way;
    }
    let aside = unit_or(n - axis * dot(axis, n), across(axis));
    let sine = sqrt(1.0 - cosine * cosine);
    let end = reach.start + (axis * cosine + aside * sine) * reach.length;
    let normal = unit_or(end - centre, n);
    return vec4f(normal, dot(end - p, normal));
}

// Depth of a point: positive inside.
fn solid_depth(solid: SolidRecord, p: vec3f) -> f32 {
    var least = 1e30;
    for (var face = 0u; face < face_count(solid); face++) {
        least = min(least, solid_face(solid, p, face).w);
    }
    return least;
}
