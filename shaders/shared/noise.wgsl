// Value noise on an integer lattice, for the look of surfaces only: nothing simulated reads it.

fn lattice_word(cell: vec2i) -> u32 {
    var h = bitcast<u32>(cell.x) * 0x8da6b343u + bitcast<u32>(cell.y) * 0xd8163841u;
    h = (h ^ (h >> 15u)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12u)) * 0x297a2d39u;
    return h ^ (h >> 15u);
}

fn lattice(cell: vec2i) -> f32 {
    return f32(lattice_word(cell) >> 8u) * (1.0 / 16777216.0);
}

// Smooth noise in 0..1 with features of unit size.
fn value_noise(p: vec2f) -> f32 {
    let whole = floor(p);
    let cell = vec2i(whole);
    let f = p - whole;
    let s = f * f * (3.0 - 2.0 * f);
    let low = mix(lattice(cell), lattice(cell + vec2i(1, 0)), s.x);
    let high = mix(lattice(cell + vec2i(0, 1)), lattice(cell + vec2i(1, 1)), s.x);
    return mix(low, high, s.y);
}

const OCTAVE_TURN = mat2x2f(0.8, 0.6, -0.6, 0.8);

// Three octaves, in 0..1.
fn cloudy_noise(p: vec2f) -> f32 {
    let q = OCTAVE_TURN * p * 2.03;
    let r = OCTAVE_TURN * q * 2.01;
    return 0.571 * value_noise(p) + 0.286 * value_noise(q) + 0.143 * value_noise(r);
}

// Weight of a detail of the given size where a pixel covers `pixel_m`: gone before it aliases.
fn detail_weight(size_m: f32, pixel_m: f32) -> f32 {
    return 1.0 - smoothstep(0.25, 0.75, pixel_m / size_m);
}
