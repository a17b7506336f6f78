//! What is held: keys, buttons, modifiers, and whose drag it is.

use std::collections::HashSet;

use winit::dpi::PhysicalPosition;
use winit::event::{ElementState, MouseButton, MouseScrollDelta};
use winit::keyboard::{KeyCode, ModifiersState};

use super::camera::{CameraMode, CameraRig};

/// Pixels that count as one notch of a wheel without notches.
const PIXELS_PER_NOTCH: f64 = 50.0;
/// A press that moves less than this many pixels is a click.
const CLICK_PX: f64 = 4.0;

/// A drag begun in the picture. One begun in a panel is the panel's and never gets here.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Drag {
    button: MouseButton,
    moved_px: f64,
}

/// Keys, buttons and pointer as they are now.
#[derive(Debug, Default)]
pub struct Input {
    held: HashSet<KeyCode>,
    pub modifiers: ModifiersState,
    /// In pixels from the upper left corner; `None` outside the window.
    pub pointer_px: Option<[f64; 2]>,
    drag: Option<Drag>,
}

impl Input {
    /// Takes in a key; true if it has just gone down.
    pub fn key(&mut self, code: KeyCode, state: ElementState) -> bool {
        match state {
            ElementState::Pressed => self.held.insert(code),
            ElementState::Released => {
                self.held.remove(&code);
                false
            }
        }
    }

    /// Lets go of everything: the window has lost the keyboard and will not hear of releases.
    pub fn release_all(&mut self) {
        self.held.clear();
        self.drag = None;
    }

    /// Takes in a button; `in_panel` tells that the press belongs to a panel. True for a click of
    /// the left button in the picture.
    pub fn button(&mut self, button: MouseButton, state: ElementState, in_panel: bool) -> bool {
        match state {
            ElementState::Pressed if self.drag.is_none() && !in_panel => {
                self.drag = Some(Drag {
                    button,
                    moved_px: 0.0,
                });
                false
            }
            ElementState::Released if self.drag.is_some_and(|d| d.button == button) => {
                let drag = self.drag.take();
                button == MouseButton::Left && drag.is_some_and(|d| d.moved_px < CLICK_PX)
            }
            _ => false,
        }
    }

    /// Moves the pointer, and the camera if a drag is on. `rows_px` is the picture's height.
    pub fn motion(&mut self, to: PhysicalPosition<f64>, rig: &mut CameraRig, rows_px: f64) {
        let to = [to.x, to.y];
        let before = self.pointer_px.replace(to).unwrap_or(to);
        let way = [to[0] - before[0], to[1] - before[1]];
        let Some(drag) = &mut self.drag else {
            return;
        };
        drag.moved_px += way[0].hypot(way[1]);
        if drag.moved_px < CLICK_PX {
            return;
        }
        let shift = self.modifiers.shift_key();
        match drag.button {
            MouseButton::Right => {
                rig.mode = CameraMode::Fly;
                rig.look(way);
            }
            MouseButton::Middle if shift => rig.pan(way, rows_px),
            MouseButton::Left if !self.modifiers.alt_key() && rig.mode == CameraMode::Fly => {
                rig.look(way);
            }
            MouseButton::Middle | MouseButton::Left => {
                rig.mode = CameraMode::Orbit;
                rig.orbit(way);
            }
            _ => {}
        }
    }

    /// Turns the wheel: speed while flying, distance otherwise.
    pub fn wheel(&self, delta: MouseScrollDelta, rig: &mut CameraRig) {
        let notches = match delta {
            MouseScrollDelta::LineDelta(_, lines) => f64::from(lines),
            MouseScrollDelta::PixelDelta(way) => way.y / PIXELS_PER_NOTCH,
        };
        if self.is_flying() {
            rig.change_speed(notches);
        } else {
            if rig.mode != CameraMode::Fly {
                rig.mode = CameraMode::Orbit;
            }
            rig.zoom(notches);
        }
    }

    /// Flies for a frame while the right button is held. True if the camera moved.
    pub fn fly(&self, rig: &mut CameraRig, frame_s: f64) -> bool {
        let way = [
            self.axis(KeyCode::KeyA, KeyCode::KeyD),
            self.axis(KeyCode::KeyQ, KeyCode::KeyE),
            self.axis(KeyCode::KeyS, KeyCode::KeyW),
        ];
        let moves = self.is_flying() && way != [0.0; 3];
        if moves {
            rig.mode = CameraMode::Fly;
            rig.fly(way, frame_s);
        }
        moves
    }

    /// Right and ahead as the arrows say, each −1, 0 or 1.
    pub fn arrows(&self) -> [i8; 2] {
        [
            self.axis(KeyCode::ArrowLeft, KeyCode::ArrowRight) as i8,
            self.axis(KeyCode::ArrowDown, KeyCode::ArrowUp) as i8,
        ]
    }

    /// Whether the right button is held in the picture.
    pub fn is_flying(&self) -> bool {
        self.drag.is_some_and(|d| d.button == MouseButton::Right)
    }

    /// Whether a drag of the picture is on.
    pub fn is_dragging(&self) -> bool {
        self.drag.is_some()
    }

    fn axis(&self, less: KeyCode, more: KeyCode) -> f64 {
        let held = |code| f64::from(u8::from(self.held.contains(&code)));
        held(more) - held(less)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drag(input: &mut Input, rig: &mut CameraRig, button: MouseButton, in_panel: bool) -> bool {
        input.motion(PhysicalPosition::new(100.0, 100.0), rig, 400.0);
        input.button(button, ElementState::Pressed, in_panel);
        input.motion(PhysicalPosition::new(140.0, 90.0), rig, 400.0);
        input.button(button, ElementState::Released, false)
    }

    #[test]
    fn a_drag_begun_in_a_panel_never_moves_the_camera() {
        let (mut input, mut rig) = (Input::default(), CameraRig::default());
        let before = rig.view();
        for button in [MouseButton::Left, MouseButton::Middle, MouseButton::Right] {
            assert!(!drag(&mut input, &mut rig, button, true));
            assert_eq!(rig.view(), before);
        }
        assert!(!drag(&mut input, &mut rig, MouseButton::Left, false));
        assert_ne!(rig.view(), before);
    }

    #[test]
    fn a_short_press_is_a_click_and_moves_nothing() {
        let (mut input, mut rig) = (Input::default(), CameraRig::default());
        let before = rig.view();
        input.motion(PhysicalPosition::new(10.0, 10.0), &mut rig, 400.0);
        input.button(MouseButton::Left, ElementState::Pressed, false);
        input.motion(PhysicalPosition::new(11.0, 10.0), &mut rig, 400.0);
        assert!(input.button(MouseButton::Left, ElementState::Released, false));
        assert_eq!(rig.view(), before);
    }

    #[test]
    fn keys_fly_only_while_the_right_button_is_held() {
        let (mut input, mut rig) = (Input::default(), CameraRig::default());
        assert!(input.key(KeyCode::KeyW, ElementState::Pressed));
        assert!(!input.key(KeyCode::KeyW, ElementState::Pressed), "a repeat");
        assert!(!input.fly(&mut rig, 0.1));
        input.button(MouseButton::Right, ElementState::Pressed, false);
        assert!(input.fly(&mut rig, 0.1));
        input.release_all();
        assert!(!input.fly(&mut rig, 0.1));
    }
}
