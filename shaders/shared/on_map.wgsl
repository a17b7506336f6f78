// Where a seed lies on a picture of the whole ground, in integers. Twin: src/field/on_map.rs, bit for
// bit.
#import "shared/philox.wgsl"

// Place on a map of a place in a cell, both in units of 2⁻²⁴ cell, given the place of the anchor's origin
// there in units of 2⁻¹⁶ texel and the texels along a cell in units of 2⁻¹⁸.
fn place_on_map(anchor_on_map: vec2u, step: u32, cell: vec2u, in_cell: vec2u) -> vec2u {
    let in_anchor = ((cell % vec2u(ANCHOR_CELLS)) << vec2u(24u)) + in_cell;
    // The far end of the last cell would carry.
    let local = min(in_anchor, vec2u((ANCHOR_CELLS << 24u) - 1u)) << vec2u(6u);
    return anchor_on_map + vec2u(multiply_high(local.x, step), multiply_high(local.y, step));
}

// The texels around a place of a map in units of 2⁻¹⁶ texel: the low one along both axes and the high one,
// and how far the place lies between them in units of 2⁻⁸. Twin: src/terrain/between_texels.rs.
struct BetweenTexels {
    low: vec2u,
    high: vec2u,
    shares: vec2u,
}

fn between_texels(place: vec2u, size: vec2u) -> BetweenTexels {
    // A texel's value lies in its middle.
    let at = max(place, vec2u(1u << 15u)) - vec2u(1u << 15u);
    let last = size - vec2u(1u);
    let low = min(at >> vec2u(16u), last);
    return BetweenTexels(low, min(low + vec2u(1u), last), (at >> vec2u(8u)) & vec2u(255u));
}

// The mixed value in units of 2⁻¹⁶ of a texel's, of values below 2¹⁶: at low and high x at the low z, then
// at the high z.
fn mix_texels(shares: vec2u, c00: vec3u, c10: vec3u, c01: vec3u, c11: vec3u) -> vec3u {
    let near = c00 * (256u - shares.x) + c10 * shares.x;
    let far = c01 * (256u - shares.x) + c11 * shares.x;
    return near * (256u - shares.y) + far * shares.y;
}
