//! Logarithms and powers of two in integers: the same bits on every machine and device.
//!
//! Both are tables of 64 intervals with linear interpolation between them. WGSL twin:
//! `shaders/shared/fixed.wgsl`.

/// Intervals of both tables.
const INTERVALS: usize = 64;

/// log₂(1 + i/64) in units of 2⁻¹⁶.
pub const LOG2_TABLE: [u32; INTERVALS + 1] = {
    let mut table = [0; INTERVALS + 1];
    let mut i = 0;
    while i <= INTERVALS {
        table[i] = log2_of((INTERVALS + i) as f64 / INTERVALS as f64);
        i += 1;
    }
    table
};

/// 2^(−i/64) in units of 2⁻¹⁵.
pub const EXP2_TABLE: [u32; INTERVALS + 1] = {
    // 2^(−1/64), correctly rounded; 64 products of it are off by less than 2⁻⁴⁵.
    const STEP: f64 = 0.989_228_013_193_975_5;
    let mut table = [0; INTERVALS + 1];
    let mut power = 32_768.0;
    let mut i = 0;
    while i <= INTERVALS {
        table[i] = (power + 0.5) as u32;
        power *= STEP;
        i += 1;
    }
    table
};

/// log₂ of 1…2 in units of 2⁻¹⁶, rounded: squaring shifts one binary digit of it to the front.
const fn log2_of(mut x: f64) -> u32 {
    let mut log = 0;
    let mut digit = 0;
    while digit < 18 {
        x *= x;
        log <<= 1;
        if x >= 2.0 {
            x *= 0.5;
            log += 1;
        }
        digit += 1;
    }
    if x >= 2.0 { 1 << 16 } else { (log + 2) >> 2 }
}

/// log₂ of a whole number from 1, in units of 2⁻¹²; within 2⁻¹² of the true value.
pub fn log2_q12(x: u32) -> i32 {
    let whole = 31 - x.max(1).leading_zeros();
    // The digits after the leading one, 16 of them.
    let digits = ((u64::from(x.max(1)) << 16) >> whole) as u32 & 0xffff;
    let (i, rest) = ((digits >> 10) as usize, digits & 1023);
    let low = LOG2_TABLE[i];
    let between = low + (((LOG2_TABLE[i + 1] - low) * rest) >> 10);
    ((whole << 12) + (between >> 4)) as i32
}

/// 2^(−x) in units of 2⁻¹⁵, for x from 0 in units of 2⁻¹²; within 2⁻¹⁴ of the true value.
pub fn exp2_minus_q15(x: u32) -> u32 {
    let (whole, part) = (x >> 12, x & 4095);
    if whole > 15 {
        return 0;
    }
    let (i, rest) = ((part >> 6) as usize, part & 63);
    let high = EXP2_TABLE[i];
    (high - (((high - EXP2_TABLE[i + 1]) * rest) >> 6)) >> whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms() {
        // Linear interpolation is off by (1/64)²/8/ln 2 = 0.18 units at most; cutting off, by one.
        for x in (1..5000_u32).chain((0..1000).map(|k| 5_000 + k * 4_290_001)) {
            let want = f64::from(x).log2() * 4096.0;
            let got = f64::from(log2_q12(x));
            assert!((got - want).abs() <= 1.25, "{x}: {got} for {want}");
        }
        assert_eq!(
            [log2_q12(1), log2_q12(2), log2_q12(1 << 31)],
            [0, 4096, 31 << 12]
        );
    }

    #[test]
    fn powers() {
        for x in 0..100_000_u32 {
            let want = (-f64::from(x) / 4096.0).exp2() * 32_768.0;
            let got = f64::from(exp2_minus_q15(x));
            // Rounding of the table, cutting off the interpolation and the shift.
            assert!((got - want).abs() <= 2.0, "{x}: {got} for {want}");
        }
        assert_eq!([exp2_minus_q15(0), exp2_minus_q15(4096)], [32_768, 16_384]);
        assert_eq!(exp2_minus_q15(u32::MAX), 0);
    }
}
