// Broad leaves: a lamina on both sides of the plant's centre line, cut out by an alpha mask. Host:
// src/render/leaves.rs.
#import "shared/drawn_plant.wgsl"
#import "shared/planar_shadow.wgsl"
#import "shared/plant_light.wgsl"

struct LeafPoint {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(perspective, centroid) radiance: vec3f,
    // From the midrib (−1 and 1 at the strip's edges), and from stalk to tip.
    @location(1) on_leaf: vec2f,
    @location(2) @interpolate(flat) opacity: f32,
    @location(3) @interpolate(flat) lobes: f32,
}

// How far the lamina's edges are folded up, over their distance from the midrib.
const FOLD = 0.35;

@vertex
fn leaf_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> LeafPoint {
    return leaf_point(drawn_plant(vertex, instance), vertex % BUCKET_VERTICES);
}

@vertex
fn shadow_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> ShadowPoint {
    let drawn = drawn_plant(vertex, instance);
    return planar_shadow(drawn, leaf_point(drawn, vertex % BUCKET_VERTICES).clip);
}

fn leaf_point(drawn: DrawnPlant, corner: u32) -> LeafPoint {
    let is_upper = is_upper_corner(corner);
    let is_outer = is_right_corner(corner);
    let side = select(-1.0, 1.0, (corner / 6u) % 2u == 1u);
    let step = corner / 12u + select(0u, 1u, is_upper);
    let joint = drawn_joint(drawn, step);
    let pose = joint.node;
    let along = joint.along;

    let plant = drawn.plant;
    let azimuth = vec3f(plant.azimuth.x, 0.0, plant.azimuth.y);
    let level = unit_or(cross(pose.direction, azimuth), vec3f(-azimuth.z, 0.0, azimuth.x));
    let roll = (shade_byte(plant, 2u) - 0.5) * 1.0;
    let across = level * cos(roll) + cross(level, pose.direction) * sin(roll);
    let normal = cross(pose.direction, across);
    let facing_up = select(normal, -normal, normal.y < 0.0);

    let centre = drawn.root_from_eye + (pose.place - plant.root) * drawn.grown;
    let half_m = 0.5 * plant.width_m * drawn.widen * drawn.grown;
    let widened = max(LEAST_HALF_PX * length(centre) * frame.pixel_rad / max(half_m, 1e-6), 1.0);
    let out = select(0.0, half_m * widened, is_outer);
    let position = centre + across * (side * out) + facing_up * (FOLD * out);
    let folded = normalize(facing_up - across * (side * FOLD));
    let depth = below_top(along, pose.place.y - plant.root.y, pose.pressed);
    let light = light_between(local_cover(drawn), depth, position);
    let radiance = leaf_radiance(plant_rgb(drawn), folded, light, position);
    let clip = frame.clip_from_eye * vec4f(position, 1.0);
    let uv = vec2f(side * select(0.0, 1.0, is_outer), along);
    let lobes = 3.0 + 5.0 * shade_byte(plant, 3u);
    return LeafPoint(clip, through_air(radiance, position), uv, 1.33 / widened, lobes);
}

// Half the lamina's width at a height, of the strip's: a stalk, then an egg with a wavy edge.
fn outline(along: f32, lobes: f32) -> f32 {
    let blade = saturate((along - 0.16) / 0.84);
    let egg = pow(max(sin(3.1416 * pow(blade, 0.75)), 0.0), 0.75);
    return max(egg * (0.92 + 0.08 * sin(6.2832 * lobes * along)), 0.07 * step(along, 0.2));
}

@fragment
fn leaf_fragment(in: LeafPoint) -> @location(0) vec4f {
    let width = fwidth(in.on_leaf);
    let from_rib = abs(in.on_leaf.x);
    let inside = outline(in.on_leaf.y, in.lobes) - from_rib;
    let cover = in.opacity * saturate(0.5 + inside / max(width.x, 1e-4));
    if cover < 0.04 || is_left_out(cover, in.clip.xy) {
        discard;
    }
    // Veins run from the midrib outwards and towards the tip; gone before they alias.
    let phase = in.on_leaf.y * 9.0 - from_rib * 2.2;
    let vein = smoothstep(0.36, 0.5, abs(fract(phase) - 0.5));
    let rib = 1.0 - smoothstep(0.03, 0.08, from_rib);
    let detail = 1.0 - smoothstep(0.04, 0.12, max(width.x, width.y));
    let tone = 1.0 + detail * (0.22 * max(vein, rib) - 0.06);
    return vec4f(in.radiance * tone, saturate(cover));
}
