// Recover: the nodes of every billboard of an active tile as they are drawn. Twin:
// src/sim/billboard/recover.rs.
//
// Once per displayed frame. A slab of `drawn` has a row per node of each of its slots, the lowest row of a
// billboard first, from left to right: place in the tile's anchor and 1; four zeros in all rows of one that
// stands in the wind as if nothing had touched it.
#import "shared/billboard_grid.wgsl"

@group(1) @binding(1) var<storage, read> tiles: array<TileRecord>;
@group(1) @binding(7) var<storage, read_write> drawn: array<vec4f>;

@compute @workgroup_size(WORKGROUP)
fn recover_billboards(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let place = group.x * WORKGROUP + local;
    if group.y >= tick.tiles || place >= board.slots {
        return;
    }
    let tile = tiles[group.y];
    let row = board_row(tile.slab, place);
    let billboard = board_at(tile.slab, place);
    let touched_at = pool[row].x;
    let is_bent = billboard.height_m > 0.0
        && touched_at != 0u
        && offset_left(tick.now - touched_at) > 0.0;
    let first = (tile.slab * board.slots + place) * BOARD_NODES;
    if is_bent {
        set_quad(wind_quad(tile.anchor, billboard));
        nodes_at = row + BOARD_STATE_ROWS;
        take_pose(row, tile.anchor, billboard, false);
    }
    for (var n = 0u; n < BOARD_NODES; n++) {
        var place = vec4f(0.0);
        if is_bent {
            place = vec4f(node(n), 1.0);
        }
        drawn[first + n] = place;
    }
}
