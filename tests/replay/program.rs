//! `run --record`, `run --out` and `replay` from outside.

#![cfg(feature = "app")]

use std::path::Path;
use std::process::Output;

use super::folder;
use super::process::{code, sward};

const ROLL: &str = r#"(
    duration_s: 0.5,
    terrain: (ground: Flat(size_m: (6, 4))),
    bodies: [(name: "ball", shape: Ball(radius_m: 0.15), position_m: (-1.0, 0.15, 0.0),
        motion: Thrown(velocity_m_per_s: (1.5, 0.0, 0.0)))],
    expect: [ActiveTiles(at_least: 1)],
)"#;

/// Two days of it: long enough that a test would not end if it were run.
const ENDLESS: &str = r#"(duration_s: 172800, bodies: [(name: "ball",
    shape: Ball(radius_m: 0.15), position_m: (0, 0.15, 0))])"#;

fn text(path: &Path) -> String {
    path.display().to_string()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).expect("stdout is one JSON value")
}

fn file(folder: &Path, name: &str, content: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, content).expect("a file");
    text(&path)
}

#[test]
fn a_recorded_run_is_verified() {
    let folder = folder("verified");
    let scene = file(&folder, "roll.ron", ROLL);
    let recording = text(&folder.join("a.recording"));
    let run = sward(&[
        "run", &scene, "--engine", "cpu", "--record", &recording, "--json",
    ]);
    assert_eq!(code(&run), 0, "{}", said(&run));
    let replay = sward(&["replay", &recording, "--verify", "--json"]);
    assert_eq!(code(&replay), 0, "{}", said(&replay));
    let (run, replay) = (json(&run), json(&replay));
    assert_eq!(replay["replay"]["equal"], true);
    assert_eq!(replay["replay"]["ticks_compared"], 60);
    let hash = |report: &serde_json::Value| report["scenarios"][0]["state_hash"].clone();
    assert!(hash(&run).is_string());
    assert_eq!(hash(&run), hash(&replay));
    // Another ball: the scene is in the recording, so its first tick differs.
    let kept = std::fs::read_to_string(&recording).expect("the recording");
    let faster = file(
        &folder,
        "b.recording",
        &kept.replace("(1.5, 0.0", "(1.6, 0.0"),
    );
    let trace = text(&folder.join("trace.csv"));
    let replay = sward(&["replay", &faster, "--verify", "--trace", &trace]);
    assert_eq!(code(&replay), 1, "{}", said(&replay));
    let printed = String::from_utf8_lossy(&replay.stdout).into_owned();
    assert!(
        printed.starts_with("roll: DIFFERS from the recording (grass and bodies)\n"),
        "{printed}"
    );
    assert!(
        printed.contains("replay: tick 1 at 0.008333 s"),
        "{printed}"
    );
    let rows = std::fs::read_to_string(&trace).expect("the trace");
    assert_eq!(rows.lines().count(), 61, "a row per sub-step and the head");
    assert_eq!(code(&sward(&["replay", &faster])), 0, "without --verify");
}

/// What the scene expects has no say in it, and does not look as if it had.
#[test]
fn a_verified_replay_of_a_failed_run_is_no_failure() {
    let folder = folder("verified_failure");
    let scene = file(
        &folder,
        "fails.ron",
        &ROLL.replace("at_least: 1", "at_least: 1000"),
    );
    let recording = text(&folder.join("fails.recording"));
    let run = sward(&["run", &scene, "--engine", "cpu", "--record", &recording]);
    assert_eq!(code(&run), 1, "{}", said(&run));
    let replay = sward(&["replay", &recording, "--verify"]);
    assert_eq!(code(&replay), 0, "{}", said(&replay));
    let printed = String::from_utf8_lossy(&replay.stdout).into_owned();
    assert!(printed.starts_with("fails: as recorded\n"), "{printed}");
    assert!(
        printed.contains("60 of 60 ticks compared, all equal"),
        "{printed}"
    );
    assert!(
        printed.contains("not judged by --verify: 1 of"),
        "{printed}"
    );
    assert!(!printed.contains("FAIL"), "{printed}");
    let judged = sward(&["replay", &recording]);
    assert_eq!(code(&judged), 1);
    let printed = String::from_utf8_lossy(&judged.stdout).into_owned();
    assert!(printed.contains("fails: FAILED"), "{printed}");
}

#[test]
fn replays_refuse_what_makes_no_sense() {
    let folder = folder("refused");
    let broken = file(&folder, "broken.recording", "(format: 1)");
    let scene = file(&folder, "roll.ron", ROLL);
    for (wrong, exit) in [
        (&["replay"][..], 2),
        (&["replay", "--verify"], 2),
        (&["replay", &broken, "--verify", "--engine", "gpu"], 2),
        (&["run", &scene, &scene, "--record", "x.recording"], 2),
        (
            &[
                "run",
                &scene,
                "--engine",
                "reference",
                "--record",
                "x.recording",
            ],
            2,
        ),
        (&["replay", "/no/such.recording", "--verify"], 3),
        (&["replay", &broken], 3),
        (&["replay", &scene], 3),
    ] {
        let output = sward(wrong);
        assert_eq!(code(&output), exit, "{wrong:?}: {}", said(&output));
        assert!(output.stdout.is_empty(), "{wrong:?}");
    }
}

