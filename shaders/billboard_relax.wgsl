// Relax: what a touched billboard does within one sub-step. Twins: src/sim/billboard/relax.rs, springs.rs,
// src/sim/springs/crumpled.rs.
//
// One invocation per touched billboard, sweeps and rounds in sequence. A turn runs some rounds and leaves
// the nodes, and how far it came, to the next one. Pushing out and laying out ask the bodies at one place
// only, in `meet_bodies`: software drivers pay for every inlined copy of that.
#import "shared/billboard_grid.wgsl"
#import "shared/contact.wgsl"
#import "shared/laid.wgsl"
#import "shared/touched.wgsl"

@group(1) @binding(1) var<storage, read> tiles: array<TileRecord>;
@group(1) @binding(3) var<storage, read_write> pool: array<vec4u>;

var<private> faces: array<u32, BOARD_MOVABLE>;
var<private> facing: vec3f;
// Where the upper node of the segment that is being laid out was before.
var<private> before: vec3f;

fn segment(node: u32) -> Laid {
    return Laid(nodes[node - BOARD_COLUMNS], rest_m[COLUMN], quad.lean);
}

// Asks one part about a node, and pushes it out and a little aside or (`laying`) turns it out. Returns
// whether that was done.
fn meet_part(
    tile: TileRecord,
    contact: u32,
    pose: Pose,
    share: f32,
    node: u32,
    laying: bool,
) -> bool {
    let n = node - BOARD_COLUMNS;
    let laid = segment(node);
    let reach = Reach(laid.start, select(-1.0, laid.length, laying), before);
    let exit = way_out(contact, pose, share, nodes[node], faces[n], reach);
    if exit.face == NO_FACE {
        return false;
    }
    faces[n] = contacts[contact].key | ((exit.face + 1u) & FACE_MASK);
    let normal = rotate(pose.turn, exit.normal);
    var put: Put;
    if laying {
        put = turned_out(tile, laid, nodes[node], normal, exit.depth);
    } else {
        let aside = facing * (exit.depth * PUSH_ASIDE);
        let to_side = select(aside, -aside, dot(facing, normal) < 0.0);
        put = pushed_out(tile, nodes[node], normal, exit.depth, to_side);
    }
    nodes[node] = put.node;
    return put.moved;
}

// A node at the rest length from the one below it, in its direction.
fn laid_out(node: u32) -> vec3f {
    let laid = segment(node);
    let along = nodes[node] - laid.start;
    let square = dot(along, along);
    if square > BOARD_POINT_M2 && square < FARTHEST_M * FARTHEST_M {
        return laid.start + along * (laid.length / sqrt(square));
    }
    return laid.start + laid.rest * laid.length;
}

// Pushes every node out of every part in reach, part after part; or, `laying`, lays columns out at their
// lengths from the ground to the top and turns their segments out of every part and of the ground.
// Returns whether a part moved a node.
fn meet_bodies(tile: TileRecord, plant_reach: f32, share: f32, laying: bool) -> bool {
    let parts = tile.end_contact - tile.first_contact;
    // A segment that is laid out asks all parts, and then again those it has not asked since one turned it.
    let looks = parts * select(1u, LOOKS, laying && parts > 1u);
    var pushed = false;
    var posed = NO_FACE;
    var pose: Pose;
    var near = false;
    var radius = 0.0;
    var asked_since = 0u;
    var turned = false;
    for (var step = 0u; step < looks * BOARD_MOVABLE; step++) {
        let look = select(step / BOARD_MOVABLE, step % looks, laying);
        let part = look % parts;
        let node = BOARD_COLUMNS + select(step % BOARD_MOVABLE, step / looks, laying);
        if laying && look == 0u {
            asked_since = 0u;
            turned = false;
            before = nodes[node];
            nodes[node] = laid_out(node);
            nodes[node] = lay_on_ground(tile, segment(node), nodes[node]);
        }
        let contact = tile.first_contact + part;
        asked_since++;
        let asked = look < parts || (turned && asked_since < parts);
        if asked && posed != contact {
            posed = contact;
            pose = pose_at(contact, share);
            near = reaches(contact, quad.root, plant_reach);
            radius = contacts[contact].radius_m;
        }
        let apart = nodes[node] - pose.place;
        let may_hold = asked && near && dot(apart, apart) <= radius * radius;
        if may_hold && meet_part(tile, contact, pose, share, node, laying) {
            pushed = true;
            turned = true;
            asked_since = 0u;
        }
        if laying && look + 1u == looks {
            nodes[node] = lay_on_ground(tile, segment(node), nodes[node]);
        }
    }
    return pushed;
}

