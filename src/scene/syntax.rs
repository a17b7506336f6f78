//! Says what is wrong with a text that is no scene, in the words of whoever writes scenes.

use ron::error::{Error, SpannedError};

use super::error::{Problem, SceneError};
use super::positions::{Place, Position, Positions};

/// Where the RON reader stopped.
struct Stop<'a> {
    positions: Positions<'a>,
    /// The reader's place before and behind what it could not take.
    start: Position,
    end: Position,
    /// The innermost value around the start, and the innermost one in brackets.
    value: Place<'a>,
    group: Place<'a>,
}

/// Place, key and sentence of an error.
type Explanation = (Position, String, String);

/// Turns the RON reader's error into one that names file, place and key.
pub(super) fn explain(file: &str, source: &str, error: &SpannedError) -> SceneError {
    let positions = Positions::scan(source);
    let [start, end] = [error.span.start, error.span.end].map(|p| Position {
        line: u32::try_from(p.line).unwrap_or(u32::MAX),
        column: u32::try_from(p.col).unwrap_or(u32::MAX),
    });
    let offset = positions.offset(start);
    let stop = Stop {
        value: positions.around(offset),
        group: positions.group_around(offset),
        positions,
        start,
        end,
    };
    let (position, key, what) = stop
        .wrong_key(&error.code)
        .or_else(|| stop.wrong_value(&error.code))
        .unwrap_or_else(|| stop.wrong_mark(&error.code));
    SceneError::new(file, position, &key, Problem::Syntax(what))
}

impl Stop<'_> {
    /// A key or variant that is unknown, missing, or there twice.
    fn wrong_key(&self, code: &Error) -> Option<Explanation> {
        let in_group = |field: &str| join(&self.group.path, field);
        Some(match code {
            Error::NoSuchStructField {
                expected, found, ..
            } => (self.start, in_group(found), unknown("key", found, expected)),
            Error::DuplicateStructField { field, .. } => {
                let what = "is given twice; keep one of the two";
                (self.start, in_group(field), what.to_owned())
            }
            Error::MissingStructField { field, .. } => {
                let group = self.ended_group();
                let what = "is missing and has no default; add it here";
                (group.position, join(&group.path, field), what.to_owned())
            }
            Error::NoSuchEnumVariant {
                expected, found, ..
            } => self.at_value(unknown("choice", found, expected)),
            Error::ExpectedMapColon => {
                let key = in_group(self.value.word.unwrap_or("?"));
                (self.end, key, "has no colon before its value".to_owned())
            }
            _ => return None,
        })
    }

    /// The group whose end the reader has found, or stands behind.
    fn ended_group(&self) -> Place<'_> {
        let [start, end] = [self.start, self.end].map(|p| self.positions.offset(p));
        let at = match self.positions.is_closing(end) {
            // Before its bracket; a value that ends right here is within the group.
            true => end + 1,
            false => start.min(end.saturating_sub(1)),
        };
        self.positions.group_around(at)
    }

    /// A value of the wrong type or length.
    fn wrong_value(&self, code: &Error) -> Option<Explanation> {
        let in_a_number = self.value.position < self.start
            && self
                .value
                .word
                .is_some_and(|w| w.starts_with(|c: char| c.is_ascii_digit() || c == '-'));
        Some(match code {
            // The reader took `4` of `4.5` for the whole number it looked for.
            Error::ExpectedComma if in_a_number => {
                self.at_value(format!("{}; write a whole number", is(&self.value)))
            }
            Error::ExpectedDifferentLength { expected, found } => {
                // The reader says "an array of length 3".
                let wanted = expected.rsplit(' ').next().unwrap_or(expected);
                let what = format!("holds {found} values; write {wanted}");
                (self.group.position, self.group.path.clone(), what)
            }
            Error::ExpectedStructLikeEnd => {
                let what = "has more values than it takes; `)` belongs here";
                (self.start, self.group.path.clone(), what.to_owned())
            }
            code => {
                let wanted = expectation(code)?;
                self.at_value(format!("{}; {wanted}", is(&self.value)))
            }
        })
    }

    /// A comma, bracket or quote that is missing or too many.
    fn wrong_mark(&self, code: &Error) -> Explanation {
        let (position, what) = match code {
            Error::TrailingCharacters => {
                let what =
                    "is followed by more text; a file holds one scene in one pair of brackets";
                return (self.start, String::new(), what.to_owned());
            }
            Error::ExpectedStringEnd => (
                self.start,
                "the text that begins here has no closing double quote",
            ),
            Error::ExpectedComma => (self.end, "a comma or a closing bracket belongs here"),
            Error::ExpectedArrayEnd => (self.end, "`]` belongs here"),
            Error::ExpectedMapEnd => (self.end, "`}` belongs here"),
            Error::UnclosedBlockComment => (self.end, "a comment has no closing `*/`"),
            Error::ExpectedIdentifier => (
                self.end,
                "a key belongs here; what an action holds stands in one pair of brackets, as in \
                 Spawn(name: …)",
            ),
            Error::Eof => (
                self.end,
                "the text ends within the scene; close its brackets",
            ),
            Error::ExceededRecursionLimit => (self.end, "brackets are nested too deeply"),
            other => {
                let what = format!("this is no valid RON ({other})");
                return (self.end, self.value.path.clone(), what);
            }
        };
        (position, self.value.path.clone(), what.to_owned())
    }

    fn at_value(&self, what: String) -> Explanation {
        (self.value.position, self.value.path.clone(), what)
    }
}

