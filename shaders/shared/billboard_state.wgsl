// What is kept of the billboards of active tiles, and the numbers of a sub-step. Host: src/gpu/billboards.rs.
//
// A slab of the pool has room for `slots` billboards. First come their records, two rows each, all zero where
// nothing grows; then the states, BOARD_STATE_ROWS rows each: one with the tick of the last contact
// (0: never) in x, then one per movable node, the lowest row of them first: offset from the quad in the
// wind as three floats' bits, and the word about the face that the node was pushed out through.
// Between turns of `relax` a state's first row has sweeps done in y, rounds of the next one in z, and the
// nodes are there instead of offsets; in w is the tick of a billboard that is on the list of touched ones.
#import "shared/billboard.wgsl"

struct BoardUniform {
    slots: u32,
    fewest_rounds: u32,
    most_rounds: u32,
    // Passes over the springs in a round.
    passes: u32,
    // κΔt over a whole sub-step, of structural and shear springs and of bend springs.
    rate_step: f32,
    bend_step: f32,
    strain_limit: f32,
    // Most sweeps, and most rounds, in a turn of the passes.
    collide_sweeps: u32,
    relax_rounds: u32,
    spare_a: u32,
    spare_b: vec2u,
}

@group(1) @binding(8) var<uniform> board: BoardUniform;

const BOARD_NODES = BOARD_COLUMNS * BOARD_ROWS;
const BOARD_MOVABLE = BOARD_NODES - BOARD_COLUMNS;
const BOARD_STATE_ROWS = BOARD_MOVABLE + 1u;
const BOARD_RECORD_ROWS = 2u;

fn first_row(slab: u32) -> u32 {
    return slab * board.slots * (BOARD_RECORD_ROWS + BOARD_STATE_ROWS);
}

// First row of a billboard's state.
fn board_row(slab: u32, place: u32) -> u32 {
    return first_row(slab) + board.slots * BOARD_RECORD_ROWS + place * BOARD_STATE_ROWS;
}

// The billboard at rest; one without a height is not there.
fn board_at(slab: u32, place: u32) -> Billboard {
    let row = first_row(slab) + place * BOARD_RECORD_ROWS;
    let first = pool[row];
    let second = pool[row + 1u];
    if first.w == 0u {
        var none: Billboard;
        return none;
    }
    let root = bitcast<vec3f>(first.xyz);
    return open_billboard(
        BillboardRecord(root, first.w, second.x, second.y, second.z, second.w),
    );
}

// Radius about the root that holds the billboard in any pose of its lengths.
fn board_reach(billboard: Billboard) -> f32 {
    return billboard.width_m * 0.5 + billboard.height_m;
}
