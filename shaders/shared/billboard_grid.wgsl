// The grid of a refined billboard: where its nodes are, and its springs. Twins: src/sim/billboard/grid.rs,
// springs.rs, recover.rs.
//
// Springs are visited by their later node, and those of one by their earlier node, as their order is in Rust.
#import "shared/billboard_quad.wgsl"
#import "shared/billboard_state.wgsl"
#import "shared/recovering.wgsl"
#import "shared/tick.wgsl"
#import "shared/tile.wgsl"

// Sides, in the order of their rest lengths.
const ROW = 0u;
const COLUMN = 1u;
const RISING = 2u;
const FALLING = 3u;
const ROW_BEND = 4u;
const COLUMN_BEND = 5u;
// Springs that end at a node from earlier ones, and those and the ones to later nodes.
const EARLIER = 6u;
const AROUND = 12u;
const NO_NODE = 0xffffffffu;
// No node is as far away, in metres.
const FARTHEST_M = 1e18;

// In the wind of now.
var<private> quad: WindQuad;
var<private> rest_m: array<f32, 6>;
// First row of the billboard's nodes in the pool.
var<private> nodes_at: u32;

fn node(n: u32) -> vec3f {
    return bitcast<vec3f>(pool[nodes_at + n].xyz);
}

fn set_node(n: u32, place: vec3f) {
    pool[nodes_at + n] = vec4u(bitcast<vec3u>(place), 0u);
}

// A node as it was when `keep_nodes` was called.
fn kept(n: u32) -> vec3f {
    return bitcast<vec3f>(pool[nodes_at + BOARD_NODES + n].xyz);
}

fn keep_nodes() {
    for (var n = 0u; n < BOARD_NODES; n++) {
        pool[nodes_at + BOARD_NODES + n] = pool[nodes_at + n];
    }
}

fn take_back_nodes() {
    for (var n = 0u; n < BOARD_NODES; n++) {
        pool[nodes_at + n] = pool[nodes_at + BOARD_NODES + n];
    }
}

fn set_quad(of_now: WindQuad) {
    quad = of_now;
    let right = quad.across * (quad.width_m / f32(BOARD_COLUMNS - 1u));
    let up = quad.lean * (quad.height_m / f32(BOARD_ROWS - 1u));
    rest_m[ROW] = length(right);
    rest_m[COLUMN] = length(up);
    rest_m[RISING] = length(right + up);
    rest_m[FALLING] = length(up - right);
    rest_m[ROW_BEND] = length(right * 2.0);
    rest_m[COLUMN_BEND] = length(up * 2.0);
}

// A node of the grid of a quad.
fn rest_node(of_quad: WindQuad, n: u32) -> vec3f {
    let column = f32(n % BOARD_COLUMNS) / f32(BOARD_COLUMNS - 1u);
    let row = f32(n / BOARD_COLUMNS) / f32(BOARD_ROWS - 1u);
    return quad_place(of_quad, vec2f(column, row));
}

// A neighbour of a node, and the side between them.
struct Neighbour {
    node: u32,
    side: u32,
}

// Columns and rows to the k-th neighbour, each 2 more than it is, and its side: four bits each.
const STEPS_X = vec2u(0x43103212u, 0x2321u);
const STEPS_Y = vec2u(0x22221110u, 0x4333u);
const NEIGHBOUR_SIDES = vec2u(0x40043125u, 0x5213u);

fn of_neighbour(words: vec2u, k: u32) -> u32 {
    let word = select(words.y, words.x, k < 8u);
    return (word >> ((k & 7u) * 4u)) & 15u;
}

// The k-th neighbour of a node, by number: the first EARLIER are those before it.
fn neighbour_at(n: u32, k: u32) -> Neighbour {
    let side = of_neighbour(NEIGHBOUR_SIDES, k);
    let column = n % BOARD_COLUMNS + of_neighbour(STEPS_X, k) - 2u;
    let row = n / BOARD_COLUMNS + of_neighbour(STEPS_Y, k) - 2u;
    // Below 0 is far above.
    let is_there = column < BOARD_COLUMNS
        && row < BOARD_ROWS
        && (BOARD_BENDS == 1u || !is_bend(side));
    return Neighbour(select(NO_NODE, row * BOARD_COLUMNS + column, is_there), side);
}

