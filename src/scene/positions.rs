//! Where each key of a RON text stands.
//!
//! The RON reader knows the place of a syntax error only. To point at a value that is well formed
//! and yet wrong, this scanner walks the same text and remembers a place for every key path, such
//! as `bodies[2].shape.radius_m`. Names of structs and enum variants are no part of a path, and
//! neither is the single unnamed value in a variant: both `Spawn(Body(name: …))` and
//! `Spawn(name: …)` hold `action.name`. The scanner never fails: on broken text it keeps what it
//! has understood so far.

mod scanner;

use scanner::{Entry, Segment, scan};

/// A place in a text; both numbers count from 1, the column in characters.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub struct Position {
    pub line: u32,
    pub column: u32,
}

/// The places of a text's keys.
#[derive(Debug)]
pub struct Positions<'a> {
    source: &'a str,
    /// In the order of their starts; the first is the whole value.
    entries: Vec<Entry>,
}

/// A value of the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Place<'a> {
    /// Its key path; empty for the whole text.
    pub path: String,
    /// Where the value begins.
    pub position: Position,
    /// The value as written, if it is a single word, number or string.
    pub word: Option<&'a str>,
}

impl<'a> Positions<'a> {
    /// Scans a text, well formed or not.
    pub fn scan(source: &'a str) -> Self {
        Self {
            source,
            entries: scan(source),
        }
    }

    /// Where the value with a key path begins; that of its nearest parent in the text where the
    /// text leaves the key to its default.
    pub fn of_key(&self, path: &str) -> Position {
        let mut wanted = path;
        loop {
            let found = (0..self.entries.len()).find(|&i| self.path(i) == wanted);
            if let Some(entry) = found.and_then(|i| self.entries.get(i)) {
                return self.position(entry.value[0]);
            }
            match wanted.rfind(['.', '[']) {
                Some(end) => wanted = &wanted[..end],
                None if wanted.is_empty() => return Position { line: 1, column: 1 },
                None => wanted = "",
            }
        }
    }

