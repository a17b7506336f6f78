// The sky behind everything. Host: src/render/sky.rs.
#import "shared/light.wgsl"
#import "shared/screen.wgsl"

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) ndc: vec2f,
}

@vertex
fn sky_vertex(@builtin(vertex_index) vertex: u32) -> Corner {
    let ndc = screen_corner(vertex);
    // Depth 0 is infinitely far away.
    return Corner(vec4f(ndc, 0.0, 1.0), ndc);
}

@fragment
fn sky_fragment(corner: Corner) -> @location(0) vec4f {
    let place = frame.eye_from_clip * vec4f(corner.ndc, 1.0, 1.0);
    let direction = normalize(place.xyz / place.w);
    return vec4f(full_sky(direction), 1.0);
}
