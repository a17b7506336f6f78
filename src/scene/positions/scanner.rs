//! Walks a RON text and notes where each value stands.

use crate::scene::limits::SCENE_DEPTH;

#[derive(Debug)]
pub(super) struct Entry {
    pub parent: usize,
    pub segment: Segment,
    /// Bytes of the value, from its first to behind its last.
    pub value: [usize; 2],
    /// First byte of the key, or of the value where there is no key.
    pub start: usize,
    /// True for anything in brackets.
    pub is_group: bool,
}

#[derive(Debug, PartialEq)]
pub(super) enum Segment {
    /// Adds nothing to the path: the root, and the single value in a variant.
    Nothing,
    /// Bytes of a field's name.
    Field([usize; 2]),
    Index(usize),
    /// Bytes of a map's key.
    MapKey([usize; 2]),
}

/// Every value of a text, well formed or not, in the order of their starts.
pub(super) fn scan(source: &str) -> Vec<Entry> {
    let mut scanner = Scanner {
        source,
        at: 0,
        entries: Vec::new(),
    };
    scanner.attributes();
    scanner.skip_space();
    scanner.value(0, Segment::Nothing, scanner.at, 0);
    scanner.entries
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
