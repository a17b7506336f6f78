// Blades of grass: strips along the plants' centre lines. Host: src/render/plants.rs.
//
// P15 sections 2.3 and 2.4. A resting plant is made here from its seed; one in an active tile
// takes its nodes from the simulation. A plant is drawn as a tuft: besides the simulated blade it
// may have companions, which take their shape and motion from it. Deviations: light is computed
// per vertex; a blade thinner than a pixel is widened and made as much more transparent, so that
// the cover of a far meadow does not flicker.
#import "shared/drawn_plant.wgsl"
#import "shared/planar_shadow.wgsl"
#import "shared/plant_light.wgsl"

struct BladePoint {
    @builtin(position) clip: vec4f,
    // At the middle of the covered samples: outside the blade colours would run on.
    @location(0) @interpolate(perspective, centroid) radiance: vec3f,
    @location(1) @interpolate(perspective, centroid) opacity: f32,
    @location(2) across: f32, // from the midrib, -1 and 1 at the edges
}

// Width along the blade, relative to the root's: fullest at a fifth, then tapering to a point.
fn taper(along: f32) -> f32 {
    return mix(0.7, 1.0, smoothstep(0.0, 0.2, along)) * sqrt(max(1.0 - along * along, 0.0))
        * (1.0 - 0.35 * along);
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

// Vertices are pairs up the blade, and its tip.
@vertex
fn blade_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> BladePoint {
    return blade_point(drawn_plant(vertex, instance), vertex % BUCKET_VERTICES);
}

@vertex
fn shadow_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> ShadowPoint {
    let drawn = drawn_plant(vertex, instance);
    return planar_shadow(drawn, blade_point(drawn, vertex % BUCKET_VERTICES).clip);
}

// A point of the blade's edge.
struct EdgePoint {
    position: vec3f, // from the eye
    radiance: vec3f,
    opacity: f32,
}

// On the way to the next coarser detail points that it lacks move to its straight edges and take on
// their light, so that nothing changes when it comes.
fn blade_point(drawn: DrawnPlant, corner: u32) -> BladePoint {
    let blade = companion(drawn.tile.tile, drawn.plant, drawn.companion);
    let step = corner / 2u;
    let node = min(step * drawn.bucket.stride, field.segments);
    let side = select(select(-1.0, 1.0, (corner & 1u) == 1u), 0.0, step == drawn.bucket.steps);
    var point = edge_point(drawn, blade, node, side);
    let low = node - node % drawn.bucket.coarser;
    let morph = drawn.tile.morph;
    if morph > 0.0 && low != node && node != field.segments {
        let high = min(low + drawn.bucket.coarser, field.segments);
        let below = edge_point(drawn, blade, low, side);
        let above = edge_point(drawn, blade, high, select(side, 0.0, high == field.segments));
        let share = f32(node - low) / f32(high - low);
        point.position = mix(point.position, mix(below.position, above.position, share), morph);
        point.radiance = mix(point.radiance, mix(below.radiance, above.radiance, share), morph);
        point.opacity = mix(point.opacity, mix(below.opacity, above.opacity, share), morph);
    }
    let clip = frame.clip_from_eye * vec4f(point.position, 1.0);
    return BladePoint(clip, point.radiance, point.opacity, side);
}

fn edge_point(drawn: DrawnPlant, blade: Companion, node: u32, side: f32) -> EdgePoint {
    let plant = drawn.plant;
    let root_from_eye = drawn.root_from_eye + blade.shift;
    let distance = length(root_from_eye);
    let grown = drawn.grown;
    let pose = drawn_node(drawn, node);
    let along = f32(node) * field.segment_share;
    let reached = turned_level(pose.place - plant.root, blade.turn);
    let centre = root_from_eye + reached * blade.size;
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
    let seen_across = unit_or(seen, unit_or(cross(direction, sight), across));
    let spread = mix(across, seen_across, saturate(widened - 1.0));
    // A blade that comes or goes is a narrow one of full height: every sample it covers changes once. If
    // it grew in length its whole curve would move, and flip as many samples to and fro.
    let edge = spread * (side * half_m * widened * taper(along) * grown);
    let position = centre + edge;

    // A blade is bent across, along its midrib. Not where it is thin: samples beside its edges
    // would continue the change across to any value.
    let bent_normal = normalize(normal + across * (0.45 * side * saturate(0.5 * seen_half_px - 0.5)));
    // A blade that is turned over shows its underside, which is paler and duller.
    let upper_rgb = plant_rgb(drawn);
    let pale_rgb = mix(upper_rgb, vec3f(dot(upper_rgb, vec3f(0.3, 0.6, 0.1))), 0.2) * 1.25;
    let rgb = mix(upper_rgb, pale_rgb, 0.6 * pose.pressed);
    let depth = below_top(along, reached.y * blade.size, pose.pressed);
    let light = light_between(plant_look.cover, depth, position);
    // The ground's colour at the root, a paler tip.
    let radiance = leaf_radiance(rgb * mix(0.8, 1.25, along), bent_normal, light, position);
    // Coverage has few steps; a lot per blade makes up for what lies between. Up to a third too
    // much cover is left, since a line of half its samples breaks up into dots.
    let lot = (shade_byte(plant, 0u) - 0.5) / f32(plant_look.samples);
    return EdgePoint(position, through_air(radiance, position), 1.33 / widened + lot);
}

// Detail of a blade's surface: a pale midrib and veins along it; gone before they alias. Deviation: a
// formula in place of a texture.
fn blade_tone(across: f32, width: f32) -> f32 {
    let rib = 1.0 - smoothstep(0.05, 0.2, abs(across));
    let veins = 0.5 + 0.5 * cos(across * 28.0);
    let ribbed = 0.20 * rib * (1.0 - smoothstep(0.15, 0.45, width));
    return 0.97 + ribbed + 0.10 * (veins - 0.5) * (1.0 - smoothstep(0.04, 0.11, width));
}

@fragment
fn blade_fragment(in: BladePoint) -> @location(0) vec4f {
    let tone = blade_tone(in.across, fwidth(in.across));
    if is_left_out(in.opacity, in.clip.xy) {
        discard;
    }
    return vec4f(in.radiance * tone, saturate(in.opacity));
}
