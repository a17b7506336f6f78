//! Doing a run again: state hashes, checkpoints, recordings, and what a failing run leaves behind.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]

mod checkpoint;
#[cfg(feature = "app")]
#[path = "../process/mod.rs"]
mod process;
mod program;
mod quarantine;
mod recordings;

use std::path::PathBuf;

/// A folder of this test's own, empty.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("replay")
        .join(name);
    // It may not be there yet.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a writable target folder");
    folder
}
