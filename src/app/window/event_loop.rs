//! The platform's events, and when to draw.

use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::WindowId;

use super::Options;
use super::scenes::SceneList;
use super::session::{After, Session};
use crate::app::Failure;
use crate::run::Exit;

/// Opens the window and runs until it is closed.
///
/// # Errors
/// What ended the program before that.
pub fn run(events: EventLoop<()>, scenes: SceneList, options: &Options) -> Result<Exit, Failure> {
    let mut app = App {
        options,
        scenes: Some(scenes),
        session: None,
        failure: None,
        next: After::Frame,
    };
    events
        .run_app(&mut app)
        .map_err(|error| Failure::Window(error.to_string()))?;
    match app.failure {
        Some(failure) => Err(failure),
        None => Ok(Exit::Ok),
    }
}

struct App<'a> {
    options: &'a Options,
    /// Until the session takes them.
    scenes: Option<SceneList>,
    session: Option<Session>,
    failure: Option<Failure>,
    /// What the last frame asked for.
    next: After,
}

impl App<'_> {
    fn fail(&mut self, events: &ActiveEventLoop, failure: Failure) {
        self.failure = Some(failure);
        events.exit();
    }
}

impl ApplicationHandler for App<'_> {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        let Some(scenes) = self.scenes.take() else {
            return;
        };
        match Session::open(events, scenes, self.options) {
            Ok(session) => self.session = Some(session),
            Err(failure) => self.fail(events, failure),
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(session) = &mut self.session else {
            return;
        };
        let outcome = match event {
            WindowEvent::CloseRequested | WindowEvent::Destroyed => {
                events.exit();
                return;
            }
            WindowEvent::RedrawRequested => session.frame(),
            event => session.event(&event),
        };
        match outcome {
            Ok(After::Quit) => events.exit(),
            Ok(next) => self.next = next,
            Err(failure) => self.fail(events, failure),
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let Some(session) = &self.session else {
            return;
        };
        let flow = match self.next {
            After::Frame => {
                session.window.request_redraw();
                ControlFlow::Wait
            }
            After::Pause(until) if until <= Instant::now() => {
                session.window.request_redraw();
                ControlFlow::Wait
            }
            After::Pause(until) => ControlFlow::WaitUntil(until),
            After::Event | After::Quit => ControlFlow::Wait,
        };
        events.set_control_flow(flow);
    }

    /// The window closes before the device, whose surface needs it.
    fn exiting(&mut self, _: &ActiveEventLoop) {
        self.session = None;
    }
}

/// The moment `wait` from now, or `None` where that is too far off to mean anything.
pub fn moment(wait: Duration) -> Option<Instant> {
    const LONGEST: Duration = Duration::from_secs(3600);
    (wait < LONGEST).then(|| Instant::now() + wait)
}