struct Measured {
    // ½Σw(‖l‖ − l₀)²; w is 1 for the springs of O09.
    energy: f32,
    // Largest relative change of a spring's length but of a bend's.
    strain: f32,
}

fn measure(bend_weight: f32) -> Measured {
    var twice_energy = 0.0;
    var strain = 0.0;
    for (var later = BOARD_COLUMNS; later < BOARD_NODES; later++) {
        for (var k = 0u; k < EARLIER; k++) {
            let earlier = neighbour_at(later, k);
            if earlier.node == NO_NODE {
                continue;
            }
            let rest = rest_m[earlier.side];
            let longer = length(nodes[earlier.node] - nodes[later]) - rest;
            if is_bend(earlier.side) {
                twice_energy += longer * longer * bend_weight;
                continue;
            }
            twice_energy += longer * longer;
            if rest > 0.0 {
                strain = max(strain, abs(longer) / rest);
            }
        }
    }
    return Measured(0.5 * twice_energy, strain);
}

// One descending pass: each movable node in turn moves against the gradient of its springs, by a share over
// their number, which cannot raise the energy.
fn descend(shape: f32, bend_weight: f32) {
    for (var node = BOARD_COLUMNS; node < BOARD_NODES; node++) {
        var down = vec3f(0.0);
        var count = 0.0;
        for (var k = 0u; k < AROUND; k++) {
            let other = neighbour_at(node, k);
            if other.node == NO_NODE {
                continue;
            }
            let apart = nodes[node] - nodes[other.node];
            let weight = select(1.0, bend_weight, is_bend(other.side));
            down += apart * (longer_share(apart, other.side) * weight);
            count += 1.0;
        }
        nodes[node] -= down * (shape / count);
    }
}

// Passes over the springs, of which the energy does not grow: where it would, as many descending ones
// instead, or none.
fn relax_springs(shape: f32, bend: f32, energy: f32) {
    let bend_weight = select(1.0, bend / shape, bend < shape);
    start = nodes;
    for (var way = 0u; way < 2u; way++) {
        for (var n = 0u; n < board.passes; n++) {
            if way == 0u {
                pull_springs(shape, bend);
            } else {
                descend(shape, bend_weight);
            }
        }
        if measure(bend_weight).energy <= energy {
            return;
        }
        nodes = start;
    }
}

// Whether an edge has no direction or a row runs against the one below it.
fn look_lost() -> bool {
    var least = 0.0;
    var total = 0.0;
    for (var later = BOARD_COLUMNS; later < BOARD_NODES; later++) {
        for (var k = 0u; k < EARLIER; k++) {
            let earlier = neighbour_at(later, k);
            if earlier.node == NO_NODE {
                continue;
            }
            let apart = length(nodes[earlier.node] - nodes[later]);
            total += apart;
            least = min(least, apart - CRUMPLED_SHARE * rest_m[earlier.side]);
        }
        if (later + 1u) % BOARD_COLUMNS != 0u {
            let below = later - BOARD_COLUMNS;
            least = min(least, dot(nodes[later + 1u] - nodes[later], nodes[below + 1u] - nodes[below]));
        }
    }
    return least < 0.0 || !(total < FARTHEST_M);
}

// Puts back what is crumpled, then rows that are inverted.
fn put_in_order() {
    if !look_lost() {
        return;
    }
    start = nodes;
    for (var later = BOARD_COLUMNS; later < BOARD_NODES; later++) {
        for (var k = 0u; k < EARLIER; k++) {
            let earlier = neighbour_at(later, k);
            if earlier.node == NO_NODE {
                continue;
            }
            let was = length(start[earlier.node] - start[later]);
            let now_apart = length(nodes[earlier.node] - nodes[later]);
            let keeps = was >= CRUMPLED_SHARE * rest_m[earlier.side] && was < FARTHEST_M;
            if !keeps || !(now_apart < FARTHEST_M) {
                let offset = rest_node(quad, later) - rest_node(quad, earlier.node);
                nodes[later] = nodes[earlier.node] + offset;
                break;
            }
        }
    }
    turn_back();
}

