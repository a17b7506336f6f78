//! One sub-step on the CPU. Its twin on the GPU is `gpu::tick`; both match line for line.

use crate::base::Real;

use super::cpu::Grass;
use super::meadow::{Meadow, MeadowError};

/// Advances the meadow and its grass by one sub-step.
///
/// # Errors
///
/// An event of the script that cannot happen.
pub fn tick<R: Real>(meadow: &mut Meadow, grass: &mut Grass<R>) -> Result<(), MeadowError> {
    meadow.script()?;
    meadow.move_bodies();
    meadow.broad_phase();
    grass.assign_slabs(meadow);
    grass.draw_depth_cubes(meadow);
    grass.collide(meadow);
    grass.relax(meadow);
    Ok(())
}
