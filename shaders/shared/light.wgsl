// Sun, sky and air: one set of colours for every layer.
#import "shared/frame.wgsl"
#import "shared/noise.wgsl"

// Radiance of the clear sky without the sun's disc. Below the horizon it keeps the horizon's.
fn clear_sky(direction: vec3f) -> vec3f {
    let up = max(direction.y, 0.0);
    let towards_sun = dot(direction, frame.sun_direction);
    let haze = exp(-7.0 * up);
    var sky = mix(frame.zenith_rgb, frame.horizon_rgb, haze);
    // Forward scattering: a broad glow in the haze and a narrow one about the sun.
    let broad = pow(max(0.5 + 0.5 * towards_sun, 0.0), 6.0);
    let narrow = pow(max(towards_sun, 0.0), 90.0);
    sky += frame.sun_rgb * (0.10 * broad * haze + 0.03 * broad + 0.35 * narrow);
    return sky;
}

// The sky with thin high clouds and the sun.
fn full_sky(direction: vec3f) -> vec3f {
    var sky = clear_sky(direction);
    let up = max(direction.y, 0.02);
    let plane = direction.xz / (up + 0.12) + frame.eye_in_sky;
    let warp = vec2f(value_noise(plane * 1.3 + 7.0), value_noise(plane * 1.3 + 31.0));
    let veil = cloudy_noise(plane * vec2f(1.1, 1.7) + warp * 1.5);
    let amount = smoothstep(0.50, 0.86, veil) * smoothstep(0.0, 0.22, direction.y) * 0.55;
    let towards_sun = max(dot(direction, frame.sun_direction), 0.0);
    let cloud = frame.horizon_rgb * 0.95 + frame.sun_rgb * (0.10 + 0.3 * pow(towards_sun, 12.0));
    sky = mix(sky, cloud, amount);
    // The disc is 0.53 degrees wide: cos(0.265 degrees) = 0.99998930.
    let disc = smoothstep(0.999980, 0.999992, dot(direction, frame.sun_direction));
    return sky + frame.sun_rgb * 60.0 * disc * (1.0 - amount);
}

// Light from the whole sky and the ground on a white surface with this normal.
fn ambient_light(normal: vec3f) -> vec3f {
    let sky = mix(frame.zenith_rgb, frame.horizon_rgb, 0.28);
    let side = frame.horizon_rgb * 0.3 + frame.zenith_rgb * 0.2 + frame.bounce_rgb * 0.5;
    let up = normal.y;
    return select(mix(side, frame.bounce_rgb, -up), mix(side, sky, up), up > 0.0);
}

// What is left of a surface's light on its way to the eye, and the air's own light.
fn through_air(radiance: vec3f, position_from_eye: vec3f) -> vec3f {
    let distance = length(position_from_eye);
    let direction = position_from_eye / max(distance, 1e-6);
    let lost = 1.0 - exp(-distance * frame.air_per_m);
    let level = normalize(vec3f(direction.x, 0.0, direction.z) + vec3f(0.0, 1e-4, 0.0));
    return mix(radiance, clear_sky(level), lost);
}

// Share of the sun's light that plants leave at a depth in them, from 0 at their tops; and of the sky's.
fn sun_past_plants(depth: f32) -> f32 {
    return exp(-3.6 * depth);
}

fn sky_past_plants(depth: f32) -> f32 {
    return 1.0 - 0.85 * depth;
}
