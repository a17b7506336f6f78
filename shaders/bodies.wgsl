// Rigid bodies, and their depth in the sun's shadow map. Hosts: src/render/bodies.rs, shadow.rs.
#import "shared/frame.wgsl"
#import "shared/light.wgsl"
#import "shared/shadow.wgsl"
#import "shared/volume_light.wgsl"

struct BodyRecord {
    turn: vec4f, // quaternion x, y, z, w: world_from_body
    place_from_eye: vec3f,
    pattern: f32, // strength of the two-tone pattern that shows a body's turning
    rgb: vec3f,
    cover: f32, // share of the sky that its coat hides
}

@group(3) @binding(0) var<storage, read> body_records: array<BodyRecord>;

struct BodyVertex {
    @location(0) position_in_body: vec3f,
    @location(1) normal_in_body: vec3f,
}

struct BodyFragment {
    @builtin(position) clip: vec4f,
    @location(0) position_from_eye: vec3f,
    @location(1) normal: vec3f,
    @location(2) position_in_body: vec3f,
    @location(3) @interpolate(flat) record: u32,
}

fn turned(turn: vec4f, p: vec3f) -> vec3f {
    let t = 2.0 * cross(turn.xyz, p);
    return p + turn.w * t + cross(turn.xyz, t);
}

@vertex
fn body_vertex(vertex: BodyVertex, @builtin(instance_index) record: u32) -> BodyFragment {
    let body = body_records[record];
    let position = turned(body.turn, vertex.position_in_body) + body.place_from_eye;
    return BodyFragment(
        frame.clip_from_eye * vec4f(position, 1.0),
        position,
        turned(body.turn, vertex.normal_in_body),
        vertex.position_in_body,
        record,
    );
}

@vertex
fn shadow_vertex(
    vertex: BodyVertex,
    @builtin(instance_index) record: u32,
) -> @builtin(position) vec4f {
    let body = body_records[record];
    let position = turned(body.turn, vertex.position_in_body) + body.place_from_eye;
    return frame.shadow_from_eye * vec4f(position, 1.0);
}

// Eight sectors in two tones with a pale band, with edges one pixel soft.
fn pattern(p: vec3f, pixel_m: f32, strength: f32, rgb: vec3f) -> vec3f {
    let soft = max(pixel_m, 1e-4);
    let side = clamp(p / soft, vec3f(-1.0), vec3f(1.0));
    let tone = 0.5 + 0.5 * side.x * side.y * side.z;
    let light = mix(rgb, vec3f(dot(rgb, vec3f(0.3, 0.6, 0.1))) * 0.4 + 0.42, 0.62);
    return mix(rgb, light, strength * tone);
}

@fragment
fn body_fragment(in: BodyFragment) -> @location(0) vec4f {
    let body = body_records[in.record];
    let normal = normalize(in.normal);
    let to_eye = normalize(-in.position_from_eye);
    let pixel_m = length(in.position_from_eye) * frame.pixel_rad;
    let albedo = pattern(in.position_in_body, pixel_m, body.pattern, body.rgb);

    let sun = frame.sun_direction;
    let facing = max(dot(normal, sun), 0.0);
    // A coat shades what it grows on as a canopy does the ground.
    let coat_open = sun_past_plants(body.cover);
    let reaches = sun_reaches(in.position_from_eye, normal) * coat_open;
    let sky_open = sky_past_plants(body.cover);
    let sky = sky_light_on(in.position_from_eye, normal);
    let from_sky = sky_light(sky, normal) * sky_open;
    let diffuse = albedo * (frame.sun_rgb * facing * reaches + from_sky);

    // GGX with Schlick's Fresnel term and Kelemen's visibility; light is in units of pi.
    let half_way = normalize(sun + to_eye);
    let n_h = max(dot(normal, half_way), 0.0);
    let v_h = max(dot(to_eye, half_way), 1e-3);
    let n_v = max(dot(normal, to_eye), 0.0);
    let roughness2 = 0.16 * 0.16;
    let spread = n_h * n_h * (roughness2 - 1.0) + 1.0;
    let fresnel = 0.04 + 0.96 * pow(1.0 - v_h, 5.0);
    let highlight = roughness2 / (spread * spread) * fresnel / (4.0 * v_h * v_h);
    let mirrored = reflect(-to_eye, normal);
    let rim = 0.04 + 0.5 * pow(1.0 - n_v, 5.0);
    let gloss = frame.sun_rgb * highlight * facing * reaches + sky_light(sky, mirrored) * rim;
    return vec4f(through_air(diffuse + gloss * coat_open, in.position_from_eye), 1.0);
}
