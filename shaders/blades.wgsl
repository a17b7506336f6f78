// Blades of grass: strips along the plants' centre lines. Host: src/render/blades.rs.
//
// P15 sections 2.3 and 2.4. A resting plant is made here from its seed; one in an active tile
// takes its nodes from the simulation. A plant is drawn as a tuft: besides the simulated blade it
// may have companions, which take their shape and motion from it. Deviations: light is computed
// per vertex; a blade thinner than a pixel is widened and made as much more transparent, so that
// the cover of a far meadow does not flicker.
#import "shared/frame.wgsl"
#import "shared/light.wgsl"
#import "shared/noise.wgsl"
#import "shared/plant.wgsl"
#import "shared/pose.wgsl"
#import "shared/shadow.wgsl"
#import "shared/state.wgsl"
#import "shared/wind.wgsl"

struct BladeLook {
    map_m: vec2f, // extent of the base-colour map
    // Share of the sky that plants hide at the ground.
    cover: f32,
    reach_m: f32,
    samples: u32, // per pixel; 1 means that coverage is drawn by lot
    spare_a: u32,
    spare_b: vec2u,
}

// Tiles drawn with one number of segments.
struct Band {
    first_tile: u32,
    blades: u32, // instances per tile
    stride: u32, // nodes per drawn segment
    steps: u32, // drawn segments
}

struct DrawnTile {
    tile: TileRecord,
    anchor_from_eye: vec3f,
    blades: f32, // how many of the tile's sequence are drawn; the last of them are still growing
    widen: f32, // what the drawn blades' width makes up for those left out
    spare_a: f32,
    spare_b: vec2f,
}

@group(3) @binding(0) var<uniform> blade_look: BladeLook;
@group(3) @binding(1) var<storage, read> bands: array<Band>;
@group(3) @binding(2) var<storage, read> drawn_tiles: array<DrawnTile>;
// Nodes of the plants in active tiles, as `recover` leaves them: a row per node, root first.
@group(3) @binding(3) var<storage, read> active_nodes: array<vec4f>;
@group(3) @binding(4) var base_colour: texture_2d<f32>;
@group(3) @binding(5) var base_sampler: sampler;

struct BladePoint {
    @builtin(position) clip: vec4f,
    // At the middle of the covered samples: outside the blade colours would run on.
    @location(0) @interpolate(perspective, centroid) radiance: vec3f,
    @location(1) @interpolate(perspective, centroid) opacity: f32,
}

// Half the least width of a drawn blade, in pixels.
const LEAST_HALF_PX = 0.46;

fn shade_byte(plant: Plant, index: u32) -> f32 {
    return f32((plant.shade >> (8u * index)) & 0xffu) * (1.0 / 255.0);
}

// Width along the blade, relative to the root's: fullest at a fifth, then tapering to a point.
fn taper(along: f32) -> f32 {
    return mix(0.7, 1.0, smoothstep(0.0, 0.2, along)) * sqrt(max(1.0 - along * along, 0.0))
        * (1.0 - 0.35 * along);
}

struct DrawnNode {
    place: vec3f,
    direction: vec3f,
    // How far the node is from where the wind alone would have it, 0 to 1.
    pressed: f32,
}

fn drawn_node(tile: TileRecord, plant: Plant, place: u32, node: u32) -> DrawnNode {
    let free = wind_pose_at(plant, wind_bend(tile, plant), node);
    if tile.slab == NO_SLAB {
        return DrawnNode(free.place, free.direction, 0.0);
    }
    let root = plant_row(tile.slab, place);
    // The segment above, or the last one at the tip.
    let upper = min(node + 1u, field.segments);
    let along = active_nodes[root + upper].xyz - active_nodes[root + upper - 1u].xyz;
    let here = active_nodes[root + node].xyz;
    let moved = distance(here, free.place) / max(plant.height_m, 1e-6);
    return DrawnNode(here, unit_or(along, UP), smoothstep(0.04, 0.35, moved));
}

// A blade of a plant's tuft: 0 is the simulated one, the others stand by it.
struct Companion {
    shift: vec3f, // of the root, in metres
    turn: vec2f, // cosine and sine of its turn about the plant's root
    size: f32,
}

