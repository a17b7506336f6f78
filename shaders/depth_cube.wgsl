// Depth cubes: six orthographic depth faces around a convex part. Twin: src/sim/depth_cube.rs.
//
// One invocation per texel (workgroup y is the job): a ray through its centre meets the part's
// closed form.
#import "shared/rigid.wgsl"
#import "shared/solid.wgsl"
#import "shared/texel.wgsl"

// One convex part.
struct PartRecord {
    // `body_from_part`: unit quaternion x, y, z, w and place.
    turn: vec4f,
    place: vec3f,
    // Run of the parts of its shape, itself among them.
    first_sibling: u32,
    end_sibling: u32,
    spare_a: u32,
    spare_b: vec2u,
    // Grown by the skin.
    solid: SolidRecord,
}

// A cube to draw.
struct CubeJob {
    part: u32,
    // A surface point this deep inside a grown sibling is hidden.
    cover_m: f32,
}

@group(1) @binding(5) var<storage, read_write> texels: array<vec2u>;
@group(1) @binding(7) var<storage, read> parts: array<PartRecord>;
@group(1) @binding(8) var<storage, read> jobs: array<CubeJob>;

// Where a ray meets a solid.
struct Meeting {
    met: bool,
    distance: f32,
    normal: vec3f,
}

fn enter_ball(start: vec3f, along: vec3f, radius: f32) -> Meeting {
    let middle = -dot(start, along);
    let off = start + along * middle;
    let left = radius * radius - dot(off, off);
    if left <= 0.0 {
        return Meeting(false, 0.0, UP);
    }
    let t = middle - sqrt(left);
    return Meeting(true, t, unit_or(start + along * t, -along));
}

fn enter_planes(solid: SolidRecord, start: vec3f, along: vec3f) -> Meeting {
    var first = Meeting(true, 0.0, -along);
    var last = 3.4e38;
    for (var face = 0u; face < face_count(solid); face++) {
        // The depth behind a plane is how far it is ahead along its normal.
        let plane = solid_face(solid, start, face);
        let slope = dot(plane.xyz, along);
        if abs(slope) < 1e-7 {
            if plane.w < 0.0 {
                return Meeting(false, 0.0, UP);
            }
        } else if slope < 0.0 {
            let t = plane.w / slope;
            // Bounds touch the outermost planes, so `>=` lets a face at the very start win.
            if t >= first.distance {
                first = Meeting(true, t, plane.xyz);
            }
        } else {
            last = min(last, plane.w / slope);
        }
    }
    first.met = first.distance < last;
    return first;
}

fn enter_cylinder(start: vec3f, along: vec3f, radius: f32, half: f32) -> Meeting {
    if along.y != 0.0 {
        let inside = start.x * start.x + start.z * start.z < radius * radius;
        return Meeting(inside, abs(start.y) - half, vec3f(0.0, -along.y, 0.0));
    }
    var meeting = enter_ball(vec3f(start.x, 0.0, start.z), along, radius);
    meeting.met = meeting.met && abs(start.y) < half;
    return meeting;
}

fn enter_capsule(start: vec3f, along: vec3f, radius: f32, half: f32) -> Meeting {
    // The nearest ball of the capsule: the end it comes from, or the one at the ray's own height.
    let centre = select(clamp(start.y, -half, half), -along.y * half, along.y != 0.0);
    return enter_ball(vec3f(start.x, start.y - centre, start.z), along, radius);
}

// First meeting of a ray along a coordinate axis with a solid.
fn enter(solid: SolidRecord, start: vec3f, along: vec3f) -> Meeting {
    switch solid.kind {
        case SOLID_BOX, SOLID_CONVEX: {
            return enter_planes(solid, start, along);
        }
        case SOLID_CYLINDER: {
            return enter_cylinder(start, along, solid.dims.x, solid.dims.y);
        }
        case SOLID_CAPSULE: {
            return enter_capsule(start, along, solid.dims.x, solid.dims.y);
        }
        default: {
            return enter_ball(start, along, solid.dims.x);
        }
    }
}

// Start of the ray through a texel of a face.
fn ray_start(solid: SolidRecord, face: u32, column: u32, row: u32) -> vec3f {
    let a = face >> 1u;
    let size = solid.high - solid.low;
    let middle = vec2f(vec2u(column, row)) + 0.5;
    let share = middle / f32(solid.resolution);
    var start = select(solid.low, solid.high, (face & 1u) == 0u);
    let b = (a + 1u) % 3u;
    let c = (a + 2u) % 3u;
    start[b] = solid.low[b] + share.x * size[b];
    start[c] = solid.low[c] + share.y * size[c];
    return start;
}

// True where a point of a part lies inside another part of its body.
fn covered(part: u32, p: vec3f, cover_m: f32) -> bool {
    let in_body = rotate(parts[part].turn, p) + parts[part].place;
    for (var n = parts[part].first_sibling; n < parts[part].end_sibling; n++) {
        if n != part {
            let p_there = inverse_point(Pose(parts[n].turn, parts[n].place), in_body);
            if solid_depth(parts[n].solid, p_there) > cover_m {
                return true;
            }
        }
    }
    return false;
}

@compute @workgroup_size(WORKGROUP)
fn draw_cube(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let job = jobs[group.y];
    let solid = parts[job.part].solid;
    let per_face = solid.resolution * solid.resolution;
    let texel = group.x * WORKGROUP + local;
    if texel >= 6u * per_face {
        return;
    }
    let face = texel / per_face;
    let within = texel % per_face;
    let start = ray_start(solid, face, within % solid.resolution, within / solid.resolution);
    let along = -face_normal(face);
    let meeting = enter(solid, start, along);
    var word = vec2u(0u);
    if meeting.met {
        let hidden = covered(job.part, start + along * meeting.distance, job.cover_m);
        let extent = (solid.high - solid.low)[face >> 1u];
        word = pack_texel(meeting.distance / extent, meeting.normal, hidden);
    }
    texels[solid.first_texel + texel] = word;
}
