//! A scene that is simulated and drawn: what a window, a picture and an embedding program share.

use std::sync::Arc;

use crate::bodies::{Bodies, BodyError};
use crate::gpu::billboards::GpuBillboards;
use crate::gpu::{Gpu, GpuError, GrassKernels, PassTimer, TickError};
use crate::render::{
    ActiveBillboards, ActiveNodes, BillboardCounts, BillboardNodes, BladeCounts, BladeDetail,
    BladesInput, Exposure, FrameInput, GroundLook, RenderError, Renderer, Sun, View, active_slabs,
    bodies_at, scene_view, tile_marks,
};
use crate::scene::assets::Assets;
use crate::scene::{Action, Camera, Likes, LoadedScene};
use crate::sim::{Meadow, MeadowError};
use crate::terrain::ColourMap;

mod light;

use light::light_of;

use super::engine::{Engine, EngineChoice};
use super::light::StageLight;
use super::scenario::Outcome;
use super::timeline::Timeline;

/// Longest time that one displayed frame may add, in seconds: a window that was hidden does not
/// have to catch up.
const LONGEST_FRAME_S: f64 = 0.25;
/// Passes of a frame that are timed.
const DRAWN_PASSES: usize = 12;

/// A scene with its engine, and the renderer that shows it.
pub struct Stage {
    loaded: LoadedScene,
    meadow: Meadow,
    engine: Engine,
    /// What the cpu engine's grass is drawn from.
    nodes: ActiveNodes,
    billboards: ActiveBillboards,
    renderer: Renderer,
    kernels: GrassKernels,
    timer: PassTimer,
    timeline: Timeline,
    /// None where the scene does not ask for light volumes.
    light: Option<StageLight>,
    /// Body shapes the renderer knows.
    shapes: [usize; 2],
    pub sun: Sun,
    pub exposure: Exposure,
    pub detail: BladeDetail,
    /// Whether the overlay has boxes around tiles at rest, too; without them it is that of figure 8 of O09.
    pub resting_boxes: bool,
}

