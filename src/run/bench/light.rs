//! The bench of light volumes: what working them out costs, what they take on the device, and what a picture
//! costs with them and without.
//!
//! The two pictures take turns, each from its submission until the device is done. Every picture is of the
//! scene at its start, from its first camera.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::machine::Machine;
use crate::base::statistics::median;
use crate::bodies::Occluders;
use crate::gpu::Gpu;
use crate::render::light::{LightGrid, TraceProgress, Visibility};
use crate::render::{PictureTarget, Sun};
use crate::run::light::{LightCache, LightMade, LightSource, LightTask};
use crate::run::report::Adapter;
use crate::run::{EngineChoice, Stage, StageError};
use crate::scene::{LightVolumes, LoadedScene};
use crate::sim::Meadow;

const PICTURE: [u32; 2] = [1280, 720];
/// Pictures of each kind, after one that is not timed.
const ROUNDS: usize = 25;
/// Times that volumes are worked out each way.
const REPEATS: usize = 3;

/// Results of the whole bench. Times are medians, in milliseconds.
#[derive(Clone, Debug, Serialize)]
pub struct LightBench {
    pub schema_version: u32,
    /// Version of sward.
    pub sward: &'static str,
    pub machine: Machine,
    pub adapter: Adapter,
    pub scene: String,
    pub columns: [u32; 2],
    pub slices: u32,
    pub rays: u32,
    /// Rays traced and the light of the sky summed, on all threads.
    pub traced_ms: f64,
    /// The same from a file of the cache; null where no file can be kept.
    pub cached_ms: Option<f64>,
    /// The light of another sun alone.
    pub relit_ms: f64,
    pub file_bytes: u64,
    pub device_bytes: u64,
    pub picture: [u32; 2],
    pub rounds: usize,
    /// A picture without volumes and with them.
    pub plain_ms: f64,
    pub lit_ms: f64,
}

/// Runs the bench on a scene that asks for light volumes; `progress` gets the share done.
///
/// # Errors
///
/// A scene that cannot be laid out, or that the device cannot hold.
pub fn bench_light(
    gpu: &Gpu,
    loaded: &LoadedScene,
    mut progress: impl FnMut(f64),
) -> Result<LightBench, StageError> {
    let machine = Machine::now();
    let mut plain = loaded.clone();
    plain.scene.light = None;
    let settings = loaded.scene.light.unwrap_or_default();
    let making = Making::new(loaded, settings)?;
    let traced_ms = making.median_ms(LightSource::Traced).unwrap_or(0.0);
    progress(0.2);
    let made = making.made(LightSource::Known);
    let mut lit = loaded.clone();
    lit.scene.light = Some(settings);
    let [plain_ms, lit_ms] = picture_ms(gpu, [&plain, &lit], |share| progress(0.3 + 0.7 * share))?;
    Ok(LightBench {
        schema_version: 1,
        sward: env!("CARGO_PKG_VERSION"),
        machine,
        adapter: Adapter::of(gpu),
        scene: loaded.name.clone(),
        columns: making.task.grid.columns,
        slices: settings.slices,
        rays: settings.rays,
        traced_ms,
        cached_ms: making.median_ms(LightSource::Cache),
        relit_ms: making.median_ms(LightSource::Known).unwrap_or(0.0),
        file_bytes: Visibility::file_bytes(&making.task.grid, settings.rays) as u64,
        device_bytes: made.map_or(0, |made| made.texels.bytes()),
        picture: PICTURE,
        rounds: ROUNDS,
        plain_ms,
        lit_ms,
    })
}

/// Volumes that are worked out again and again.
struct Making {
    task: LightTask,
    known: Option<Arc<Visibility>>,
    /// A folder of the bench's own, which goes with it.
    folder: PathBuf,
}

impl Making {
    fn new(loaded: &LoadedScene, settings: LightVolumes) -> Result<Self, StageError> {
        let meadow = Meadow::new(loaded.scene.clone(), &loaded.assets)?;
        let own = format!("sward-bench-light-{}", std::process::id());
        let mut making = Self {
            task: LightTask {
                settings,
                grid: LightGrid::new(&settings, &meadow.field.ground),
                occluders: Arc::new(Occluders::new(&meadow.bodies).map_err(StageError::Light)?),
                cache: LightCache::none(),
                daylight: Sun::default().daylight(),
                known: None,
            },
            known: None,
            folder: std::env::temp_dir().join(own),
        };
        // Fills the cache as well.
        making.known = making.made(LightSource::Cache).map(|made| made.visibility);
        Ok(making)
    }

    /// Volumes from where they shall come from; a cache without the file has them traced.
    fn made(&self, from: LightSource) -> Option<LightMade> {
        let mut task = self.task.clone();
        match from {
            LightSource::Traced => {}
            LightSource::Cache => task.cache = LightCache::in_folder(&self.folder),
            LightSource::Known => task.known.clone_from(&self.known),
        }
        task.make(&TraceProgress::default())
    }

    /// How long they take from there; `None` where they come from elsewhere.
    fn median_ms(&self, from: LightSource) -> Option<f64> {
        let made = (0..REPEATS).filter_map(|_| self.made(from));
        let right = made.filter(|made| made.source == from);
        let times_ms: Vec<f64> = right.map(|made| 1e3 * made.seconds).collect();
        median(&times_ms)
    }
}

impl Drop for Making {
    fn drop(&mut self) {
        // It may not be there, and it is in the folder for what may go.
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// Milliseconds of a picture of either scene, in turns.
fn picture_ms(
    gpu: &Gpu,
    scenes: [&LoadedScene; 2],
    mut progress: impl FnMut(f64),
) -> Result<[f64; 2], StageError> {
    let target = PictureTarget::new(gpu, PICTURE)?;
    let stage = |scene| {
        Stage::new(
            gpu,
            scene,
            EngineChoice::Cpu,
            PictureTarget::FORMAT,
            PICTURE,
        )
    };
    let mut stages = [stage(scenes[0])?, stage(scenes[1])?];
    let mut times_ms = [Vec::new(), Vec::new()];
    for stage in &mut stages {
        stage.finish_light(gpu, |_| {})?;
    }
    for round in 0..=ROUNDS {
        for (stage, times_ms) in stages.iter_mut().zip(&mut times_ms) {
            let view = stage.camera(None)?;
            let started = Instant::now();
            stage.draw(gpu, &view, &target.view, false)?;
            gpu.wait()?;
            if round > 0 {
                times_ms.push(1e3 * started.elapsed().as_secs_f64());
            }
        }
        progress(round as f64 / ROUNDS as f64);
    }
    Ok(times_ms.map(|times_ms| median(&times_ms).unwrap_or(0.0)))
}
