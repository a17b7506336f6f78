//! What an open window holds, and one frame of it.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::dpi::PhysicalSize;
use winit::event::{ElementState, WindowEvent};
use winit::event_loop::ActiveEventLoop;
use winit::keyboard::PhysicalKey;
use winit::window::Window;

use super::Options;
use super::camera::{CameraMode, CameraRig};
use super::canvas::Canvas;
use super::event_loop::moment;
use super::input::Input;
use super::panels::{self, Facts, Shown, Wish};
use super::play::Play;
use super::scenes::SceneList;
use super::surface::{Acquired, WindowSurface};
use super::toast::Toasts;
use super::ui::{Painting, Ui};
use super::{keys, screenshot};
use crate::app::Failure;
use crate::gpu::Gpu;
use crate::render::{BladeDetail, Count, Submission, Transition, View};
use crate::run::StageError;
use crate::run::light::LightNews;

/// Sides of the scene's picture over those of the window, where the processor draws.
const SOFTWARE_SCALE: f64 = 0.5;
/// Blades where the processor draws: about a third of what it draws for a single picture, since
/// a camera that follows the hand matters more than a dense meadow.
const SOFTWARE_DETAIL: BladeDetail = BladeDetail {
    full_m: 2.5,
    reach_m: 40.0,
    tuft: 2,
    count: Count::Distance,
    density: 1.0,
    submission: Submission::Exact,
    transition: Transition::Smooth,
    shadows: true,
    judged_from: None,
    drops_hidden: true,
};
/// Weight of the newest frame in the smoothed time of a frame.
const FRAME_WEIGHT: f64 = 0.1;
/// How soon a frame that the surface refused is tried again.
const RETRY: Duration = Duration::from_millis(20);
/// How often messages, and light volumes in the making, are looked at while nothing else moves.
const TOAST_TICK: Duration = Duration::from_millis(250);

/// What to do after an event or a frame.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum After {
    /// Draw the next frame at once.
    Frame,
    /// Draw at this moment, or at the next event.
    Pause(Instant),
    /// Draw at the next event.
    Event,
    Quit,
}

/// An open window.
///
/// The surface is dropped before the window it belongs to.
pub struct Session {
    surface: WindowSurface,
    pub(super) gpu: Gpu,
    ui: Ui,
    canvas: Canvas,
    pub(super) play: Play,
    pub(super) rig: CameraRig,
    pub(super) input: Input,
    pub(super) toasts: Toasts,
    pub(super) shown: Shown,
    /// A picture is wanted of the next frame.
    pub(super) wants_picture: bool,
    out: PathBuf,
    scale: f64,
    /// When the last frame began; `None` if the window has waited for an event since.
    last_frame: Option<Instant>,
    frame_ms: f64,
    pub window: Arc<Window>,
}

impl Session {
    /// Opens the window, the device and the current scene.
    ///
    /// # Errors
    /// No window, no adapter for it, an invalid scene.
    pub fn open(
        events: &ActiveEventLoop,
        scenes: SceneList,
        options: &Options,
    ) -> Result<Self, Failure> {
        let [width, height] = options.size;
        let attributes = Window::default_attributes()
            .with_title("sward")
            .with_inner_size(PhysicalSize::new(width, height));
        let window = events
            .create_window(attributes)
            .map_err(|error| Failure::Window(error.to_string()))?;
        let window = Arc::new(window);
        let display = events.owned_display_handle();
        let (mut surface, gpu) = WindowSurface::open(display, Arc::clone(&window))?;
        surface.resize(&gpu, window.inner_size())?;
        let scale = if gpu.adapter.is_software {
            SOFTWARE_SCALE
        } else {
            1.0
        };
        let size = surface.size().unwrap_or(options.size);
        let canvas = Canvas::new(&gpu, size, scale)?;
        let mut play = Play::new(&gpu, scenes, options.engine, canvas.scene_size())?;
        if gpu.adapter.is_software {
            play.stage.detail = SOFTWARE_DETAIL;
        }
        play.stage.detail.density = options.density;
        play.stage.detail.count = options.count;
        let mut session = Self {
            ui: Ui::new(&gpu, &window),
            surface,
            gpu,
            canvas,
            play,
            rig: CameraRig::default(),
            input: Input::default(),
            toasts: Toasts::default(),
            shown: Shown {
                panels: true,
                help: false,
            },
            wants_picture: false,
            out: options.out.clone(),
            scale,
            last_frame: None,
            frame_ms: 0.0,
            window,
        };
        session.start_camera();
        Ok(session)
    }

