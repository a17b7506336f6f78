//! Scenes as tests of another program.

use std::fmt;
use std::path::Path;

use crate::scene::{LoadedScene, SceneError, load_scene};

use super::judge::Verdict;
use super::scenario::{Device, Outcome, RunError, RunOptions, run_scene};

/// Why a scene is no passed test.
#[derive(thiserror::Error)]
pub enum CheckError {
    #[error(transparent)]
    Scene(#[from] Box<SceneError>),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error("{name} failed:\n{}", failures.join("\n"))]
    Failed { name: String, failures: Vec<String> },
}

/// A test that returns this error shows it by `Debug`: the sentence is what its reader needs.
impl fmt::Debug for CheckError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Runs a scene file on the cpu engine and checks its expectations:
///
/// ```no_run
/// #[test]
/// fn the_track_recovers() -> Result<(), sward::run::CheckError> {
///     sward::run::check_scene("tests/track.ron")?;
///     Ok(())
/// }
/// ```
///
/// # Errors
///
/// A scene that cannot be read or run, or what failed in it, in sentences.
pub fn check_scene(path: impl AsRef<Path>) -> Result<Outcome, CheckError> {
    let loaded = load_scene(path.as_ref(), &[]).map_err(Box::new)?;
    check_loaded(&loaded, &Device::Processor)
}

/// Runs a scene that was read before, on a device, and checks its expectations.
///
/// # Errors
///
/// A scene that cannot be run, or what failed in it, in sentences.
pub fn check_loaded(loaded: &LoadedScene, device: &Device) -> Result<Outcome, CheckError> {
    let outcome = run_scene(loaded, &RunOptions::default(), device, |_| {})?;
    if outcome.passed() {
        return Ok(outcome);
    }
    let failed = outcome.verdicts.iter().filter(|v| v.passed == Some(false));
    Err(CheckError::Failed {
        name: outcome.name.clone(),
        failures: failed.map(sentence).collect(),
    })
}

fn sentence(verdict: &Verdict) -> String {
    let mut text = verdict.what.clone();
    if let Some(at_s) = verdict.at_s {
        text = format!("at {at_s} s: {text}");
    }
    if let Some(measured) = verdict.measured {
        text += &format!(": {measured} {}", verdict.unit);
    }
    if let Some(limit) = verdict.limit {
        text += &format!(", limit {limit} {}", verdict.unit);
    }
    if let Some(reason) = &verdict.reason {
        text += &format!(" ({reason})");
    }
    text
}