    /// The innermost value around a byte of the text. A key counts as part of its value.
    pub fn around(&self, offset: usize) -> Place<'a> {
        let found = (0..self.entries.len())
            .rev()
            .find(|&i| (self.entries[i].start..=self.entries[i].value[1]).contains(&offset));
        match found {
            Some(i) => self.place(i),
            None => Place {
                path: String::new(),
                position: self.position(0),
                word: None,
            },
        }
    }

    /// The innermost bracketed value around a byte: the struct or list that an unknown key or a
    /// missing one belongs to.
    pub fn group_around(&self, offset: usize) -> Place<'a> {
        let found = (0..self.entries.len()).rev().find(|&i| {
            let entry = &self.entries[i];
            let within = entry.value[0] < offset && offset <= entry.value[1];
            within && entry.is_group
        });
        self.place(found.unwrap_or(0))
    }

    /// Whether a round bracket is closed at a byte.
    pub fn is_closing(&self, offset: usize) -> bool {
        self.source.as_bytes().get(offset) == Some(&b')')
    }

    /// The byte at a line and column, or the text's end.
    pub fn offset(&self, position: Position) -> usize {
        let line_start = self
            .source
            .split_inclusive('\n')
            .take(position.line.saturating_sub(1) as usize)
            .map(str::len)
            .sum::<usize>();
        let line = self.source.get(line_start..).unwrap_or_default();
        line.char_indices()
            .nth(position.column.saturating_sub(1) as usize)
            .map_or(self.source.len(), |(i, _)| line_start + i)
    }

    /// The line and column of a byte.
    pub fn position(&self, offset: usize) -> Position {
        let before = &self.source[..self.source.floor_char_boundary(offset)];
        let line = 1 + before.bytes().filter(|&b| b == b'\n').count();
        let column = 1 + before.chars().rev().take_while(|&c| c != '\n').count();
        Position {
            line: u32::try_from(line).unwrap_or(u32::MAX),
            column: u32::try_from(column).unwrap_or(u32::MAX),
        }
    }

    fn place(&self, index: usize) -> Place<'a> {
        let Some(entry) = self.entries.get(index) else {
            return Place {
                path: String::new(),
                position: Position { line: 1, column: 1 },
                word: None,
            };
        };
        let text = &self.source[entry.value[0]..entry.value[1]];
        Place {
            path: self.path(index),
            position: self.position(entry.value[0]),
            word: (!entry.is_group && !text.is_empty()).then_some(text),
        }
    }

    fn path(&self, index: usize) -> String {
        let mut chain = Vec::new();
        let mut at = index;
        while at != 0 {
            chain.push(at);
            at = self.entries[at].parent;
        }
        let mut path = String::new();
        for i in chain.into_iter().rev() {
            match self.entries[i].segment {
                Segment::Nothing => {}
                Segment::Field([from, to]) => {
                    if !path.is_empty() {
                        path.push('.');
                    }
                    path.push_str(&self.source[from..to]);
                }
                Segment::Index(i) => path.push_str(&format!("[{i}]")),
                Segment::MapKey([from, to]) => {
                    path.push_str(&format!("[{}]", &self.source[from..to]));
                }
            }
        }
        path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(source: &str, path: &str) -> (u32, u32) {
        let p = Positions::scan(source).of_key(path);
        (p.line, p.column)
    }

    #[test]
    fn fields_lists_and_vectors() {
        let source = "(\n  bodies: [\n    (name: \"a\", at: (1, -2.5, 3e-1)),\n    Body(name: \"b\"),\n  ],\n)";
        assert_eq!(at(source, ""), (1, 1));
        assert_eq!(at(source, "bodies"), (2, 11));
        assert_eq!(at(source, "bodies[0].name"), (3, 12));
        assert_eq!(at(source, "bodies[0].at[1]"), (3, 25));
        assert_eq!(at(source, "bodies[1]"), (4, 5));
        assert_eq!(at(source, "bodies[1].name"), (4, 16));
    }

    #[test]
    fn a_default_points_at_its_nearest_parent() {
        let source = "(a: (b: 1),\n c: 2)";
        assert_eq!(at(source, "a.missing.deeper[3]"), (1, 5));
        assert_eq!(at(source, "absent"), (1, 1));
    }

    /// True if the value at `path` begins with `text`.
    fn begins_with(source: &str, path: &str, text: &str) -> bool {
        let positions = Positions::scan(source);
        source[positions.offset(positions.of_key(path))..].starts_with(text)
    }

    #[test]
    fn comments_and_strings_hide_brackets() {
        let source = "/* ( /* nested ( */ */ ( // )\n a: \"x) \\\" , b: 9\", /* , */ b: 2)";
        assert_eq!(at(source, "a"), (2, 5));
        assert!(begins_with(source, "b", "2)"));
        let raw = "(a: r#\"quote \" and ) \"#, b: r\"\\\", c: ')', d: b\"(\", e: 5)";
        for (path, text) in [("b", "r\"\\\","), ("c", "')'"), ("d", "b\"("), ("e", "5)")] {
            assert!(begins_with(raw, path, text), "{path}");
        }
    }

    #[test]
    fn variants_do_not_show_in_paths() {
        let source = "(action: Spawn(name: \"a\", mass: Kilograms(-3), shape: Ball(radius_m: 1)))";
        assert_eq!(at(source, "action"), (1, 10));
        assert_eq!(at(source, "action.mass"), (1, 33));
        assert_eq!(at(source, "action.shape.radius_m"), (1, 70));
        let wrapped = "(action: Spawn((name: \"a\")), limit: Some(7), pair: P(1, 2))";
        assert_eq!(at(wrapped, "action.name"), (1, 23));
        assert_eq!(at(wrapped, "pair[1]"), (1, 57));
        let inside = Positions::scan(wrapped).around(wrapped.find('7').expect("there"));
        assert_eq!((inside.path.as_str(), inside.word), ("limit", Some("7")));
    }

    #[test]
    fn maps_and_attributes() {
        let source = "#![enable(implicit_some)]\n(m: {\"k (\": (x: 1), two: [5, 6]})";
        assert_eq!(at(source, "m[\"k (\"].x"), (2, 17));
        assert_eq!(at(source, "m[two][1]"), (2, 30));
    }

    #[test]
    fn columns_count_characters() {
        assert_eq!(at("(a: \"äöü\", b: 1)", "b"), (1, 15));
        let positions = Positions::scan("(a: \"äöü\", b: 1)");
        let b = positions.of_key("b");
        assert_eq!(&positions.source[positions.offset(b)..], "1)");
    }

    #[test]
    fn broken_text_keeps_what_was_understood() {
        for source in [
            "(a: (b: [1, 2",
            "(a: \"never closed",
            "(a: /* open",
            "(a 1 b: 2)",
            "",
            ")",
            "(a: ])",
        ] {
            let positions = Positions::scan(source);
            for offset in 0..=source.len() {
                positions.around(offset);
                positions.group_around(offset);
            }
        }
        let cut = Positions::scan("(a: (b: [1, 2");
        assert_eq!(cut.around(12).path, "a.b[1]");
        assert_eq!(Positions::scan("(a: 1 b: 2)").of_key("b").column, 10);
    }

    #[test]
    fn deep_nesting_ends_quietly() {
        let deep = "(".repeat(100_000);
        assert_eq!(Positions::scan(&deep).of_key("").line, 1);
    }
}
