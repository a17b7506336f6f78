// Light on plants: P15 section 2.4.
#import "shared/field.wgsl"
#import "shared/frame.wgsl"
#import "shared/light.wgsl"
#import "shared/shadow.wgsl"
#import "shared/volume_light.wgsl"

// Half the least width of what is drawn, in pixels.
const LEAST_HALF_PX = 0.46;

// Eq. 13: light that comes through a leaf, a slab of unit thickness.
fn transmitted(towards_sun: f32, thickness: f32) -> f32 {
    if towards_sun >= -1e-3 {
        return 0.0;
    }
    return -towards_sun * exp(thickness / towards_sun);
}

struct PlantLight {
    sky_open: f32,
    sun_open: f32,
    sky: SkyLight, // past the ground and the fixed bodies
}

// Reeves and Blau: neighbours leave less light further down. `cover` is the share of the sky that
// they hide at the ground.
fn light_between(cover: f32, below_top: f32, position: vec3f) -> PlantLight {
    let depth = cover * pow(below_top, 1.4);
    let sun_open = sun_past_plants(depth) * sun_reaches_cheaply(position + UP * 0.01);
    return PlantLight(sky_past_plants(depth), sun_open, sky_light_at(position));
}

// Eq. 14 for a thin green leaf, per vertex: it is a few pixels wide.
fn leaf_radiance(
    surface: vec3f,
    side_normal: vec3f,
    light: PlantLight,
    position: vec3f,
) -> vec3f {
    let to_eye = -normalize(position);
    let normal = select(side_normal, -side_normal, dot(side_normal, to_eye) < 0.0);
    let sun = frame.sun_direction;
    // The diffuse normal leans a little towards the sky: a single strip stands for a curved blade.
    // More would take the light off pressed grass, whose blades do face the sky.
    let facing = dot(normal, sun);
    let soft = max(dot(normalize(normal + UP * 0.12), sun), 0.0);
    let through = transmitted(facing, 0.4) * 2.0;
    let mirrored = reflect(-sun, normal);
    let glint = pow(max(dot(to_eye, mirrored), 0.0), 18.0) * 0.10 * step(0.0, facing);
    let sheen = sky_light(light.sky, reflect(-to_eye, normal)) * (0.05 * light.sky_open);
    let direct = surface * soft + surface * vec3f(1.25, 1.15, 0.45) * through + vec3f(glint);
    return frame.sun_rgb * light.sun_open * direct
        + leaf_sky_light(light.sky, normalize(normal + UP * 0.25)) * light.sky_open * surface
        + sheen;
}

// Eq. 14 without transmission and mirror, for stones and wood.
fn dull_radiance(surface: vec3f, normal: vec3f, light: PlantLight) -> vec3f {
    let facing = max(dot(normal, frame.sun_direction), 0.0);
    return surface
        * (frame.sun_rgb * (light.sun_open * facing)
            + sky_light(light.sky, normal) * light.sky_open);
}