// True where the edge from a node to its right one, as it was, runs against the edge below it.
fn runs_against(left: u32) -> bool {
    let below = left - BOARD_COLUMNS;
    return dot(start[left + 1u] - start[left], nodes[below + 1u] - nodes[below]) < 0.0;
}

fn turn_back() {
    start = nodes;
    for (var node = BOARD_COLUMNS; node < BOARD_NODES; node++) {
        let column = node % BOARD_COLUMNS;
        var against = false;
        if column > 0u {
            against = runs_against(node - 1u);
        }
        if column + 1u < BOARD_COLUMNS && !against {
            against = runs_against(node);
        }
        if against {
            let below = node - BOARD_COLUMNS;
            nodes[node] = nodes[below] + (rest_node(quad, node) - rest_node(quad, below));
        }
    }
}

// How far a billboard has come in a sub-step.
struct Progress {
    // Sweeps done, and rounds of the next one.
    sweep: u32,
    round: u32,
    // Most rounds that a sweep took.
    most: u32,
}

// Runs rounds, as many as a turn has.
fn respond(tile: TileRecord, reach: f32, sweeps: u32, from_: Progress) -> Progress {
    var at = from_;
    if at.sweep >= sweeps {
        return at;
    }
    let rate = board.rate_step / f32(sweeps);
    let bend_rate = board.bend_step / f32(sweeps);
    let shape = 2.0 * (rate / (1.0 + 2.0 * rate));
    let bend = 2.0 * (bend_rate / (1.0 + 2.0 * bend_rate));
    let bend_weight = select(1.0, bend / shape, bend < shape);
    // A step meets the bodies once: round 0 is the first push, which decides whether any round follows.
    for (var step = 0u; step < board.relax_rounds && at.sweep < sweeps; step++) {
        let share = f32(at.sweep + 1u) / f32(sweeps);
        let laying = at.round > 0u;
        if laying {
            relax_springs(shape, bend, measure(bend_weight).energy);
        }
        let pushed = meet_bodies(tile, reach, share, laying);
        if !laying {
            if pushed {
                put_in_order();
                at.round = 1u;
            } else {
                at.sweep++;
            }
            continue;
        }
        at.most = max(at.most, at.round);
        let is_done = at.round >= board.fewest_rounds
            && measure(bend_weight).strain <= board.strain_limit;
        if is_done || at.round >= board.most_rounds {
            at.sweep++;
            at.round = 0u;
        } else {
            at.round++;
        }
    }
    return at;
}

@compute @workgroup_size(WORKGROUP)
fn relax_billboards(
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
    let row = board_row(tile.slab, entry.place);
    let state = pool[row];
    // What is done has no tick in w.
    if state.w != tick.now {
        return;
    }
    let billboard = board_at(tile.slab, entry.place);
    set_quad(wind_quad(tile.anchor, billboard));
    facing = quad_normal();
    let is_first = turn() == 0u;
    var from_ = Progress(state.y, state.z, 0u);
    if is_first {
        from_ = Progress(0u, 0u, 0u);
        take_pose_before(row, tile.anchor, billboard);
    }
    // What is back in the wind has no memory of faces, whenever its tile gave its slab back.
    let forgets = is_first && is_back(tick.now - state.x);
    for (var node = 0u; node < BOARD_NODES; node++) {
        if node < BOARD_COLUMNS {
            nodes[node] = rest_node(quad, node);
            continue;
        }
        let stored = pool[row + 1u + node - BOARD_COLUMNS];
        if !is_first {
            nodes[node] = bitcast<vec3f>(stored.xyz);
        }
        faces[node - BOARD_COLUMNS] = select(stored.w, 0u, forgets);
    }
    let at = respond(tile, board_reach(billboard), entry.sweeps, from_);
    atomicMax(&touched[1], at.most);
    let is_last = at.sweep >= entry.sweeps;
    for (var node = BOARD_COLUMNS; node < BOARD_NODES; node++) {
        var kept = nodes[node];
        if is_last {
            kept -= rest_node(quad, node);
        }
        let n = node - BOARD_COLUMNS;
        pool[row + 1u + n] = vec4u(bitcast<vec3u>(kept), faces[n]);
    }
    tell_if_cut_short(BOARD_ROWS);
    if is_last {
        pool[row] = vec4u(tick.now, 0u, 0u, 0u);
    } else {
        pool[row] = vec4u(state.x, at.sweep, at.round, tick.now);
    }
}
