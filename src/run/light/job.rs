//! Light volumes in the making, on threads of their own.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::{JoinHandle, spawn};
use std::time::Instant;

use rayon::ThreadPoolBuilder;

use super::cache::{Found, LightCache};
use crate::bodies::Occluders;
use crate::render::Daylight;
use crate::render::light::{LightGrid, LightTexels, TraceProgress, Visibility};
use crate::scene::LightVolumes;

/// Everything that light volumes are made from.
#[derive(Clone, Debug)]
pub struct LightTask {
    pub settings: LightVolumes,
    pub grid: LightGrid,
    pub occluders: Arc<Occluders>,
    pub cache: LightCache,
    pub daylight: Daylight,
    /// What the cells see, where that is known: then the light alone is worked out.
    pub known: Option<Arc<Visibility>>,
}

/// Where what the cells see comes from.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum LightSource {
    /// It was known.
    Known,
    /// A file of the cache.
    Cache,
    /// Rays were traced.
    Traced,
}

/// Finished light volumes.
#[derive(Clone, Debug)]
pub struct LightMade {
    pub visibility: Arc<Visibility>,
    pub texels: LightTexels,
    pub source: LightSource,
    /// How long it took, in seconds.
    pub seconds: f64,
    /// What went wrong with the cache meanwhile, in sentences; the volumes are right all the same.
    pub notices: Vec<String>,
}

/// Light volumes that another thread is working on. Dropping it ends the work.
#[derive(Debug)]
pub struct LightJob {
    progress: Arc<TraceProgress>,
    cells: usize,
    thread: Option<JoinHandle<Option<LightMade>>>,
}

impl LightTask {
    pub fn key(&self) -> u64 {
        let LightVolumes { rays, seed, .. } = self.settings;
        Visibility::key(&self.grid, rays, seed, self.occluders.hash())
    }

    /// Makes the volumes on this thread and rayon's; `None` once they are no longer wanted.
    pub fn make(&self, progress: &TraceProgress) -> Option<LightMade> {
        let start = Instant::now();
        let mut notices = Vec::new();
        let (visibility, source) = match &self.known {
            Some(known) => (Arc::clone(known), LightSource::Known),
            None => self.cached(&mut notices).map_or_else(
                || {
                    let traced = Arc::new(self.trace(progress)?);
                    self.keep(&traced, &mut notices);
                    Some((traced, LightSource::Traced))
                },
                |cached| Some((Arc::new(cached), LightSource::Cache)),
            )?,
        };
        Some(LightMade {
            texels: LightTexels::new(&visibility, &self.daylight),
            visibility,
            source,
            seconds: start.elapsed().as_secs_f64(),
            notices,
        })
    }

    fn trace(&self, progress: &TraceProgress) -> Option<Visibility> {
        let LightVolumes { rays, seed, .. } = self.settings;
        let sight = |from, along| self.occluders.sight(from, along);
        Visibility::trace(self.grid.clone(), rays, seed, &sight, progress)
    }

    fn cached(&self, notices: &mut Vec<String>) -> Option<Visibility> {
        let (key, LightVolumes { rays, seed, .. }) = (self.key(), self.settings);
        let most = Visibility::file_bytes(&self.grid, rays);
        let read = match self.cache.read(key, most) {
            Found::Missing => return None,
            Found::Unreadable(error) => Err(error.to_string()),
            Found::Bytes(bytes) => {
                Visibility::from_bytes(&bytes, key, self.grid.clone(), rays, seed)
            }
        };
        match read {
            Ok(visibility) => Some(visibility),
            Err(reason) => {
                let file = self.cache.file(key).unwrap_or_default();
                notices.push(format!(
                    "{}: {reason}; the light volumes are worked out anew",
                    file.display()
                ));
                None
            }
        }
    }

    fn keep(&self, visibility: &Visibility, notices: &mut Vec<String>) {
        let key = self.key();
        if let Err(error) = self.cache.write(key, &visibility.to_bytes(key)) {
            let file = self.cache.file(key).unwrap_or_default();
            notices.push(format!(
                "{}: {error}; the light volumes are not kept for the next time (SWARD_CACHE names \
                 another folder)",
                file.display()
            ));
        }
    }
}

impl LightJob {
    /// Begins to make light volumes on one thread less than the machine has, so that drawing goes on.
    pub fn start(task: LightTask) -> Self {
        let progress = Arc::new(TraceProgress::default());
        let (cells, shared) = (task.grid.cells(), Arc::clone(&progress));
        // Threads of its own: rays would keep a sub-step's work waiting on the common ones.
        let spare = rayon::current_num_threads().saturating_sub(1).max(1);
        let work = move || match ThreadPoolBuilder::new().num_threads(spare).build() {
            Ok(pool) => pool.install(|| task.make(&shared)),
            // Threads are short: the common ones are slower for the rest, but right.
            Err(_) => task.make(&shared),
        };
        Self {
            progress,
            cells,
            thread: Some(spawn(work)),
        }
    }

    /// The share that is done, 0…1.
    pub fn done_share(&self) -> f64 {
        self.progress.cells_done.load(Ordering::Relaxed) as f64 / self.cells as f64
    }

    pub fn is_finished(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Waits for the volumes; `None` if the thread ended without any.
    pub fn finish(mut self) -> Option<LightMade> {
        self.thread.take()?.join().ok()?
    }
}

impl Drop for LightJob {
    fn drop(&mut self) {
        self.progress.is_unwanted.store(true, Ordering::Relaxed);
    }
}
