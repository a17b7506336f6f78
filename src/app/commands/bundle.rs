//! What a failing scenario leaves behind: all it takes to see it fail again.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::outputs::{FileTrace, ResultFile};
use super::scene_file;
use crate::app::{Failure, complain};
use crate::run::report::Report;
use crate::run::{Device, Recording, RunOptions};
use crate::scene::{LoadedScene, limits};

mod picture;

pub use picture::End;
use picture::picture;

const TRACE: &str = "trace.csv";
const SCENE: &str = "scene.ron";
const METRICS: &str = "metrics.json";
const PICTURE: &str = "end.png";
/// How to do the run again, how it ended, and why there is no picture: only where there is something to
/// say.
const NOTES: &str = "notes.txt";

/// A folder that is filled if its scenario fails, and goes if it passes.
pub struct Bundle {
    folder: PathBuf,
    /// A row per frame, written while the scenario runs.
    pub trace: FileTrace,
}

impl Bundle {
    /// Makes the folder; what an earlier run left in it goes.
    ///
    /// # Errors
    ///
    /// A folder that cannot be written to.
    pub fn open(folder: PathBuf, name: &str) -> Result<Self, Failure> {
        for file in [SCENE, METRICS, PICTURE, NOTES, &recording_name(name)] {
            let path = folder.join(file);
            match fs::remove_file(&path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    return Err(Failure::file(&path, error));
                }
                _ => {}
            }
        }
        let trace = ResultFile::create_with_folders(&folder.join(TRACE))?.into_trace();
        Ok(Self { folder, trace })
    }

    /// Takes the folder away again, unless something else is in it.
    ///
    /// # Errors
    ///
    /// A trace that cannot be removed.
    pub fn discard(self) -> Result<(), Failure> {
        let path = self.folder.join(TRACE);
        drop(self.trace);
        fs::remove_file(&path).map_err(|e| Failure::file(&path, e))?;
        // Folders with other files stay; that is what the call refuses.
        let _ = fs::remove_dir(&self.folder);
        Ok(())
    }

    /// Fills the folder and tells it.
    ///
    /// # Errors
    ///
    /// A file that cannot be written, or an asset that has changed since it was read.
    pub fn fill(self, contents: &Contents<'_>, end: End) -> Result<PathBuf, Failure> {
        let Self { folder, trace } = self;
        let path = folder.join(TRACE);
        trace.finish().map_err(|e| Failure::file(&path, e))?;
        let write = |file: &str, bytes: &[u8]| {
            ResultFile::create_with_folders(&folder.join(file))?.write(bytes)
        };
        write(SCENE, contents.loaded.source.as_bytes())?;
        write(METRICS, &serde_json::to_vec_pretty(contents.report)?)?;
        for file in contents.loaded.assets.file_hashes.keys() {
            write(file, &contents.asset(file)?)?;
        }
        let mut notes = String::new();
        if let Some(recording) = contents.recording {
            let name = recording_name(contents.name);
            write(&name, &text_of(recording)?)?;
            notes.push_str(&format!(
                "{SCENE} is the scene as it was given. `sward replay {name}` does the run again with the settings that \
                 the command line had beside it.\n"
            ));
        }
        if let End::BrokenOff { ticks, error } = &end {
            notes.push_str(&format!(
                "The run ended early, after {ticks} whole sub-steps: {error}\n\
                 {PICTURE} is drawn from doing it again up to there on the cpu engine.\n"
            ));
        }
        match picture(contents.loaded, contents.options, end, contents.device) {
            Ok(png) => write(PICTURE, &png)?,
            // The rest of the bundle is worth more than its picture.
            Err(reason) => {
                complain(&format!("no picture of {}: {reason}", contents.name));
                notes.push_str(&format!("There is no {PICTURE}: {reason}\n"));
            }
        }
        if !notes.is_empty() {
            write(NOTES, notes.as_bytes())?;
        }
        Ok(folder)
    }
}

/// What goes into a bundle.
pub struct Contents<'a> {
    pub name: &'a str,
    pub loaded: &'a LoadedScene,
    /// Of this scenario alone.
    pub report: &'a Report,
    pub recording: Option<&'a Recording>,
    pub device: &'a Device,
    pub options: &'a RunOptions,
    /// Folders of assets besides the scene's own.
    pub asset_dirs: &'a [PathBuf],
}

impl Contents<'_> {
    fn asset(&self, file: &str) -> Result<Vec<u8>, Failure> {
        let path = self.loaded.path.as_deref();
        let read = scene_file::read_asset(path, self.asset_dirs, file, limits::ASSET_BYTES);
        read.map_err(|error| Failure::file(Path::new(file), io::Error::other(error.to_string())))
    }
}

/// Name of a scene's recording.
pub fn recording_name(scene: &str) -> String {
    format!("{scene}.recording")
}

/// A recording as bytes of its file.
///
/// # Errors
///
/// None is known; the writer's own are passed on.
pub fn text_of(recording: &Recording) -> Result<Vec<u8>, Failure> {
    let text = recording.to_text().map_err(io::Error::other)?;
    Ok(text.into_bytes())
}
