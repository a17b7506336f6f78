//! Which engine a command runs, and on what: the options that all commands share.

use clap::{Args, ValueEnum};

use super::Failure;
use crate::gpu::{Gpu, GpuError};
use crate::run::{Device, EngineChoice};

/// Options that choose the engine.
#[derive(Args, Debug, Default)]
pub struct EngineArguments {
    /// What simulates the grass; by default the gpu on a hardware adapter, else the cpu
    #[arg(long, value_enum)]
    engine: Option<EngineName>,
    /// Fail where no graphics adapter is found, instead of falling back to the cpu engine
    #[arg(long)]
    require_gpu: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum EngineName {
    Cpu,
    Gpu,
    /// In double precision with exact shapes: the truth, slowly
    Reference,
}

impl EngineArguments {
    /// Whether any of the options was given.
    pub fn is_chosen(&self) -> bool {
        self.engine.is_some() || self.require_gpu
    }

    /// What the user asks for.
    ///
    /// # Errors
    ///
    /// Options that contradict each other.
    pub fn choice(&self) -> Result<EngineChoice, Failure> {
        match (self.engine, self.require_gpu) {
            (Some(EngineName::Cpu | EngineName::Reference), true) => Err(Failure::Usage(
                "--require-gpu needs the gpu engine: leave it or --engine out".into(),
            )),
            (Some(EngineName::Reference), false) => Ok(EngineChoice::Reference),
            (Some(EngineName::Cpu), false) => Ok(EngineChoice::Cpu),
            (Some(EngineName::Gpu), _) | (None, true) => Ok(EngineChoice::Gpu),
            (None, false) => Ok(EngineChoice::Auto),
        }
    }

    /// Opens what the engine runs on, and says which on stderr.
    ///
    /// # Errors
    ///
    /// Options that contradict each other; a missing adapter where one is asked for.
    pub fn open(&self) -> Result<Device, Failure> {
        let device = match self.choice()? {
            EngineChoice::Cpu => Device::Processor,
            EngineChoice::Reference => Device::Reference,
            EngineChoice::Gpu => Device::graphics(Gpu::headless()?)?,
            EngineChoice::Auto => match Gpu::headless() {
                Ok(gpu) if EngineChoice::Auto.is_gpu_on(&gpu) => Device::graphics(gpu)?,
                Ok(gpu) => {
                    let name = &gpu.adapter.name;
                    log::info!("{name} is a software adapter: the cpu engine is faster");
                    Device::Processor
                }
                Err(GpuError::NoAdapter { reason } | GpuError::NoDevice { reason, .. }) => {
                    log::info!("no usable graphics adapter ({reason})");
                    Device::Processor
                }
                Err(error) => return Err(error.into()),
            },
        };
        match device.gpu() {
            Some(gpu) => log::info!(
                "engine: gpu on {} ({}, {})",
                gpu.adapter.name,
                gpu.adapter.driver,
                gpu.adapter.backend
            ),
            None => {
                let (name, threads) = (device.engine_name(), rayon::current_num_threads());
                log::info!("engine: {name}, {threads} threads");
            }
        }
        Ok(device)
    }
}
