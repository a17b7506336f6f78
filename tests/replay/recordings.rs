//! Recordings as files: what is written is read, runs again, and a changed one is told.

use std::path::Path;

use sward::gpu::GpuError;
use sward::run::recording::{Difference, Hashed, MOST_TICKS};
use sward::run::{
    Device, Engine, Input, Recorder, Recording, RunOptions, RunWatcher, Verifier, run_watched,
};
use sward::scene::{Action, LoadedScene, load_scene, parse_scene};
use sward::sim::Meadow;

use super::folder;

const ROLL: &str = r##"(
    description: "A \"ball\" rolls, r#\"raw\"#.",
    duration_s: 0.8,
    terrain: (ground: Flat(size_m: (6, 4))),
    bodies: [
        (name: "ball", shape: Ball(radius_m: 0.15), position_m: (-1.0, 0.15, 0.0),
         motion: Thrown(velocity_m_per_s: (1.5, 0.0, 0.0))),
    ],
    script: [(at_s: 0.5, action: SetWind(strength: 0.2))],
)"##;

/// Records a run, or compares it.
struct Follow<'a> {
    recorder: Option<Recorder>,
    verifier: Option<Verifier<'a>>,
}

impl RunWatcher for Follow<'_> {
    fn tick(&mut self, meadow: &Meadow, engine: &mut Engine) -> Result<(), GpuError> {
        if let Some(recorder) = &mut self.recorder {
            recorder.tick(meadow, engine);
        }
        if let Some(verifier) = &mut self.verifier {
            verifier.tick(meadow, engine);
        }
        Ok(())
    }
}

fn record(loaded: &LoadedScene, options: &RunOptions) -> Recording {
    let recorder = Recorder::new(loaded, options).expect("a short run");
    let mut follow = Follow {
        recorder: Some(recorder),
        verifier: None,
    };
    run_watched(loaded, options, &Device::Processor, &mut follow).expect("a run");
    let recorder = follow.recorder.expect("it is still there");
    recorder.recording().clone()
}

fn first_difference(recording: &Recording, loaded: &LoadedScene) -> Option<Difference> {
    let mut follow = Follow {
        recorder: None,
        verifier: Some(Verifier::new(recording)),
    };
    let options = recording.options();
    run_watched(loaded, &options, &Device::Processor, &mut follow).expect("a run");
    let verifier = follow.verifier.expect("it is still there");
    assert_eq!(verifier.compared() as usize, recording.hashes.len());
    verifier.first_difference()
}

/// A run with inputs from outside, a seed and a frame rate of its own.
fn options() -> RunOptions {
    let throw = Action::Throw {
        body: "ball".into(),
        velocity_m_per_s: [0.1, 2.0, 1.0 / 3.0],
        spin_deg_per_s: [0.0; 3],
    };
    let thrown = |tick| Input {
        tick,
        action: throw.clone(),
    };
    RunOptions {
        hz: 47.0,
        substep_s: Some(1.0 / 130.0),
        seed: Some(7),
        inputs: vec![thrown(20), thrown(57), thrown(57)],
        ..RunOptions::default()
    }
}

fn written(recording: &Recording, name: &str) -> std::path::PathBuf {
    let path = folder(name).join("roll.recording");
    std::fs::write(&path, recording.to_text().expect("it can be written")).expect("a file");
    path
}

#[test]
fn a_recording_is_read_back_and_runs_again() {
    let loaded = parse_scene("roll", ROLL, &[]).expect("a valid scene");
    let recording = record(&loaded, &options());
    assert_eq!(recording.hashes.len(), 104, "0.8 s at 130 Hz");
    assert_eq!(recording.hashed, Hashed::GrassAndBodies);
    let path = written(&recording, "read_back");
    let (again, scene) = Recording::read(&path, &[]).expect("a valid recording");
    assert_eq!(again, recording);
    assert_eq!(scene.scene, loaded.scene);
    assert_eq!(first_difference(&again, &scene), None);
    // A tick costs what the module says, beside the scene and what stands once.
    let text = recording.to_text().expect("it can be written");
    let longer = Recording {
        hashes: vec![0x0123_4567; 104 + 3200],
        ..recording
    };
    let more = longer.to_text().expect("it can be written").len() - text.len();
    assert!((3200 * 8..3200 * 9).contains(&more), "{more} bytes");
}

#[test]
fn the_first_tick_that_differs_is_named() {
    let loaded = parse_scene("roll", ROLL, &[]).expect("a valid scene");
    let recording = record(&loaded, &options());
    let mut without = recording.clone();
    without.inputs.truncate(1);
    let difference = first_difference(&without, &loaded).expect("an input is missing");
    assert_eq!(difference.tick, 58, "the first after 57");
    assert!((difference.time_s - 58.0 / 130.0).abs() < 1e-9);
    let mut flipped = recording.clone();
    flipped.hashes[40] ^= 1;
    let difference = first_difference(&flipped, &loaded).expect("one bit");
    assert_eq!(difference.tick, 41);
    assert_eq!(difference.recorded ^ 1, difference.found);
    let mut other = recording.clone();
    other.seed = Some(8);
    let tick = first_difference(&other, &loaded)
        .expect("other plants")
        .tick;
    assert_eq!(tick, 1, "the ball stands in the grass from the start");
}

