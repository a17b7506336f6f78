// Whether anything within a ball may be in the picture. `reach` is how much farther than its middle a
// ball of radius 1 reaches in clip space, across and up: View::clip_reach in src/render/camera.rs.

fn ball_in_view(clip_from_eye: mat4x4f, reach: vec2f, middle: vec3f, radius: f32) -> bool {
    let clip = clip_from_eye * vec4f(middle, 1.0);
    let far = reach * radius;
    return clip.w > -radius && abs(clip.x) <= clip.w + far.x && abs(clip.y) <= clip.w + far.y;
}
