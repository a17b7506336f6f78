//! The window: a meadow to play with and to watch.
//!
//! [`event_loop`] takes the platform's events, [`session`] is what is open: the surface, the
//! scene on its stage, the camera, the panels. Without a display [`headless`] takes over.

mod camera;
mod canvas;
mod event_loop;
mod headless;
mod input;
mod keys;
mod panels;
mod plant_panel;
mod play;
mod scenes;
mod screenshot;
mod session;
mod surface;
mod toast;
mod tools;
mod ui;

use std::io::Write;
use std::path::PathBuf;

use winit::event_loop::EventLoop;

use super::{Failure, complain};
use crate::render::Count;
use crate::run::{EngineChoice, Exit};
use scenes::SceneList;

/// How to open the window.
#[derive(Clone, Debug)]
pub struct Options {
    /// A scene's file, or the name of one of the program's own; `None` for the default one.
    pub scene: Option<PathBuf>,
    /// Folders in which assets are looked up, after the scene's own.
    pub assets: Vec<PathBuf>,
    pub engine: EngineChoice,
    /// Width and height of the window's inside, in pixels.
    pub size: [u32; 2],
    /// Factor of the number of plants drawn.
    pub density: f32,
    /// What decides how many plants are drawn.
    pub count: Count,
    /// Folder for pictures.
    pub out: PathBuf,
}

/// Opens the window and returns when it is closed. Without a display it says so, runs the scene
/// headless, writes a picture where there is an adapter, and prints what it did.
///
/// # Errors
/// An invalid scene; no adapter for the window; what the device or a file refuses.
pub fn open(options: &Options, out: &mut impl Write) -> Result<Exit, Failure> {
    let scenes = SceneList::new(options.scene.as_deref(), &options.assets)?;
    if let Some(missing) = missing_display() {
        return headless::run(&missing, &scenes, options, out);
    }
    match EventLoop::builder().build() {
        Ok(events) => event_loop::run(events, scenes, options),
        Err(error) => headless::run(&error.to_string(), &scenes, options, out),
    }
}

/// What is missing for a window, as far as the environment tells.
fn missing_display() -> Option<String> {
    let names = ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"];
    let is_set = |name: &&str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let needed = cfg!(all(unix, not(target_os = "macos")));
    (needed && !names.iter().any(is_set))
        .then(|| "neither WAYLAND_DISPLAY nor DISPLAY is set".to_owned())
}
