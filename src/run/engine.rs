//! The engines behind one face: what a run, a picture or a window asks of the grass.

use std::collections::BTreeSet;

use crate::field::TileId;
use crate::sim::measure::{self, Snapshot, Standing};
use crate::sim::{Grass, Meadow, MeadowError};

/// Which engine a user asks for.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum EngineChoice {
    /// gpu on a hardware adapter, else cpu.
    #[default]
    Auto,
    Cpu,
    Gpu,
}

/// A running engine with the state of one meadow's grass.
pub enum Engine {
    Cpu(Grass<f32>),
}

impl Engine {
    /// Advances the meadow and its grass by one sub-step.
    ///
    /// # Errors
    ///
    /// An event of the script that cannot happen.
    pub fn tick(&mut self, meadow: &mut Meadow) -> Result<(), MeadowError> {
        match self {
            Self::Cpu(grass) => crate::sim::tick(meadow, grass),
        }
    }

    pub fn name(&self) -> &'static str {
        match self {
            Self::Cpu(_) => "cpu",
        }
    }

    /// Measures every active tile.
    pub fn snapshot(&mut self, meadow: &Meadow) -> Snapshot {
        match self {
            Self::Cpu(grass) => measure::snapshot(meadow, grass),
        }
    }

    /// The plants rooted near a place.
    pub fn near(
        &mut self,
        meadow: &Meadow,
        place_m: [f64; 2],
        within_m: f64,
    ) -> Vec<Standing<f32>> {
        match self {
            Self::Cpu(grass) => measure::near(meadow, grass, place_m, within_m),
        }
    }

    /// Plants that a body has pushed at least `far_m` off within the last `ticks` ticks.
    pub fn bent(
        &mut self,
        meadow: &Meadow,
        body: u32,
        ticks: u32,
        far_m: f64,
    ) -> BTreeSet<(TileId, u32)> {
        match self {
            Self::Cpu(grass) => measure::bent(meadow, grass, body, ticks, far_m),
        }
    }

    /// The hash of the grass state, where the engine promises its bits.
    pub fn state_hash(&self, meadow: &Meadow) -> Option<u64> {
        match self {
            Self::Cpu(grass) => Some(measure::state_hash(meadow, grass)),
        }
    }

    /// Total milliseconds spent so far per pass, by the pass's name.
    pub fn pass_ms(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Cpu(grass) => {
                let ms = |d: std::time::Duration| d.as_secs_f64() * 1e3;
                vec![
                    ("depth_cubes", ms(grass.times.depth_cubes)),
                    ("collide", ms(grass.times.collide)),
                    ("relax", ms(grass.times.relax)),
                ]
            }
        }
    }
}
