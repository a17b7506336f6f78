// Relax: what a touched billboard does within one sub-step. Twins: src/sim/billboard/relax.rs, springs.rs,
// src/sim/springs/crumpled.rs.
//
// One invocation per touched billboard, sweeps and rounds in sequence. A turn runs some rounds and leaves
// to the next one how far it came. Pushing out and laying out ask the bodies at one place
// only, in `meet_bodies`: software drivers pay for every inlined copy of that.
#import "shared/billboard_grid.wgsl"
#import "shared/contact.wgsl"
#import "shared/laid.wgsl"
#import "shared/touched.wgsl"

@group(1) @binding(1) var<storage, read> tiles: array<TileRecord>;

var<private> facing: vec3f;
// First row of the billboard's offsets and faces.
var<private> faces_at: u32;
// Where the upper node of the segment that is being laid out was before.
var<private> before: vec3f;

fn segment(n: u32) -> Laid {
    return Laid(node(n - BOARD_COLUMNS), rest_m[COLUMN], quad.lean);
}

// Asks one part about a node, and pushes it out and a little aside or (`laying`) turns it out. Returns
// whether that was done.
fn meet_part(
    tile: TileRecord,
    contact: u32,
    pose: Pose,
    share: f32,
    n: u32,
    laying: bool,
) -> bool {
    let laid = segment(n);
    let place = node(n);
    let at = faces_at + n - BOARD_COLUMNS;
    let reach = Reach(laid.start, select(-1.0, laid.length, laying), before);
    let exit = way_out(contact, pose, share, place, pool[at].w, reach);
    if exit.face == NO_FACE {
        return false;
    }
    pool[at].w = contacts[contact].key | ((exit.face + 1u) & FACE_MASK);
    let normal = rotate(pose.turn, exit.normal);
    var put: Put;
    if laying {
        put = turned_out(tile, laid, place, normal, exit.depth);
    } else {
        let aside = facing * (exit.depth * PUSH_ASIDE);
        let to_side = select(aside, -aside, dot(facing, normal) < 0.0);
        put = pushed_out(tile, place, normal, exit.depth, to_side);
    }
    set_node(n, put.node);
    return put.moved;
}

// A node at the rest length from the one below it, in its direction, and not in the ground.
fn laid_out(tile: TileRecord, n: u32) -> vec3f {
    let laid = segment(n);
    let along = node(n) - laid.start;
    let square = dot(along, along);
    var place = laid.start + laid.rest * laid.length;
    if square > BOARD_POINT_M2 && square < FARTHEST_M * FARTHEST_M {
        place = laid.start + along * (laid.length / sqrt(square));
    }
    return lay_on_ground(tile, laid, place);
}

