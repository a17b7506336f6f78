// Relax: what a touched plant does within one sub-step. Twin: src/sim/relax.rs.
//
// One invocation per touched plant, sweeps and rounds in sequence, so no two write the same place. A
// later turn goes on from the nodes that the one before has left in the place of their offsets, so
// that turns change no bit.
// Pushing out and laying out ask the bodies at one place only, in `meet_bodies`: software drivers
// pay for every inlined copy of that.
#import "shared/contact.wgsl"
#import "shared/laid.wgsl"
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
// Where the upper node of the segment that is being laid out was before.
var<private> before: vec3f;

// Direction of segment j in the wind pose.
fn rest_direction(j: u32) -> vec3f {
    return unit_or(wind_nodes[j + 1u] - wind_nodes[j], UP);
}

// Segment j, about its lower node.
fn segment(j: u32, length: f32) -> Laid {
    return Laid(nodes[j], length, rest_direction(j));
}

// Asks one part about segment j's upper node, and pushes or (`laying`) turns it out. Returns whether
// that was done.
fn meet_part(
    tile: TileRecord,
    contact: u32,
    pose: Pose,
    share: f32,
    length: f32,
    j: u32,
    laying: bool,
) -> bool {
    let reach = Reach(nodes[j], select(-1.0, length, laying), before);
    let exit = way_out(contact, pose, share, nodes[j + 1u], faces[j], reach);
    if exit.face == NO_FACE {
        return false;
    }
    faces[j] = contacts[contact].key | ((exit.face + 1u) & FACE_MASK);
    let n = rotate(pose.turn, exit.normal);
    var put: Put;
    if laying {
        put = turned_out(tile, segment(j, length), nodes[j + 1u], n, exit.depth);
    } else {
        put = pushed_out(tile, nodes[j + 1u], n, exit.depth, vec3f(0.0));
    }
    nodes[j + 1u] = put.node;
    return put.moved;
}

// Pushes every node out of every part that reaches the plant, part after part; or, `laying`, lays
// segments out at their length from root to tip and turns them out of every part and of the ground.
// Returns whether a part moved a node.
fn meet_bodies(tile: TileRecord, plant_reach: f32, length: f32, share: f32, laying: bool) -> bool {
    let parts = tile.end_contact - tile.first_contact;
    // A segment that is laid out asks all parts, and then again those it has not asked since one turned it.
    let looks = parts * select(1u, LOOKS, laying && parts > 1u);
    var pushed = false;
    var posed = NO_FACE;
    var pose: Pose;
    var near = false;
    var asked_since = 0u;
    var turned = false;
    for (var step = 0u; step < looks * field.segments; step++) {
        let look = select(step / field.segments, step % looks, laying);
        let part = look % parts;
        let j = select(step % field.segments, step / looks, laying);
        if laying && look == 0u {
            asked_since = 0u;
            turned = false;
            before = nodes[j + 1u];
            let direction = unit_or(nodes[j + 1u] - nodes[j], rest_direction(j));
            nodes[j + 1u] = nodes[j] + direction * length;
            nodes[j + 1u] = lay_on_ground(tile, segment(j, length), nodes[j + 1u]);
        }
        let contact = tile.first_contact + part;
        asked_since++;
        let asked = look < parts || (turned && asked_since < parts);
        if asked && posed != contact {
            posed = contact;
            pose = pose_at(contact, share);
            near = reaches(contact, nodes[0], plant_reach);
        }
        if asked && near && meet_part(tile, contact, pose, share, length, j, laying) {
            pushed = true;
            turned = true;
            asked_since = 0u;
        }
        if laying && look + 1u == looks {
            nodes[j + 1u] = lay_on_ground(tile, segment(j, length), nodes[j + 1u]);
        }
    }
    return pushed;
}

// Bend springs, by 2a or by half, a quarter or an eighth of it where more would raise their energy
// once the lengths are back; not at all where that would too. `rate` is κΔt.
fn bend_springs(rate: f32, length: f32) {
    let before = laid_energy(0.0, length);
    var share = 2.0 * rate / (1.0 + 2.0 * rate);
    for (var attempt = 0u; attempt < SPRING_TRIES; attempt++) {
        if laid_energy(share, length) <= before {
            pull_bends(share);
            return;
        }
        share *= 0.5;
    }
}

// What the bend spring from node j to node j + 2 moves a free end by.
fn bend_correction(j: u32, lower: vec3f, upper: vec3f, share: f32) -> vec3f {
    let rest = length(wind_nodes[j + 2u] - wind_nodes[j]);
    let across = upper - lower;
    return unit_or(across, UP) * (share * (length(across) - rest));
}

