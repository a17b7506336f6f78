// Philox-2x32 and PCG. Twin: src/base/philox.rs, bit for bit.

const PHILOX_MULTIPLIER = 0xD256D193u;
const PHILOX_WEYL = 0x9E3779B9u;

// Upper word of a product of two words, from four products of halves.
fn multiply_high(a: u32, b: u32) -> u32 {
    let a0 = a & 0xffffu;
    let a1 = a >> 16u;
    let b0 = b & 0xffffu;
    let b1 = b >> 16u;
    let low = a0 * b0;
    let cross = a1 * b0 + (low >> 16u);
    let cross_low = (cross & 0xffffu) + a0 * b1;
    return a1 * b1 + (cross >> 16u) + (cross_low >> 16u);
}

fn philox2x32(counter: vec2u, key: u32, rounds: u32) -> vec2u {
    var c = counter;
    var k = key;
    for (var round = 0u; round < rounds; round++) {
        c = vec2u(multiply_high(PHILOX_MULTIPLIER, c.x) ^ k ^ c.y, PHILOX_MULTIPLIER * c.x);
        k += PHILOX_WEYL;
    }
    return c;
}

// State of a plant's small generator.
fn pcg_from_words(words: vec2u) -> u32 {
    return words.x ^ (words.y * PHILOX_WEYL);
}

fn pcg_next(state: ptr<function, u32>) -> u32 {
    *state = *state * 747796405u + 2891336453u;
    let s = *state;
    let word = ((s >> ((s >> 28u) + 4u)) ^ s) * 277803737u;
    return (word >> 22u) ^ word;
}

// A word as a fraction in [0, 1): its upper 24 bits.
fn unit(word: u32) -> f32 {
    return f32(word >> 8u) * (1.0 / 16777216.0);
}

// A byte of a random word, 0 to 1.
fn byte_of(word: u32, index: u32) -> f32 {
    return f32((word >> (8u * index)) & 0xffu) * (1.0 / 255.0);
}
