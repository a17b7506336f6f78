// From scene light to display colours. Host: src/render/tonemap.rs.
//
// The curve is AgX (Troy Sobotka): it bends bright saturated colours towards white instead of
// clipping one channel. Matrices and the polynomial of its contrast curve are Benjamin Wrensch's
// published approximation, with a mild gain of contrast and saturation after it.
#import "shared/screen.wgsl"

struct Tonemap {
    exposure: f32,
    contrast: f32,
    saturation: f32,
    encode_srgb: u32, // 1 where the target's format does not encode by itself
}

@group(0) @binding(0) var<uniform> tonemap: Tonemap;
@group(0) @binding(1) var scene_light: texture_2d<f32>;

const INTO_AGX = mat3x3f(
    0.842479062253094, 0.0423282422610123, 0.0423756549057051,
    0.0784335999999992, 0.878468636469772, 0.0784336,
    0.0792237451477643, 0.0791661274605434, 0.879142973793104,
);
const FROM_AGX = mat3x3f(
    1.19687900512017, -0.0528968517574562, -0.0529716355144438,
    -0.0980208811401368, 1.15190312990417, -0.0980434501171241,
    -0.0990297440797205, -0.0989611768448433, 1.15107367264116,
);
const LEAST_STOP = -12.47393;
const MOST_STOP = 4.026069;

@vertex
fn tonemap_vertex(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
    return vec4f(screen_corner(vertex), 0.0, 1.0);
}

fn contrast_curve(x: vec3f) -> vec3f {
    let x2 = x * x;
    let x4 = x2 * x2;
    return 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2
        + 0.1191 * x - 0.00232;
}

// Scene light to light of the display, linear.
fn film(scene: vec3f) -> vec3f {
    let stops = log2(max(INTO_AGX * scene, vec3f(1e-10)));
    let placed = saturate((stops - LEAST_STOP) / (MOST_STOP - LEAST_STOP));
    var encoded = saturate(contrast_curve(placed));
    encoded = pow(encoded, vec3f(tonemap.contrast));
    let grey = dot(encoded, vec3f(0.2126, 0.7152, 0.0722));
    encoded = max(grey + tonemap.saturation * (encoded - grey), vec3f(0.0));
    return saturate(pow(max(FROM_AGX * encoded, vec3f(0.0)), vec3f(2.2)));
}

fn srgb(linear: vec3f) -> vec3f {
    let low = linear * 12.92;
    let high = 1.055 * pow(linear, vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3f(0.0031308));
}

// A still pattern of plus or minus half a step of 8 bits, against bands in the sky.
fn dither(pixel: vec2u) -> f32 {
    var h = pixel.x * 0x8da6b343u + pixel.y * 0xd8163841u;
    h = (h ^ (h >> 15u)) * 0x2c1b3c6du;
    h = h ^ (h >> 13u);
    return (f32(h & 0xffffu) / 65536.0 - 0.5) / 255.0;
}

@fragment
fn tonemap_fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(at.xy);
    let scene = textureLoad(scene_light, pixel, 0).rgb;
    let shown = film(scene * tonemap.exposure);
    if tonemap.encode_srgb == 0u {
        return vec4f(shown, 1.0);
    }
    return vec4f(srgb(shown) + dither(pixel), 1.0);
}
