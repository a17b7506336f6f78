//! The engines behind one face: what a run, a picture or a window asks of the grass.

use std::collections::BTreeSet;

use crate::base::Real;
use crate::field::TileId;
use crate::gpu::{Gpu, GpuError, GpuGrass, GpuState, GrassKernels, TickError};
use crate::sim::measure::{self, GrassState, Snapshot, Standing, StandingBillboard};
use crate::sim::reference;
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
    Reference,
}

impl EngineChoice {
    /// True if the gpu engine is to run on this device.
    pub fn is_gpu_on(self, gpu: &Gpu) -> bool {
        match self {
            Self::Auto => !gpu.adapter.is_software,
            Self::Cpu | Self::Reference => false,
            Self::Gpu => true,
        }
    }
}

/// A running engine with the state of one meadow's grass.
pub enum Engine {
    Cpu(Grass<f32>),
    Gpu(Box<GpuEngine>),
    /// In `f64`; its meadow has the settings of [`reference::solver`].
    Reference(Box<Grass<f64>>),
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

    /// The engine that others are compared with. Gives the meadow's solver its settings, so that it
    /// has to be asked for before the first sub-step.
    pub fn reference(meadow: &mut Meadow) -> Self {
        meadow.set_solver(reference::solver(&meadow.scene.solver));
        Self::Reference(Box::default())
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

    /// The same engine with all grass at rest, for a meadow whose plants have become others.
    ///
    /// # Errors
    ///
    /// A meadow larger than the device can bind.
    pub fn at_rest(
        &self,
        gpu: &Gpu,
        kernels: &GrassKernels,
        meadow: &mut Meadow,
    ) -> Result<Self, GpuError> {
        match self {
            Self::Cpu(_) => Ok(Self::cpu()),
            Self::Gpu(_) => Self::gpu(gpu, kernels, meadow),
            Self::Reference(_) => Ok(Self::Reference(Box::default())),
        }
    }

    /// Advances the meadow and its grass by one sub-step.
    ///
    /// # Errors
    ///
    /// An event of the script that cannot happen; what the device refuses.
    pub fn tick(&mut self, meadow: &mut Meadow) -> Result<(), TickError> {
        match self {
            Self::Cpu(grass) => {
                crate::sim::tick(meadow, grass)?;
                grass.chain_hash(meadow);
                Ok(())
            }
            Self::Reference(grass) => Ok(crate::sim::tick(meadow, grass)?),
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
            Self::Reference(_) => "reference",
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
            Self::Reference(grass) => measure::snapshot(meadow, grass.as_ref()),
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
    ) -> Result<Vec<Standing<f64>>, GpuError> {
        Ok(match self {
            Self::Cpu(grass) => all_standing(meadow, tile, grass),
            Self::Reference(grass) => all_standing(meadow, tile, grass.as_ref()),
            Self::Gpu(engine) => all_standing(meadow, tile, engine.state(meadow)?),
        })
    }

    /// Every plant of a tile as it stands, awake or not, in the order of places.
    ///
    /// # Errors
    ///
    /// The device's.
    pub fn of_tile(
        &mut self,
        meadow: &Meadow,
        tile: TileId,
    ) -> Result<Vec<Standing<f64>>, GpuError> {
        Ok(match self {
            Self::Cpu(grass) => widened(measure::of_tile(meadow, grass, tile)),
            Self::Reference(grass) => measure::of_tile(meadow, grass.as_ref(), tile),
            Self::Gpu(engine) => widened(measure::of_tile(meadow, engine.state(meadow)?, tile)),
        })
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
    ) -> Result<Vec<Standing<f64>>, GpuError> {
        Ok(match self {
            Self::Cpu(grass) => widened(measure::near(meadow, grass, place_m, within_m)),
            Self::Reference(grass) => measure::near(meadow, grass.as_ref(), place_m, within_m),
            Self::Gpu(engine) => widened(measure::near(
                meadow,
                engine.state(meadow)?,
                place_m,
                within_m,
            )),
        })
    }

    /// Every billboard of an active tile as it stands, in the order of places.
    ///
    /// # Errors
    ///
    /// The device's.
    pub fn standing_billboards(
        &mut self,
        meadow: &Meadow,
        tile: &TileWork,
    ) -> Result<Vec<StandingBillboard<f64>>, GpuError> {
        Ok(match self {
            Self::Cpu(grass) => all_billboards(meadow, tile, grass),
            Self::Reference(grass) => all_billboards(meadow, tile, grass.as_ref()),
            Self::Gpu(engine) => all_billboards(meadow, tile, engine.state(meadow)?),
        })
    }

    /// The billboards rooted near a place.
    ///
    /// # Errors
    ///
    /// The device's.
    pub fn billboards_near(
        &mut self,
        meadow: &Meadow,
        place_m: [f64; 2],
        within_m: f64,
    ) -> Result<Vec<StandingBillboard<f64>>, GpuError> {
        let widened = |near: Vec<StandingBillboard<f32>>| {
            let near = near.into_iter();
            near.map(StandingBillboard::widened).collect()
        };
        Ok(match self {
            Self::Cpu(grass) => widened(measure::billboards_near(meadow, grass, place_m, within_m)),
            Self::Reference(grass) => {
                measure::billboards_near(meadow, grass.as_ref(), place_m, within_m)
            }
            Self::Gpu(engine) => {
                let state = engine.state(meadow)?;
                widened(measure::billboards_near(meadow, state, place_m, within_m))
            }
        })
    }

    /// Plants and billboards that a body has pushed at least `far_m` off within the last `ticks` ticks.
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
            Self::Reference(grass) => measure::bent(meadow, grass.as_ref(), body, ticks, far_m),
            Self::Gpu(engine) => measure::bent(meadow, engine.state(meadow)?, body, ticks, far_m),
        })
    }

    /// Whether the device has run every loop of the sub-steps so far to its end. Waits for it.
    ///
    /// # Errors
    ///
    /// The device's.
    pub fn check(&self) -> Result<(), GpuError> {
        match self {
            Self::Cpu(_) | Self::Reference(_) => Ok(()),
            Self::Gpu(engine) => engine.grass.check(),
        }
    }

    /// The same as far as it is known without waiting.
    ///
    /// # Errors
    ///
    /// As for [`Engine::check`].
    pub fn check_late(&self) -> Result<(), GpuError> {
        match self {
            Self::Cpu(_) | Self::Reference(_) => Ok(()),
            Self::Gpu(engine) => engine.grass.check_late(),
        }
    }

    /// The hash of all ticks so far, where the engine promises its bits.
    pub fn state_hash(&self) -> Option<u64> {
        match self {
            Self::Cpu(grass) => Some(grass.state_hash.value()),
            Self::Reference(_) | Self::Gpu(_) => None,
        }
    }

    /// Plants and billboards pushed in the last sub-step and the most rounds one of them took; `None` for an
    /// engine that does not say.
    pub fn response(&self) -> Option<(u64, u32)> {
        match self {
            Self::Cpu(grass) => Some((grass.pushed, grass.rounds)),
            Self::Reference(grass) => Some((grass.pushed, grass.rounds)),
            Self::Gpu(_) => None,
        }
    }

    /// Total milliseconds spent so far per pass, by the pass's name. Empty for the gpu engine,
    /// whose times come late: see [`Engine::device_pass_ms`].
    pub fn pass_ms(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Cpu(grass) => grass.times.in_ms(),
            Self::Reference(grass) => grass.times.in_ms(),
            Self::Gpu(_) => Vec::new(),
        }
    }

    /// Median milliseconds of each pass over the last sub-steps, from the device's own clock.
    /// Empty for the cpu engine, and where the device has no timestamps.
    pub fn device_pass_ms(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Cpu(_) | Self::Reference(_) => Vec::new(),
            Self::Gpu(engine) => engine.grass.timer.medians_ms(),
        }
    }
}

fn all_standing<R: Real>(
    meadow: &Meadow,
    tile: &TileWork,
    state: &impl GrassState<R>,
) -> Vec<Standing<f64>> {
    let slab = state.slab(tile.slab);
    slab.map_or_else(Vec::new, |slab| {
        widened(measure::standing(meadow, tile, slab))
    })
}

fn all_billboards<R: Real>(
    meadow: &Meadow,
    tile: &TileWork,
    state: &impl GrassState<R>,
) -> Vec<StandingBillboard<f64>> {
    let slab = state.billboards(tile.slab);
    slab.map_or_else(Vec::new, |slab| {
        let all = measure::standing_billboards(meadow, tile, slab);
        all.into_iter().map(StandingBillboard::widened).collect()
    })
}

fn widened<R: Real>(plants: Vec<Standing<R>>) -> Vec<Standing<f64>> {
    plants.into_iter().map(Standing::widened).collect()
}
