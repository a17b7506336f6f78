//! Values of options: what a wrong one is told.

use crate::render::Count;

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

/// Least and most plants per pixel of the rules by area.
const PER_PX: [f32; 2] = [0.001, 100.0];
/// Plants per pixel where none are given.
const USUAL_PER_PX: f32 = 0.5;

/// A rule by which the number of plants drawn is decided.
///
/// # Errors
///
/// A text that is none, with those that there are.
pub fn count(text: &str) -> Result<Count, String> {
    let (rule, per_px) = match text.split_once(',') {
        Some((rule, per_px)) => (rule, per_px.parse().ok()),
        None => (text, Some(USUAL_PER_PX)),
    };
    let [least, most] = PER_PX;
    let per_px = per_px.filter(|per_px| (least..=most).contains(per_px));
    match (rule, per_px) {
        ("distance", _) if text == rule => Ok(Count::Distance),
        ("projected", Some(per_px)) => Ok(Count::ProjectedArea { per_px }),
        ("world", Some(per_px)) => Ok(Count::WorldArea { per_px }),
        _ => Err(format!(
            "give distance, or projected or world, with plants per pixel from {least} to {most} after a comma, \
             such as projected,{USUAL_PER_PX}"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_of_counting_have_names() {
        assert_eq!(count("distance"), Ok(Count::Distance));
        let per_px = USUAL_PER_PX;
        assert_eq!(count("projected"), Ok(Count::ProjectedArea { per_px }));
        assert_eq!(count("world,3"), Ok(Count::WorldArea { per_px: 3.0 }));
        for wrong in [
            "",
            "near",
            "distance,1",
            "projected,",
            "world,0",
            "world,101",
            "world,NaN",
        ] {
            let told = count(wrong).expect_err(wrong);
            assert!(told.contains("0.001 to 100"), "{told}");
        }
    }

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
