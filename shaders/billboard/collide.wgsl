// Collide: which billboards a body touches in this sub-step. Twin: src/sim/billboard/collide.rs.
//
// One invocation per billboard of a colliding tile (workgroup y is the tile), as for blades. One that an
// earlier turn has listed has the tick in w of its state's first row.
#import "shared/billboard_grid.wgsl"
#import "shared/contact.wgsl"
#import "shared/ground.wgsl"
#import "shared/touched.wgsl"

@group(1) @binding(1) var<storage, read> tiles: array<TileRecord>;

// True where a node that is not pinned is inside a part in reach, in any sweep of this turn.
fn any_touched(tile: TileRecord, reach: f32, before: bool, done: u32, sweeps: u32) -> bool {
    let last = min(done + board.collide_sweeps, sweeps);
    for (var contact = tile.first_contact; contact < tile.end_contact; contact++) {
        if !reaches(contact, quad.root, reach) {
            continue;
        }
        for (var sweep = done + 1u; sweep <= last; sweep++) {
            let pose = pose_at(contact, f32(sweep) / f32(sweeps));
            for (var n = BOARD_COLUMNS; n < BOARD_NODES; n++) {
                let place = node(n);
                if before && place.y - ground_in_anchor(tile, place.x, place.z) <= PINNED_M {
                    continue;
                }
                if holds(contact, pose, place) {
                    return true;
                }
            }
        }
    }
    return false;
}

// True where a part in reach has a node in it at the end of the sub-step; or, `nearly`, so close to it that
// it still holds it.
fn any_held(tile: TileRecord, reach: f32, nearly: bool) -> bool {
    for (var contact = tile.first_contact; contact < tile.end_contact; contact++) {
        if !reaches(contact, quad.root, reach) {
            continue;
        }
        let least = select(ON_SURFACE_M, -contacts[contact].hold_m, nearly);
        for (var n = BOARD_COLUMNS; n < BOARD_NODES; n++) {
            if depth_at_end(contact, node(n)) > least {
                return true;
            }
        }
    }
    return false;
}

@compute @workgroup_size(WORKGROUP)
fn collide_billboards(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let place = group.x * WORKGROUP + local;
    if group.y >= tick.colliding || place >= board.slots {
        return;
    }
    let tile = tiles[group.y];
    let row = board_row(tile.slab, place);
    let billboard = board_at(tile.slab, place);
    if billboard.height_m == 0.0 {
        return;
    }
    let reach = board_reach(billboard);
    let sweeps = BOARD_FINENESS * sweeps_for(tile, billboard.root, reach);
    let done = turn() * board.collide_sweeps;
    if done >= sweeps || (done > 0u && pool[row].w == tick.now) {
        return;
    }
    set_quad(wind_quad(tile.anchor, billboard));
    nodes_at = row + BOARD_STATE_ROWS;
    let before = was_touched(pool[row].x);
    take_pose(row, tile.anchor, billboard, true);
    if any_touched(tile, reach, before, done, sweeps) {
        pool[row].w = tick.now;
        add_touched(Touched(group.y, place, sweeps));
        return;
    }
    tell_if_cut_short(BOARD_ROWS);
    if done + board.collide_sweeps < sweeps || !before {
        return;
    }
    // Held where it was pushed before, or it would recover into a part if it were let go: it keeps its
    // pose and does not recover yet.
    for (var look = 0u; look < 2u; look++) {
        if look == 1u {
            take_pose(row, tile.anchor, billboard, false);
        }
        if any_held(tile, reach, look == 0u) {
            pool[row].w = tick.now;
            add_touched(Touched(group.y, place, 0u));
            return;
        }
    }
}
