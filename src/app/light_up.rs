//! Light volumes of a stage whose pictures are made without a window.

use super::progress::Progress;
use crate::gpu::Gpu;
use crate::run::light::LightNews;
use crate::run::stage::{Stage, StageError};

/// Waits for the light volumes of a scene that asks for them, with a bar, and tells how they came.
///
/// # Errors
/// Volumes that the device cannot hold.
pub fn light_up(gpu: &Gpu, stage: &mut Stage) -> Result<(), StageError> {
    if stage.meadow().scene.light.is_none() {
        return Ok(());
    }
    let progress = Progress::new("light volumes");
    stage.finish_light(gpu, |share| progress.set(share))?;
    drop(progress);
    for news in stage.take_light_news() {
        match news {
            LightNews::Told(text) => log::info!("{text}"),
            LightNews::Trouble(text) => log::warn!("{text}"),
        }
    }
    Ok(())
}
