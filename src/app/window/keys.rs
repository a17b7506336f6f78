//! Keys and what they do: one table for the input and the help.

use winit::keyboard::{KeyCode, ModifiersState};

/// What a key does once when it goes down.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Command {
    Pause,
    Step,
    Restart,
    PreviousScene,
    NextScene,
    DropBall,
    TileOverlay,
    AwakeTiles,
    CameraMode,
    FrameAll,
    FrameBody,
    Panels,
    Help,
    Screenshot,
    CloseHelp,
}

/// A key, its name and what it does.
pub struct Binding {
    pub code: KeyCode,
    pub key: &'static str,
    pub command: Command,
    pub help: &'static str,
}

const fn bind(code: KeyCode, key: &'static str, command: Command, help: &'static str) -> Binding {
    Binding {
        code,
        key,
        command,
        help,
    }
}

/// Every key that acts when it goes down.
pub const BINDINGS: &[Binding] = &[
    bind(KeyCode::KeyP, "P", Command::Pause, "pause, go on"),
    bind(
        KeyCode::KeyO,
        "O",
        Command::Step,
        "one frame (1/60 s), then pause",
    ),
    bind(
        KeyCode::KeyR,
        "R",
        Command::Restart,
        "start the scene again",
    ),
    bind(
        KeyCode::BracketLeft,
        "[",
        Command::PreviousScene,
        "scene before",
    ),
    bind(KeyCode::BracketRight, "]", Command::NextScene, "next scene"),
    bind(
        KeyCode::KeyB,
        "B",
        Command::DropBall,
        "drop a ball at the pointer",
    ),
    bind(
        KeyCode::KeyT,
        "T",
        Command::TileOverlay,
        "show the states of tiles",
    ),
    bind(
        KeyCode::Digit8,
        "8",
        Command::AwakeTiles,
        "show colliding and recovering tiles alone",
    ),
    bind(
        KeyCode::KeyC,
        "C",
        Command::CameraMode,
        "next camera: orbit, fly, the scene's own",
    ),
    bind(
        KeyCode::Home,
        "Home",
        Command::FrameAll,
        "look at everything",
    ),
    bind(
        KeyCode::KeyF,
        "F",
        Command::FrameBody,
        "look at the selected body (click one)",
    ),
    bind(
        KeyCode::Tab,
        "Tab",
        Command::Panels,
        "show or hide the panels",
    ),
    bind(KeyCode::F1, "F1", Command::Help, "this help"),
    bind(
        KeyCode::F12,
        "F12",
        Command::Screenshot,
        "save a picture of the window",
    ),
    bind(
        KeyCode::Escape,
        "Esc",
        Command::CloseHelp,
        "close this help",
    ),
];

/// What is held or dragged: a name and what it does.
pub const HELD: &[(&str, &str)] = &[
    ("Right drag", "look around"),
    (
        "Right + W A S D, Q E",
        "fly; Q down, E up; the wheel changes the speed",
    ),
    ("Middle or Alt+left drag", "orbit"),
    ("Shift+middle drag", "pan"),
    ("Left drag", "orbit, or look around in the fly camera"),
    ("Wheel", "nearer, farther"),
    ("Arrows", "drive the vehicle, where the scene has one"),
    ("Ctrl+Q", "quit"),
];

/// What a key does, if it does something when it goes down.
pub fn command(code: KeyCode) -> Option<Command> {
    let binding = BINDINGS.iter().find(|binding| binding.code == code);
    binding.map(|binding| binding.command)
}

/// Whether a key that goes down ends the program.
pub fn quits(code: KeyCode, modifiers: ModifiersState) -> bool {
    code == KeyCode::KeyQ && modifiers.control_key()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_key_and_each_command_is_bound_once() {
        for (i, a) in BINDINGS.iter().enumerate() {
            for b in &BINDINGS[i + 1..] {
                assert!(a.code != b.code && a.command != b.command, "{}", a.key);
            }
        }
        assert_eq!(command(KeyCode::KeyP), Some(Command::Pause));
        assert_eq!(command(KeyCode::KeyW), None, "held to fly");
    }
}
