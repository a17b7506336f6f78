//! a of a pass, from κΔt.
//!
//! Two forms stay below ½ and do not depend on how time is cut, for a single spring: the rational
//! κΔt/(1 + 2κΔt), XPBD's first-order one, to first order in κΔt, and the exponential
//! ½(1 − e^(−2κΔt)) exactly. Poses after a second at 15 to 240 Hz differ (measured, nodes shaken by
//! 20 mm, κ = 3 … 300 /s) on a blade of 8 by 6.4 mm to 0.06 µm with the rational and by less than
//! 0.06 µm with the exponential form; on billboards by 0.4 to 8 mm with either, because the order
//! of a sweep weighs as much. Neither raised the energy. The rational one is the default: the
//! sub-step's length is fixed, and it needs no exponential on the GPU.

/// Share of the bound of the linear stability that the literal method may take.
pub const BOUND_SHARE: f64 = 0.9;

/// A step and whether the bound cut it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounded {
    pub step: f64,
    pub clamped: bool,
}

/// κΔt/(1 + 2κΔt).
pub fn rational(rate_step: f64) -> f64 {
    let x = at_least_zero(rate_step);
    // The same number as x/(1 + 2x), without ∞/∞ for the largest floats.
    if x > 1.0 {
        1.0 / (1.0 / x + 2.0)
    } else {
        x / (1.0 + 2.0 * x)
    }
}

/// ½(1 − e^(−2κΔt)).
pub fn exponential(rate_step: f64) -> f64 {
    -0.5 * libm::expm1(-2.0 * at_least_zero(rate_step))
}

/// min(κΔt/2, 0.9/λmax).
pub fn literal(rate_step: f64, largest_eigenvalue: f64) -> Bounded {
    let asked = 0.5 * at_least_zero(rate_step);
    let bound = if largest_eigenvalue > 0.0 {
        BOUND_SHARE / largest_eigenvalue
    } else {
        0.0
    };
    Bounded {
        step: asked.min(bound),
        clamped: asked > bound,
    }
}

fn at_least_zero(rate_step: f64) -> f64 {
    // `max` returns the number where the other is not one.
    rate_step.max(0.0)
}
