//! Files of results, opened before the run: one that cannot be written must not cost hours.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
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
    /// Makes the file in a folder that is there.
    ///
    /// # Errors
    ///
    /// A file that cannot be written; a folder that does not exist, which may well be a slip.
    pub fn create(path: &Path) -> Result<Self, Failure> {
        let failed = |e| Failure::file(path, e);
        folder_exists(path.parent()).map_err(failed)?;
        Ok(Self {
            path: path.to_owned(),
            file: File::create(path).map_err(failed)?,
        })
    }

    /// Makes the file, and the folders it lies in.
    ///
    /// # Errors
    ///
    /// A file that cannot be written.
    pub fn create_with_folders(path: &Path) -> Result<Self, Failure> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|e| Failure::file(path, e))?;
        }
        Self::create(path)
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

/// Makes a folder for results, where it is not there yet, in one that is, and tries to write in it.
///
/// # Errors
///
/// A folder that cannot be made or written to; one in a folder that does not exist.
pub fn make_folder(folder: &Path) -> Result<(), Failure> {
    let failed = |e| Failure::file(folder, e);
    if !folder.is_dir() {
        folder_exists(folder.parent()).map_err(failed)?;
        fs::create_dir(folder).map_err(failed)?;
    }
    let probe = folder.join(format!(".sward-{}", std::process::id()));
    File::create(&probe)
        .and_then(|_| fs::remove_file(&probe))
        .map_err(failed)
}

fn folder_exists(folder: Option<&Path>) -> io::Result<()> {
    match folder {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.exists() => {
            let text = format!(
                "the folder {} does not exist; make it first",
                folder.display()
            );
            Err(io::Error::new(io::ErrorKind::NotFound, text))
        }
        _ => Ok(()),
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