#[test]
fn files_that_cannot_be_written_are_told_before_the_run() {
    let folder = folder("unwritable");
    let scene = file(&folder, "endless.ron", ENDLESS);
    // A file where a folder would have to be.
    let blocked = file(&folder, "blocked", "");
    let inside = format!("{blocked}/x");
    for option in ["--trace", "--junit", "--out", "--record"] {
        let output = sward(&["run", &scene, "--engine", "cpu", option, &inside]);
        assert_eq!(code(&output), 5, "{option}: {}", said(&output));
        assert!(
            said(&output).contains(&blocked),
            "{option}: {}",
            said(&output)
        );
    }
    let recording = file(&folder, "any.recording", "(format: 1)");
    let output = sward(&["replay", &recording, "--trace", &inside]);
    assert_eq!(code(&output), 5, "{}", said(&output));
    // A run that no recording can hold: known before it begins.
    let record = text(&folder.join("long.recording"));
    let output = sward(&["run", &scene, "--engine", "cpu", "--record", &record]);
    assert_eq!(code(&output), 2, "{}", said(&output));
    assert!(said(&output).contains("20736000"), "{}", said(&output));
}

#[test]
fn a_failing_scenario_leaves_a_bundle() {
    let folder = folder("bundle");
    let assets = folder.join("assets");
    std::fs::create_dir_all(&assets).expect("a folder");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/assets/horseshoe.obj");
    std::fs::copy(shipped, assets.join("shoe.obj")).expect("a copy");
    let failing = ROLL.replace("at_least: 1", "at_least: 1000").replace(
        "bodies: [",
        "bodies: [(name: \"shoe\", position_m: (1, 0.5, 0),
            shape: Mesh(file: \"assets/shoe.obj\", max_parts: 4)), ",
    );
    let fails = file(&folder, "fails.ron", &failing);
    let passes = file(&folder, "passes.ron", ROLL);
    let out = folder.join("out");
    let output = sward(&[
        "run",
        &fails,
        &passes,
        "--engine",
        "cpu",
        "--out",
        &text(&out),
    ]);
    assert_eq!(code(&output), 1, "{}", said(&output));
    let bundle = out.join("fails");
    assert!(said(&output).contains(&text(&bundle)), "{}", said(&output));
    assert!(
        !out.join("passes").exists(),
        "nothing is left of what passed"
    );
    let kept = |name: &str| std::fs::read_to_string(bundle.join(name)).expect(name);
    assert_eq!(kept("scene.ron"), failing);
    let metrics: serde_json::Value = serde_json::from_str(&kept("metrics.json")).expect("JSON");
    assert_eq!(metrics["scenarios"][0]["passed"], false);
    // Half a second at 60 frames per second and the head.
    assert_eq!(kept("trace.csv").lines().count(), 31);
    let required = std::env::var_os("SWARD_REQUIRE_GPU").is_some_and(|value| value == "1");
    if required || bundle.join("end.png").exists() {
        let png = std::fs::read(bundle.join("end.png")).expect("a picture of the end");
        assert!(png.starts_with(b"\x89PNG"));
    }
    // Notes say how to do the run again, and why there is no picture.
    let notes = kept("notes.txt");
    assert!(notes.contains("sward replay fails.recording"), "{notes}");
    assert_ne!(
        notes.contains("no end.png"),
        bundle.join("end.png").exists(),
        "{notes}"
    );
    // The bundle stands for itself: its assets are in it.
    std::fs::remove_dir_all(&assets).expect("the folder");
    let recording = text(&bundle.join("fails.recording"));
    let replay = sward(&["replay", &recording, "--verify"]);
    assert_eq!(code(&replay), 0, "{}", said(&replay));
    let replay = sward(&["replay", &recording, "--engine", "cpu"]);
    assert_eq!(code(&replay), 1, "it fails again");
}

#[test]
fn a_scenario_that_could_not_begin_says_why_there_is_no_picture() {
    let folder = folder("not begun");
    let scene = file(&folder, "roll.ron", ROLL);
    let out = folder.join("out");
    // A fourth of the shortest sub-step that a scene may have.
    let output = sward(&[
        "run",
        &scene,
        "--engine",
        "cpu",
        "--substep",
        "1e-4",
        "--method",
        "grass-steps-4",
        "--out",
        &text(&out),
    ]);
    assert_eq!(code(&output), 3, "{}", said(&output));
    let notes = std::fs::read_to_string(out.join("roll/notes.txt")).expect("notes");
    assert!(
        notes.contains("after 0 whole sub-steps") && notes.contains("no end.png"),
        "{notes}"
    );
    assert!(!out.join("roll/end.png").exists());
}
