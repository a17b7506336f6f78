// Relax: what a touched plant does within one sub-step. Twin: src/sim/relax.rs.
//
// One invocation per touched plant, sweeps and rounds in sequence, so no two write the same place.
// `push_out_all` is called at one place only: software drivers pay for every inlined copy.
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
// Workgroups of every pass, three words each; `count_groups` sets those of `relax`.
@group(1) @binding(7) var<storage, read_write> pass_groups: array<u32>;

var<private> nodes: array<vec3f, MAX_NODES>;
var<private> wind_nodes: array<vec3f, MAX_NODES>;
var<private> faces: array<u32, MAX_SEGMENTS>;

// Pushes every node out of every part that reaches the plant, parts in their order.
fn push_out_all(tile: TileRecord, reach: f32, share: f32) -> bool {
    var pushed = false;
    for (var contact = tile.first_contact; contact < tile.end_contact; contact++) {
        if !reaches(contact, nodes[0], reach) {
            continue;
        }
        let pose = pose_at(contact, share);
        for (var j = 0u; j < field.segments; j++) {
            let exit = way_out(contact, pose, nodes[j + 1u], faces[j]);
            if exit.face != NO_FACE {
                nodes[j + 1u] += rotate(pose.turn, exit.normal) * exit.depth;
                faces[j] = contacts[contact].key | ((exit.face + 1u) & FACE_MASK);
                pushed = true;
            }
        }
    }
    return pushed;
}

fn bend_springs() {
    for (var j = 0u; j + 1u < field.segments; j++) {
        let rest = length(wind_nodes[j + 2u] - wind_nodes[j]);
        let across = nodes[j + 2u] - nodes[j];
        let correction = unit_or(across, UP) * (tick.bend * (length(across) - rest));
        // The root is pinned: it has no responsibility, its partner has all of it.
        let lower = select(0.5, 0.0, j == 0u);
        nodes[j] += correction * lower;
        nodes[j + 2u] -= correction * (1.0 - lower);
    }
}

// Follow the leader: lengths from root to tip, directions kept.
fn restore_lengths(length: f32) {
    for (var j = 0u; j < field.segments; j++) {
        let rest = unit_or(wind_nodes[j + 1u] - wind_nodes[j], UP);
        let direction = unit_or(nodes[j + 1u] - nodes[j], rest);
        nodes[j + 1u] = nodes[j] + direction * length;
    }
}

fn keep_above_ground(tile: TileRecord) {
    for (var j = 1u; j <= field.segments; j++) {
        let height = ground_in_anchor(tile, nodes[j].x, nodes[j].z);
        nodes[j].y = max(nodes[j].y, height);
    }
}

fn largest_strain(rest: f32) -> f32 {
    var worst = 0.0;
    for (var j = 0u; j < field.segments; j++) {
        worst = max(worst, abs(length(nodes[j + 1u] - nodes[j]) / rest - 1.0));
    }
    return worst;
}

// Runs one sub-step; returns the largest number of rounds a sweep took.
fn respond(tile: TileRecord, reach: f32, sweeps: u32, length: f32) -> u32 {
    var rounds_used = 0u;
    for (var sweep = 1u; sweep <= sweeps; sweep++) {
        let share = f32(sweep) / f32(sweeps);
        // Round 0 is the first push, which decides whether any round follows.
        for (var round = 0u; round <= tick.most_rounds; round++) {
            if round > 0u {
                bend_springs();
                restore_lengths(length);
            }
            let pushed = push_out_all(tile, reach, share);
            if round == 0u {
                if !pushed {
                    break;
                }
                continue;
            }
            keep_above_ground(tile);
            rounds_used = max(rounds_used, round);
            if round >= tick.fewest_rounds && largest_strain(length) <= tick.strain_limit {
                break;
            }
        }
    }
    return rounds_used;
}

@compute @workgroup_size(WORKGROUP)
fn relax(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = (group.y * groups.x + group.x) * WORKGROUP + local;
    if index >= atomicLoad(&touched[0]) {
        return;
    }
    let entry = touched_at(index);
    let tile = tiles[entry.tile];
    let plant = plant_at(tile, entry.place);
    let row = plant_row(tile.slab, entry.place);
    var walk = walk_from_root(tile, plant, state[row].x);
    nodes[0] = walk.node;
    wind_nodes[0] = walk.wind;
    for (var j = 0u; j < field.segments; j++) {
        let stored = state[row + 1u + j];
        walk_up(&walk, plant, j, bitcast<vec3f>(stored.xyz));
        nodes[j + 1u] = walk.node;
        wind_nodes[j + 1u] = walk.wind;
        faces[j] = stored.w;
    }
    let rounds = respond(tile, plant.height_m, entry.sweeps, walk.length);
    atomicMax(&touched[1], rounds);
    for (var j = 0u; j < field.segments; j++) {
        let offset = nodes[j + 1u] - wind_nodes[j + 1u];
        state[row + 1u + j] = vec4u(bitcast<vec3u>(offset), faces[j]);
    }
    state[row] = vec4u(tick.now, 0u, 0u, 0u);
}

// Sets the size of `relax` from the number of touched plants, in rows that every device allows.
@compute @workgroup_size(1)
fn count_groups() {
    let groups = (atomicLoad(&touched[0]) + WORKGROUP - 1u) / WORKGROUP;
    let rows = (groups + MOST_GROUPS - 1u) / MOST_GROUPS;
    pass_groups[RELAX_GROUPS] = min(groups, MOST_GROUPS);
    pass_groups[RELAX_GROUPS + 1u] = rows;
    pass_groups[RELAX_GROUPS + 2u] = 1u;
}
