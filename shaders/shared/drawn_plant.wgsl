// A plant as the second stage gets it from the first. Hosts: src/render/plants.rs,
// src/render/sort_plants.rs.
#import "shared/draw_args.wgsl"
#import "shared/drawn_tile.wgsl"
#import "shared/noise.wgsl"
#import "shared/plant.wgsl"
#import "shared/pose.wgsl"
#import "shared/state.wgsl"
#import "shared/wind.wgsl"

// Nodes and vertices of one form at one detail.
struct Bucket {
    stride: u32, // nodes per drawn segment
    steps: u32, // drawn segments
    coarser: u32, // nodes per drawn segment at the next coarser detail
    spare: u32,
}

// What only one form has, by kind.
struct FormUniform {
    petal_rgb: vec3f,
    petals: f32,
    centre_rgb: vec3f,
    head_m: f32,
}

struct PlantLook {
    map_m: vec2f, // extent of the base-colour map
    // Share of the sky that plants hide at the ground.
    cover: f32,
    reach_m: f32,
    samples: u32, // per pixel; 1 means that coverage is drawn by lot
    spare_a: u32,
    spare_b: vec2u,
    buckets: array<Bucket, BUCKETS>,
    forms: array<FormUniform, MAX_SPECIES>,
}

@group(3) @binding(0) var<uniform> plant_look: PlantLook;
@group(3) @binding(1) var<storage, read> drawn_tiles: array<DrawnTile>;
// Nodes of the plants in active tiles, as `recover` leaves them: a row per node, root first.
@group(3) @binding(2) var<storage, read> active_nodes: array<vec4f>;
@group(3) @binding(3) var base_colour: texture_2d<f32>;
@group(3) @binding(4) var base_sampler: sampler;
// Plants bucket by bucket: tile; rank; how it thrives in 17 bits, then its kind in 3; and halves:
// share of its size and one over its width's factor. And where those of each bucket begin.
@group(3) @binding(5) var<storage, read> sorted: array<vec4u>;
@group(3) @binding(6) var<storage, read> draws: array<DrawArgs, BUCKETS>;

struct DrawnPlant {
    tile: DrawnTile,
    plant: Plant,
    place: u32,
    companion: u32, // 0 is the simulated plant
    thrives: f32, // s′ of eq. 18
    grown: f32, // share of its size
    widen: f32, // factor of its width
    root_from_eye: vec3f,
    bucket: Bucket,
}

// The plant of an instance; `vertex` counts BUCKET_VERTICES for every bucket.
fn drawn_plant(vertex: u32, instance: u32) -> DrawnPlant {
    let bucket = vertex / BUCKET_VERTICES;
    let entry = sorted[draws[bucket].start + instance];
    let tile = drawn_tiles[entry.x];
    let rank = entry.y;
    // First one blade of every plant, then their companions.
    let place = rank % field.plants_per_tile;
    let choice = KindChoice((entry.z >> 17u) & 7u, entry.z & 0x1ffffu);
    let plant = plant_of(tile.tile, seed_at(tile.tile, place), choice);
    let sizes = unpack2x16unorm(entry.w);
    return DrawnPlant(
        tile,
        plant,
        place,
        rank / field.plants_per_tile,
        f32(choice.thrives) * (1.0 / 65536.0),
        sizes.x,
        1.0 / max(sizes.y, 1e-4),
        tile.anchor_from_eye + plant.root,
        plant_look.buckets[bucket],
    );
}

// Whether a pixel is left out: without multisampling coverage is drawn by lot, pixel by pixel.
fn is_left_out(opacity: f32, pixel: vec2f) -> bool {
    return plant_look.samples == 1u && opacity < lattice(vec2i(pixel));
}

// Whether a corner of a quad of two triangles is one of its upper two, or of those on its right.
fn is_upper_corner(corner: u32) -> bool {
    let of_quad = corner % 6u;
    return of_quad == 2u || of_quad == 3u || of_quad == 5u;
}

fn is_right_corner(corner: u32) -> bool {
    let of_quad = corner % 6u;
    return of_quad == 1u || of_quad == 4u || of_quad == 5u;
}

// A vector turned about the vertical, by an angle given as its cosine and sine.
fn turned_level(v: vec3f, turn: vec2f) -> vec3f {
    return vec3f(v.x * turn.x - v.z * turn.y, v.y, v.x * turn.y + v.z * turn.x);
}

fn shade_byte(plant: Plant, index: u32) -> f32 {
    return byte_of(plant.shade, index);
}

struct DrawnNode {
    place: vec3f,
    direction: vec3f,
    // How far the node is from where the wind alone would have it, 0 to 1.
    pressed: f32,
}

