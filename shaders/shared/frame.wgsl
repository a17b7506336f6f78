// What every layer of a picture reads. Rust twin: src/render/view_group.rs.
// Positions "from eye" have the world's axes and the eye as origin.

struct Frame {
    clip_from_eye: mat4x4f,
    eye_from_clip: mat4x4f,
    shadow_from_eye: mat4x4f,
    sun_direction: vec3f, // towards the sun, of unit length
    time_s: f32,
    sun_rgb: vec3f, // radiance of a white surface that faces the sun, over that of exposure 1
    air_per_m: f32, // share of a view ray's light lost to the air, per metre
    zenith_rgb: vec3f,
    pixel_rad: f32, // angle of a pixel
    horizon_rgb: vec3f,
    shadow_texel_m: f32,
    bounce_rgb: vec3f, // light that the ground throws up
    blade_reach_m: f32, // blades are drawn up to this distance
    eye_in_sky: vec2f, // slow drift of the sky's haze
    blade_full_m: f32, // every blade is drawn up to this distance
    pad_a: f32,
    viewport_px: vec2f,
    pad_b: vec2f,
    judge_from_eye: vec3f, // distances from here decide how many blades are drawn
    pad_c: f32,
}

@group(1) @binding(0) var<uniform> frame: Frame;