/// Why a stage cannot be set or shown.
#[derive(Debug, thiserror::Error)]
pub enum StageError {
    #[error(transparent)]
    Meadow(#[from] MeadowError),
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Render(#[from] RenderError),
    #[error("the light volumes: {0}")]
    Light(BodyError),
    #[error("the scene has no camera '{name}'; it has {known}")]
    UnknownCamera { name: String, known: String },
}

impl From<TickError> for StageError {
    fn from(error: TickError) -> Self {
        match error {
            TickError::Meadow(error) => Self::Meadow(error),
            TickError::Gpu(error) => Self::Gpu(error),
        }
    }
}

impl Stage {
    /// Lays a scene out, for pictures of a format and size.
    ///
    /// # Errors
    ///
    /// A scene that cannot be laid out, or one that the device cannot hold.
    pub fn new(
        gpu: &Gpu,
        loaded: &LoadedScene,
        choice: EngineChoice,
        format: wgpu::TextureFormat,
        size: [u32; 2],
    ) -> Result<Self, StageError> {
        let kernels = GrassKernels::new(gpu)?;
        let (meadow, engine) = lay_out(gpu, &kernels, loaded, choice)?;
        Self::around(gpu, loaded, (meadow, engine, kernels), format, size)
    }

    /// Puts the end of a run on stage. Where it ran on a device, `gpu` is that device.
    ///
    /// # Errors
    ///
    /// A scene that the device cannot hold.
    pub fn of_run(
        gpu: &Gpu,
        loaded: &LoadedScene,
        outcome: Outcome,
        format: wgpu::TextureFormat,
        size: [u32; 2],
    ) -> Result<Self, StageError> {
        let running = (outcome.meadow, outcome.engine, GrassKernels::new(gpu)?);
        Self::around(gpu, loaded, running, format, size)
    }

    fn around(
        gpu: &Gpu,
        loaded: &LoadedScene,
        (meadow, engine, kernels): (Meadow, Engine, GrassKernels),
        format: wgpu::TextureFormat,
        size: [u32; 2],
    ) -> Result<Self, StageError> {
        let mut renderer = Renderer::new(gpu, format, size)?;
        show(gpu, &mut renderer, &meadow, &loaded.assets)?;
        Ok(Self {
            nodes: ActiveNodes::new(gpu)?,
            billboards: ActiveBillboards::new(gpu)?,
            timer: PassTimer::new(gpu, DRAWN_PASSES),
            timeline: new_timeline(&meadow),
            shapes: known_shapes(&meadow.bodies),
            sun: Sun::default(),
            exposure: Exposure::default(),
            detail: BladeDetail::of_device(gpu),
            light: light_of(gpu, &renderer, &meadow)?,
            resting_boxes: true,
            loaded: loaded.clone(),
            meadow,
            engine,
            renderer,
            kernels,
        })
    }

    /// Puts another scene on the stage, or the same one at its start, and keeps what is compiled.
    ///
    /// # Errors
    ///
    /// As for [`Stage::new`]; then the old scene goes on.
    pub fn set_scene(
        &mut self,
        gpu: &Gpu,
        loaded: &LoadedScene,
        choice: EngineChoice,
    ) -> Result<(), StageError> {
        let (meadow, engine) = lay_out(gpu, &self.kernels, loaded, choice)?;
        let light = light_of(gpu, &self.renderer, &meadow)?;
        show(gpu, &mut self.renderer, &meadow, &loaded.assets)?;
        self.renderer.set_light(gpu, None)?;
        self.light = light;
        self.timeline = new_timeline(&meadow);
        self.shapes = known_shapes(&meadow.bodies);
        self.loaded = loaded.clone();
        self.meadow = meadow;
        self.engine = engine;
        Ok(())
    }

    /// Gives the kind of plant at a place of the scene's list another ground to like; the meadow grows
    /// anew at once. Bodies, wind and time go on. All grass comes to rest, since a bent plant may be of
    /// another kind now, or gone: what a body still touches is pushed with the next sub-step, and
    /// imprints are lost. The state hash begins a new chain.
    ///
    /// # Errors
    ///
    /// A kind that the scene lacks or that likes no ground, a value outside its range: then nothing has
    /// changed. After the device's refusal the stage needs [`Stage::set_scene`].
    pub fn set_likes(&mut self, gpu: &Gpu, kind: usize, likes: Likes) -> Result<(), StageError> {
        self.meadow.set_likes(kind, likes)?;
        self.engine = self.engine.at_rest(gpu, &self.kernels, &mut self.meadow)?;
        show(gpu, &mut self.renderer, &self.meadow, &self.loaded.assets)
    }

    /// The scene as it was read.
    pub fn loaded(&self) -> &LoadedScene {
        &self.loaded
    }

    pub fn meadow(&self) -> &Meadow {
        &self.meadow
    }

    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// Simulates one sub-step.
    ///
    /// # Errors
    ///
    /// An event of the script that cannot happen; what the device refuses.
    pub fn tick(&mut self) -> Result<(), StageError> {
        Ok(self.engine.tick(&mut self.meadow)?)
    }

    /// Simulates the sub-steps that are due after a displayed frame of `frame_s`, and tells how
    /// many they were. A frame longer than a tenth of a second counts as that.
    ///
    /// # Errors
    ///
    /// As for [`Stage::tick`].
    pub fn advance(&mut self, frame_s: f64) -> Result<u32, StageError> {
        let due = self.timeline.advance(frame_s);
        for _ in 0..due {
            self.tick()?;
        }
        Ok(due)
    }

    /// Seconds of displayed time that were not simulated, because frames took too long.
    pub fn discarded_s(&self) -> f64 {
        self.timeline.discarded_s
    }

    /// Lets something happen to the bodies or the wind now.
    ///
    /// # Errors
    ///
    /// An action that cannot be done; then nothing has changed.
    pub fn act(&mut self, action: &Action) -> Result<(), StageError> {
        Ok(self.meadow.act(action)?)
    }

    /// The view of a camera by its name, as of now. Without a name the scene's first camera; a
    /// scene without cameras frames its bodies.
    ///
    /// # Errors
    ///
    /// `UnknownCamera`.
    pub fn camera(&self, name: Option<&str>) -> Result<View, StageError> {
        let cameras = &self.meadow.scene.cameras;
        let camera = match name {
            None => cameras.first(),
            Some(name) => Some(named_camera(cameras, name)?),
        };
        Ok(scene_view(&self.meadow, camera))
    }

    /// Makes pictures of another size from now on; the same size costs nothing.
    ///
    /// # Errors
    ///
    /// A size the device cannot hold; the old one stays.
    pub fn resize(&mut self, gpu: &Gpu, size: [u32; 2]) -> Result<(), StageError> {
        Ok(self.renderer.resize(gpu, size)?)
    }

    /// Width and height of the pictures, in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.renderer.size()
    }

    /// Draws the scene as it is after the last sub-step; `overlay` adds boxes around tiles that
    /// are awake.
    ///
    /// # Errors
    ///
    /// The device's.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        view: &View,
        target: &wgpu::TextureView,
        overlay: bool,
    ) -> Result<(), StageError> {
        self.take_in_shapes(gpu)?;
        if let Some(light) = &mut self.light {
            light.follow(gpu, &mut self.renderer, self.sun)?;
        }
        let meadow = &self.meadow;
        match &mut self.engine {
            Engine::Cpu(grass) => {
                self.nodes.copy(gpu, meadow, grass)?;
                self.billboards.copy(gpu, meadow, grass)?;
            }
            Engine::Reference(grass) => {
                self.nodes.copy(gpu, meadow, grass.as_ref())?;
                self.billboards.copy(gpu, meadow, grass.as_ref())?;
            }
            Engine::Gpu(engine) => engine.grass.recover()?,
        }
        let slabs = active_slabs(meadow);
        let (active, active_nodes) = match &self.engine {
            Engine::Cpu(_) | Engine::Reference(_) => (&self.nodes.tiles, &self.nodes.nodes),
            Engine::Gpu(engine) => (&slabs, engine.grass.drawn()),
        };
        let on_device = match &self.engine {
            Engine::Gpu(engine) => engine.grass.billboards.as_ref(),
            Engine::Cpu(_) | Engine::Reference(_) => None,
        };
        let on_device = on_device.map(|billboards| billboards.drawn(meadow));
        let billboards = match &on_device {
            Some((tiles, nodes)) => BillboardNodes { tiles, nodes },
            None => self.billboards.drawn(),
        };
        let marks = if overlay {
            tile_marks(meadow, self.resting_boxes.then_some(view.eye_in_world))
        } else {
            Vec::new()
        };
        let input = FrameInput {
            view,
            sun: self.sun,
            exposure: self.exposure,
            // The grass is that of the last tick's end, and so are the bodies.
            bodies: &bodies_at(meadow, 1.0),
            blades: Some(BladesInput {
                field: &meadow.field,
                wind: &meadow.work.wind,
                active,
                active_nodes,
                billboards: Some(billboards),
                detail: self.detail,
            }),
            marks: &marks,
            time_s: meadow.time_s(),
        };
        Ok(self.renderer.draw(gpu, &input, target, &mut self.timer)?)
    }

