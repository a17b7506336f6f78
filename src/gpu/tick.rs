//! One sub-step on the device. Its twin on the CPU is `sim::tick`; both match line for line.

use super::GpuError;
use super::grass::GpuGrass;
use crate::sim::{Meadow, MeadowError};

/// Why a tick could not be done.
#[derive(Debug, thiserror::Error)]
pub enum TickError {
    #[error(transparent)]
    Meadow(#[from] MeadowError),
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Advances the meadow and its grass by one sub-step.
///
/// # Errors
///
/// An event of the script that cannot happen, or what the device refuses.
pub fn tick(meadow: &mut Meadow, grass: &mut GpuGrass) -> Result<(), TickError> {
    meadow.script()?;
    meadow.move_bodies();
    meadow.broad_phase();
    grass.assign_slabs(meadow)?;
    grass.draw_depth_cubes(meadow)?;
    grass.collide(meadow)?;
    grass.relax();
    grass.submit();
    Ok(())
}
