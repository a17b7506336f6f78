// One part near a tile. Twin: src/sim/contact.rs; records: src/gpu/tick_data.rs.
#import "shared/cube.wgsl"
#import "shared/rigid.wgsl"
#import "shared/solid.wgsl"
#import "shared/tick.wgsl"
#import "shared/tile.wgsl"

struct ContactRecord {
    // `anchor_from_part` at the start and the end of the sub-step: unit quaternions x, y, z, w.
    from_turn: vec4f,
    to_turn: vec4f,
    from_place: vec3f,
    // Radius about the part's origin that holds the part.
    radius_m: f32,
    to_place: vec3f,
    // Pieces the sub-step is cut into for this body.
    sweeps: u32,
    // Body and part, in the upper bits of a vertex's memory of its face.
    key: u32,
    // 1: tested with the depth cube.
    uses_cube: u32,
    // A vertex that was pushed before is held while it is no farther off.
    hold_m: f32,
    // Number of the part within its body, whose parts follow one another.
    part_in_body: u32,
    parts_of_body: u32,
    spare_a: u32,
    spare_b: vec2u,
    solid: SolidRecord,
}

@group(1) @binding(2) var<storage, read> contacts: array<ContactRecord>;

// The part's pose at a share of the sub-step.
fn pose_at(contact: u32, share: f32) -> Pose {
    let from_pose = Pose(contacts[contact].from_turn, contacts[contact].from_place);
    let to_pose = Pose(contacts[contact].to_turn, contacts[contact].to_place);
    return lerp_poses(from_pose, to_pose, share);
}

// True where the swept ball around the part may reach a ball around a plant's root.
fn reaches(contact: u32, root: vec3f, reach: f32) -> bool {
    let from_place = contacts[contact].from_place;
    let way = contacts[contact].to_place - from_place;
    let length_squared = dot(way, way);
    var t = 0.0;
    if length_squared > 1e-12 {
        t = clamp(dot(root - from_place, way) / length_squared, 0.0, 1.0);
    }
    let apart = root - (from_place + way * t);
    let distance = contacts[contact].radius_m + reach;
    return dot(apart, apart) <= distance * distance;
}

// Sweeps a plant needs: the most of any body that may reach it; 0 if none does.
fn sweeps_for(tile: TileRecord, root: vec3f, reach: f32) -> u32 {
    var most = 0u;
    for (var contact = tile.first_contact; contact < tile.end_contact; contact++) {
        if reaches(contact, root, reach) {
            most = max(most, contacts[contact].sweeps);
        }
    }
    return most;
}

// True where a vertex is inside the part at a pose, and not merely on its surface.
fn holds(contact: u32, pose: Pose, vertex: vec3f) -> bool {
    let p = inverse_point(pose, vertex);
    if contacts[contact].uses_cube != 0u {
        return cube_is_deeper(contacts[contact].solid, p, ON_SURFACE_M);
    }
    return solid_depth(contacts[contact].solid, p) > ON_SURFACE_M;
}

// True where a vertex is inside the part at the end of the sub-step, or so close to it that a plant
// the body pushed before is still held.
fn nearly_holds(contact: u32, vertex: vec3f) -> bool {
    return depth_at_end(contact, vertex) > -contacts[contact].hold_m;
}

// True where a vertex would be inside the part at the end of the sub-step.
fn will_hold(contact: u32, vertex: vec3f) -> bool {
    return depth_at_end(contact, vertex) > ON_SURFACE_M;
}

fn depth_at_end(contact: u32, vertex: vec3f) -> f32 {
    let pose = Pose(contacts[contact].to_turn, contacts[contact].to_place);
    return solid_depth(contacts[contact].solid, inverse_point(pose, vertex));
}

// True where a point of the anchor's space is in another part of a contact's body at a share of the
// sub-step.
fn is_covered(contact: u32, share: f32, p: vec3f) -> bool {
    let first = contact - contacts[contact].part_in_body;
    for (var other = first; other < first + contacts[contact].parts_of_body; other++) {
        if other == contact {
            continue;
        }
        let p_there = inverse_point(pose_at(other, share), p);
        if solid_depth(contacts[other].solid, p_there) > tick.cover_m {
            return true;
        }
    }
    return false;
}

// The way out of a closed form for a point inside. `kept` is the feature of the last sub-step or
// NO_FACE.
fn solid_exit(contact: u32, pose: Pose, share: f32, p: vec3f, kept: u32, reach: Reach) -> Exit {
    let solid = contacts[contact].solid;
    var choice = no_choice();
    for (var face = 0u; face < face_count(solid); face++) {
        var found = solid_face(solid, p, face);
        if found.w <= 0.0 {
            return outside();
        }
        let radius = round_radius(solid, face);
        if radius > 0.0 {
            found = way_in_reach(p, found, radius, reach);
        }
        let exit = Exit(found.w, found.xyz, face);
        let end = rotate(pose.turn, p + found.xyz * found.w) + pose.place;
        offer(&choice, p, kept, reach, exit, is_covered(contact, share, end));
    }
    return take(choice);
}

// The way out of the part at a share of the sub-step, in its pose of then, for a vertex with a memory
// of its last face. `reach` is the vertex's segment in the anchor's coordinates.
fn way_out(
    contact: u32,
    pose: Pose,
    share: f32,
    vertex: vec3f,
    memory: u32,
    reach: Reach,
) -> Exit {
    let p = inverse_point(pose, vertex);
    let segment = Reach(
        inverse_point(pose, reach.start),
        reach.length,
        inverse_point(pose, reach.before),
    );
    var kept = NO_FACE;
    if (memory & ~FACE_MASK) == contacts[contact].key && (memory & FACE_MASK) != 0u {
        kept = (memory & FACE_MASK) - 1u;
    }
    if contacts[contact].uses_cube != 0u {
        return cube_exit(contacts[contact].solid, p, kept, segment);
    }
    return solid_exit(contact, pose, share, p, kept, segment);
}
