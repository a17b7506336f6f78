//! Why a command ended without a result.

use std::io;
use std::path::{Path, PathBuf};

use crate::field::blade_shape::ShapeError;
use crate::gpu::GpuError;
use crate::run::{Exit, StageError};
use crate::scene::SceneError;

/// An error that ends a command. Printed once, by the program's main function.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Arguments that parse but make no sense.
    #[error("{0}")]
    Usage(String),
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Stage(#[from] StageError),
    /// The platform refuses a window, for a reason in its own words.
    #[error("no window: {0}")]
    Window(String),
    #[error("cannot write to stdout: {0}")]
    Output(#[from] io::Error),
    #[error("cannot write {}: {source}", path.display())]
    File { path: PathBuf, source: io::Error },
}

impl Failure {
    /// The program's exit code.
    pub fn exit(&self) -> Exit {
        match self {
            Self::Usage(_) => Exit::Usage,
            Self::Scene(_) | Self::Stage(StageError::Meadow(_)) => Exit::Invalid,
            Self::Gpu(GpuError::NoAdapter { .. } | GpuError::NoDevice { .. }) => Exit::NoAdapter,
            Self::Output(_) if self.is_closed_pipe() => Exit::Ok,
            Self::Gpu(_)
            | Self::Stage(_)
            | Self::Window(_)
            | Self::Output(_)
            | Self::File { .. } => Exit::Internal,
        }
    }

    /// A file of results that cannot be written.
    pub fn file(path: &Path, source: io::Error) -> Self {
        Self::File {
            path: path.to_owned(),
            source,
        }
    }

    /// Whether the reader of stdout has had enough.
    pub fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Output(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }
}

impl From<ShapeError> for Failure {
    fn from(error: ShapeError) -> Self {
        Self::Usage(error.to_string())
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        Self::Output(error.into())
    }
}
