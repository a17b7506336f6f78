// A depth cube's texel as two words. Twin: src/sim/depth_cube.rs (pack, pack_normal).
#import "shared/field.wgsl"

fn pack_texel(depth: f32, normal: vec3f, hidden: bool) -> vec2u {
    let steps = u32(clamp(depth, 0.0, 1.0) * DEPTH_STEPS);
    return vec2u(HIT | select(0u, HIDDEN, hidden) | steps, pack_normal(normal));
}

// Depth as a fraction of the face's extent.
fn unpack_depth(word: u32) -> f32 {
    return f32(word & (HIDDEN - 1u)) * (1.0 / DEPTH_STEPS);
}

fn sign_of(v: vec2f) -> vec2f {
    return select(vec2f(1.0), vec2f(-1.0), v < vec2f(0.0));
}

// Octahedral map, 16 bits for each coordinate.
fn pack_normal(n: vec3f) -> u32 {
    let sum = abs(n.x) + abs(n.y) + abs(n.z);
    var on_map = n.xy / sum;
    if n.z < 0.0 {
        on_map = (1.0 - abs(on_map.yx)) * sign_of(on_map);
    }
    let steps = vec2u(clamp(on_map * 0.5 + 0.5, vec2f(0.0), vec2f(1.0)) * 65535.0 + 0.5);
    return steps.x | (steps.y << 16u);
}

fn unpack_normal(word: u32) -> vec3f {
    var on_map = vec2f(f32(word & 0xffffu), f32(word >> 16u)) * (2.0 / 65535.0) - 1.0;
    let z = 1.0 - abs(on_map.x) - abs(on_map.y);
    if z < 0.0 {
        on_map = (1.0 - abs(on_map.yx)) * sign_of(on_map);
    }
    return unit_or(vec3f(on_map, z), UP);
}