// The root is pinned: it has no responsibility, its partner has all of it.
fn lower_share(j: u32) -> f32 {
    return select(0.5, 0.0, j == 0u);
}

fn pull_bends(share: f32) {
    for (var j = 0u; j + 1u < field.segments; j++) {
        let correction = bend_correction(j, nodes[j], nodes[j + 2u], share);
        nodes[j] += correction * lower_share(j);
        nodes[j + 2u] -= correction * (1.0 - lower_share(j));
    }
}

// A blade's nodes, laid out from the root one after the other: the last but one, the last, and the
// energy of the bends so far.
struct Bends {
    before: vec3f,
    start: vec3f,
    energy: f32,
}

fn add_bend(bends: ptr<function, Bends>, j: u32, node: vec3f, length_m: f32) {
    if j == 0u {
        return;
    }
    let start = (*bends).start;
    let laid = start + unit_or(node - start, rest_direction(j - 1u)) * length_m;
    if j >= 2u {
        let rest = length(wind_nodes[j] - wind_nodes[j - 2u]);
        let longer = length(laid - (*bends).before) - rest;
        (*bends).energy += longer * longer;
    }
    (*bends).before = start;
    (*bends).start = laid;
}

// The bends' energy after their springs have been pulled by a share and the lengths were restored;
// neither is done to the nodes.
fn laid_energy(share: f32, length_m: f32) -> f32 {
    var bends = Bends(nodes[0], nodes[0], 0.0);
    var lower = nodes[0];
    var middle = nodes[1];
    for (var j = 0u; j + 1u < field.segments; j++) {
        let correction = bend_correction(j, lower, nodes[j + 2u], share);
        add_bend(&bends, j, lower + correction * lower_share(j), length_m);
        lower = middle;
        middle = nodes[j + 2u] - correction * (1.0 - lower_share(j));
    }
    add_bend(&bends, field.segments - 1u, lower, length_m);
    add_bend(&bends, field.segments, middle, length_m);
    return bends.energy;
}

fn keep_above_ground(tile: TileRecord) {
    for (var j = 1u; j <= field.segments; j++) {
        nodes[j].y = max(nodes[j].y, ground_below(tile, nodes[j]));
    }
}

fn largest_strain(rest: f32) -> f32 {
    var worst = 0.0;
    for (var j = 0u; j < field.segments; j++) {
        worst = max(worst, abs(length(nodes[j + 1u] - nodes[j]) / rest - 1.0));
    }
    return worst;
}

// Runs the sweeps of this turn, after `done` ones; returns the largest number of rounds one took.
fn respond(tile: TileRecord, reach: f32, done: u32, sweeps: u32, length: f32) -> u32 {
    var rounds_used = 0u;
    for (var sweep = done + 1u; sweep <= min(done + tick.relax_sweeps, sweeps); sweep++) {
        let share = f32(sweep) / f32(sweeps);
        // Round 0 is the first push, which decides whether any round follows.
        for (var round = 0u; round <= tick.most_rounds; round++) {
            let pushed = meet_bodies(tile, reach, length, share, round > 0u);
            if round == 0u {
                if !pushed {
                    break;
                }
                bend_springs(tick.bend / f32(sweeps), length);
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
    let done = turn() * tick.relax_sweeps;
    if done > 0u && done >= entry.sweeps {
        return;
    }
    let tile = tiles[entry.tile];
    let plant = plant_at(tile, entry.place);
    let row = plant_row(tile.slab, entry.place);
    var walk = walk_before(tile, plant, state[row].x);
    nodes[0] = walk.node;
    wind_nodes[0] = walk.wind;
    // What is back in the wind pose has no memory of faces, whenever its tile gave its slab back.
    let is_back = is_back(tick.now - state[row].x);
    for (var j = 0u; j < field.segments; j++) {
        let stored = state[row + 1u + j];
        walk_up(&walk, plant, j, bitcast<vec3f>(stored.xyz));
        nodes[j + 1u] = select(walk.node, bitcast<vec3f>(stored.xyz), done > 0u);
        wind_nodes[j + 1u] = walk.wind;
        faces[j] = select(stored.w, 0u, is_back);
    }
    let rounds = respond(tile, plant.height_m, done, entry.sweeps, walk.length);
    atomicMax(&touched[1], rounds);
    let is_last = done + tick.relax_sweeps >= entry.sweeps;
    for (var j = 0u; j < field.segments; j++) {
        let kept = nodes[j + 1u] - select(vec3f(0.0), wind_nodes[j + 1u], is_last);
        state[row + 1u + j] = vec4u(bitcast<vec3u>(kept), faces[j]);
    }
    tell_if_cut_short(field.segments);
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
