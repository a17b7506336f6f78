//! What is wrong with a scene, and where.

use std::fmt::{self, Display, Formatter};

use super::positions::{Position, Positions};

/// A scene that cannot be used. Prints as `file:line:column: key: what is wrong`, or as
/// `file: what is wrong` where no text was read.
#[derive(Debug, thiserror::Error)]
pub struct SceneError {
    /// The scene file as it was asked for, or the name of a scene that has no file.
    pub file: String,
    /// Counts from 1; 0 for an error about the file as a whole.
    pub line: u32,
    /// Counts from 1, in characters; 0 for an error about the file as a whole.
    pub column: u32,
    /// Path of the key, such as `bodies[2].shape.radius_m`; `scene` for the scene as a whole.
    pub key: String,
    pub problem: Problem,
}

/// What is wrong at a key.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    #[error("the file cannot be read: {0}")]
    Unreadable(std::io::Error),
    #[error("the file has {bytes} bytes, more than the limit of {limit}")]
    TooLarge { bytes: u64, limit: u64 },
    #[error("the file is no UTF-8 text; save it as UTF-8")]
    NotText,
    /// The text is no RON, or not of the shape of a scene.
    #[error("{0}")]
    Syntax(String),
    /// A value is out of its limits or does not fit the others.
    #[error("{0}")]
    Value(String),
    #[error(transparent)]
    Asset(#[from] AssetError),
}

/// A mesh or height map that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AssetError {
    #[error(
        "`{file}` is in none of the folders looked in ({folders}); put it beside the scene or name its folder with --assets"
    )]
    NotFound { file: String, folders: String },
    #[error(
        "`{file}` would leave the scene's folder and the asset folders; give a relative path that stays inside, without `..` and links that lead out"
    )]
    Outside { file: String },
    #[error("`{file}` cannot be read: {reason}")]
    Unreadable { file: String, reason: String },
    #[error("`{file}` has {bytes} bytes, more than the limit of {limit} for an asset")]
    TooLarge {
        file: String,
        bytes: u64,
        limit: u64,
    },
    #[error("`{file}` is {found}; {wanted} is needed")]
    Format {
        file: String,
        found: String,
        wanted: &'static str,
    },
    #[error("`{file}` is damaged: {reason}")]
    Damaged { file: String, reason: String },
    #[error("`{file}` has {count} {what}, more than the limit of {limit}")]
    OverBudget {
        file: String,
        count: u64,
        what: &'static str,
        limit: u64,
    },
    #[error(
        "`{file}` has a direction of length {length:.3} in texel ({column}, {row}), shorter than the \
         limit of {limit}; give that texel a colour farther from mid grey"
    )]
    NoDirection {
        file: String,
        column: u32,
        row: u32,
        length: f64,
        limit: f64,
    },
    #[error(
        "`{file}` has a direction that rises by {rise:.3} in texel ({column}, {row}), but clumps grow \
         upwards, so it must be more than 0; give that texel a green of 128 or more"
    )]
    DirectionDown {
        file: String,
        column: u32,
        row: u32,
        rise: f64,
    },
    #[error("`{file}` holds no solid: {reason}")]
    NoSolid { file: String, reason: String },
}

impl Display for SceneError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self {
            file,
            line,
            column,
            key,
            problem,
        } = self;
        match line {
            0 => write!(f, "{file}: {problem}"),
            _ => write!(f, "{file}:{line}:{column}: {key}: {problem}"),
        }
    }
}

impl SceneError {
    pub(super) fn new(file: &str, position: Position, key: &str, problem: Problem) -> Self {
        Self {
            file: file.to_owned(),
            line: position.line,
            column: position.column,
            key: if key.is_empty() { "scene" } else { key }.to_owned(),
            problem,
        }
    }

    /// An error about the value of a key in a text of the scene language.
    pub fn at_key(file: &str, source: &str, key: &str, what: String) -> Self {
        let position = Positions::scan(source).of_key(key);
        Self::new(file, position, key, Problem::Value(what))
    }

    /// An error about a file or folder as a whole.
    pub fn whole(file: &str, problem: Problem) -> Self {
        Self::new(file, Position { line: 0, column: 0 }, "", problem)
    }
}