/// What a value of the wrong type should have been.
fn expectation(code: &Error) -> Option<String> {
    Some(match code {
        Error::ExpectedBoolean => "write true or false".to_owned(),
        Error::ExpectedFloat | Error::FloatUnderscore => "write a number, such as 1.5".to_owned(),
        Error::ExpectedInteger
        | Error::IntegerOutOfBounds
        | Error::InvalidIntegerDigit { .. }
        | Error::UnderscoreAtBeginning => {
            "write a whole number, 0 or more, that fits the key".to_owned()
        }
        Error::ExpectedString => "write text in double quotes".to_owned(),
        Error::ExpectedArray => "write a list in square brackets: [ … ]".to_owned(),
        Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_) => {
            "write it in round brackets: fields as (key: value, …), a vector as (x, y, z)"
                .to_owned()
        }
        Error::ExpectedDifferentStructName { expected, .. } => {
            format!("write {expected}( … ), or only ( … )")
        }
        Error::InvalidIdentifier(_) | Error::SuggestRawIdentifier(_) => {
            "write the name of a choice, as in Even(0.5); scenes/README.md lists them".to_owned()
        }
        Error::InvalidValueForType { expected, .. } => format!("write {expected}"),
        Error::Message(message) => message.clone(),
        _ => return None,
    })
}

fn is(place: &Place<'_>) -> String {
    match place.word {
        // A long text would bury the sentence.
        Some(word) if word.chars().count() <= 40 => format!("is {word}"),
        Some(_) => "is a text".to_owned(),
        None => "has the wrong form".to_owned(),
    }
}

fn join(parent: &str, field: &str) -> String {
    if parent.is_empty() {
        field.to_owned()
    } else {
        format!("{parent}.{field}")
    }
}

/// The word that was probably meant by one that is none of the expected: a third of the letters wrong is a
/// typing error, more is another word.
pub fn probably_meant<'a>(
    found: &str,
    expected: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    let near = expected.into_iter().map(|e| (edit_distance(found, e), e));
    near.min()
        .filter(|&(distance, e)| 3 * distance <= e.chars().count().max(3))
        .map(|(_, e)| e)
}

fn unknown(kind: &str, found: &str, expected: &[&str]) -> String {
    let near = probably_meant(found, expected.iter().copied());
    let hint = near.map_or_else(String::new, |e| format!("did you mean {e}? "));
    format!(
        "`{found}` is no known {kind}; {hint}allowed are {}",
        expected.join(", ")
    )
}

/// Fewest insertions, removals and replacements that turn one word into another (Levenshtein).
fn edit_distance(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    // Keys are short; a longer word is no typing error and would only cost time.
    if from.chars().count() > 64 {
        return usize::MAX / 4;
    }
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (i, a) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &b) in to.iter().enumerate() {
            let replaced = diagonal + usize::from(a != b);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances() {
        assert_eq!(edit_distance("radius", "radius_m"), 2);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("kitten", "sitting"), 3);
    }

    #[test]
    fn only_near_words_are_proposed() {
        assert!(unknown("key", "radius", &["radius_m"]).contains("did you mean radius_m?"));
        assert!(!unknown("key", "colour", &["radius_m"]).contains("did you mean"));
    }
}
