//! The light volumes of the scene on a stage.

use std::sync::Arc;

use super::cache::LightCache;
use super::job::{LightJob, LightMade, LightSource, LightTask};
use crate::bodies::{BodyError, Occluders};
use crate::gpu::Gpu;
use crate::render::light::{LightGrid, Visibility};
use crate::render::{RenderError, Renderer, Sun};
use crate::scene::LightVolumes;
use crate::sim::Meadow;

/// What a person may want to know of light volumes, in a sentence.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum LightNews {
    /// How they come along.
    Told(String),
    /// What went wrong.
    Trouble(String),
}

/// Starts the making of volumes, takes them when they are ready, and makes them anew where the sun moves.
#[derive(Debug)]
pub struct StageLight {
    settings: LightVolumes,
    grid: LightGrid,
    occluders: Arc<Occluders>,
    cache: LightCache,
    visibility: Option<Arc<Visibility>>,
    job: Option<LightJob>,
    /// The sun of the last volumes that were asked for.
    sun: Option<Sun>,
    /// Volumes could not be made, so that they are not asked for again.
    has_failed: bool,
    news: Vec<LightNews>,
}

impl StageLight {
    /// Of the meadow as it is now; `None` where its scene does not ask for volumes.
    ///
    /// # Errors
    /// A ground that makes no collider.
    pub fn of(meadow: &Meadow, cache: LightCache) -> Result<Option<Self>, BodyError> {
        let Some(settings) = meadow.scene.light else {
            return Ok(None);
        };
        Ok(Some(Self {
            settings,
            grid: LightGrid::new(&settings, &meadow.field.ground),
            occluders: Arc::new(Occluders::new(&meadow.bodies)?),
            cache,
            visibility: None,
            job: None,
            sun: None,
            has_failed: false,
            news: Vec::new(),
        }))
    }

    /// Slices of the volumes.
    pub fn slices(&self) -> u32 {
        self.grid.slices
    }

    /// Hands the renderer volumes that are ready, and begins new ones where the sun has moved. Does not
    /// wait: until the first are ready the scene is in plain light.
    ///
    /// # Errors
    /// Volumes that the device cannot hold.
    pub fn follow(
        &mut self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        sun: Sun,
    ) -> Result<(), RenderError> {
        if let Some(job) = self.job.take_if(|job| job.is_finished()) {
            match job.finish() {
                Some(made) => {
                    self.tell(&made);
                    renderer.set_light(gpu, Some(&made.texels))?;
                    self.visibility = Some(made.visibility);
                }
                None => {
                    self.has_failed = true;
                    let text = "the light volumes could not be made: the light stays as it is";
                    self.news.push(LightNews::Trouble(text.to_owned()));
                }
            }
        }
        if self.job.is_none() && self.sun != Some(sun) && !self.has_failed {
            if self.visibility.is_none() {
                let text = "light volumes are worked out: plain light until then";
                self.news.push(LightNews::Told(text.to_owned()));
            }
            self.sun = Some(sun);
            self.job = Some(LightJob::start(self.task(sun)));
        }
        Ok(())
    }

    fn task(&self, sun: Sun) -> LightTask {
        LightTask {
            settings: self.settings,
            grid: self.grid.clone(),
            occluders: Arc::clone(&self.occluders),
            cache: self.cache.clone(),
            daylight: sun.daylight(),
            known: self.visibility.clone(),
        }
    }

    fn tell(&mut self, made: &LightMade) {
        let notices = made.notices.iter().cloned();
        self.news.extend(notices.map(LightNews::Trouble));
        let how = match made.source {
            LightSource::Known => return,
            LightSource::Cache => "read from the cache",
            LightSource::Traced => "worked out",
        };
        self.news.push(LightNews::Told(format!(
            "light volumes: {} cells {how} in {:.2} s",
            self.grid.cells(),
            made.seconds
        )));
    }

    /// The share of the rays that are traced, 0…1, where volumes are in the making.
    pub fn pending_share(&self) -> Option<f64> {
        self.job.as_ref().map(LightJob::done_share)
    }

    /// What happened since the last call, in sentences.
    pub fn take_news(&mut self) -> Vec<LightNews> {
        std::mem::take(&mut self.news)
    }
}