    /// What the last picture drew of the billboards; `None` in a scene without them.
    pub fn billboard_counts(&self) -> Option<BillboardCounts> {
        self.renderer.billboard_counts()
    }

    /// Bytes on the device of the billboards' records, state and geometry, without their pictures; `None`
    /// in a scene without them.
    pub fn billboard_bytes(&self) -> Option<u64> {
        let drawn = self.renderer.billboard_counts()?;
        let simulated = match &self.engine {
            // Its nodes are those that are drawn.
            Engine::Gpu(engine) => {
                let bytes = engine.grass.billboards.as_ref().map(GpuBillboards::bytes);
                bytes.unwrap_or_default().iter().sum()
            }
            Engine::Cpu(_) | Engine::Reference(_) => drawn.nodes_bytes,
        };
        Some(drawn.state_bytes + simulated)
    }

    /// What the last picture drew of the plants.
    pub fn blade_counts(&self) -> BladeCounts {
        self.renderer.blade_counts()
    }

    /// Median milliseconds of each pass of the simulation (on the device) and of drawing, over
    /// the last frames; empty where the device has no timestamps.
    pub fn pass_ms(&self) -> Vec<(&'static str, f64)> {
        let mut passes = self.engine.device_pass_ms();
        passes.extend(self.timer.medians_ms());
        passes
    }

    /// Hands the renderer the shapes of bodies that came up since the last picture.
    fn take_in_shapes(&mut self, gpu: &Gpu) -> Result<(), RenderError> {
        let bodies = &self.meadow.bodies;
        let known = known_shapes(bodies);
        if known != self.shapes {
            self.renderer
                .set_shapes(gpu, bodies.shapes(), bodies.coated())?;
            self.shapes = known;
        }
        Ok(())
    }
}

fn lay_out(
    gpu: &Gpu,
    kernels: &GrassKernels,
    loaded: &LoadedScene,
    choice: EngineChoice,
) -> Result<(Meadow, Engine), StageError> {
    let mut meadow = Meadow::new(loaded.scene.clone(), &loaded.assets)?;
    let engine = if choice == EngineChoice::Reference {
        Engine::reference(&mut meadow)
    } else if choice.is_gpu_on(gpu) {
        Engine::gpu(gpu, kernels, &mut meadow)?
    } else {
        Engine::cpu()
    };
    Ok((meadow, engine))
}

fn show(
    gpu: &Gpu,
    renderer: &mut Renderer,
    meadow: &Meadow,
    assets: &Assets,
) -> Result<(), StageError> {
    let terrain = &meadow.scene.terrain;
    let map = match &meadow.field.seeds.kinds {
        Some(kinds) => Arc::clone(&kinds.map),
        None => Arc::new(
            ColourMap::of(terrain, &meadow.field.ground, assets).map_err(MeadowError::from)?,
        ),
    };
    let look = GroundLook {
        map: &map,
        soil_rgb: terrain.soil_rgb,
    };
    let bodies = &meadow.bodies;
    Ok(renderer.set_scene(gpu, &meadow.field, &look, bodies.shapes(), bodies.coated())?)
}

/// How many shapes, and coats on them, there are.
fn known_shapes(bodies: &Bodies) -> [usize; 2] {
    [bodies.shapes().len(), bodies.coated().len()]
}

fn new_timeline(meadow: &Meadow) -> Timeline {
    Timeline::limited(meadow.scene.solver.substep_s, LONGEST_FRAME_S)
}

fn named_camera<'a>(cameras: &'a [Camera], name: &str) -> Result<&'a Camera, StageError> {
    let found = cameras.iter().find(|camera| camera.name == name);
    found.ok_or_else(|| {
        let names: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
        StageError::UnknownCamera {
            name: name.to_owned(),
            known: if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            },
        }
    })
}
