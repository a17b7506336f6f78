//! Numbers of the report in words.

use super::super::{Relative, Row};

/// A ratio of times with the range it is known to.
pub fn times(relative: Option<Relative>) -> String {
    relative.map_or_else(
        || "–".into(),
        |Relative { median, low, high }| format!("{median:.2} ({low:.2} … {high:.2})"),
    )
}

/// Milliseconds per simulated second; a dash where there was no work.
pub fn ms(ms_per_s: Option<f64>) -> String {
    ms_per_s.map_or_else(|| "–".into(), |ms| format!("{ms:.0}"))
}

/// An error in millimetres.
pub fn mm(metres: Option<f64>) -> String {
    metres.map_or_else(|| "–".into(), |m| format!("{:.2}", m * 1e3))
}

/// A point's error, marked where its scene does not judge poses.
pub fn mm_of_limit(row: &Row, floor: &Row) -> String {
    let error = mm(row.rms_m);
    if floor.judges_poses() {
        error
    } else {
        format!("{error} (not judged)")
    }
}

/// A length that may be as small as rounding; empty where it was not measured.
pub fn small_mm(metres: Option<f64>) -> String {
    match metres.map(|m| m * 1e3) {
        None => String::new(),
        Some(0.0) => "0".into(),
        Some(mm) if mm < 0.01 => format!("{mm:.1e}"),
        Some(mm) => format!("{mm:.2}"),
    }
}

/// A share of one.
pub fn share(value: Option<f64>) -> String {
    value.map_or_else(|| "–".into(), |v| format!("{v:.3}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_the_digits_that_matter() {
        assert_eq!(small_mm(Some(3.21e-3)), "3.21");
        assert_eq!(small_mm(Some(4.8e-6)), "4.8e-3");
        assert_eq!([Some(0.0), None].map(small_mm), ["0", ""]);
        let relative = Relative {
            median: 0.5,
            low: 0.456,
            high: 0.6,
        };
        assert_eq!(times(Some(relative)), "0.50 (0.46 … 0.60)");
        assert_eq!([times(None), ms(None), mm(None)], ["–", "–", "–"]);
    }
}
