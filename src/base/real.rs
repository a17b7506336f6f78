//! The float a kernel is generic over: `f32` for the `cpu` engine, `f64` for `reference`.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// An IEEE float with the operations the kernels use. Only operations that IEEE 754 rounds
/// correctly are here, so that results do not depend on the platform's maths library.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + 'static
{
    const ZERO: Self;
    const ONE: Self;
    /// Distance from 1 to the next float.
    const EPSILON: Self;

    /// Rounds a constant or a stored `f64` to this float.
    fn of(value: f64) -> Self;
    /// Widens a stored `f32`; exact.
    fn of_f32(value: f32) -> Self;
    fn to_f32(self) -> f32;
    fn to_f64(self) -> f64;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    fn floor(self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn is_finite(self) -> bool;

    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
}

macro_rules! real {
    ($float:ty) => {
        impl Real for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = <$float>::EPSILON;

            fn of(value: f64) -> Self {
                value as $float
            }
            fn of_f32(value: f32) -> Self {
                <$float>::from(value)
            }
            fn to_f32(self) -> f32 {
                self as f32
            }
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            fn sqrt(self) -> Self {
                <$float>::sqrt(self)
            }
            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            fn floor(self) -> Self {
                <$float>::floor(self)
            }
            fn min(self, other: Self) -> Self {
                if other < self { other } else { self }
            }
            fn max(self, other: Self) -> Self {
                if other > self { other } else { self }
            }
            fn is_finite(self) -> bool {
                <$float>::is_finite(self)
            }
        }
    };
}

real!(f32);
real!(f64);

// A loop that gathers several extremes with `f64::min` and `f64::max` loses some of them where
// rustc 1.95 (LLVM 22) vectorises it: bounds came out decimetres too small, in some builds and not in
// others. These compare, which the optimiser leaves alone. Loops over floats take them.

/// The smaller of two floats; the first where they cannot be compared.
pub fn least<R: Real>(a: R, b: R) -> R {
    Real::min(a, b)
}

/// The larger of two floats; the first where they cannot be compared.
pub fn most<R: Real>(a: R, b: R) -> R {
    Real::max(a, b)
}

/// A range, widened to hold another one.
pub fn widened<R: Real>([low, high]: [R; 2], other: [R; 2]) -> [R; 2] {
    [least(low, other[0]), most(high, other[1])]
}