fn companion(tile: TileRecord, plant: Plant, index: u32) -> Companion {
    if index == 0u {
        return Companion(vec3f(0.0), vec2f(1.0, 0.0), 1.0);
    }
    var random = plant.shade ^ (index * PHILOX_WEYL);
    let direction = unit(pcg_next(&random));
    let away_m = TUFT_RADIUS_M * sqrt(unit(pcg_next(&random)));
    let turn = (unit(pcg_next(&random)) - 0.5) * TUFT_TURNS;
    let size = 0.5 + 0.45 * unit(pcg_next(&random));
    let xz = away_m * vec2f(cos_turns(direction), sin_turns(direction));
    let place = plant.root.xz + xz;
    let rise = ground_in_anchor(tile, place.x, place.y) - plant.root.y;
    return Companion(vec3f(xz.x, rise, xz.y), vec2f(cos_turns(turn), sin_turns(turn)), size);
}

fn turned_level(v: vec3f, turn: vec2f) -> vec3f {
    return vec3f(v.x * turn.x - v.z * turn.y, v.y, v.x * turn.y + v.z * turn.x);
}

// Colour of a plant: that of the ground under it, varied by patch and by plant.
fn plant_rgb(tile: TileRecord, plant: Plant) -> vec3f {
    let corner = vec2f(tile.anchor * ANCHOR_CELLS) * field.cell_m;
    let place = corner + plant.root.xz;
    let base = textureSampleLevel(base_colour, base_sampler, place / blade_look.map_m, 0.0).rgb;
    let patches = value_noise(place * 0.9 + 3.0);
    let lightness = 0.72 + 0.34 * shade_byte(plant, 0u) + 0.22 * patches;
    let dry = smoothstep(0.72, 1.0, shade_byte(plant, 1u)) * 0.7 + 0.2 * patches;
    let rgb = base * field.species[plant.species].tint_rgb * lightness;
    let grey = dot(rgb, vec3f(0.3, 0.6, 0.1));
    return mix(rgb, grey * vec3f(1.55, 1.2, 0.5), dry * 0.6);
}

fn nowhere() -> BladePoint {
    return BladePoint(vec4f(0.0, 0.0, -1.0, 1.0), vec3f(0.0), 0.0);
}

// `vertex` counts 64 for every band, then pairs up the blade and the tip; `instance` counts the
// places of the band's tiles.
@vertex
fn blade_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> BladePoint {
    let band = bands[vertex / 64u];
    let corner = vertex % 64u;
    let rank = instance % band.blades;
    let drawn = drawn_tiles[band.first_tile + instance / band.blades];
    if f32(rank) >= drawn.blades {
        return nowhere();
    }
    // First one blade of every plant, then their companions.
    let place = rank % field.plants_per_tile;
    let plant = plant_at(drawn.tile, place);
    if !plant.grows {
        return nowhere();
    }
    let blade = companion(drawn.tile, plant, rank / field.plants_per_tile);
    let root_from_eye = drawn.anchor_from_eye + plant.root + blade.shift;
    let distance = length(root_from_eye);
    // Plants at the end of the prefix, and those at the end of sight, are small: nothing pops.
    let youngest = saturate((drawn.blades - f32(rank)) / max(0.2 * drawn.blades, 1.0));
    let grown = youngest * (1.0 - smoothstep(0.75, 1.0, distance / blade_look.reach_m));
    if grown < 0.02 {
        return nowhere();
    }

    let step = corner / 2u;
    let node = min(step * band.stride, field.segments);
    let pose = drawn_node(drawn.tile, plant, place, node);
    let along = f32(node) * field.segment_share;
    let reached = turned_level(pose.place - plant.root, blade.turn);
    let centre = root_from_eye + reached * (grown * blade.size);
    let direction = turned_level(pose.direction, blade.turn);
    let azimuth = turned_level(vec3f(plant.azimuth.x, 0.0, plant.azimuth.y), blade.turn);

    // The strip's cross direction: level, then rolled about the blade, more towards the tip.
    let level = unit_or(
        cross(direction, azimuth),
        vec3f(-azimuth.z, 0.0, azimuth.x),
    );
    let roll = (shade_byte(plant, 2u) - 0.5) * 1.6 + (shade_byte(plant, 3u) - 0.5) * 1.4 * along;
    let up = cross(level, direction);
    let across = level * cos(roll) + up * sin(roll);
    let normal = cross(direction, across);

    let sight = centre / max(length(centre), 1e-6);
    let seen = across - sight * dot(across, sight);
    let seen_share = length(seen);
    let half_m = 0.5 * plant.width_m * drawn.widen * mix(0.6, 1.0, blade.size);
    let pixel_m = distance * frame.pixel_rad;
    // The whole blade is widened by one factor, from its mean width as seen.
    let seen_half_px = 0.7 * half_m * max(seen_share, 0.05) / pixel_m;
    let widened = max(LEAST_HALF_PX / seen_half_px, 1.0);
    let side = select(select(-1.0, 1.0, (corner & 1u) == 1u), 0.0, step == band.steps);
    let seen_across = unit_or(seen, unit_or(cross(direction, sight), across));
    let spread = mix(across, seen_across, saturate(widened - 1.0));
    let edge = spread * (side * half_m * widened * taper(along) * sqrt(grown));
    let position = centre + edge;

    // A blade is bent across, along its midrib. Not where it is thin: samples beside its edges
    // would continue the change across to any value.
    let bent_normal = normalize(normal + across * (0.45 * side * saturate(0.5 * seen_half_px - 0.5)));
    // A blade that is turned over shows its underside, which is paler and duller.
    let upper_rgb = plant_rgb(drawn.tile, plant);
    let pale_rgb = mix(upper_rgb, vec3f(dot(upper_rgb, vec3f(0.3, 0.6, 0.1))), 0.2) * 1.25;
    let rgb = mix(upper_rgb, pale_rgb, 0.6 * pose.pressed);
    // How deep in the grass, by height above the ground. Where grass is pressed its neighbours
    // are too, and shade it less.
    let height = saturate(reached.y * blade.size / (0.75 * field.reach_m));
    let top = max(mix(along, height, 0.85), 0.7 * pose.pressed);
    let radiance = blade_radiance(rgb, bent_normal, along, 1.0 - top, position);
    let clip = frame.clip_from_eye * vec4f(position, 1.0);
    // Coverage has few steps; a lot per blade makes up for what lies between. Up to a third too
    // much cover is left, since a line of half its samples breaks up into dots.
    let lot = (shade_byte(plant, 0u) - 0.5) / f32(blade_look.samples);
    return BladePoint(clip, through_air(radiance, position), 1.33 / widened + lot);
}