fn is_bend(side: u32) -> bool {
    return side == ROW_BEND || side == COLUMN_BEND;
}

// 1 − l₀/‖l‖; 0 between nodes at one place, which have no direction.
fn longer_share(apart: vec3f, side: u32) -> f32 {
    let square = dot(apart, apart);
    if square > BOARD_POINT_M2 {
        return 1.0 - rest_m[side] / sqrt(square);
    }
    return 0.0;
}

// One sequential pass over the springs, by 2a of those of O09 and of the bend springs.
fn pull_springs(shape: f32, bend: f32) {
    for (var later = BOARD_COLUMNS; later < BOARD_NODES; later++) {
        var place = node(later);
        for (var k = 0u; k < EARLIER; k++) {
            let earlier = neighbour_at(later, k);
            if earlier.node == NO_NODE {
                continue;
            }
            let other = node(earlier.node);
            let apart = other - place;
            let pull = select(shape, bend, is_bend(earlier.side));
            // Beside a pinned node the later one has all of it.
            let is_pinned = earlier.node < BOARD_COLUMNS;
            let by = apart * (longer_share(apart, earlier.side) * select(pull * 0.5, pull, is_pinned));
            place += by;
            if !is_pinned {
                set_node(earlier.node, other - by);
            }
        }
        set_node(later, place);
    }
}

// Gives the segments of every column their rest length, keeping the directions of the nodes that are kept.
// One that was turned right over takes the side that the quad faces.
fn restore_lengths(facing: vec3f) {
    let column_m = rest_m[COLUMN];
    for (var n = BOARD_COLUMNS; n < BOARD_NODES; n++) {
        let below = n - BOARD_COLUMNS;
        var along = kept(n) - kept(below);
        let square = dot(along, along);
        if square > 0.25 * column_m * column_m {
            set_node(n, node(below) + along * (column_m / sqrt(square)));
            continue;
        }
        let small = ASIDE * column_m;
        let off_line = cross(along, quad.lean);
        if dot(off_line, off_line) < small * small {
            along += facing * small;
        }
        set_node(n, node(below) + unit_or(along, quad.lean) * column_m);
    }
}

// The side that the quad shows.
fn quad_normal() -> vec3f {
    let level = vec3f(-quad.across.z, 0.0, quad.across.x);
    return unit_or(cross(quad.across, quad.lean), level);
}

// Lays out the nodes of a billboard whose state begins at `row`, as they are now; `before`, as bodies meet
// them in this sub-step: as they were left if it was touched in the sub-step before, wherever the wind has
// gone since. `quad` is set before.
fn take_pose(row: u32, anchor: vec2u, billboard: Billboard, before: bool) {
    let touched_at = pool[row].x;
    let is_left = before && was_touched(touched_at);
    var of_pose = quad;
    var left = 0.0;
    if is_left {
        of_pose = bent_quad(billboard, billboard_bend_by(tick.wind_before, anchor, billboard));
        left = 1.0;
    } else if touched_at != 0u {
        left = offset_left(tick.now - touched_at);
    }
    for (var n = 0u; n < BOARD_NODES; n++) {
        var place = rest_node(of_pose, n);
        if n >= BOARD_COLUMNS && left > 0.0 {
            place += bitcast<vec3f>(pool[row + 1u + n - BOARD_COLUMNS].xyz) * left;
        }
        set_node(n, place);
    }
    if is_left || left <= 0.0 || touched_at == tick.now {
        return;
    }
    let facing = quad_normal();
    for (var passed = 0u; passed <= BOARD_RECOVER_PASSES; passed++) {
        if passed > 0u {
            pull_springs(0.5, 0.0);
        }
        keep_nodes();
        restore_lengths(facing);
    }
}
