//! The engines behind one face: what a run, a picture or a window asks of the grass.

use std::collections::BTreeSet;

use crate::field::TileId;
use crate::gpu::{Gpu, GpuError, GpuGrass, GpuState, GrassKernels, TickError};
use crate::sim::measure::{self, GrassState, Snapshot, Standing};
use crate::sim::work::TileWork;
use crate::sim::{Grass, Meadow};

/// Which engine a user asks for.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum EngineChoice {
    /// gpu on a hardware adapter, else cpu.
    #[default]
    Auto,
    Cpu,
    Gpu,
}

impl EngineChoice {
    /// True if the gpu engine is to run on this device.
    pub fn is_gpu_on(self, gpu: &Gpu) -> bool {
        match self {
            Self::Auto => !gpu.adapter.is_software,
            Self::Cpu => false,
            Self::Gpu => true,
        }
    }
}

/// A running engine with the state of one meadow's grass.
pub enum Engine {
    Cpu(Grass<f32>),
    Gpu(Box<GpuEngine>),
}

/// The grass on the device, and a copy of its state for measures.
pub struct GpuEngine {
    pub grass: GpuGrass,
    /// The state after the last tick, once something has asked for it.
    state: Option<GpuState>,
}

impl GpuEngine {
    fn state(&mut self, meadow: &Meadow) -> Result<&GpuState, GpuError> {
        let state = match self.state.take() {
            Some(state) => state,
            None => self.grass.read_state(meadow)?,
        };
        Ok(self.state.insert(state))
    }
}

impl Engine {
    /// An engine that computes on the processor.
    pub fn cpu() -> Self {
        Self::Cpu(Grass::new())
    }

    /// An engine that computes on a device. Lowers the meadow's slab limit to what it can bind.
    ///
    /// # Errors
    ///
    /// A meadow larger than the device can bind.
    pub fn gpu(gpu: &Gpu, kernels: &GrassKernels, meadow: &mut Meadow) -> Result<Self, GpuError> {
        Ok(Self::Gpu(Box::new(GpuEngine {
            grass: GpuGrass::new(gpu, kernels, meadow)?,
            state: None,
        })))
    }

    /// Advances the meadow and its grass by one sub-step.
    ///
    /// # Errors
    ///
    /// An event of the script that cannot happen; what the device refuses.
    pub fn tick(&mut self, meadow: &mut Meadow) -> Result<(), TickError> {
        match self {
            Self::Cpu(grass) => Ok(crate::sim::tick(meadow, grass)?),
            Self::Gpu(engine) => {
                engine.state = None;
                crate::gpu::tick(meadow, &mut engine.grass)
            }
        }
    }

    pub fn name(&self) -> &'static str {
        match self {
            Self::Cpu(_) => "cpu",
            Self::Gpu(_) => "gpu",
        }
    }

    /// Measures every active tile. The gpu engine reads its state back, and waits for it.
    ///
    /// # Errors
    ///
    /// The device's.
    pub fn snapshot(&mut self, meadow: &Meadow) -> Result<Snapshot, GpuError> {
        Ok(match self {
            Self::Cpu(grass) => measure::snapshot(meadow, grass),
            Self::Gpu(engine) => measure::snapshot(meadow, engine.state(meadow)?),
        })
    }

    /// Every plant of an active tile as it stands, in the order of places.
    ///
    /// # Errors
    ///
    /// The device's.
    pub fn standing(
        &mut self,
        meadow: &Meadow,
        tile: &TileWork,
    ) -> Result<Vec<Standing<f32>>, GpuError> {
        let slab = match self {
            Self::Cpu(grass) => GrassState::slab(grass, tile.slab),
            Self::Gpu(engine) => engine.state(meadow)?.slab(tile.slab),
        };
        Ok(slab.map_or_else(Vec::new, |slab| measure::standing(meadow, tile, slab)))
    }

    /// The plants rooted near a place.
    ///
    /// # Errors
    ///
    /// The device's.
    pub fn near(
        &mut self,
        meadow: &Meadow,
        place_m: [f64; 2],
        within_m: f64,
    ) -> Result<Vec<Standing<f32>>, GpuError> {
        Ok(match self {
            Self::Cpu(grass) => measure::near(meadow, grass, place_m, within_m),
            Self::Gpu(engine) => measure::near(meadow, engine.state(meadow)?, place_m, within_m),
        })
    }

    /// Plants that a body has pushed at least `far_m` off within the last `ticks` ticks.
    ///
    /// # Errors
    ///
    /// The device's.
    pub fn bent(
        &mut self,
        meadow: &Meadow,
        body: u32,
        ticks: u32,
        far_m: f64,
    ) -> Result<BTreeSet<(TileId, u32)>, GpuError> {
        Ok(match self {
            Self::Cpu(grass) => measure::bent(meadow, grass, body, ticks, far_m),
            Self::Gpu(engine) => measure::bent(meadow, engine.state(meadow)?, body, ticks, far_m),
        })
    }

    /// The hash of the grass state, where the engine promises its bits.
    pub fn state_hash(&self, meadow: &Meadow) -> Option<u64> {
        match self {
            Self::Cpu(grass) => Some(measure::state_hash(meadow, grass)),
            Self::Gpu(_) => None,
        }
    }

    /// Total milliseconds spent so far per pass, by the pass's name. Empty for the gpu engine,
    /// whose times come late: see [`Engine::device_pass_ms`].
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
            Self::Gpu(_) => Vec::new(),
        }
    }

    /// Median milliseconds of each pass over the last sub-steps, from the device's own clock.
    /// Empty for the cpu engine, and where the device has no timestamps.
    pub fn device_pass_ms(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Cpu(_) => Vec::new(),
            Self::Gpu(engine) => engine.grass.timer.medians_ms(),
        }
    }
}
