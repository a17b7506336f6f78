// The pose of now, from root to tip. Twin: src/sim/recover.rs.
//
// v = lengths( w(now) + t³ d₀ ), one node after the other: what follows depends on the node below
// alone, so no list of nodes is kept.
#import "shared/plant.wgsl"
#import "shared/pose.wgsl"
#import "shared/tick.wgsl"
#import "shared/tile.wgsl"
#import "shared/wind.wgsl"

struct Walk {
    blade: BladePlace,
    bend: vec2f,
    // Rest length of a segment.
    length: f32,
    // The share t³ of the offset that is left; 0 for the wind pose itself.
    left: f32,
    // True where the pose is the one that the last contact left, without lengths restored.
    as_left: bool,
    // True where that was by the wind of the sub-step before; then what it bends to.
    before: bool,
    bend_before: vec2f,
    wind_before: vec3f,
    // The node reached, the same node of the wind pose, and before its segment got its length.
    node: vec3f,
    wind: vec3f,
    bent: vec3f,
}

// The share of the offset that is left `age` ticks after the last contact.
fn offset_left(age: u32) -> f32 {
    let t = max(1.0 - f32(age) * tick.step_over_t, 0.0);
    return t * t * t;
}

// Whether nothing is left of an offset. Half a sub-step forgives rounding.
fn is_back(age: u32) -> bool {
    return 1.0 - f32(age) * tick.step_over_t < 0.5 * tick.step_over_t;
}

// At the root of a plant touched at a tick (0: never), as it is now.
fn walk_from_root(tile: TileRecord, plant: Plant, touched_at: u32) -> Walk {
    var walk: Walk;
    walk.blade = blade_place(plant);
    walk.bend = wind_bend(tile, plant);
    walk.length = segment_length(plant);
    if touched_at != 0u {
        walk.left = offset_left(tick.now - touched_at);
        walk.as_left = tick.now == touched_at;
    }
    walk.node = plant.root;
    walk.wind = plant.root;
    walk.bent = plant.root;
    return walk;
}

// True of a blend of opposite directions: short, and along the line of both.
fn is_turned_over(segment: vec3f, rest: vec3f) -> bool {
    let square = dot(rest, rest);
    let off_line = cross(segment, rest);
    return dot(segment, segment) < 0.25 * square
        && dot(off_line, off_line) < ASIDE * ASIDE * square * square;
}

// True of a plant that was touched in the sub-step before this one.
fn was_touched(touched_at: u32) -> bool {
    return touched_at != 0u && tick.now - touched_at == 1u;
}

// At the root of a plant as bodies meet it in this sub-step: as it was left if it was touched in the
// sub-step before, wherever the wind has gone since.
fn walk_before(tile: TileRecord, plant: Plant, touched_at: u32) -> Walk {
    var walk = walk_from_root(tile, plant, touched_at);
    if was_touched(touched_at) {
        walk.before = true;
        walk.bend_before = wind_bend_by(tick.wind_before, tile, plant);
        walk.wind_before = plant.root;
    }
    return walk;
}

// Goes up segment `j`, whose upper node has the given offset.
fn walk_up(walk: ptr<function, Walk>, plant: Plant, j: u32, offset: vec3f) {
    let blade = (*walk).blade;
    let length = (*walk).length;
    let below = (*walk).wind;
    let above = below + wind_direction(plant, blade, (*walk).bend, j) * length;
    (*walk).wind = above;
    if (*walk).before {
        (*walk).wind_before += wind_direction(plant, blade, (*walk).bend_before, j) * length;
        (*walk).node = (*walk).wind_before + offset;
        return;
    }
    if (*walk).left <= 0.0 {
        (*walk).node = above;
        return;
    }
    let bent = above + offset * (*walk).left;
    if (*walk).as_left {
        (*walk).node = bent;
        return;
    }
    let rest = above - below;
    var segment = bent - (*walk).bent;
    (*walk).bent = bent;
    if is_turned_over(segment, rest) {
        segment += across(unit_or(rest, UP)) * (length * ASIDE);
    }
    (*walk).node += unit_or(segment, unit_or(rest, UP)) * length;
}
