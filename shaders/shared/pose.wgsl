// The wind pose of a plant. Twins: src/field/pose.rs, src/field/blade_table.rs.
//
// Walk it from root to tip: node j + 1 is node j plus `wind_direction` times `segment_length`.
#import "shared/field.wgsl"
#import "shared/plant.wgsl"

// A place between four entries of the blade table.
struct BladePlace {
    // Index of the first segment of the entry with the smaller stiffness and lean.
    first: u32,
    // Fractions 0…1 of the way to the next entry.
    stiffness: f32,
    lean: f32,
}

// A node and the unit direction of the segment above it (at the tip, of the last one).
struct PoseNode {
    place: vec3f,
    direction: vec3f,
}

// A place on the stiffness axis of the blade table, counted in entries, from a fraction of it.
fn stiffness_in_entries(fraction: f32) -> f32 {
    let last = f32(field.stiffness_entries - 1u);
    let knee = field.stiffness_knee;
    if knee < 0.0 {
        return fraction * last;
    }
    var middle = f32(field.stiffness_entries / 2u);
    if knee == 0.0 || knee == 1.0 {
        middle = knee * last;
    }
    if knee > 0.0 && fraction <= knee {
        return middle * (1.0 - sqrt(sqrt((knee - fraction) / knee)));
    }
    return middle + (last - middle) * sqrt(sqrt((fraction - knee) / (1.0 - knee)));
}

// A place on the lean axis; where the stiffness axis has a knee, entries crowd towards no lean.
fn lean_in_entries(fraction: f32) -> f32 {
    let last = f32(field.lean_entries - 1u);
    if field.stiffness_knee < 0.0 {
        return fraction * last;
    }
    return sqrt(sqrt(fraction)) * last;
}

// The entry below a place counted in entries (x) and the rest of the way to the next (y).
fn entry_and_rest(at: f32, entries: u32) -> vec2f {
    let below = min(floor(at), f32(entries - 2u));
    return vec2f(below, at - below);
}

fn blade_place(plant: Plant) -> BladePlace {
    let stiffness_at = stiffness_in_entries(clamp(plant.stiffness, 0.0, 1.0));
    let lean_at = lean_in_entries(clamp(plant.lean, 0.0, 1.0));
    let stiffness = entry_and_rest(stiffness_at, field.stiffness_entries);
    let lean = entry_and_rest(lean_at, field.lean_entries);
    let entry = u32(lean.x) * field.stiffness_entries + u32(stiffness.x);
    return BladePlace(entry * field.segments, stiffness.y, lean.y);
}

// [sin θ, cos θ] of a segment of the resting shape, slightly shorter than a unit vector.
fn blade_direction(place: BladePlace, segment: u32) -> vec2f {
    let low = place.first + segment;
    let leaning = low + field.segments * field.stiffness_entries;
    let upright_low = blade_directions[low];
    let upright_high = blade_directions[low + field.segments];
    let leaned_low = blade_directions[leaning];
    let leaned_high = blade_directions[leaning + field.segments];
    let upright = upright_low + (upright_high - upright_low) * place.stiffness;
    let leaned = leaned_low + (leaned_high - leaned_low) * place.stiffness;
    return upright + (leaned - upright) * place.lean;
}

// Rest length of a segment, in metres.
fn segment_length(plant: Plant) -> f32 {
    return plant.height_m * field.segment_share;
}

// Unit direction of a segment (from 0 at the root) of the plant bent by the wind.
fn wind_direction(plant: Plant, place: BladePlace, bend: vec2f, segment: u32) -> vec3f {
    let blade = blade_direction(place, segment);
    let share = field.wind_shares[segment >> 2u][segment & 3u];
    let leaning = vec3f(
        blade.x * plant.azimuth.x + bend.x * share,
        blade.y,
        blade.x * plant.azimuth.y + bend.y * share,
    );
    return unit_or(leaning, UP);
}

// One node of the wind pose; node 0 is the root.
fn wind_pose_at(plant: Plant, bend: vec2f, node: u32) -> PoseNode {
    let place = blade_place(plant);
    let length = segment_length(plant);
    var at = plant.root;
    var direction = UP;
    for (var j = 0u; j < min(node + 1u, field.segments); j++) {
        direction = wind_direction(plant, place, bend, j);
        if j < node {
            at += direction * length;
        }
    }
    return PoseNode(at, direction);
}

// Every node of the wind pose, from root to tip; only the first `segments + 1` count.
fn wind_pose(plant: Plant, bend: vec2f) -> array<vec3f, MAX_NODES> {
    var nodes: array<vec3f, MAX_NODES>;
    let place = blade_place(plant);
    let length = segment_length(plant);
    var at = plant.root;
    nodes[0] = at;
    for (var j = 0u; j < field.segments; j++) {
        at += wind_direction(plant, place, bend, j) * length;
        nodes[j + 1u] = at;
    }
    return nodes;
}
