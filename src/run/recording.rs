//! A recording: one text file from which a run can be done again, and checked tick by tick.
//!
//! It is written in the scene language (RON), so that a person can read it and numbers keep their
//! bits:
//!
//! ```text
//! (
//!     format: 1,
//!     sward: "0.1.0",
//!     scene: "ball_roll",              name of the scene
//!     hashed: GrassAndBodies,          what the hashes cover: Bodies for the gpu engine
//!     hz: 60.0,
//!     substep_s: None,                 what the run had instead of the scene's
//!     seed: None,
//!     method: None,
//!     assets: [(file: "assets/a.obj", hash: "…16 hexadecimal digits…")],
//!     inputs: [(tick: 57, action: Throw(body: "ball", …))],
//!     ticks: 600,
//!     hashes: ["…8 digits per tick, 32 ticks per line…"],
//!     source: r#"…the scene as it was read…"#,
//! )
//! ```
//!
//! A tick costs 8.3 bytes: 1 kB per simulated second at 1/120 s, 90 MB for a day. Its 8 digits are
//! the lower half of the [state hash](crate::sim::StateHash) after it. As that is chained, a run
//! that has once differed differs for good; one tick in 2^32 hides it until the next.

mod format;
mod record;
mod verify;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::scene::assets::{Folders, InOrder};
use crate::scene::{Action, LoadedScene, SceneError, builtin, read_text};

use super::methods;
use super::scenario::RunOptions;

pub use record::{Recorder, TooLong};
pub use verify::{Difference, Verifier};

/// Rises when a key changes its meaning, comes or goes.
pub const FORMAT: u32 = 1;
/// Most ticks of a recording: 38 hours at 1/120 s.
pub const MOST_TICKS: u32 = 1 << 24;
/// Most bytes of a recording: its ticks, and as much again as the largest scene and its inputs.
pub const MOST_BYTES: u64 = 192 << 20;

/// Something that was done to a running scene from outside of its script.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Sub-steps that were done before it.
    pub tick: u32,
    pub action: Action,
}

/// What the hashes of a recording cover.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
pub enum Hashed {
    /// The whole state of the cpu engine.
    GrassAndBodies,
    /// The bodies alone: the grass's engine promised no bits.
    #[default]
    Bodies,
}

/// A recorded run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Version of the sward that recorded it.
    pub sward: String,
    /// Name of the scene.
    pub scene: String,
    /// The scene's text.
    pub source: String,
    /// A hash of the bytes of each file that the scene has read, by the path it gives.
    pub assets: BTreeMap<String, u64>,
    pub hz: f64,
    /// What the run had instead of the scene's.
    pub substep_s: Option<f64>,
    pub seed: Option<u32>,
    /// Name of a method of [`super::methods`].
    pub method: Option<String>,
    pub hashed: Hashed,
    /// In the order of their ticks.
    pub inputs: Vec<Input>,
    /// Lower half of the state hash after each tick.
    pub hashes: Vec<u32>,
}

impl Recording {
    /// Reads a recording and its scene. Assets are looked up beside the recording, then in
    /// `asset_dirs`, then among the program's own.
    ///
    /// # Errors
    ///
    /// A file that is no recording, with line, column and key; an asset that is gone or has other
    /// bytes than the recorded run's.
    pub fn read(path: &Path, asset_dirs: &[PathBuf]) -> Result<(Self, LoadedScene), SceneError> {
        let text = read_text(path, MOST_BYTES)?;
        let own_folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
            _ => PathBuf::from("."),
        };
        let folders = Folders::new(std::iter::once(own_folder).chain(asset_dirs.iter().cloned()));
        let assets = InOrder(&folders, &builtin::ASSETS);
        format::parse(&path.display().to_string(), &text, &assets)
    }

    /// The text of its file.
    ///
    /// # Errors
    ///
    /// None is known; the writer's own are passed on.
    pub fn to_text(&self) -> Result<String, ron::Error> {
        format::write(self)
    }

    /// How to run it again.
    pub fn options(&self) -> RunOptions {
        RunOptions {
            hz: self.hz,
            substep_s: self.substep_s,
            seed: self.seed,
            method: self.method.as_deref().and_then(methods::method),
            against_reference: false,
            ticks: Some(self.hashes.len() as u32),
            inputs: self.inputs.clone(),
        }
    }
}
