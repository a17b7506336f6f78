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
    if folder.exists() && !folder.is_dir() {
        let text = "a file is there; give a folder";
        return Err(failed(io::Error::new(io::ErrorKind::NotADirectory, text)));
    }
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

/// Refuses options that would write one file twice, or over a file that the command reads.
///
/// # Errors
///
/// Two options of one file, by name.
pub fn refuse_one_file_for_two(
    outputs: &[(&str, Option<&Path>)],
    inputs: &[PathBuf],
) -> Result<(), Failure> {
    let outputs = outputs
        .iter()
        .filter_map(|(option, path)| Some((*option, (*path)?)));
    let outputs: Vec<(&str, &Path)> = outputs.collect();
    for (number, (option, path)) in outputs.iter().enumerate() {
        let place = place(path);
        if inputs.iter().any(|input| self::place(input) == place) {
            let text = format!("{option} {} would overwrite what is read", path.display());
            return Err(Failure::Usage(format!("{text}: give another file")));
        }
        let others = outputs[..number].iter();
        if let Some((other, _)) = others
            .clone()
            .find(|(_, other)| self::place(other) == place)
        {
            let file = path.display();
            return Err(Failure::Usage(format!(
                "{other} and {option} would both write {file}: give each a file of its own"
            )));
        }
    }
    Ok(())
}

/// A path without links and dots, as far as it exists.
fn place(path: &Path) -> PathBuf {
    if let Ok(whole) = path.canonicalize() {
        return whole;
    }
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new(".")).canonicalize();
    match (folder, path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.to_owned(),
    }
}
