//! Sine and cosine of an angle in turns, as polynomials of our own: the same on every platform.
//!
//! Whatever enters the state must not depend on a platform's maths library. The polynomial is the
//! Taylor series of sin(πx/2) up to x¹⁵ on a quarter turn, where its first omitted term is below
//! 6.1e-12; in `f32` rounding dominates, within 2.5e-7 absolute. WGSL twin:
//! `shaders/shared/trig.wgsl`.

use std::f64::consts::FRAC_PI_2;

use super::Real;

/// Coefficients of x, x³, … x¹⁵ of sin(πx/2).
pub const SINE_QUARTER: [f64; 8] = {
    let h = FRAC_PI_2;
    let h2 = h * h;
    let c3 = -h * h2 / 6.0;
    let c5 = -c3 * h2 / 20.0;
    let c7 = -c5 * h2 / 42.0;
    let c9 = -c7 * h2 / 72.0;
    let c11 = -c9 * h2 / 110.0;
    let c13 = -c11 * h2 / 156.0;
    let c15 = -c13 * h2 / 210.0;
    [h, c3, c5, c7, c9, c11, c13, c15]
};

/// sin(2π·`turns`). Exactly 0 at whole turns.
pub fn sin_turns<R: Real>(turns: R) -> R {
    let f = turns - turns.floor();
    // Quarters 0…4; fold onto -1…1, on which the sine of a quarter turn is odd and monotone.
    let q = f * R::of(4.0);
    let x = if q < R::ONE {
        q
    } else if q < R::of(3.0) {
        R::of(2.0) - q
    } else {
        q - R::of(4.0)
    };
    let x2 = x * x;
    let mut sum = R::of(SINE_QUARTER[7]);
    for c in SINE_QUARTER[..7].iter().rev() {
        sum = sum * x2 + R::of(*c);
    }
    sum * x
}

/// cos(2π·`turns`).
pub fn cos_turns<R: Real>(turns: R) -> R {
    sin_turns(turns + R::of(0.25))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_library() {
        for i in -2000..=2000 {
            let t = f64::from(i) * 0.00217;
            let want = (t * std::f64::consts::TAU).sin();
            assert!((sin_turns(t) - want).abs() < 1e-11, "{t}");
            // Turns up to 4.4 in f32 are off by 2^-22 turn, 1.5e-6 rad; the series adds 2.5e-7.
            assert!((f64::from(sin_turns(t as f32)) - want).abs() < 2e-6, "{t}");
        }
        assert_eq!(sin_turns(3.0_f32), 0.0);
        assert_eq!(cos_turns(0.0_f32), sin_turns(0.25_f32));
    }
}
