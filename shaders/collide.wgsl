// Collide: which plants a body touches in this sub-step. Twin: src/sim/collide.rs.
//
// One invocation per plant of a colliding tile (workgroup y is the tile). The nodes are met while
// walking up the plant, so none are stored; a plant counts as touched if any node is inside any part
// in any sweep, whatever the order. One that an earlier turn has listed is marked with the tick in y
// of its state's first row.
#import "shared/contact.wgsl"
#import "shared/ground.wgsl"
#import "shared/plant.wgsl"
#import "shared/recovering.wgsl"
#import "shared/state.wgsl"
#import "shared/tick.wgsl"
#import "shared/tile.wgsl"
#import "shared/touched.wgsl"

@group(1) @binding(1) var<storage, read> tiles: array<TileRecord>;
@group(1) @binding(3) var<storage, read_write> state: array<vec4u>;

// True where a node is inside a part that reaches the plant, in any sweep of this turn, which comes
// after `done` ones.
fn node_touched(tile: TileRecord, plant: Plant, node: vec3f, done: u32, sweeps: u32) -> bool {
    let last = min(done + tick.collide_sweeps, sweeps);
    for (var contact = tile.first_contact; contact < tile.end_contact; contact++) {
        if !reaches(contact, plant.root, plant.height_m) {
            continue;
        }
        for (var sweep = done + 1u; sweep <= last; sweep++) {
            if holds(contact, pose_at(contact, f32(sweep) / f32(sweeps)), node) {
                return true;
            }
        }
    }
    return false;
}

// True where a part that reaches the plant still holds a node that was pushed before.
fn node_held(tile: TileRecord, plant: Plant, node: vec3f) -> bool {
    for (var contact = tile.first_contact; contact < tile.end_contact; contact++) {
        if reaches(contact, plant.root, plant.height_m) && nearly_holds(contact, node) {
            return true;
        }
    }
    return false;
}

// True where the plant would recover into a part within this sub-step if it were let go.
fn is_in_the_way(tile: TileRecord, plant: Plant, row: u32) -> bool {
    var walk = walk_from_root(tile, plant, state[row].x);
    for (var j = 0u; j < field.segments; j++) {
        walk_up(&walk, plant, j, bitcast<vec3f>(state[row + 1u + j].xyz));
        for (var contact = tile.first_contact; contact < tile.end_contact; contact++) {
            if reaches(contact, plant.root, plant.height_m) && will_hold(contact, walk.node) {
                return true;
            }
        }
    }
    return false;
}

// True where a node lies on the ground, so that pushing would only shuffle it.
fn is_pinned(tile: TileRecord, node: vec3f) -> bool {
    return node.y - ground_in_anchor(tile, node.x, node.z) <= PINNED_M;
}

@compute @workgroup_size(WORKGROUP)
fn collide(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let place = group.x * WORKGROUP + local;
    if group.y >= tick.colliding || place >= field.plants_per_tile {
        return;
    }
    let tile = tiles[group.y];
    let plant = plant_at(tile, place);
    if !responds(plant) {
        return;
    }
    let sweeps = sweeps_for(tile, plant.root, plant.height_m);
    let done = turn() * tick.collide_sweeps;
    if done >= sweeps {
        return;
    }
    let row = plant_row(tile.slab, place);
    if done > 0u && state[row].y == tick.now {
        return;
    }
    var walk = walk_before(tile, plant, state[row].x);
    var held = false;
    for (var j = 0u; j < field.segments; j++) {
        walk_up(&walk, plant, j, bitcast<vec3f>(state[row + 1u + j].xyz));
        let free = !walk.before || !is_pinned(tile, walk.node);
        if free && node_touched(tile, plant, walk.node, done, sweeps) {
            state[row].y = tick.now;
            add_touched(Touched(group.y, place, sweeps));
            return;
        }
        held = held || (walk.before && node_held(tile, plant, walk.node));
    }
    tell_if_cut_short(field.segments);
    if done + tick.collide_sweeps < sweeps {
        return;
    }
    // Held where it was pushed before: it keeps its pose and does not recover yet.
    if held || (walk.before && is_in_the_way(tile, plant, row)) {
        add_touched(Touched(group.y, place, 0u));
    }
}
