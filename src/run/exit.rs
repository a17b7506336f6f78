//! What a command came to, as the process's exit code.

use std::process::ExitCode;

/// An exit code of the program.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Exit {
    Ok = 0,
    /// An expectation failed, a replay diverged or a limit was exceeded.
    Failed = 1,
    /// The command line makes no sense.
    Usage = 2,
    /// A scene, recording or asset is invalid.
    Invalid = 3,
    /// A needed adapter or feature is missing.
    NoAdapter = 4,
    /// A fault of the program or of the machine under it.
    Internal = 5,
}

impl Exit {
    /// The code of several scenarios together: the first of 5, 3, 4, 1, 0 that occurred.
    pub fn of_all(exits: impl IntoIterator<Item = Self>) -> Self {
        let gravity = |exit: &Self| match exit {
            Self::Ok => 0,
            Self::Failed => 1,
            Self::NoAdapter => 2,
            Self::Invalid => 3,
            Self::Usage => 4,
            Self::Internal => 5,
        };
        exits.into_iter().max_by_key(gravity).unwrap_or(Self::Ok)
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::Exit::{self, Failed, Internal, Invalid, NoAdapter, Ok};

    #[test]
    fn the_gravest_code_wins() {
        assert_eq!(Exit::of_all([]), Ok);
        assert_eq!(Exit::of_all([Ok, Failed, Ok]), Failed);
        assert_eq!(Exit::of_all([Failed, NoAdapter]), NoAdapter);
        assert_eq!(Exit::of_all([NoAdapter, Invalid, Failed]), Invalid);
        assert_eq!(Exit::of_all([Internal, Invalid, NoAdapter]), Internal);
    }

    #[test]
    fn codes_are_those_of_the_contract() {
        assert_eq!(
            [Ok, Failed, Exit::Usage, Invalid, NoAdapter, Internal].map(|e| e as u8),
            [0, 1, 2, 3, 4, 5]
        );
    }
}
