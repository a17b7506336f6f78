// Flowers: a stem, and a head with an alpha mask that looks at the sky. Host: src/render/flowers.rs.
#import "shared/drawn_plant.wgsl"
#import "shared/planar_shadow.wgsl"
#import "shared/plant_light.wgsl"

struct FlowerPoint {
    @builtin(position) clip: vec4f,
    // Surface times light on the stem; light alone on the head.
    @location(0) @interpolate(perspective, centroid) radiance: vec3f,
    @location(1) position_from_eye: vec3f,
    // Place on the head, whose petals end at radius 1.
    @location(2) on_head: vec2f,
    // Turn of the petals, in petals; cover; then the kind, or MAX_SPECIES on the stem.
    @location(3) @interpolate(flat) turn: f32,
    @location(4) @interpolate(flat) opacity: f32,
    @location(5) @interpolate(flat) kind: u32,
}

const HEAD_SECTORS = 8u;
const TAU = 6.2831853;
// A circle of radius 1 fits into the head's octagon of this radius.
const HEAD_REACH = 1.0824;

@vertex
fn flower_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> FlowerPoint {
    return flower_point(drawn_plant(vertex, instance), vertex % BUCKET_VERTICES);
}

@vertex
fn shadow_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> ShadowPoint {
    let drawn = drawn_plant(vertex, instance);
    return planar_shadow(drawn, flower_point(drawn, vertex % BUCKET_VERTICES).clip);
}

fn flower_point(drawn: DrawnPlant, corner: u32) -> FlowerPoint {
    if corner < 6u * drawn.bucket.steps {
        return on_stem(drawn, corner);
    }
    return on_head(drawn, corner - 6u * drawn.bucket.steps);
}

fn on_stem(drawn: DrawnPlant, corner: u32) -> FlowerPoint {
    let is_upper = is_upper_corner(corner);
    let is_right = is_right_corner(corner);
    let step = corner / 6u + select(0u, 1u, is_upper);
    let joint = drawn_joint(drawn, step);
    let pose = joint.node;
    let along = joint.along;
    let centre = drawn.root_from_eye + (pose.place - drawn.plant.root) * drawn.grown;
    let sight = centre / max(length(centre), 1e-6);
    let across = unit_or(cross(pose.direction, sight), vec3f(1.0, 0.0, 0.0));
    let half_m = 0.5 * drawn.plant.width_m * drawn.widen;
    let widened = max(LEAST_HALF_PX * length(centre) * frame.pixel_rad / half_m, 1.0);
    let position = centre + across * (half_m * widened * select(-1.0, 1.0, is_right));
    let normal = normalize(cross(across, pose.direction) + across * select(-0.5, 0.5, is_right));
    let depth = below_top(along, pose.place.y - drawn.plant.root.y, pose.pressed);
    let light = light_between(plant_look.cover, depth, position);
    let radiance = leaf_radiance(plant_rgb(drawn) * mix(0.8, 1.1, along), normal, light, position);
    let clip = frame.clip_from_eye * vec4f(position, 1.0);
    return FlowerPoint(clip, radiance, position, vec2f(0.0), 0.0, 1.33 / widened, MAX_SPECIES);
}

// Triangles from the middle to the rim, which is raised a little.
fn on_head(drawn: DrawnPlant, corner: u32) -> FlowerPoint {
    let form = plant_look.forms[drawn.plant.species];
    let pose = drawn_node(drawn, field.segments);
    let centre = drawn.root_from_eye + (pose.place - drawn.plant.root) * drawn.grown;
    // A head that is not pressed turns to the sky.
    let normal = normalize(pose.direction + UP * (0.8 * (1.0 - pose.pressed)) + vec3f(0.0, 1e-4, 0.0));
    let first = unit_or(cross(normal, vec3f(drawn.plant.azimuth.y, 0.0, -drawn.plant.azimuth.x)), UP);
    let second = cross(normal, first);
    let rim = corner % 3u;
    let sector = f32(corner / 3u + select(0u, 1u, rim == 2u)) / f32(HEAD_SECTORS);
    let reach = select(HEAD_REACH, 0.0, rim == 0u);
    let uv = reach * vec2f(cos_turns(sector), sin_turns(sector));

    let size = 0.8 + 0.4 * shade_byte(drawn.plant, 2u);
    let half_m = 0.5 * form.head_m * size * drawn.grown * sqrt(drawn.widen);
    let widened = max(LEAST_HALF_PX * length(centre) * frame.pixel_rad / max(half_m, 1e-6), 1.0);
    let shift = (first * uv.x + second * uv.y + normal * (0.22 * reach)) * (half_m * widened);
    let position = centre + shift;
    let cupped = normalize(normal - 0.35 * (first * uv.x + second * uv.y));
    let depth = below_top(1.0, pose.place.y - drawn.plant.root.y, pose.pressed);
    let light = light_between(plant_look.cover, depth, position);
    let to_eye = -normalize(position);
    let facing = dot(select(cupped, -cupped, dot(cupped, to_eye) < 0.0), frame.sun_direction);
    let lit = max(facing, 0.0) + 1.6 * transmitted(facing, 0.3);
    let radiance = frame.sun_rgb * (light.sun_open * lit) + sky_light(light.sky, cupped) * light.sky_open;
    let clip = frame.clip_from_eye * vec4f(position, 1.0);
    let turn = 8.0 * shade_byte(drawn.plant, 3u);
    let opacity = 1.33 / (widened * widened);
    return FlowerPoint(clip, radiance, position, uv, turn, opacity, drawn.plant.species);
}

// The alpha mask: how much of a pixel the petals (x) and the middle (y) cover. `pixel` is a pixel's
// size on the head.
fn head_mask(uv: vec2f, petals: f32, turn: f32, pixel: f32) -> vec2f {
    let radius = length(uv);
    let middle = saturate(0.5 + (0.3 - radius) / pixel);
    let angle = fract(atan2(uv.y, uv.x) / TAU * petals + turn) - 0.5;
    let along = saturate((radius - 0.15) / 0.85);
    let half_width = 0.49 * pow(sin(3.1416 * (0.12 + 0.8 * along)), 0.5);
    let inside = min((half_width - abs(angle)) * TAU * radius / petals, 1.0 - radius);
    // Where petals are finer than pixels their mean is left.
    let sharp = saturate(0.5 + inside / pixel);
    let mean = 0.75 * saturate(0.5 + (0.95 - radius) / pixel);
    return vec2f(max(mix(sharp, mean, smoothstep(0.15, 0.5, pixel)), middle), middle);
}

@fragment
fn flower_fragment(in: FlowerPoint) -> @location(0) vec4f {
    let width = fwidth(in.on_head);
    let pixel = max(max(width.x, width.y), 1e-4);
    var rgb = in.radiance;
    var cover = in.opacity;
    if in.kind < MAX_SPECIES {
        let form = plant_look.forms[in.kind];
        let mask = head_mask(in.on_head, form.petals, in.turn, pixel);
        let shaded = form.petal_rgb * mix(0.72, 1.0, saturate(length(in.on_head)));
        rgb *= mix(shaded, form.centre_rgb, mask.y);
        cover *= mask.x;
    }
    if cover < 0.04 || is_left_out(cover, in.clip.xy) {
        discard;
    }
    return vec4f(through_air(rgb, in.position_from_eye), saturate(cover));
}
