// Logarithms and powers of two in integers. Twin: src/base/fixed.rs, bit for bit.

// log₂ of a whole number from 1, in units of 2⁻¹².
fn log2_q12(x: u32) -> i32 {
    let whole = 31u - countLeadingZeros(max(x, 1u));
    // The digits after the leading one, 16 of them.
    var digits = max(x, 1u);
    if whole > 16u {
        digits >>= whole - 16u;
    } else {
        digits <<= 16u - whole;
    }
    digits &= 0xffffu;
    let i = digits >> 10u;
    let low = LOG2_TABLE[i];
    let between = low + (((LOG2_TABLE[i + 1u] - low) * (digits & 1023u)) >> 10u);
    return i32((whole << 12u) + (between >> 4u));
}

// 2^(−x) in units of 2⁻¹⁵, for x in units of 2⁻¹².
fn exp2_minus_q15(x: u32) -> u32 {
    let whole = x >> 12u;
    if whole > 15u {
        return 0u;
    }
    let i = (x >> 6u) & 63u;
    let high = EXP2_TABLE[i];
    return (high - (((high - EXP2_TABLE[i + 1u]) * (x & 63u)) >> 6u)) >> whole;
}
