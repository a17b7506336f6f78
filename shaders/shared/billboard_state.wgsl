// What is kept of the billboards of active tiles, and the numbers of a sub-step. Host: src/gpu/billboards.rs.
//
// A slab of the pool has room for `slots` billboards. First come their records, two rows each, all zero where
// nothing grows; then what is kept of each, BOARD_ROWS_EACH rows: one with the tick of the last contact
// (0: never) in x; then one per movable node, the lowest row of them first: offset from the quad in the
// wind as three floats' bits, and the word about the face that the node was pushed out through; then
// places of all nodes and the same before springs or lengths, to work with: drivers that keep arrays in
// registers, as software does, would write out a choice among all of them wherever one is asked for.
// Between turns of `relax` the first row has sweeps done and rounds of the next one in the halves of y, the
// energy of the springs in z, and in w the tick of a billboard that is on the list of touched ones.
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

@group(1) @binding(3) var<storage, read_write> pool: array<vec4u>;
@group(1) @binding(8) var<uniform> board: BoardUniform;

const BOARD_NODES = BOARD_COLUMNS * BOARD_ROWS;
const BOARD_MOVABLE = BOARD_NODES - BOARD_COLUMNS;
const BOARD_STATE_ROWS = BOARD_MOVABLE + 1u;
const BOARD_ROWS_EACH = BOARD_STATE_ROWS + 2u * BOARD_NODES;
const BOARD_RECORD_ROWS = 2u;

fn first_row(slab: u32) -> u32 {
    return slab * board.slots * (BOARD_RECORD_ROWS + BOARD_ROWS_EACH);
}

// First row of what is kept of a billboard.
fn board_row(slab: u32, place: u32) -> u32 {
    return first_row(slab) + board.slots * BOARD_RECORD_ROWS + place * BOARD_ROWS_EACH;
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
