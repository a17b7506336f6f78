//! Files of results, opened before the run: one that cannot be written must not cost hours.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::app::Failure;
use crate::run::trace::Trace;

/// A trace that goes to a file.
pub type FileTrace = Trace<BufWriter<File>>;

/// A file that is there, empty, and waits for its content.
#[derive(Debug)]
pub struct ResultFile {
    path: PathBuf,
    file: File,
}

impl ResultFile {
    /// Makes the file, and the folders it lies in.
    ///
    /// # Errors
    ///
    /// A file that cannot be written.
    pub fn create(path: &Path) -> Result<Self, Failure> {
        let failed = |e| Failure::file(path, e);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(failed)?;
        }
        Ok(Self {
            path: path.to_owned(),
            file: File::create(path).map_err(failed)?,
        })
    }

    /// Gives the file its content.
    ///
    /// # Errors
    ///
    /// A disk that is full by now.
    pub fn write(mut self, bytes: &[u8]) -> Result<(), Failure> {
        let written = self.file.write_all(bytes);
        written.map_err(|e| Failure::file(&self.path, e))
    }

    /// Starts a trace in the file.
    pub fn into_trace(self) -> FileTrace {
        Trace::new(BufWriter::new(self.file))
    }
}

/// Ends a trace that was to go to `path`.
///
/// # Errors
///
/// What went wrong first while it was written.
pub fn finish_trace(trace: Option<FileTrace>, path: Option<&Path>) -> Result<(), Failure> {
    match (trace, path) {
        (Some(trace), Some(path)) => trace.finish().map_err(|e| Failure::file(path, e)),
        _ => Ok(()),
    }
}