// A plant whose node is nearer to where the wind alone would have it than this share of its height is
// drawn from its seed, so that waking and falling asleep change no pixel.
const UNMOVED = 2e-5;

// A node of the centre line, in the anchor's coordinates.
fn drawn_node(drawn: DrawnPlant, node: u32) -> DrawnNode {
    let tile = drawn.tile.tile;
    let free = wind_pose_at(drawn.plant, wind_bend(tile, drawn.plant), node);
    if tile.slab == NO_SLAB {
        return DrawnNode(free.place, free.direction, 0.0);
    }
    let root = plant_row(tile.slab, drawn.place);
    // The segment above, or the last one at the tip.
    let upper = min(node + 1u, field.segments);
    let along = active_nodes[root + upper].xyz - active_nodes[root + upper - 1u].xyz;
    let here = active_nodes[root + node].xyz;
    let moved = distance(here, free.place) / max(drawn.plant.height_m, 1e-6);
    if moved < UNMOVED {
        return DrawnNode(free.place, free.direction, 0.0);
    }
    return DrawnNode(here, unit_or(along, UP), smoothstep(0.04, 0.35, moved));
}

// A joint of the drawn centre line.
struct DrawnJoint {
    node: DrawnNode,
    along: f32, // share of the way from root to tip
    morph: f32, // how far it is on its way to the next coarser detail
}

// Joint `step`. On the way to the next coarser detail those that it lacks move to its straight segments,
// so that nothing changes when it comes.
fn drawn_joint(drawn: DrawnPlant, step: u32) -> DrawnJoint {
    let node = min(step * drawn.bucket.stride, field.segments);
    let own = drawn_node(drawn, node);
    let along = f32(node) * field.segment_share;
    let coarser = drawn.bucket.coarser;
    let low = node - node % coarser;
    if drawn.tile.morph <= 0.0 || low == node || node == field.segments {
        return DrawnJoint(own, along, 0.0);
    }
    let high = min(low + coarser, field.segments);
    let below = drawn_node(drawn, low);
    let above = drawn_node(drawn, high);
    let share = f32(node - low) / f32(high - low);
    let morph = drawn.tile.morph;
    let place = mix(own.place, mix(below.place, above.place, share), morph);
    let direction = mix(own.direction, mix(below.direction, above.direction, share), morph);
    let pressed = mix(own.pressed, mix(below.pressed, above.pressed, share), morph);
    return DrawnJoint(DrawnNode(place, unit_or(direction, UP), pressed), along, morph);
}

// Place on the base map of the plant's root, in metres from its corner.
fn map_place(drawn: DrawnPlant) -> vec2f {
    return vec2f(drawn.tile.tile.anchor * ANCHOR_CELLS) * field.cell_m + drawn.plant.root.xz;
}

// Colour of the ground under the plant.
fn ground_rgb(drawn: DrawnPlant) -> vec3f {
    let uv = map_place(drawn) / plant_look.map_m;
    return textureSampleLevel(base_colour, base_sampler, uv, 0.0).rgb;
}

// Colour of a green plant: that of the ground under it, varied by patch and by plant.
fn plant_rgb(drawn: DrawnPlant) -> vec3f {
    let plant = drawn.plant;
    let patches = value_noise(map_place(drawn) * 0.9 + 3.0);
    let lightness = 0.72 + 0.34 * shade_byte(plant, 0u) + 0.22 * patches;
    let dry = smoothstep(0.72, 1.0, shade_byte(plant, 1u)) * 0.7 + 0.2 * patches;
    let rgb = ground_rgb(drawn) * field.species[plant.species].tint_rgb * lightness;
    let grey = dot(rgb, vec3f(0.3, 0.6, 0.1));
    return mix(rgb, grey * vec3f(1.55, 1.2, 0.5), dry * 0.6);
}

// Share of the sky that neighbours hide from what lies on the ground: little where it thrives, as
// much as elsewhere where it strayed into the grass.
fn local_cover(drawn: DrawnPlant) -> f32 {
    return mix(plant_look.cover, min(plant_look.cover, 0.15), smoothstep(0.05, 0.4, drawn.thrives));
}

// How deep in the grass a point of the plant lies, 0 at the tops; `height_m` over the ground. Where
// grass is pressed its neighbours are too, and shade it less.
fn below_top(along: f32, height_m: f32, pressed: f32) -> f32 {
    let height = saturate(height_m / (0.75 * field.reach_m));
    return 1.0 - max(mix(along, height, 0.85), 0.7 * pressed);
}