    /// Takes in an event.
    ///
    /// # Errors
    /// What the device refuses and the program cannot go on without.
    pub fn event(&mut self, event: &WindowEvent) -> Result<After, Failure> {
        self.ui.event(&self.window, event);
        match event {
            WindowEvent::Resized(size) => self.surface.resize(&self.gpu, *size)?,
            WindowEvent::Focused(false) => self.input.release_all(),
            WindowEvent::ModifiersChanged(modifiers) => self.input.modifiers = modifiers.state(),
            WindowEvent::KeyboardInput { event, .. } => {
                if let PhysicalKey::Code(code) = event.physical_key
                    && self.input.key(code, event.state)
                {
                    if keys::quits(code, self.input.modifiers) {
                        return Ok(After::Quit);
                    }
                    if let Some(command) = keys::command(code) {
                        self.obey(command);
                    }
                }
            }
            WindowEvent::CursorLeft { .. } if !self.input.is_dragging() => {
                self.input.pointer_px = None;
            }
            WindowEvent::CursorMoved { position, .. } => {
                let rows = f64::from(self.canvas.size()[1]);
                self.input.motion(*position, &mut self.rig, rows);
            }
            WindowEvent::MouseInput { state, button, .. } => self.press(*button, *state),
            WindowEvent::MouseWheel { delta, .. } if !self.is_pointer_in_panel() => {
                self.input.wheel(*delta, &mut self.rig);
            }
            _ => {}
        }
        Ok(After::Frame)
    }

    fn press(&mut self, button: winit::event::MouseButton, state: ElementState) {
        let in_panel = self.is_pointer_in_panel();
        if self.input.button(button, state, in_panel)
            && let Some((view, ray)) = self.pointer_ray()
        {
            self.play.select(&view, ray);
        }
    }

    fn is_pointer_in_panel(&self) -> bool {
        let place = self.input.pointer_px;
        place.is_some_and(|place| self.ui.is_panel_at(place))
    }

    /// The view, and the direction from its eye through the pointer; `None` without a pointer in
    /// the picture.
    pub(super) fn pointer_ray(&self) -> Option<(View, crate::base::Vec3<f64>)> {
        let [x, y] = self.input.pointer_px?;
        let [width, height] = self.canvas.size().map(f64::from);
        let inside = (0.0..width).contains(&x) && (0.0..height).contains(&y);
        let view = self.rig.view();
        inside.then(|| (view, view.ray(width / height, x / width, y / height)))
    }

    /// Simulates, draws and shows one frame.
    ///
    /// # Errors
    /// What the program cannot go on without: the device, or a window it can draw on.
    pub fn frame(&mut self) -> Result<After, Failure> {
        let Some(size) = self.surface.size() else {
            return Ok(After::Event);
        };
        let Acquired::Frame(texture) = self.surface.acquire(&self.gpu)? else {
            return Ok(moment(RETRY).map_or(After::Frame, After::Pause));
        };
        let frame_s = self.clock();
        if let Err(error) = self.advance(frame_s) {
            self.toasts.error(error);
        }
        if let Some(error) = self.play.news_of_device() {
            self.toasts.error(error);
        }
        self.move_camera(frame_s);
        if let Err(error) = self.draw_scene(size) {
            // A lost device ends the program; anything else may pass with the next frame.
            self.gpu.check()?;
            self.toasts.error(error);
        }
        self.tell_of_light();
        let (painting, wishes) = self.panels();
        let repaint_after = painting.repaint_after;
        self.show(texture, painting);
        self.gpu.check()?;
        if std::mem::take(&mut self.wants_picture) {
            self.save_picture();
        }
        let acted = !wishes.is_empty();
        for wish in wishes {
            match wish {
                Wish::Do(command) => self.obey(command),
                Wish::Scene(line) => self.choose(line),
                Wish::Density(factor) => self.play.stage.detail.density = factor,
                Wish::Colour { kind, hsv } => self.recolour(kind, hsv),
            }
        }
        Ok(self.after(acted, repaint_after))
    }

