//! Why a command ended without a result.

use std::io;
use std::path::{Path, PathBuf};

use crate::field::blade_shape::ShapeError;
use crate::gpu::GpuError;
use crate::render::RenderError;
use crate::run::accuracy::{AccuracyError, PlotError};
use crate::run::bench::flight::experiment::FlightError;
use crate::run::bench::flight::plot::FlightPlotError;
use crate::run::bench::{DrawBenchError, TerrainBenchError};
use crate::run::{Exit, RunError, StageError};
use crate::scene::AssetError;
use crate::scene::SceneError;

/// An error that ends a command. Printed once, by the program's main function.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Arguments that parse but make no sense.
    #[error("{0}")]
    Usage(String),
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A scene that is nowhere, with the names that there are.
    #[error("{0}")]
    UnknownScene(String),
    /// A ground of a bench that cannot be used, in words.
    #[error("{0}")]
    BadGround(String),
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Stage(#[from] StageError),
    /// Something the machine or the engine does not have, in words.
    #[error("{0}")]
    Missing(String),
    /// The platform refuses a window, for a reason in its own words.
    #[error("no window: {0}")]
    Window(String),
    /// What no user can mend, in words.
    #[error("{0}")]
    Internal(String),
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
            Self::Scene(_) | Self::UnknownScene(_) | Self::BadGround(_) => Exit::Invalid,
            Self::Run(error) => exit_of_run(error),
            Self::Stage(error) => exit_of_stage(error),
            Self::Gpu(error) => exit_of_gpu(error),
            Self::Missing(_) => Exit::NoAdapter,
            Self::Output(_) if self.is_closed_pipe() => Exit::Ok,
            Self::Internal(_) | Self::Window(_) | Self::Output(_) | Self::File { .. } => {
                Exit::Internal
            }
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

/// The exit code of a scenario that could not be run.
pub fn exit_of_run(error: &RunError) -> Exit {
    match error {
        RunError::Meadow { .. } => Exit::Invalid,
        RunError::Gpu { source, .. } => exit_of_gpu(source),
        RunError::Rate(_) | RunError::NotComparable { .. } => Exit::Usage,
    }
}

fn exit_of_gpu(error: &GpuError) -> Exit {
    match error {
        GpuError::NoAdapter { .. }
        | GpuError::NoDevice { .. }
        | GpuError::TooLarge { .. }
        | GpuError::UnknownMethod { .. } => Exit::NoAdapter,
        _ => Exit::Internal,
    }
}

fn exit_of_stage(error: &StageError) -> Exit {
    match error {
        StageError::Meadow(_) | StageError::Light(_) => Exit::Invalid,
        StageError::Gpu(error) | StageError::Render(RenderError::Gpu(error)) => exit_of_gpu(error),
        StageError::Render(RenderError::ClumpLayers { .. } | RenderError::LightLayers { .. }) => {
            Exit::NoAdapter
        }
        StageError::Render(RenderError::PictureSize { .. } | RenderError::PictureBytes { .. })
        | StageError::UnknownCamera { .. } => Exit::Usage,
        StageError::Render(_) => Exit::Internal,
    }
}

impl From<AccuracyError> for Failure {
    fn from(error: AccuracyError) -> Self {
        match error {
            AccuracyError::Run(error) => Self::Run(error),
            // Not stdout: the error says itself what could not be written.
            error @ (AccuracyError::Store(_)
            | AccuracyError::Blades(_)
            | AccuracyError::Scene(_)) => Self::Internal(error.to_string()),
        }
    }
}

impl From<PlotError> for Failure {
    fn from(error: PlotError) -> Self {
        Self::Internal(error.to_string())
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        Self::Stage(error.into())
    }
}

impl From<TerrainBenchError> for Failure {
    fn from(error: TerrainBenchError) -> Self {
        Self::Internal(error.to_string())
    }
}

impl From<AssetError> for Failure {
    fn from(error: AssetError) -> Self {
        Self::BadGround(error.to_string())
    }
}

impl From<FlightError> for Failure {
    fn from(error: FlightError) -> Self {
        match error {
            FlightError::Draw(DrawBenchError::Terrain(error)) => Self::BadGround(error.to_string()),
            FlightError::Draw(DrawBenchError::Field(error)) => Self::BadGround(error.to_string()),
            FlightError::Draw(error) => error.into(),
            FlightError::Terrain(error) => error.into(),
        }
    }
}

impl From<FlightPlotError> for Failure {
    fn from(error: FlightPlotError) -> Self {
        Self::Internal(error.to_string())
    }
}

impl From<DrawBenchError> for Failure {
    fn from(error: DrawBenchError) -> Self {
        match error {
            DrawBenchError::Gpu(error) => error.into(),
            DrawBenchError::Render(error) => error.into(),
            other => Self::Internal(other.to_string()),
        }
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
