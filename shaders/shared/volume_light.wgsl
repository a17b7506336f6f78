// Light of the sky past the ground and the fixed bodies, from volumes: O09 section 6.1. Host and Rust
// twin: src/render/light.
//
// A slice is a layer of 2D texture arrays, at one height over the ground. Within a slice the sampler
// mixes texels, between slices this does. What a cell stores: src/render/light/irradiance.rs.
#import "shared/frame.wgsl"
#import "shared/light.wgsl"

struct LightVolume {
    corner_from_eye: vec3f, // of the first column, at height 0 of the world
    slices: u32, // 0 where the scene has no volume
    cells_per_m: vec2f,
    slices_per_m: f32,
    spare: f32,
}

@group(2) @binding(2) var<uniform> light_volume: LightVolume;
@group(2) @binding(3) var openness_slices: texture_2d_array<f32>;
// All slices of red, of green, of blue.
@group(2) @binding(4) var irradiance_slices: texture_2d_array<f32>;
// Height of the ground under each column.
@group(2) @binding(5) var column_heights: texture_2d<f32>;
@group(2) @binding(6) var volume_sampler: sampler;

// Share of the light on a leaf that comes through it from its other side.
const LEAF_LETS_THROUGH = 0.3;

// Light at a point as a function of a surface's normal there.
struct SkyLight {
    openness: f32, // share of the upper half of the sphere that is open
    mean: vec3f,
    leans: mat3x3f, // a column per colour
}

// Height of the volume's floor under a place that counts columns and rows.
fn volume_floor(place: vec2f) -> f32 {
    let last = vec2i(textureDimensions(column_heights)) - 1;
    let low = min(vec2i(place), last);
    let high = min(low + 1, last);
    let share = place - vec2f(low);
    let near = mix(
        textureLoad(column_heights, low, 0).r,
        textureLoad(column_heights, vec2i(high.x, low.y), 0).r,
        share.x,
    );
    let far = mix(
        textureLoad(column_heights, vec2i(low.x, high.y), 0).r,
        textureLoad(column_heights, high, 0).r,
        share.x,
    );
    return mix(near, far, share.y);
}

fn openness_at(uv: vec2f, low: u32, share: f32) -> f32 {
    let below = textureSampleLevel(openness_slices, volume_sampler, uv, low, 0.0).r;
    if share == 0.0 {
        return below;
    }
    return mix(
        below,
        textureSampleLevel(openness_slices, volume_sampler, uv, low + 1u, 0.0).r,
        share,
    );
}

fn irradiance_at(uv: vec2f, colour: u32, low: u32, share: f32) -> vec4f {
    let layer = colour * light_volume.slices + low;
    let below = textureSampleLevel(irradiance_slices, volume_sampler, uv, layer, 0.0);
    if share == 0.0 {
        return below;
    }
    return mix(
        below,
        textureSampleLevel(irradiance_slices, volume_sampler, uv, layer + 1u, 0.0),
        share,
    );
}

// Light at a point; beyond the volume's sides and top that at them.
fn sky_light_at(position_from_eye: vec3f) -> SkyLight {
    if light_volume.slices == 0u {
        return SkyLight();
    }
    let size = vec2f(textureDimensions(column_heights));
    let from_corner = position_from_eye - light_volume.corner_from_eye;
    let place = clamp(from_corner.xz * light_volume.cells_per_m, vec2f(0.0), size - 1.0);
    let over_m = from_corner.y - volume_floor(place);
    let top = f32(light_volume.slices - 1u);
    let slice = clamp(over_m * light_volume.slices_per_m, 0.0, top);
    let low = u32(min(slice, top - 1.0));
    let share = slice - f32(low);
    let uv = (place + 0.5) / size;
    let red = irradiance_at(uv, 0u, low, share);
    let green = irradiance_at(uv, 1u, low, share);
    let blue = irradiance_at(uv, 2u, low, share);
    return SkyLight(
        openness_at(uv, low, share),
        vec3f(red.w, green.w, blue.w),
        mat3x3f(red.xyz, green.xyz, blue.xyz),
    );
}

// Light of sky and ground on a white surface with this normal: by `ambient_light` where the scene has no
// volume.
fn sky_light(light: SkyLight, normal: vec3f) -> vec3f {
    if light_volume.slices == 0u {
        return ambient_light(normal);
    }
    let from_ground = frame.bounce_rgb * (light.openness * (0.5 - 0.5 * normal.y));
    return max(light.mean + normal * light.leans, vec3f(0.0)) + from_ground;
}

// Light on a thin white leaf, as the side with this normal shows it: both its sides (KCS07).
fn leaf_sky_light(light: SkyLight, normal: vec3f) -> vec3f {
    if light_volume.slices == 0u {
        return ambient_light(normal);
    }
    return mix(sky_light(light, normal), sky_light(light, -normal), LEAF_LETS_THROUGH);
}

// Light on a solid's surface: looked up half a cell above it, where less of what lies behind is mixed in.
fn sky_light_on(position_from_eye: vec3f, normal: vec3f) -> SkyLight {
    if light_volume.slices == 0u {
        return SkyLight();
    }
    return sky_light_at(position_from_eye + normal * (0.5 / light_volume.cells_per_m.x));
}
