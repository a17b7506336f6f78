//! What the command line takes down while a scene runs.

use super::outputs::FileTrace;
use crate::app::progress::Progress;
use crate::gpu::GpuError;
use crate::run::{Engine, Frame, Recorder, RunWatcher, Verifier};
use crate::sim::Meadow;

/// Follows one run; each part is there if somebody asked for it.
pub struct Follower<'a> {
    pub name: &'a str,
    pub bar: Progress,
    /// A row per sub-step.
    pub trace: Option<&'a mut FileTrace>,
    /// A row per frame.
    pub frames: Option<&'a mut FileTrace>,
    pub recorder: Option<Recorder>,
    pub verifier: Option<Verifier<'a>>,
    /// Whole sub-steps so far.
    pub ticks: u32,
}

impl RunWatcher for Follower<'_> {
    fn tick(&mut self, meadow: &Meadow, engine: &mut Engine) -> Result<(), GpuError> {
        self.ticks = meadow.ticks;
        if let Some(recorder) = &mut self.recorder {
            recorder.tick(meadow, engine);
        }
        if let Some(verifier) = &mut self.verifier {
            verifier.tick(meadow, engine);
        }
        match &mut self.trace {
            Some(trace) => trace.tick(self.name, meadow, engine),
            None => Ok(()),
        }
    }

    fn frame(&mut self, frame: &Frame<'_>) {
        self.bar.set(frame.done);
        if let Some(frames) = &mut self.frames {
            frames.frame(self.name, frame);
        }
    }
}
