// Twigs: round sticks along the plants' centre lines, each with a side branch. Host:
// src/render/twigs.rs.
#import "shared/drawn_plant.wgsl"
#import "shared/planar_shadow.wgsl"
#import "shared/plant_light.wgsl"

struct TwigPoint {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(perspective, centroid) radiance: vec3f,
    // Around and along the stick, for the bark.
    @location(1) on_bark: vec2f,
    @location(2) @interpolate(flat) opacity: f32,
}

// A point of a stick's centre line.
struct StickPoint {
    centre: vec3f, // from the eye
    direction: vec3f,
    radius_m: f32,
    along: f32,
}

const SIDES = 3u;

@vertex
fn twig_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> TwigPoint {
    return twig_point(drawn_plant(vertex, instance), vertex % BUCKET_VERTICES);
}

@vertex
fn shadow_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> ShadowPoint {
    let drawn = drawn_plant(vertex, instance);
    return planar_shadow(drawn, twig_point(drawn, vertex % BUCKET_VERTICES).clip);
}

fn twig_point(drawn: DrawnPlant, corner: u32) -> TwigPoint {
    let is_upper = is_upper_corner(corner);
    let is_right = is_right_corner(corner);
    let side = (corner / 6u) % SIDES + select(0u, 1u, is_right);
    let part = corner / (6u * SIDES);
    var point: StickPoint;
    if part < drawn.bucket.steps {
        point = on_stick(drawn, part + select(0u, 1u, is_upper));
    } else {
        point = on_branch(drawn, is_upper);
    }

    let level = unit_or(cross(point.direction, UP), vec3f(1.0, 0.0, 0.0));
    let up = cross(level, point.direction);
    let around = f32(side) / f32(SIDES) + shade_byte(drawn.plant, 2u);
    let normal = level * cos_turns(around) + up * sin_turns(around);
    let least_m = LEAST_HALF_PX * length(point.centre) * frame.pixel_rad;
    let widened = max(least_m / max(point.radius_m, 1e-6), 1.0);
    let position = point.centre + normal * (point.radius_m * widened);
    // Bark has little of the ground's green: old wood goes grey.
    let ground = ground_rgb(drawn) * field.species[drawn.plant.species].tint_rgb;
    let wood = mix(ground, dot(ground, vec3f(0.3, 0.6, 0.1)) * vec3f(1.1, 0.95, 0.8), 0.6);
    let surface = wood * (0.6 + 0.7 * shade_byte(drawn.plant, 1u));
    let light = light_between(local_cover(drawn), 0.9, position);
    let radiance = through_air(dull_radiance(surface, normal, light), position);
    let clip = frame.clip_from_eye * vec4f(position, 1.0);
    let on_bark = vec2f(around * 5.0, point.along * 14.0 + f32(drawn.plant.shade & 255u));
    return TwigPoint(clip, radiance, on_bark, 1.33 / widened);
}

// A twig lies on the ground where its centre line would run into it.
fn over_ground(drawn: DrawnPlant, place: vec3f, radius_m: f32) -> vec3f {
    let ground = ground_in_anchor(drawn.tile.tile, place.x, place.z) + radius_m;
    return vec3f(place.x, max(place.y, ground), place.z);
}

fn on_stick(drawn: DrawnPlant, step: u32) -> StickPoint {
    let joint = drawn_joint(drawn, step);
    let pose = joint.node;
    let along = joint.along;
    let radius_m = 0.5 * drawn.plant.width_m * drawn.widen * drawn.grown * (1.0 - 0.65 * along);
    let place = over_ground(drawn, pose.place, radius_m);
    // Grown wood has knees: every node lies a little off the line.
    let word = drawn.plant.shade >> (step * drawn.bucket.stride & 15u);
    let off = (vec2f(f32(word & 15u), f32((word >> 4u) & 15u)) / 15.0 - 0.5) 
        * (2.4 * radius_m * (1.0 - joint.morph));
    let centre = drawn.root_from_eye
        + (place + vec3f(off.x, 0.0, off.y) - drawn.plant.root) * drawn.grown;
    return StickPoint(centre, pose.direction, radius_m, along);
}

// The branch leaves the stick at its middle, and ends thin.
fn on_branch(drawn: DrawnPlant, is_tip: bool) -> StickPoint {
    let middle = (drawn.bucket.steps + 1u) / 2u;
    var point = on_stick(drawn, middle);
    let level = unit_or(cross(point.direction, UP), vec3f(1.0, 0.0, 0.0));
    let side = select(-1.0, 1.0, shade_byte(drawn.plant, 3u) > 0.5);
    let direction = normalize(point.direction * 0.8 + level * (0.55 * side) + UP * 0.15);
    let length_m = drawn.plant.height_m * (0.2 + 0.25 * shade_byte(drawn.plant, 0u)) * drawn.grown;
    point.centre += direction * select(0.0, length_m, is_tip);
    point.direction = direction;
    point.radius_m *= select(0.75, 0.3, is_tip);
    return point;
}

@fragment
fn twig_fragment(in: TwigPoint) -> @location(0) vec4f {
    if is_left_out(in.opacity, in.clip.xy) {
        discard;
    }
    let width = fwidth(in.on_bark);
    let detail = 1.0 - smoothstep(0.3, 0.9, max(width.x, width.y));
    let bark = 1.0 + detail * (value_noise(in.on_bark * vec2f(2.0, 1.0)) - 0.5) * 0.7;
    return vec4f(in.radiance * bark, saturate(in.opacity));
}