    /// Seconds since the last frame; none after a wait, which is nobody's delay.
    fn clock(&mut self) -> f64 {
        let now = Instant::now();
        let Some(before) = self.last_frame.replace(now) else {
            return 0.0;
        };
        let frame_s = (now - before).as_secs_f64();
        if self.frame_ms == 0.0 {
            self.frame_ms = 1e3 * frame_s;
        }
        self.frame_ms += FRAME_WEIGHT * (1e3 * frame_s - self.frame_ms);
        frame_s
    }

    fn advance(&mut self, frame_s: f64) -> Result<(), StageError> {
        self.play.drive(self.input.arrows())?;
        self.play.advance(frame_s)
    }

    fn move_camera(&mut self, frame_s: f64) {
        self.input.fly(&mut self.rig, frame_s);
        if let CameraMode::Scene(place) = self.rig.mode {
            self.follow_scene_camera(place);
        }
        let ground = &self.play.stage.meadow().field.ground;
        self.rig.stay_above(|x, z| ground.height_in_world(x, z));
    }

    fn draw_scene(&mut self, size: [u32; 2]) -> Result<(), StageError> {
        self.canvas.resize(&self.gpu, size, self.scale)?;
        let stage = &mut self.play.stage;
        stage.resize(&self.gpu, self.canvas.scene_size())?;
        let (view, overlay) = (self.rig.view(), self.play.overlay);
        stage.draw(&self.gpu, &view, self.canvas.scene_view(), overlay)
    }

    fn tell_of_light(&mut self) {
        for news in self.play.stage.take_light_news() {
            match news {
                LightNews::Told(text) => self.toasts.news(text),
                LightNews::Trouble(text) => self.toasts.error(text),
            }
        }
    }

    fn panels(&mut self) -> (Painting, Vec<Wish>) {
        let facts = Facts {
            play: &self.play,
            adapter: &self.gpu.adapter,
            frame_ms: self.frame_ms,
            camera: &self.rig.mode,
            speed_m_per_s: self.rig.speed_m_per_s,
            scale: self.scale,
        };
        let (shown, toasts) = (self.shown, &mut self.toasts);
        let mut wishes = Vec::new();
        let painting = self.ui.pass(&self.window, |ui| {
            wishes.extend(panels::show(ui, &facts, shown, toasts));
        });
        (painting, wishes)
    }

    /// Brings the scene and the panels into the window.
    fn show(&mut self, texture: wgpu::SurfaceTexture, painting: Painting) {
        let gpu = &self.gpu;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.canvas.enlarge_scene(gpu, &mut encoder);
        let (target, size) = (self.canvas.window_view(), self.canvas.size());
        self.ui.paint(gpu, &mut encoder, target, size, painting);
        let shown = texture.texture.create_view(&Default::default());
        self.canvas.present(gpu, &mut encoder, &shown);
        gpu.queue.submit([encoder.finish()]);
        self.window.pre_present_notify();
        gpu.queue.present(texture);
    }

    fn save_picture(&mut self) {
        let picture = self.canvas.read(&self.gpu);
        let saved = picture
            .map_err(Failure::from)
            .and_then(|picture| screenshot::save(&picture, &self.play.stage, &self.gpu, &self.out));
        match saved {
            Ok(path) => self.toasts.news(format!("saved {}", path.display())),
            Err(error) => self.toasts.error(error),
        }
    }

    fn after(&mut self, acted: bool, repaint_after: Duration) -> After {
        let moves = !self.play.paused || self.input.is_flying();
        if acted || moves || self.wants_picture || repaint_after.is_zero() {
            return After::Frame;
        }
        self.last_frame = None;
        let has_toasts = self.toasts.current().next().is_some();
        let is_lit_later = self.play.stage.pending_light().is_some();
        let wait = if has_toasts || is_lit_later {
            repaint_after.min(TOAST_TICK)
        } else {
            repaint_after
        };
        moment(wait).map_or(After::Event, After::Pause)
    }
}