#[test]
fn a_malformed_recording_is_an_error_with_its_key() {
    let loaded = parse_scene("roll", ROLL, &[]).expect("a valid scene");
    let text = record(&loaded, &options()).to_text().expect("text");
    let path = folder("malformed").join("bad.recording");
    let error_of = |text: &str| {
        std::fs::write(&path, text).expect("a file");
        match Recording::read(&path, &[]) {
            Ok(_) => panic!("this was taken:\n{text}"),
            Err(error) => error.to_string(),
        }
    };
    let first = text.find("hashes: [").expect("the key") + 20;
    let mut no_hash = text.clone();
    no_hash.replace_range(first..=first, "x");
    for (text, key, help) in [
        (
            text.replace("format: 1", "format: 2"),
            ": format: ",
            "format 1",
        ),
        (
            text.replace("format: 1,", ""),
            "`format`",
            "is no recording",
        ),
        (text.replace("hz: 47.0", "hz: NaN"), ": hz: ", "1 to 10000"),
        (
            text.replace("hz: 47.0", "hz: 47.0, colour: 3"),
            ": colour: ",
            "no known key",
        ),
        (
            text.replace("seed: 7", "seed: -1"),
            ": seed",
            "whole number",
        ),
        (
            text.replace(&format!("substep_s: {}", 1.0 / 130.0), "substep_s: 7"),
            ": substep_s: ",
            "0.0001 to",
        ),
        (
            text.replace("ticks: 104", "ticks: 105"),
            ": hashes: ",
            "hold 104 ticks",
        ),
        (
            text.replace("ticks: 104", "ticks: 4294967295"),
            ": ticks: ",
            "at most 16777216",
        ),
        (no_hash, ": hashes[0]: ", "8 hexadecimal digits"),
        (
            text.replace("tick: 20", "tick: 58"),
            ": inputs[1].tick: ",
            "rise",
        ),
        (
            text.replace("tick: 20", "tick: 4000000000"),
            "inputs[0].tick",
            "rise",
        ),
        (
            text.replacen("body: \"ball\"", "body: \"bell\"", 1),
            ": inputs[0].action.body: ",
            "there are ball",
        ),
        (
            text.replacen("(0.1, 2.0", "(inf, 2.0", 1),
            ": inputs[0].action.velocity_m_per_s",
            "-1000 to 1000",
        ),
        (
            text.replace("radius_m: 0.15", "radius_m: -1"),
            "bodies[0].shape.radius_m",
            "100 m",
        ),
        (
            text.replace("assets: []", "assets: [(file: \"a.obj\", hash: \"00\")]"),
            ": assets[0].file: ",
            "does not read",
        ),
    ] {
        let error = error_of(&text);
        assert!(error.contains("bad.recording:"), "{error}");
        assert!(error.contains(key), "{key} is not in: {error}");
        assert!(error.contains(help), "{help} is not in: {error}");
    }
    for end in (0..text.len() - 3).step_by(97) {
        assert!(!error_of(&text[..text.floor_char_boundary(end)]).is_empty());
    }
    error_of("");
    error_of("\0\0\0\0");
    error_of(&"[".repeat(10_000));
    std::fs::write(&path, [0xff, 0xfe, 0x00]).expect("a file");
    let error = Recording::read(&path, &[])
        .expect_err("no text")
        .to_string();
    assert!(error.contains("UTF-8"), "{error}");
    let error = Recording::read(Path::new("/no/such.recording"), &[]).expect_err("gone");
    assert!(error.to_string().contains("/no/such.recording"));
}

#[test]
fn a_changed_asset_is_refused() {
    let folder = folder("assets");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/assets/horseshoe.obj");
    let asset = folder.join("shoe.obj");
    std::fs::copy(&shipped, &asset).expect("a copy");
    let scene = r#"(duration_s: 0.05, bodies: [(name: "shoe", position_m: (0, 1, 0),
        shape: Mesh(file: "shoe.obj", max_parts: 4))])"#;
    std::fs::write(folder.join("shoe.ron"), scene).expect("a file");
    let loaded = load_scene(&folder.join("shoe.ron"), &[]).expect("a valid scene");
    let recording = record(&loaded, &RunOptions::default());
    assert_eq!(recording.assets.len(), 1);
    let path = folder.join("shoe.recording");
    std::fs::write(&path, recording.to_text().expect("text")).expect("a file");
    let (again, scene) = Recording::read(&path, &[]).expect("nothing has changed");
    assert_eq!(first_difference(&again, &scene), None);
    let mut bytes = std::fs::read(&asset).expect("the copy");
    bytes.extend(b"# a comment\n");
    std::fs::write(&asset, bytes).expect("the copy");
    let error = Recording::read(&path, &[])
        .expect_err("changed")
        .to_string();
    assert!(error.contains("assets[0].hash"), "{error}");
    assert!(error.contains("`shoe.obj` has changed"), "{error}");
    std::fs::remove_file(&asset).expect("the copy");
    let error = Recording::read(&path, &[]).expect_err("gone").to_string();
    assert!(error.contains("--assets"), "{error}");
}

#[test]
fn what_is_too_long_to_record_is_refused_beforehand() {
    let loaded = parse_scene("roll", ROLL, &[]).expect("a valid scene");
    let options = RunOptions {
        ticks: Some(MOST_TICKS + 1),
        ..RunOptions::default()
    };
    let error = Recorder::new(&loaded, &options).expect_err("one tick too many");
    assert!(error.to_string().contains("16777217"), "{error}");
}
