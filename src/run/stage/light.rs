//! The light volumes of a stage, from outside: how far they are, and waiting for them.

use std::time::Duration;

use super::{Stage, StageError};
use crate::gpu::Gpu;
use crate::render::Renderer;
use crate::run::light::{LightCache, LightNews, StageLight};
use crate::sim::Meadow;

/// How often a wait for light volumes looks whether they are ready.
const LIGHT_LOOK: Duration = Duration::from_millis(5);

impl Stage {
    /// The share of the light volumes that is worked out, while they are in the making: on other threads,
    /// from the first picture on. Until they are ready pictures are in plain light.
    pub fn pending_light(&self) -> Option<f64> {
        self.light.as_ref()?.pending_share()
    }

    /// What happened to the light volumes since the last call; nothing where the scene has none.
    pub fn take_light_news(&mut self) -> Vec<LightNews> {
        self.light
            .as_mut()
            .map_or_else(Vec::new, StageLight::take_news)
    }

    /// Waits for the light volumes under the present sun, and tells meanwhile what share of them is
    /// there. A scene that does not ask for any costs nothing.
    ///
    /// # Errors
    ///
    /// Volumes that the device cannot hold.
    pub fn finish_light(&mut self, gpu: &Gpu, mut tell: impl FnMut(f64)) -> Result<(), StageError> {
        let Some(light) = &mut self.light else {
            return Ok(());
        };
        light.follow(gpu, &mut self.renderer, self.sun)?;
        while let Some(share) = light.pending_share() {
            tell(share);
            std::thread::sleep(LIGHT_LOOK);
            light.follow(gpu, &mut self.renderer, self.sun)?;
        }
        Ok(())
    }
}

/// Light volumes as the scene asks for them, if the device can hold them.
pub(super) fn light_of(
    gpu: &Gpu,
    renderer: &Renderer,
    meadow: &Meadow,
) -> Result<Option<StageLight>, StageError> {
    let light = StageLight::of(meadow, LightCache::of_platform()).map_err(StageError::Light)?;
    if let Some(light) = &light {
        renderer.check_light(gpu, light.slices())?;
    }
    Ok(light)
}
