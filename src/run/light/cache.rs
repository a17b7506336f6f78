//! What cells of light volumes see, on disk: a file per content.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A folder of files that can be made again, each named by the hash of what it is made from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightCache {
    folder: Option<PathBuf>,
}

/// A file of the cache.
#[derive(Debug)]
pub enum Found {
    Bytes(Vec<u8>),
    Missing,
    /// There is one, but it cannot be read.
    Unreadable(io::Error),
}

impl LightCache {
    /// Keeps nothing.
    pub fn none() -> Self {
        Self::default()
    }

    /// Keeps files in a folder, which is made when there is one to keep.
    pub fn in_folder(folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: Some(folder.into()),
        }
    }

    /// The folder that the variable `SWARD_CACHE` names, none where it is empty; without the variable
    /// the platform's folder for such files, if the environment tells one: `sward` in `XDG_CACHE_HOME` or
    /// in `.cache` of the home folder, in `Library/Caches` on macOS, in `LOCALAPPDATA` on Windows.
    pub fn of_platform() -> Self {
        Self::of_environment(|name| std::env::var_os(name).map(PathBuf::from))
    }

    fn of_environment(variable: impl Fn(&str) -> Option<PathBuf>) -> Self {
        if let Some(own) = variable("SWARD_CACHE") {
            return Self {
                folder: Some(own).filter(|folder| !folder.as_os_str().is_empty()),
            };
        }
        // Relative paths are invalid there by the XDG base directory specification.
        let absolute = |name| variable(name).filter(|folder| folder.is_absolute());
        let caches = if cfg!(windows) {
            absolute("LOCALAPPDATA")
        } else if cfg!(target_os = "macos") {
            absolute("HOME").map(|home| home.join("Library/Caches"))
        } else {
            absolute("XDG_CACHE_HOME").or_else(|| Some(absolute("HOME")?.join(".cache")))
        };
        Self {
            folder: caches.map(|caches| caches.join("sward")),
        }
    }

    /// The file of a key; `None` where nothing is kept.
    pub fn file(&self, key: u64) -> Option<PathBuf> {
        let folder = self.folder.as_ref()?;
        Some(folder.join(format!("light-{key:016x}.bin")))
    }

    /// What there is for a key, if it has no more bytes than `most`, as the right file has.
    pub(super) fn read(&self, key: u64, most: usize) -> Found {
        let Some(file) = self.file(key) else {
            return Found::Missing;
        };
        let read = fs::metadata(&file).and_then(|known| {
            if known.len() > most as u64 {
                let text = format!("it has {} bytes, {most} at most are right", known.len());
                return Err(io::Error::new(io::ErrorKind::InvalidData, text));
            }
            fs::read(&file)
        });
        match read {
            Ok(bytes) => Found::Bytes(bytes),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Found::Missing,
            Err(error) => Found::Unreadable(error),
        }
    }

    /// Keeps a file: written beside its place and then moved there, so that no reader sees a part of it.
    ///
    /// # Errors
    /// The platform's; then there is what was there before.
    pub(super) fn write(&self, key: u64, bytes: &[u8]) -> io::Result<()> {
        let Some(file) = self.file(key) else {
            return Ok(());
        };
        let folder = file.parent().unwrap_or(Path::new("."));
        fs::create_dir_all(folder)?;
        let own = file.with_extension(format!("{}.part", std::process::id()));
        let written = (fs::File::create(&own))
            .and_then(|mut part| part.write_all(bytes).and_then(|()| part.sync_all()))
            .and_then(|()| fs::rename(&own, &file));
        if written.is_err() {
            // The first error is the one to tell.
            let _ = fs::remove_file(&own);
        }
        written
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(set: &[(&str, &str)]) -> Option<String> {
        let of = |name: &str| {
            let found = set.iter().find(|(known, _)| *known == name);
            found.map(|(_, value)| PathBuf::from(value))
        };
        let folder = LightCache::of_environment(of).folder;
        folder.map(|folder| folder.display().to_string())
    }

    #[test]
    fn the_folder_follows_the_environment() {
        let own = ("SWARD_CACHE", "mine");
        assert_eq!(folder(&[own]).as_deref(), Some("mine"));
        assert_eq!(folder(&[("SWARD_CACHE", ""), ("HOME", "/home/a")]), None);
        assert_eq!(folder(&[]), None);
        if cfg!(all(unix, not(target_os = "macos"))) {
            let (home, xdg) = (("HOME", "/home/a"), ("XDG_CACHE_HOME", "/c"));
            assert_eq!(folder(&[home]).as_deref(), Some("/home/a/.cache/sward"));
            assert_eq!(folder(&[home, xdg]).as_deref(), Some("/c/sward"));
            let relative = ("XDG_CACHE_HOME", "c");
            assert_eq!(
                folder(&[home, relative]).as_deref(),
                Some("/home/a/.cache/sward")
            );
        }
    }
}
