// Recover: the nodes of every plant of an active tile as they are drawn. Twin: src/sim/recover.rs.
//
// Once per displayed frame. A slab of `drawn` has a row per node, root first; w is 1, or 0 where
// nothing grows.
#import "shared/plant.wgsl"
#import "shared/recovering.wgsl"
#import "shared/state.wgsl"
#import "shared/tick.wgsl"
#import "shared/tile.wgsl"

@group(1) @binding(1) var<storage, read> tiles: array<TileRecord>;
@group(1) @binding(3) var<storage, read> state: array<vec4u>;
@group(1) @binding(7) var<storage, read_write> drawn: array<vec4f>;

@compute @workgroup_size(WORKGROUP)
fn recover(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let place = group.x * WORKGROUP + local;
    if group.y >= tick.tiles || place >= field.plants_per_tile {
        return;
    }
    let tile = tiles[group.y];
    let row = plant_row(tile.slab, place);
    let plant = plant_at(tile, place);
    drawn[row] = vec4f(plant.root, f32(plant.grows));
    if !plant.grows {
        return;
    }
    var walk = walk_from_root(tile, plant, state[row].x);
    for (var j = 0u; j < field.segments; j++) {
        walk_up(&walk, plant, j, bitcast<vec3f>(state[row + 1u + j].xyz));
        drawn[row + 1u + j] = vec4f(walk.node, 1.0);
    }
}