// Pushes every node out of every part in reach, part after part; or, `laying`, lays columns out at their
// lengths from the ground to the top and turns their segments out of every part and of the ground.
// Returns whether a part moved a node.
//
// The inner loop goes on to the next node and part that may meet, the outer one lets them: billboards that
// run side by side wait for each other once per meeting, and not once per node and part.
fn meet_bodies(tile: TileRecord, plant_reach: f32, share: f32, laying: bool) -> bool {
    let parts = tile.end_contact - tile.first_contact;
    // A segment that is laid out asks all parts, and then again those it has not asked since one turned it.
    let looks = parts * select(1u, LOOKS, laying && parts > 1u);
    let steps = looks * BOARD_MOVABLE;
    var pushed = false;
    var posed = NO_FACE;
    var pose: Pose;
    var near = false;
    var radius = 0.0;
    var asked_since = 0u;
    var turned = false;
    var n = 0u;
    var step = 0u;
    loop {
        var meets = false;
        for (; step < steps && !meets; step++) {
            let look = select(step / BOARD_MOVABLE, step % looks, laying);
            let part = look % parts;
            if laying && look == 0u {
                lay_before(tile, n);
                asked_since = 0u;
                turned = false;
            }
            n = BOARD_COLUMNS + select(step % BOARD_MOVABLE, step / looks, laying);
            if laying && look == 0u {
                before = node(n);
                set_node(n, laid_out(tile, n));
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
            let apart = node(n) - pose.place;
            meets = asked && near && dot(apart, apart) <= radius * radius;
        }
        if !meets {
            break;
        }
        if meet_part(tile, posed, pose, share, n, laying) {
            pushed = true;
            turned = true;
            asked_since = 0u;
        }
    }
    if laying {
        lay_before(tile, n);
    }
    return pushed;
}

// Lays a node that has met all parts on the ground; none is before the first.
fn lay_before(tile: TileRecord, n: u32) {
    if n >= BOARD_COLUMNS {
        set_node(n, lay_on_ground(tile, segment(n), node(n)));
    }
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
        let place = node(later);
        for (var k = 0u; k < EARLIER; k++) {
            let earlier = neighbour_at(later, k);
            if earlier.node == NO_NODE {
                continue;
            }
            let rest = rest_m[earlier.side];
            let longer = length(node(earlier.node) - place) - rest;
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
    for (var n = BOARD_COLUMNS; n < BOARD_NODES; n++) {
        let place = node(n);
        var down = vec3f(0.0);
        var count = 0.0;
        for (var k = 0u; k < AROUND; k++) {
            let other = neighbour_at(n, k);
            if other.node == NO_NODE {
                continue;
            }
            let apart = place - node(other.node);
            let weight = select(1.0, bend_weight, is_bend(other.side));
            down += apart * (longer_share(apart, other.side) * weight);
            count += 1.0;
        }
        set_node(n, place - down * (shape / count));
    }
}

// Passes over the springs, of which the energy does not grow: where it would, as many descending ones
// instead, or none.
fn relax_springs(shape: f32, bend: f32, energy: f32) {
    let bend_weight = select(1.0, bend / shape, bend < shape);
    keep_nodes();
    for (var way = 0u; way < 2u; way++) {
        for (var passed = 0u; passed < board.passes; passed++) {
            if way == 0u {
                pull_springs(shape, bend);
            } else {
                descend(shape, bend_weight);
            }
        }
        if measure(bend_weight).energy <= energy {
            return;
        }
        take_back_nodes();
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
            let apart = length(node(earlier.node) - node(later));
            total += apart;
            least = min(least, apart - CRUMPLED_SHARE * rest_m[earlier.side]);
        }
        if (later + 1u) % BOARD_COLUMNS != 0u {
            let below = later - BOARD_COLUMNS;
            least = min(least, dot(node(later + 1u) - node(later), node(below + 1u) - node(below)));
        }
    }
    return least < 0.0 || !(total < FARTHEST_M);
}

// Puts back what is crumpled, then rows that are inverted.
fn put_in_order() {
    if !look_lost() {
        return;
    }
    keep_nodes();
    for (var later = BOARD_COLUMNS; later < BOARD_NODES; later++) {
        for (var k = 0u; k < EARLIER; k++) {
            let earlier = neighbour_at(later, k);
            if earlier.node == NO_NODE {
                continue;
            }
            let was = length(kept(earlier.node) - kept(later));
            let now_apart = length(node(earlier.node) - node(later));
            let keeps = was >= CRUMPLED_SHARE * rest_m[earlier.side] && was < FARTHEST_M;
            if !keeps || !(now_apart < FARTHEST_M) {
                let offset = rest_node(quad, later) - rest_node(quad, earlier.node);
                set_node(later, node(earlier.node) + offset);
                break;
            }
        }
    }
    turn_back();
}

// True where the edge from a node to its right one, as it was, runs against the edge below it.
fn runs_against(left: u32) -> bool {
    let below = left - BOARD_COLUMNS;
    return dot(kept(left + 1u) - kept(left), node(below + 1u) - node(below)) < 0.0;
}

fn turn_back() {
    keep_nodes();
    for (var n = BOARD_COLUMNS; n < BOARD_NODES; n++) {
        let column = n % BOARD_COLUMNS;
        var against = column > 0u && runs_against(n - 1u);
        against = against || (column + 1u < BOARD_COLUMNS && runs_against(n));
        if against {
            let below = n - BOARD_COLUMNS;
            set_node(n, node(below) + (rest_node(quad, n) - rest_node(quad, below)));
        }
    }
}

// How far a billboard has come in a sub-step.
struct Progress {
    // Sweeps done, and rounds of the next one.
    sweep: u32,
    round: u32,
    // Energy of the springs after them.
    energy: f32,
    // Most rounds that a sweep took.
    most: u32,
}

// 2a of springs of this rate over a sub-step, in one of so many sweeps.
fn twice_a(rate_step: f32, sweeps: u32) -> f32 {
    let rate = rate_step / f32(sweeps);
    return 2.0 * (rate / (1.0 + 2.0 * rate));
}

// Runs rounds, as many as a turn has.
fn respond(tile: TileRecord, reach: f32, sweeps: u32, come: Progress) -> Progress {
    var at = come;
    if at.sweep >= sweeps {
        return at;
    }
    let shape = twice_a(board.rate_step, sweeps);
    let bend = twice_a(board.bend_step, sweeps);
    let bend_weight = select(1.0, bend / shape, bend < shape);
    // A step meets the bodies once: round 0 is the first push, which decides whether any round follows.
    for (var step = 0u; step < board.relax_rounds && at.sweep < sweeps; step++) {
        let share = f32(at.sweep + 1u) / f32(sweeps);
        let laying = at.round > 0u;
        if laying {
            relax_springs(shape, bend, at.energy);
        }
        let pushed = meet_bodies(tile, reach, share, laying);
        if !laying && !pushed {
            at.sweep++;
            continue;
        }
        if !laying {
            put_in_order();
        }
        let measured = measure(bend_weight);
        at.energy = measured.energy;
        at.most = max(at.most, at.round);
        let is_done = laying
            && at.round >= board.fewest_rounds
            && measured.strain <= board.strain_limit;
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
    nodes_at = row + BOARD_STATE_ROWS;
    faces_at = row + 1u;
    var come = Progress(state.y >> 16u, state.y & 0xffffu, bitcast<f32>(state.z), 0u);
    if turn() == 0u {
        come = Progress(0u, 0u, 0.0, 0u);
        take_pose(row, tile.anchor, billboard, true);
        // What is back in the wind has no memory of faces, whenever its tile gave its slab back.
        let forgets = is_back(tick.now - state.x);
        for (var n = 0u; n < BOARD_NODES; n++) {
            if n < BOARD_COLUMNS {
                set_node(n, rest_node(quad, n));
            } else if forgets {
                pool[faces_at + n - BOARD_COLUMNS].w = 0u;
            }
        }
    }
    let at = respond(tile, board_reach(billboard), entry.sweeps, come);
    atomicMax(&touched[1], at.most);
    tell_if_cut_short(BOARD_ROWS);
    if at.sweep < entry.sweeps {
        pool[row] = vec4u(state.x, (at.sweep << 16u) | at.round, bitcast<u32>(at.energy), tick.now);
        return;
    }
    for (var n = BOARD_COLUMNS; n < BOARD_NODES; n++) {
        let place = faces_at + n - BOARD_COLUMNS;
        let offset = node(n) - rest_node(quad, n);
        pool[place] = vec4u(bitcast<vec3u>(offset), pool[place].w);
    }
    pool[row] = vec4u(tick.now, 0u, 0u, 0u);
}
