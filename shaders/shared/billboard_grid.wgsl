// The grid of a refined billboard: where its nodes are, and its springs. Twins: src/sim/billboard/grid.rs,
// springs.rs, recover.rs.
//
// Springs are visited by their later node, and those of one by their earlier node, as their order is in Rust.
// A shader that imports this declares `pool`.
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
var<private> nodes: array<vec3f, BOARD_NODES>;
// Nodes before the springs, or before lengths are restored.
var<private> start: array<vec3f, BOARD_NODES>;

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
fn rest_node(of_quad: WindQuad, node: u32) -> vec3f {
    let column = f32(node % BOARD_COLUMNS) / f32(BOARD_COLUMNS - 1u);
    let row = f32(node / BOARD_COLUMNS) / f32(BOARD_ROWS - 1u);
    return quad_place(of_quad, vec2f(column, row));
}

// A neighbour of a node, and the side between them.
struct Neighbour {
    node: u32,
    side: u32,
}

fn neighbour(node: u32, steps: vec2i, side: u32) -> Neighbour {
    let column = i32(node % BOARD_COLUMNS) + steps.x;
    let row = i32(node / BOARD_COLUMNS) + steps.y;
    let is_bend = side == ROW_BEND || side == COLUMN_BEND;
    let is_there = column >= 0
        && column < i32(BOARD_COLUMNS)
        && row >= 0
        && row < i32(BOARD_ROWS)
        && (BOARD_BENDS == 1u || !is_bend);
    let there = u32(row) * BOARD_COLUMNS + u32(column);
    return Neighbour(select(NO_NODE, there, is_there), side);
}

// The k-th neighbour of a node: the first EARLIER are those before it.
fn neighbour_at(node: u32, k: u32) -> Neighbour {
    switch k {
        case 0u: {
            return neighbour(node, vec2i(0, -2), COLUMN_BEND);
        }
        case 1u: {
            return neighbour(node, vec2i(-1, -1), RISING);
        }
        case 2u: {
            return neighbour(node, vec2i(0, -1), COLUMN);
        }
        case 3u: {
            return neighbour(node, vec2i(1, -1), FALLING);
        }
        case 4u: {
            return neighbour(node, vec2i(-2, 0), ROW_BEND);
        }
        case 5u: {
            return neighbour(node, vec2i(-1, 0), ROW);
        }
        case 6u: {
            return neighbour(node, vec2i(1, 0), ROW);
        }
        case 7u: {
            return neighbour(node, vec2i(2, 0), ROW_BEND);
        }
        case 8u: {
            return neighbour(node, vec2i(-1, 1), FALLING);
        }
        case 9u: {
            return neighbour(node, vec2i(0, 1), COLUMN);
        }
        case 10u: {
            return neighbour(node, vec2i(1, 1), RISING);
        }
        default: {
            return neighbour(node, vec2i(0, 2), COLUMN_BEND);
        }
    }
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
        for (var k = 0u; k < EARLIER; k++) {
            let earlier = neighbour_at(later, k);
            if earlier.node == NO_NODE {
                continue;
            }
            let apart = nodes[earlier.node] - nodes[later];
            let pull = select(shape, bend, is_bend(earlier.side));
            let longer = longer_share(apart, earlier.side);
            if earlier.node >= BOARD_COLUMNS {
                nodes[earlier.node] -= apart * (longer * (pull * 0.5));
                nodes[later] += apart * (longer * (pull * 0.5));
            } else {
                // Beside a pinned node the later one has all of it.
                nodes[later] += apart * (longer * pull);
            }
        }
    }
}

// Gives the segments of every column their rest length, keeping the directions they have in `start`. One
// that was turned right over takes the side that the quad faces.
fn restore_lengths(facing: vec3f) {
    let column_m = rest_m[COLUMN];
    for (var node = BOARD_COLUMNS; node < BOARD_NODES; node++) {
        let below = node - BOARD_COLUMNS;
        var along = start[node] - start[below];
        let square = dot(along, along);
        if square > 0.25 * column_m * column_m {
            nodes[node] = nodes[below] + along * (column_m / sqrt(square));
            continue;
        }
        let small = ASIDE * column_m;
        let off_line = cross(along, quad.lean);
        if dot(off_line, off_line) < small * small {
            along += facing * small;
        }
        nodes[node] = nodes[below] + unit_or(along, quad.lean) * column_m;
    }
}

// The side that the quad shows.
fn quad_normal() -> vec3f {
    let level = vec3f(-quad.across.z, 0.0, quad.across.x);
    return unit_or(cross(quad.across, quad.lean), level);
}

// Nodes as they are now, of a billboard whose state begins at `row`; `quad` is set before.
fn take_pose(row: u32) {
    let touched_at = pool[row].x;
    var left = 0.0;
    if touched_at != 0u {
        left = offset_left(tick.now - touched_at);
    }
    for (var node = 0u; node < BOARD_NODES; node++) {
        nodes[node] = rest_node(quad, node);
        if node >= BOARD_COLUMNS && left > 0.0 {
            let offset = pool[row + 1u + node - BOARD_COLUMNS].xyz;
            nodes[node] += bitcast<vec3f>(offset) * left;
        }
    }
    if left <= 0.0 || touched_at == tick.now {
        return;
    }
    let facing = quad_normal();
    for (var pass_ = 0u; pass_ <= BOARD_RECOVER_PASSES; pass_++) {
        if pass_ > 0u {
            pull_springs(0.5, 0.0);
        }
        start = nodes;
        restore_lengths(facing);
    }
}

// Nodes as bodies meet them in this sub-step: as they were left if the billboard was touched in the
// sub-step before, wherever the wind has gone since. `quad` is set before.
fn take_pose_before(row: u32, anchor: vec2u, billboard: Billboard) {
    if !was_touched(pool[row].x) {
        take_pose(row);
        return;
    }
    let before = bent_quad(billboard, billboard_bend_by(tick.wind_before, anchor, billboard));
    for (var node = 0u; node < BOARD_NODES; node++) {
        nodes[node] = rest_node(before, node);
        if node >= BOARD_COLUMNS {
            let offset = pool[row + 1u + node - BOARD_COLUMNS].xyz;
            nodes[node] += bitcast<vec3f>(offset);
        }
    }
}
