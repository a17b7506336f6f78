//! Says what is wrong with a text that is no scene, in the words of whoever writes scenes.

use ron::error::{Error, SpannedError};

use super::error::{Problem, SceneError};
use super::positions::{Place, Position, Positions};

/// Turns the RON reader's error into one that names file, place and key.
pub(super) fn explain(file: &str, source: &str, error: &SpannedError) -> SceneError {
    let positions = Positions::scan(source);
    let place_of = |p: ron::error::Position| Position {
        line: u32::try_from(p.line).unwrap_or(u32::MAX),
        column: u32::try_from(p.col).unwrap_or(u32::MAX),
    };
    let (start, end) = (place_of(error.span.start), place_of(error.span.end));
    let offset = positions.offset(start);
    let fail = |position, key: &str, what: String| {
        SceneError::new(file, position, key, Problem::Syntax(what))
    };
    let around = positions.around(offset);
    match &error.code {
        Error::NoSuchStructField {
            expected, found, ..
        } => {
            let group = positions.group_around(offset);
            fail(
                start,
                &join(&group.path, found),
                unknown("key", found, expected),
            )
        }
        Error::MissingStructField { field, .. } => {
            // The reader stands behind the closing bracket; one character back is inside it.
            let inside = positions.offset(end).saturating_sub(1);
            let group = positions.group_around(positions.offset(start).min(inside));
            let what = "is missing and has no default; add it here".to_owned();
            fail(group.position, &join(&group.path, field), what)
        }
        Error::DuplicateStructField { field, .. } => {
            let group = positions.group_around(offset);
            let what = "is given twice; keep one of the two".to_owned();
            fail(start, &join(&group.path, field), what)
        }
        Error::NoSuchEnumVariant {
            expected, found, ..
        } => fail(
            around.position,
            &around.path,
            unknown("choice", found, expected),
        ),
        Error::ExpectedDifferentLength { expected, found } => {
            let group = positions.group_around(offset);
            // The reader says "an array of length 3".
            let wanted = expected.rsplit(' ').next().unwrap_or(expected);
            let what = format!("holds {found} values; write {wanted}");
            fail(group.position, &group.path, what)
        }
        Error::ExpectedMapColon => {
            let group = positions.group_around(offset);
            let key = join(&group.path, around.word.unwrap_or("?"));
            fail(
                end,
                &key,
                "a colon between key and value belongs here".to_owned(),
            )
        }
        Error::TrailingCharacters => {
            let what = "is followed by more text; a file holds one scene in one pair of brackets";
            fail(start, "", what.to_owned())
        }
        code => match expectation(code) {
            Some(wanted) => fail(
                around.position,
                &around.path,
                format!("{}; {wanted}", is(&around)),
            ),
            None => bracket_problem(code, &positions, &around, [start, end], &fail),
        },
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
        Error::InvalidValueForType { expected, .. } => format!("write {expected}"),
        Error::Message(message) => message.clone(),
        _ => return None,
    })
}

/// A comma, bracket or quote that is missing or too many.
fn bracket_problem(
    code: &Error,
    positions: &Positions<'_>,
    around: &Place<'_>,
    [start, end]: [Position; 2],
    fail: &dyn Fn(Position, &str, String) -> SceneError,
) -> SceneError {
    let inside_a_number = around.position < start
        && around
            .word
            .is_some_and(|w| w.starts_with(|c: char| c.is_ascii_digit() || c == '-'));
    let what = match code {
        // The reader took `4` of `4.5` for the whole number it looked for.
        Error::ExpectedComma if inside_a_number => {
            let what = format!("{}; write a whole number", is(around));
            return fail(around.position, &around.path, what);
        }
        Error::ExpectedStructLikeEnd => {
            let group = positions.group_around(positions.offset(start));
            let what = "has more values than it takes; `)` belongs here".to_owned();
            return fail(start, &group.path, what);
        }
        Error::ExpectedComma => "a comma or a closing bracket belongs here",
        Error::ExpectedArrayEnd => "`]` belongs here",
        Error::ExpectedMapEnd => "`}` belongs here",
        Error::ExpectedStringEnd => "the text that begins here has no closing double quote",
        Error::UnclosedBlockComment => "the comment has no closing `*/`",
        Error::ExpectedIdentifier => {
            "the name of a key belongs here; a body or a wind in an action stands in one pair of brackets: Spawn(name: …)"
        }
        Error::Eof => "the text ends in the middle of the scene; close its brackets",
        Error::ExceededRecursionLimit => "brackets are nested too deeply for a scene",
        other => {
            return fail(
                end,
                &around.path,
                format!("this is not valid RON ({other})"),
            );
        }
    };
    let at = if matches!(code, Error::ExpectedStringEnd) {
        start
    } else {
        end
    };
    fail(at, &around.path, what.to_owned())
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

fn unknown(kind: &str, found: &str, expected: &[&str]) -> String {
    let near = expected
        .iter()
        .map(|&e| (edit_distance(found, e), e))
        .min()
        // A third of the letters wrong is a typing error; more is another word.
        .filter(|&(distance, e)| 3 * distance <= e.chars().count().max(3));
    let hint = near.map_or_else(String::new, |(_, e)| format!("did you mean {e}? "));
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
