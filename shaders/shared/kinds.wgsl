// Which kind of plant grows on a ground: P15 section 3.3 in integers. Twin: src/field/kinds.rs, bit
// for bit.
#import "shared/field.wgsl"
#import "shared/fixed.wgsl"
#import "shared/on_map.wgsl"

// The base map as it is stored: sRGB bytes.
@group(0) @binding(4) var base_texels: texture_2d<u32>;

// What grows at a place. On bare ground `kind` is `field.species_count` or more.
struct KindChoice {
    kind: u32,
    // s′ of eq. 18 in units of 2⁻¹⁶.
    thrives: u32,
}

// The map's colour at a place in units of 2⁻¹⁶ texel, mixed between texels, in units of 2⁻⁸ of a
// byte's step.
fn map_colour(place: vec2u) -> vec3u {
    let at = between_texels(place, field.map_texels);
    let c00 = textureLoad(base_texels, at.low, 0).rgb;
    let c10 = textureLoad(base_texels, vec2u(at.high.x, at.low.y), 0).rgb;
    let c01 = textureLoad(base_texels, vec2u(at.low.x, at.high.y), 0).rgb;
    let c11 = textureLoad(base_texels, at.high, 0).rgb;
    return mix_texels(at.shares, c00, c10, c01, c11) >> vec3u(8u);
}

fn hue_edge(first: u32, second: u32, spread: u32) -> i32 {
    return (i32(first) - i32(second)) * (1 << 14u) / i32(spread);
}

// Hue in HUE_TURNths of a turn, saturation and value in 0…65536.
fn hsv_of(rgb: vec3u) -> vec3u {
    let most = max(max(rgb.r, rgb.g), rgb.b);
    let spread = most - min(min(rgb.r, rgb.g), rgb.b);
    let value = most + (most >> 8u);
    if spread == 0u {
        return vec3u(0u, 0u, value);
    }
    var hue: i32;
    if most == rgb.r {
        hue = hue_edge(rgb.g, rgb.b, spread);
    } else if most == rgb.g {
        hue = (2 << 14u) + hue_edge(rgb.b, rgb.r, spread);
    } else {
        hue = (4 << 14u) + hue_edge(rgb.r, rgb.g, spread);
    }
    if hue < 0 {
        hue += i32(HUE_TURN);
    }
    return vec3u(u32(hue), (spread << 16u) / most, value);
}

fn apart(a: u32, b: u32) -> u32 {
    return max(a, b) - min(a, b);
}

// log₂ of a score without the share, in units of 2⁻¹².
fn score_log(taste: TasteUniform, hsv: vec3u) -> i32 {
    let hue = apart(hsv.x, taste.hsv.x);
    let differences = vec3u(
        min(hue, HUE_TURN - hue) / 24u,
        apart(hsv.y, taste.hsv.y) >> 4u,
        apart(hsv.z, taste.hsv.z) >> 4u,
    );
    let weighted = (differences * taste.weights) >> vec3u(12u);
    let squares = weighted * weighted;
    let squared = squares.x + squares.y + squares.z;
    let distance_log = log2_q12(max(squared, LEAST_SQUARED)) - (24 << 12u);
    return -((i32(taste.exponent) * distance_log) >> 9u);
}

// What grows at a place of the map, given a random word.
fn choose_kind(place: vec2u, word: u32) -> KindChoice {
    let hsv = hsv_of(map_colour(place));
    let none = i32(0x80000000u);
    var first = KindChoice(MAX_TASTES, 0u);
    var second = MAX_TASTES;
    var first_log = none;
    var second_log = none;
    for (var i = 0u; i < field.taste_count; i++) {
        let taste = field.tastes[i];
        let own = score_log(taste, hsv);
        if own < taste.threshold_log {
            continue;
        }
        let score = own + taste.share_log;
        if score > first_log {
            second = first.kind;
            second_log = first_log;
            first.kind = i;
            first_log = score;
        } else if score > second_log {
            second = i;
            second_log = score;
        }
    }
    var chance = 0u;
    if second != MAX_TASTES {
        let ratio = exp2_minus_q15(u32(first_log - second_log));
        chance = (ratio << 16u) / (32768u + ratio);
    }
    if (word >> 16u) < chance {
        return KindChoice(second, chance);
    }
    return KindChoice(first.kind, 65536u - chance);
}
