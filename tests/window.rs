//! The real window in a display of its own, with keys and drags from outside the process.
//!
//! Needs `Xvfb`, `xdotool` and a graphics adapter; what is missing makes the trials ignored, or
//! fail where `SWARD_REQUIRE_GPU=1`.

mod window_harness;

use std::process::Command;

use libtest_mimic::{Arguments, Failed, Trial};
use window_harness::{Server, Shot, Window, folder, is_installed, missing, run_to_end};

/// A ball that goes to and fro over a small meadow. No red but the overlay's.
const ROLL: &str = r#"(
    description: "A ball goes to and fro.",
    terrain: (ground: Flat(size_m: (10, 10))),
    grass: (density_per_m2: 64.0),
    bodies: [(
        name: "ball",
        shape: Ball(radius_m: 0.3),
        above_ground: true,
        motion: Path(repeat: true, waypoints: [
            (at_s: 0, position_m: (-1.5, 0.3, 0)),
            (at_s: 2, position_m: (1.5, 0.3, 0)),
            (at_s: 4, position_m: (-1.5, 0.3, 0)),
        ]),
        rgb: (0.05, 0.1, 0.6),
    )],
    cameras: [(name: "eye", eye_m: (0, 2.5, 5), target_m: (0, 0, 0))],
)"#;

const STILL: &str = r#"(
    description: "Nothing moves.",
    terrain: (ground: Flat(size_m: (10, 10))),
    grass: (density_per_m2: 64.0),
    duration_s: 0.1,
)"#;

/// The window of these trials, and the left part of it that the panel takes.
const SIZE: [u32; 2] = [640, 400];
const PANEL_PX: u32 = 236;

type Check = fn() -> Result<(), Failed>;

const CHECKS: &[(&str, Check)] = &[
    ("keys_change_the_picture", keys_change_the_picture),
    (
        "drags_belong_to_where_they_begin",
        drags_belong_to_where_they_begin,
    ),
    ("sizes_come_and_go", sizes_come_and_go),
];

fn main() {
    let arguments = Arguments::from_args();
    let required = std::env::var_os("SWARD_REQUIRE_GPU").is_some_and(|v| v == "1");
    let missing = missing();
    let mut trials: Vec<Trial> = CHECKS
        .iter()
        .map(|&(name, check)| {
            let missing = missing.clone();
            let ignored = missing.is_some() && !required;
            let run = move || match missing {
                Some(missing) => Err(missing.into()),
                None => check(),
            };
            Trial::test(name, run).with_ignored_flag(ignored)
        })
        .collect();
    let has_adapter = sward::gpu::Gpu::headless().is_ok();
    trials.push(Trial::test("no_display_gives_a_picture", move || {
        no_display_gives_a_picture(has_adapter)
    }));
    trials.push(Trial::test("no_display_and_no_folder_is_5", || {
        no_display_and_no_folder_is_5()
    }));
    // Drivers of other platforms are not found by files, and keep their adapter.
    let lacks_server = !is_installed("Xvfb") || !cfg!(target_os = "linux");
    trials.push(
        Trial::test("a_display_without_an_adapter_is_4", || {
            a_display_without_an_adapter_is_4()
        })
        .with_ignored_flag(lacks_server),
    );
    libtest_mimic::run(&arguments, trials).exit();
}

fn ensure(holds: bool, what: impl Into<String>) -> Result<(), Failed> {
    if holds {
        Ok(())
    } else {
        Err(what.into().into())
    }
}

/// Writes the two scenes and opens the first, with its panels hidden.
fn open(name: &str) -> Result<Window, Failed> {
    let folder = folder(name)?;
    std::fs::write(folder.join("a_roll.ron"), ROLL)?;
    std::fs::write(folder.join("b_still.ron"), STILL)?;
    let window = Window::open(&folder, "a_roll.ron", SIZE)?;
    window.keys(&["Tab"])?;
    Ok(window)
}

/// Texels that the overlay's boxes turn red.
fn red(shot: &Shot) -> usize {
    shot.count(|[r, g, b]| r > 120 && u16::from(r) > 2 * u16::from(g.max(b)))
}

