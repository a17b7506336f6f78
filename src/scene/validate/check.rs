//! The small checks all others are made of.

use std::fmt::Display;

use crate::scene::limits::{NAME_CHARACTERS, Range};

/// A value that breaks a limit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key}: {what}")]
pub struct Invalid {
    /// Path of the key, such as `bodies[2].shape.radius_m`.
    pub key: String,
    /// What the value is and what would be right.
    pub what: String,
}

pub(super) type Check = Result<(), Invalid>;

/// A key path under construction.
#[derive(Clone, Debug)]
pub(super) struct Key(String);

impl Key {
    pub fn root() -> Self {
        Self(String::new())
    }

    pub fn of(path: String) -> Self {
        Self(path)
    }

    pub fn field(&self, name: &str) -> Self {
        let dot = if self.0.is_empty() { "" } else { "." };
        Self(format!("{}{dot}{name}", self.0))
    }

    pub fn nth(&self, index: usize) -> Self {
        Self(format!("{}[{index}]", self.0))
    }

    pub fn fail<T>(self, what: impl Into<String>) -> Result<T, Invalid> {
        Err(Invalid {
            key: self.0,
            what: what.into(),
        })
    }
}

/// A number that a range can hold.
pub(super) trait Number: Copy + Display {
    fn is_within(self, range: &Range) -> bool;
    /// Why the value is no number at all, if it is none.
    fn flaw(self) -> Option<&'static str>;
}

impl Number for f64 {
    fn is_within(self, range: &Range) -> bool {
        (range.min..=range.max).contains(&self)
    }

    fn flaw(self) -> Option<&'static str> {
        match () {
            () if self.is_nan() => Some("NaN, which is no number"),
            () if self.is_infinite() => Some("infinite, or past 1.8e308, the largest 64-bit float"),
            () => None,
        }
    }
}

impl Number for f32 {
    fn is_within(self, range: &Range) -> bool {
        // A limit that the scene writes in decimals rounds the same way here as there.
        (range.min as f32..=range.max as f32).contains(&self)
    }

    fn flaw(self) -> Option<&'static str> {
        match () {
            () if self.is_nan() => Some("NaN, which is no number"),
            () if self.is_infinite() => Some("infinite, or past 3.4e38, the largest 32-bit float"),
            () => None,
        }
    }
}

impl Number for u32 {
    fn is_within(self, range: &Range) -> bool {
        f64::from(self).is_within(range)
    }

    fn flaw(self) -> Option<&'static str> {
        None
    }
}

pub(super) fn within<T: Number>(key: &Key, value: T, range: &Range) -> Check {
    if value.is_within(range) {
        return Ok(());
    }
    let is = value
        .flaw()
        .map_or_else(|| value.to_string(), str::to_owned);
    key.clone().fail(format!("is {is}; write {range}"))
}

/// Every component of a vector.
pub(super) fn within_each<T: Number>(key: &Key, values: &[T], range: &Range) -> Check {
    for (i, &value) in values.iter().enumerate() {
        within(&key.nth(i), value, range)?;
    }
    Ok(())
}

/// A pair of smallest and largest value.
pub(super) fn ordered<T: Number + PartialOrd>(key: &Key, pair: [T; 2], range: &Range) -> Check {
    within_each(key, &pair, range)?;
    let [least, most] = pair;
    if least > most {
        let what = format!("is ({least}, {most}); write the smaller value first");
        return key.clone().fail(what);
    }
    Ok(())
}

pub(super) fn at_most(key: &Key, count: usize, limit: usize, what: &str) -> Check {
    if count <= limit {
        return Ok(());
    }
    key.clone()
        .fail(format!("makes {count} {what}; at most {limit} are allowed"))
}

/// A name that fits a menu and a file name.
pub(super) fn name(key: &Key, name: &str) -> Check {
    let length = name.chars().count();
    if length == 0 || length > NAME_CHARACTERS || name.chars().any(char::is_control) {
        let what = format!(
            "is a name of {length} characters; write 1 to {NAME_CHARACTERS}, all of them printable"
        );
        return key.clone().fail(what);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const RANGE: Range = Range {
        min: 0.1,
        max: 2.0,
        unit: "m",
    };

    #[test]
    fn numbers_at_and_beyond_the_limits() {
        let key = Key::root().field("a").nth(2);
        for good in [0.1_f32, 1.0, 2.0] {
            assert_eq!(within(&key, good, &RANGE), Ok(()));
        }
        let what = |value: f32| {
            within(&key, value, &RANGE)
                .expect_err("outside")
                .to_string()
        };
        assert_eq!(what(-1.0), "a[2]: is -1; write 0.1 to 2 m");
        assert_eq!(
            what(f32::NAN),
            "a[2]: is NaN, which is no number; write 0.1 to 2 m"
        );
        assert!(what(f32::INFINITY).contains("past 3.4e38"));
        assert!(within(&key, f64::NEG_INFINITY, &RANGE).is_err());
        assert!(within(&key, 3_u32, &RANGE).is_err());
    }

    #[test]
    fn pairs_and_names() {
        let key = Key::root().field("pair");
        assert_eq!(ordered(&key, [0.5, 0.5], &RANGE), Ok(()));
        let text = ordered(&key, [2.0, 0.5], &RANGE)
            .expect_err("reversed")
            .to_string();
        assert_eq!(text, "pair: is (2, 0.5); write the smaller value first");
        assert!(name(&key, "a ball").is_ok());
        for bad in ["", "a\nb", &"x".repeat(65)] {
            assert!(name(&key, bad).is_err(), "{bad:?}");
        }
    }
}
