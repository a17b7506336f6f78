//! Values of options: what a wrong one is told.

/// A number, for options whose limits the command itself checks and tells.
///
/// # Errors
///
/// A text that is no number.
pub fn number(text: &str) -> Result<f64, String> {
    let parsed = text.parse();
    parsed.map_err(|_| "give a number, such as 60 or 0.5".to_owned())
}

/// A whole number from `least` to `most`.
///
/// # Errors
///
/// A text that is none, with the limits.
pub fn whole(text: &str, least: u32, most: u32) -> Result<u32, String> {
    let parsed = text.parse().ok();
    let within = parsed.filter(|value| (least..=most).contains(value));
    within.ok_or_else(|| format!("give a whole number from {least} to {most}"))
}

/// Least and largest factor of the number of plants drawn.
pub const DENSITIES: [f32; 2] = [0.1, 4.0];

/// A factor of the number of plants drawn.
///
/// # Errors
///
/// A text that is none, with the limits.
pub fn density(text: &str) -> Result<f32, String> {
    let [least, most] = DENSITIES;
    let parsed = text.parse().ok();
    let within = parsed.filter(|factor| (least..=most).contains(factor));
    within.ok_or_else(|| format!("give a factor from {least} to {most}, such as 0.5"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn densities_have_limits() {
        assert_eq!((density("0.1"), density("4")), (Ok(0.1), Ok(4.0)));
        for wrong in ["0", "0.09", "4.1", "NaN", "inf", "-1", "thick", ""] {
            let told = density(wrong).expect_err(wrong);
            assert!(told.contains("0.1 to 4"), "{told}");
        }
    }

    #[test]
    fn limits_are_allowed_and_told() {
        assert_eq!((whole("1", 1, 64), whole("64", 1, 64)), (Ok(1), Ok(64)));
        for wrong in ["0", "65", "-3", "99999999999", "3.5", "abc", ""] {
            let told = whole(wrong, 1, 64).expect_err(wrong);
            assert!(told.contains("from 1 to 64"), "{told}");
        }
        assert_eq!(number("0.5"), Ok(0.5));
        assert!(number("half").is_err());
    }
}