fn keys_change_the_picture() -> Result<(), Failed> {
    let mut window = open("keys")?;
    let first = window.shot()?;
    let later = window.shot()?;
    ensure(later.tick > first.tick, "time goes on by itself")?;

    window.keys(&["p"])?;
    let paused = window.shot()?;
    let still = window.shot()?;
    ensure(paused.tick == still.tick, "P stops the time")?;
    let changed = still.differing(&paused);
    ensure(
        changed == 0,
        format!("{changed} texels change while paused"),
    )?;

    window.keys(&["t"])?;
    let tiles = window.shot()?;
    let (before, boxed) = (red(&paused), red(&tiles));
    // A box is at least some dozen texels wide here and its edges alone are more than these.
    ensure(
        boxed > before + 100,
        format!("T: {before} red texels, then {boxed}"),
    )?;
    window.keys(&["t"])?;
    ensure(
        window.shot()?.differing(&paused) == 0,
        "T takes the boxes away",
    )?;
    window.keys(&["8"])?;
    let awake = red(&window.shot()?);
    ensure(
        awake > before + 100,
        format!("8: {before} red texels, then {awake}"),
    )?;
    window.keys(&["8"])?;
    ensure(
        window.shot()?.differing(&paused) == 0,
        "8 takes the boxes away",
    )?;

    let pointer = [440, 290];
    window.point(pointer)?;
    window.keys(&["b"])?;
    let dropped = window.shot()?;
    // A ball of 0.25 m, 4 to 6 m away, is some 40 texels across, and starts 1.2 m above.
    let near = dropped.differing_within(&paused, [pointer[0], pointer[1] - 100], 120);
    ensure(
        near > 400,
        format!("B: {near} texels change above the pointer"),
    )?;

    window.keys(&["o"; 12])?;
    let stepped = window.shot()?;
    ensure(
        stepped.tick == dropped.tick + 24,
        format!(
            "12 frames of 2 sub-steps: {} to {}",
            dropped.tick, stepped.tick
        ),
    )?;
    ensure(stepped.differing(&dropped) > 400, "the ball falls")?;

    window.keys(&["r"])?;
    let restarted = window.shot()?;
    ensure(restarted.tick == 0, format!("R: tick {}", restarted.tick))?;
    let gone = restarted.differing_within(&stepped, [pointer[0], pointer[1] - 50], 150);
    ensure(gone > 400, "R takes the dropped ball away")?;

    window.keys(&["bracketright"])?;
    let next = window.shot()?;
    ensure(next.scene == "b_still", format!("]: scene {}", next.scene))?;
    window.keys(&["bracketleft"])?;
    ensure(window.shot()?.scene == "a_roll", "[ goes back")?;
    window.close()
}

fn drags_belong_to_where_they_begin() -> Result<(), Failed> {
    let mut window = open("drags")?;
    window.keys(&["p"])?;
    let bare = window.shot()?;
    window.keys(&["Tab"])?;
    let panels = window.shot()?;
    let in_panel = panels.differing_left_of(&bare, PANEL_PX);
    // The panel darkens all behind it.
    let most = (PANEL_PX * SIZE[1]) as usize * 9 / 10;
    ensure(
        in_panel > most,
        format!("Tab: {in_panel} texels change in the panel"),
    )?;

    window.drag([120, 390], [420, 200])?;
    window.keys(&["Tab"])?;
    let after_panel = window.shot()?.differing(&bare);
    ensure(
        after_panel == 0,
        format!("a panel's drag changes {after_panel} texels"),
    )?;

    window.drag([300, 200], [420, 180])?;
    let orbited = window.shot()?;
    ensure(
        orbited.differing(&bare) > 10_000,
        "a drag in the picture orbits",
    )?;
    window.keys(&["Home"])?;
    ensure(
        window.shot()?.differing(&orbited) > 10_000,
        "Home moves the camera",
    )?;
    window.close()
}

fn sizes_come_and_go() -> Result<(), Failed> {
    let mut window = open("sizes")?;
    for size in [[300, 200], [1, 1], [37, 500], SIZE] {
        window.resize(size)?;
        let shot = window.shot_of(size)?;
        ensure(
            shot.size == size,
            format!("asked for {size:?}, got {:?}", shot.size),
        )?;
    }
    window.close()
}

fn no_display_gives_a_picture(has_adapter: bool) -> Result<(), Failed> {
    let folder = folder("no_display")?;
    std::fs::write(folder.join("b_still.ron"), STILL)?;
    let mut command = Command::new(env!("CARGO_BIN_EXE_sward"));
    command
        .args(["view", "b_still.ron", "--size", "160x100"])
        .current_dir(&folder)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET");
    let (code, stderr) = run_to_end(command)?;
    ensure(code == Some(0), format!("exit {code:?}: {stderr}"))?;
    ensure(stderr.contains("no display"), stderr.clone())?;
    let picture = folder.join("sward-b_still.png").is_file();
    let told = stderr.contains("no picture");
    ensure(picture == has_adapter && told != has_adapter, stderr)
}

/// The scene would take half an hour: it is not begun.
fn no_display_and_no_folder_is_5() -> Result<(), Failed> {
    let folder = folder("no_folder")?;
    std::fs::write(
        folder.join("long.ron"),
        STILL.replace("duration_s: 0.1", "duration_s: 170000"),
    )?;
    std::fs::write(folder.join("file"), "")?;
    for out in ["none/out", "file"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sward"));
        command
            .args(["view", "long.ron", "--size", "160x100", "--out", out])
            .current_dir(&folder)
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET");
        let (code, stderr) = run_to_end(command)?;
        ensure(code == Some(5), format!("exit {code:?}: {stderr}"))?;
        ensure(stderr.contains(&format!("cannot write {out}")), stderr)?;
    }
    ensure(
        !folder.join("none").exists(),
        "a slip in a path makes no folders",
    )
}

fn a_display_without_an_adapter_is_4() -> Result<(), Failed> {
    let server = Server::start()?;
    let folder = folder("no_adapter")?;
    std::fs::write(folder.join("b_still.ron"), STILL)?;
    let mut command = Command::new(env!("CARGO_BIN_EXE_sward"));
    command
        .args(["view", "b_still.ron"])
        .current_dir(&folder)
        .env("DISPLAY", server.display())
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .env("VK_ICD_FILENAMES", "/dev/null")
        .env("VK_DRIVER_FILES", "/dev/null");
    let (code, stderr) = run_to_end(command)?;
    ensure(code == Some(4), format!("exit {code:?}: {stderr}"))?;
    for told in ["no graphics adapter", "sward run", "mesa-vulkan-drivers"] {
        ensure(stderr.contains(told), format!("no {told}: {stderr}"))?;
    }
    Ok(())
}