// Eq. 13: light that comes through the blade, a slab of unit thickness.
fn transmitted(towards_sun: f32, thickness: f32) -> f32 {
    if towards_sun >= -1e-3 {
        return 0.0;
    }
    return -towards_sun * exp(thickness / towards_sun);
}

// Eq. 14, per vertex: a blade is a few pixels wide.
fn blade_radiance(
    rgb: vec3f,
    side_normal: vec3f,
    along: f32,
    below_top: f32,
    position: vec3f,
) -> vec3f {
    let to_eye = -normalize(position);
    let normal = select(side_normal, -side_normal, dot(side_normal, to_eye) < 0.0);
    let sun = frame.sun_direction;
    // Reeves and Blau: neighbours leave less light further down.
    let depth = blade_look.cover * pow(below_top, 1.4);
    let sky_open = 1.0 - 0.85 * depth;
    let sun_open = exp(-3.6 * depth) * sun_reaches_cheaply(position + UP * 0.01);
    // The ground's colour at the root, a paler tip.
    let surface = rgb * mix(0.8, 1.25, along);
    // The diffuse normal leans a little towards the sky: a single strip stands for a curved blade.
    // More would take the light off pressed grass, whose blades do face the sky.
    let facing = dot(normal, sun);
    let soft = max(dot(normalize(normal + UP * 0.12), sun), 0.0);
    let through = transmitted(facing, 0.4) * 2.0;
    let mirrored = reflect(-sun, normal);
    let glint = pow(max(dot(to_eye, mirrored), 0.0), 18.0) * 0.10 * step(0.0, facing);
    let sheen = ambient_light(reflect(-to_eye, normal)) * (0.05 * sky_open);
    let direct = surface * soft + surface * vec3f(1.25, 1.15, 0.45) * through + vec3f(glint);
    return frame.sun_rgb * sun_open * direct
        + ambient_light(normalize(normal + UP * 0.25)) * sky_open * surface
        + sheen;
}

@fragment
fn blade_fragment(in: BladePoint) -> @location(0) vec4f {
    // Without multisampling coverage is drawn by lot, pixel by pixel.
    if blade_look.samples == 1u && in.opacity < lattice(vec2i(in.clip.xy)) {
        discard;
    }
    return vec4f(in.radiance, saturate(in.opacity));
}
