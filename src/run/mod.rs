//! Running scenes: the clock, what is measured, what is judged, reports and benches.

pub mod accuracy;
pub mod against;
pub mod bench;
mod check;
pub mod compare;
pub mod engine;
mod exit;
mod jitter;
pub mod judge;
pub mod junit;
pub mod light;
pub mod methods;
mod pass_times;
pub mod recording;
pub mod release;
pub mod report;
pub mod scenario;
mod spring_clamp;
pub mod stage;
pub mod swept;
pub mod table;
pub mod timeline;
pub mod trace;
pub mod watch;

pub use check::{CheckError, check_loaded, check_scene};
pub use engine::{Engine, EngineChoice, GpuEngine};
pub use exit::Exit;
pub use judge::Verdict;
pub use pass_times::PassTimes;
pub use recording::{Input, Recorder, Recording, Verifier};
pub use scenario::{
    Device, Frame, Outcome, RunError, RunOptions, RunWatcher, run_scene, run_watched,
};
pub use stage::{Stage, StageError};
pub use timeline::Timeline;
