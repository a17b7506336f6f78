//! Where each key of a RON text stands.
//!
//! The RON reader knows the place of a syntax error only. To point at a value that is well formed
//! and yet wrong, this scanner walks the same text and remembers a place for every key path, such
//! as `bodies[2].shape.radius_m`. Names of structs and enum variants are no part of a path, and
//! neither is the single unnamed value in a variant: both `Spawn(Body(name: …))` and
//! `Spawn(name: …)` hold `action.name`. The scanner never fails: on broken text it keeps what it
//! has understood so far.

use super::limits::SCENE_DEPTH;

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

#[derive(Debug)]
struct Entry {
    parent: usize,
    segment: Segment,
    /// Bytes of the value, from its first to behind its last.
    value: [usize; 2],
    /// First byte of the key, or of the value where there is no key.
    start: usize,
    /// True for anything in brackets.
    is_group: bool,
}

#[derive(Debug, PartialEq)]
enum Segment {
    /// Adds nothing to the path: the root, and the single value in a variant.
    Nothing,
    /// Bytes of a field's name.
    Field([usize; 2]),
    Index(usize),
    /// Bytes of a map's key.
    MapKey([usize; 2]),
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
        let mut scanner = Scanner {
            source,
            at: 0,
            entries: Vec::new(),
        };
        scanner.attributes();
        scanner.skip_space();
        scanner.value(0, Segment::Nothing, scanner.at, 0);
        Self {
            source,
            entries: scanner.entries,
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

struct Scanner<'a> {
    source: &'a str,
    at: usize,
    entries: Vec<Entry>,
}

impl Scanner<'_> {
    fn rest(&self) -> &str {
        &self.source[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn bump(&mut self) {
        self.at += self.peek().map_or(0, char::len_utf8);
    }

    fn eat(&mut self, text: &str) -> bool {
        let hit = self.rest().starts_with(text);
        if hit {
            self.at += text.len();
        }
        hit
    }

    /// Skips white space and comments; block comments nest.
    fn skip_space(&mut self) {
        loop {
            let rest = self.rest();
            self.at += rest.len() - rest.trim_start().len();
            if self.rest().starts_with("//") {
                self.at += self.rest().find('\n').unwrap_or(self.rest().len());
            } else if self.eat("/*") {
                self.end_comment();
            } else {
                return;
            }
        }
    }

    fn end_comment(&mut self) {
        let mut depth = 1;
        while depth > 0 && self.peek().is_some() {
            if self.eat("/*") {
                depth += 1;
            } else if self.eat("*/") {
                depth -= 1;
            } else {
                self.bump();
            }
        }
    }

    /// `#![enable(…)]` lines before the value.
    fn attributes(&mut self) {
        loop {
            self.skip_space();
            if !self.rest().starts_with("#!") {
                return;
            }
            self.at += self.rest().find(']').map_or(self.rest().len(), |i| i + 1);
        }
    }

    fn word(&mut self) -> [usize; 2] {
        let from = self.at;
        let in_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '+' | '-' | '.' | '#');
        while self.peek().is_some_and(in_word) {
            self.bump();
        }
        [from, self.at]
    }

    /// Reads a string, raw or not, or a character; false where none begins here.
    fn quoted(&mut self) -> bool {
        let prefix = self.rest().trim_start_matches('b');
        let bytes_before = self.rest().len() - prefix.len();
        let hashes = prefix.strip_prefix('r').map(|raw| {
            let after = raw.trim_start_matches('#');
            (raw.len() - after.len(), after.starts_with('"'))
        });
        if bytes_before > 1 {
            return false;
        }
        if let Some((count, true)) = hashes {
            self.at += bytes_before + 1 + count + 1;
            let end = format!("\"{}", "#".repeat(count));
            self.at += self
                .rest()
                .find(&end)
                .map_or(self.rest().len(), |i| i + end.len());
            return true;
        }
        let Some(quote) = prefix.chars().next().filter(|c| matches!(c, '"' | '\'')) else {
            return false;
        };
        self.at += bytes_before + 1;
        while let Some(c) = self.peek() {
            self.bump();
            if c == '\\' {
                self.bump();
            } else if c == quote {
                break;
            }
        }
        true
    }

    fn value(&mut self, parent: usize, segment: Segment, start: usize, depth: usize) {
        let index = self.entries.len();
        self.entries.push(Entry {
            parent,
            segment,
            value: [self.at, self.source.len()],
            start,
            is_group: false,
        });
        if !self.quoted() {
            let [from, to] = self.word();
            let word_end = self.at;
            self.skip_space();
            match self.peek() {
                Some('(') => self.group(index, ')', from < to, depth),
                Some('[') if from == to => self.group(index, ']', false, depth),
                Some('{') if from == to => self.group(index, '}', false, depth),
                _ => self.at = word_end,
            }
        }
        self.entries[index].value[1] = self.at;
    }

    fn group(&mut self, owner: usize, close: char, named: bool, depth: usize) {
        self.bump();
        self.entries[owner].is_group = true;
        let mut elements = 0;
        let mut single = None;
        loop {
            self.skip_space();
            match self.peek() {
                None => break,
                Some(c) if c == close => {
                    self.bump();
                    break;
                }
                // Not ours: an opening bracket was left open, and this closes one further out.
                Some(')' | ']' | '}') => break,
                Some(_) => {}
            }
            let from = self.at;
            if depth < SCENE_DEPTH {
                let segment = self.key(close, elements);
                let unnamed = matches!(segment, Segment::Index(_));
                single = (unnamed && elements == 0).then_some(self.entries.len());
                self.value(owner, segment, from, depth + 1);
                elements += 1;
            }
            self.skip_space();
            if !self.eat(",") && self.at == from {
                self.bump();
            }
        }
        if let (true, Some(i)) = (named, single) {
            self.entries[i].segment = Segment::Nothing;
        }
    }

    /// Reads a field's name or a map's key with its colon, if there is one here.
    fn key(&mut self, close: char, elements: usize) -> Segment {
        let from = self.at;
        let name = match close {
            ')' => Some(self.word()),
            '}' => {
                if !self.quoted() {
                    self.word();
                }
                Some([from, self.at])
            }
            _ => None,
        };
        if let Some(name) = name.filter(|[from, to]| from < to) {
            self.skip_space();
            if self.eat(":") {
                self.skip_space();
                return if close == ')' {
                    Segment::Field(name)
                } else {
                    Segment::MapKey(name)
                };
            }
        }
        self.at = from;
        Segment::Index(elements)
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

    #[test]
    fn comments_and_strings_hide_brackets() {
        let source = "/* ( /* nested ( */ */ ( // )\n a: \"x) \\\" , b: 9\", /* , */ b: 2)";
        assert_eq!(at(source, "a"), (2, 5));
        assert_eq!(at(source, "b"), (2, 32));
        let raw = "(a: r#\"quote \" and ) \"#, b: r\"\\\", c: ')', d: b\"(\", e: 5)";
        assert_eq!(at(raw, "b"), (1, 29));
        assert_eq!(at(raw, "c"), (1, 37));
        assert_eq!(at(raw, "e"), (1, 53));
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
