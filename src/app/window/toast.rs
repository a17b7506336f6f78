//! Short messages at the lower edge of the window.

use std::collections::VecDeque;
use std::fmt::Display;
use std::time::{Duration, Instant};

/// How long a message stays.
const NEWS_S: u64 = 3;
const ERROR_S: u64 = 10;
/// Messages shown at once; older ones go first. Errors are on stderr as well.
const MOST: usize = 4;

/// A message with its end.
#[derive(Clone, Debug)]
pub struct Toast {
    pub text: String,
    pub is_error: bool,
    until: Instant,
}

/// The messages of now.
#[derive(Debug, Default)]
pub struct Toasts {
    shown: VecDeque<Toast>,
}

impl Toasts {
    pub fn news(&mut self, text: impl Into<String>) {
        self.push(text.into(), false, NEWS_S);
    }

    /// Shows an error, and writes it to the log.
    pub fn error(&mut self, error: impl Display) {
        let text = error.to_string();
        log::error!("{text}");
        self.push(text, true, ERROR_S);
    }

    /// The messages whose time is not over, oldest first.
    pub fn current(&mut self) -> impl Iterator<Item = &Toast> {
        let now = Instant::now();
        self.shown.retain(|toast| toast.until > now);
        self.shown.iter()
    }

    fn push(&mut self, text: String, is_error: bool, seconds: u64) {
        self.shown.retain(|toast| toast.text != text);
        if self.shown.len() == MOST {
            self.shown.pop_front();
        }
        self.shown.push_back(Toast {
            text,
            is_error,
            until: Instant::now() + Duration::from_secs(seconds),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repeated_message_is_shown_once_and_old_ones_give_way() {
        let mut toasts = Toasts::default();
        for text in ["a", "b", "a", "c", "d", "e"] {
            toasts.news(text);
        }
        let texts: Vec<_> = toasts.current().map(|toast| toast.text.as_str()).collect();
        assert_eq!(texts, ["a", "c", "d", "e"]);
    }
}
