//! Comparing a run with a recording.

use crate::sim::{Meadow, StateHash};

use super::super::engine::Engine;
use super::{Hashed, Recording};

/// Follows a run and finds the first tick that is not the recorded one.
#[derive(Clone, Debug)]
pub struct Verifier<'a> {
    recording: &'a Recording,
    bodies: StateHash,
    compared: u32,
    first: Option<Difference>,
}

/// The first tick that differs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Ticks count from 1; all before this one are equal.
    pub tick: u32,
    /// Simulated time at its end, in seconds.
    pub time_s: f64,
    /// Lower halves of the two state hashes.
    pub recorded: u32,
    pub found: u32,
}

impl<'a> Verifier<'a> {
    pub fn new(recording: &'a Recording) -> Self {
        Self {
            recording,
            bodies: StateHash::default(),
            compared: 0,
            first: None,
        }
    }

    /// Compares a tick that is done, in order; the engine is the cpu engine unless the recording
    /// covers the bodies alone.
    pub fn tick(&mut self, meadow: &Meadow, engine: &Engine) {
        self.bodies.bodies(meadow);
        let found = match (self.recording.hashed, engine.state_hash()) {
            (Hashed::GrassAndBodies, Some(hash)) => hash,
            _ => self.bodies.value(),
        } as u32;
        let Some(&recorded) = self.recording.hashes.get(self.compared as usize) else {
            return;
        };
        self.compared += 1;
        if found != recorded && self.first.is_none() {
            self.first = Some(Difference {
                tick: meadow.ticks,
                time_s: meadow.time_s(),
                recorded,
                found,
            });
        }
    }

    /// Ticks compared so far.
    pub fn compared(&self) -> u32 {
        self.compared
    }

    /// The first tick that differs, if one does.
    pub fn first_difference(&self) -> Option<Difference> {
        self.first
    }
}
