// The sun's shadow map of the bodies. Host: src/render/shadow.rs.
#import "shared/frame.wgsl"

@group(2) @binding(0) var shadow_map: texture_depth_2d;
@group(2) @binding(1) var shadow_sampler: sampler_comparison;

// Share of the sun that reaches a point, 0 in the shadow of a body. The point is first moved off
// its surface by a texel and a half, more where the sun grazes, so that nothing shades itself.
fn sun_reaches(position_from_eye: vec3f, normal: vec3f) -> f32 {
    let facing = clamp(dot(normal, frame.sun_direction), 0.0, 1.0);
    let lift = frame.shadow_texel_m * (0.5 + 1.5 * sqrt(1.0 - facing * facing));
    let lifted = position_from_eye + normal * lift;
    let place = frame.shadow_from_eye * vec4f(lifted, 1.0);
    let uv = place.xy * vec2f(0.5, -0.5) + 0.5;
    if any(uv != saturate(uv)) || place.z >= 1.0 {
        return 1.0;
    }
    let texel = 1.0 / vec2f(textureDimensions(shadow_map));
    var lit = 0.0;
    for (var row = -1; row <= 1; row++) {
        for (var column = -1; column <= 1; column++) {
            let at = uv + vec2f(f32(column), f32(row)) * texel;
            lit += textureSampleCompareLevel(shadow_map, shadow_sampler, at, place.z);
        }
    }
    return lit / 9.0;
}

// One filtered look-up, for vertices of blades.
fn sun_reaches_cheaply(position_from_eye: vec3f) -> f32 {
    let place = frame.shadow_from_eye * vec4f(position_from_eye, 1.0);
    let uv = place.xy * vec2f(0.5, -0.5) + 0.5;
    if any(uv != saturate(uv)) || place.z >= 1.0 {
        return 1.0;
    }
    return textureSampleCompareLevel(shadow_map, shadow_sampler, uv, place.z);
}
