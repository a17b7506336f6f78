//! Half floats, which textures can mix in hardware.

/// Largest half float.
const MOST: f32 = 65_504.0;
/// Bits of the smallest half float that is normal, 2⁻¹⁴, as an `f32`.
const LEAST_NORMAL: u32 = 0x3880_0000;
/// What an `f32`'s exponent exceeds a half float's by, in its place.
const BIAS: u32 = 0x3800_0000;

/// The nearest half float, ties to even; beyond the largest the largest.
pub(super) fn half_bits(value: f32) -> u16 {
    let bits = value.clamp(-MOST, MOST).to_bits();
    let sign = bits >> 16 & 0x8000;
    let magnitude = bits & 0x7fff_ffff;
    let rounded = if magnitude < LEAST_NORMAL {
        // Below it they are even steps of 2⁻²⁴.
        (f32::from_bits(magnitude) * 16_777_216.0).round_ties_even() as u32
    } else {
        (magnitude + 0x0fff + (magnitude >> 13 & 1) - BIAS) >> 13
    };
    (sign | rounded) as u16
}

/// What a finite half float stands for, exactly.
pub(super) fn of_half_bits(bits: u16) -> f32 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f32::from(bits & 0x3ff));
    match exponent {
        0 => sign * fraction * (-24_f32).exp2(),
        _ => sign * (1.0 + fraction / 1024.0) * ((exponent - 15) as f32).exp2(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_half_float_stays_and_what_lies_between_goes_to_the_nearest() {
        for bits in (0..0x7c00_u16).chain(0x8000..0xfc00) {
            assert_eq!(half_bits(of_half_bits(bits)), bits);
        }
        for bits in 0..0x7bff_u16 {
            let (low, high) = (of_half_bits(bits), of_half_bits(bits + 1));
            let middle = 0.5 * (low + high);
            assert_eq!(half_bits(middle) % 2, 0, "a tie goes to the even one");
            assert_eq!(half_bits(f32::from_bits(middle.to_bits() - 1)), bits);
            assert_eq!(half_bits(f32::from_bits(middle.to_bits() + 1)), bits + 1);
        }
        assert_eq!(half_bits(1e9), 0x7bff);
    }
}
