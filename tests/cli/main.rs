//! The program from outside: exit codes, what goes to stdout, closed pipes.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]
#![cfg(feature = "app")]

#[path = "../process/mod.rs"]
mod process;
mod told;

use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use process::{code, sward};

const STILL: &str = r#"(
    description: "Nothing moves.",
    duration_s: 0.1,
    grass: (density_per_m2: 16.0),
    expect: [SimulatedPlants(at_most: 0)],
)"#;

const WRONG: &str = r#"(
    duration_s: 0.1,
    expect: [SimulatedPlants(at_least: 1)],
)"#;

/// A scene in this test's own folder.
fn scene(name: &str, text: &str) -> String {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("cli");
    std::fs::create_dir_all(&folder).expect("a writable target folder");
    let path = folder.join(name);
    std::fs::write(&path, text).expect("a writable target folder");
    path.display().to_string()
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).expect("stdout is one JSON value")
}

/// Its sub-steps are shorter than the scene's; the run is not.
#[test]
fn the_reference_engine_runs_the_whole_scene() {
    let path = scene("still_reference.ron", STILL);
    let output = sward(&["run", &path, "--engine", "reference", "--json"]);
    assert_eq!(code(&output), 0);
    let report = json(&output);
    let run = &report["scenarios"][0];
    assert_eq!(report["engine"], "reference");
    assert_eq!(run["passed"], true);
    let simulated_s = run["seconds_simulated"].as_f64().expect("a number");
    assert!((simulated_s - 0.1).abs() < 1e-9, "{simulated_s}");
}

/// The program is another build of the library than the tests have: other features, other inlining.
/// The optimiser once made it miss bodies near a tile, which the pinned hash tells.
#[test]
fn the_program_has_the_bits_that_the_tests_have() {
    let output = sward(&["run", "vehicle", "mesh_drop", "--engine", "cpu", "--json"]);
    assert_eq!(
        code(&output),
        0,
        "{}",
        String::from_utf8_lossy(&output.stdout)
    );
    for run in json(&output)["scenarios"].as_array().expect("two runs") {
        let verdicts = run["expectations"].as_array().expect("verdicts");
        let pinned = verdicts.iter().find(|verdict| {
            let what = verdict["what"].as_str().expect("a text");
            what.starts_with("the state hash")
        });
        assert_eq!(pinned.expect("a pinned hash")["passed"], true);
    }
}

#[test]
fn usage_errors_are_2_and_help_is_0() {
    for wrong in [
        &["bogus"][..],
        &["run"],
        &["blade-shape", "--segments", "8"],
        &["blade-shape", "--segments", "0", "--stiffness", "1"],
        &["blade-shape", "--segments", "8", "--stiffness", "-1"],
        &[
            "blade-shape",
            "--segments",
            "8",
            "--stiffness",
            "1",
            "--root",
            "3k",
        ],
        &["run", "--hz", "NaN", "x.ron"],
        &["run", "--substep", "-1", "x.ron"],
    ] {
        let output = sward(wrong);
        assert_eq!(code(&output), 2, "{wrong:?}");
        assert!(
            output.stdout.is_empty() && !output.stderr.is_empty(),
            "{wrong:?}"
        );
    }
    assert_eq!(code(&sward(&["--help"])), 0);
    assert_eq!(code(&sward(&["--version"])), 0);
}

#[test]
fn a_method_that_the_gpu_does_not_know_is_4() {
    // Without an adapter the code is 4 as well.
    let arguments = ["run", "still", "--engine", "gpu", "--method", "paper"];
    let refused = sward(&arguments);
    assert_eq!(code(&refused), 4);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    if !said.contains("no graphics adapter") {
        assert!(
            said.contains("--engine cpu") && said.contains("cube-64"),
            "{said}"
        );
        assert!(
            !said.contains("nearest-64") && !said.contains('{'),
            "{said}"
        );
    }
    assert_eq!(code(&sward(&["run", "still", "--method", "none"])), 2);
}

#[test]
fn a_wrong_lean_is_told_as_it_was_given() {
    let output = sward(&[
        "blade-shape",
        "--segments",
        "8",
        "--stiffness",
        "64",
        "--lean",
        "181",
    ]);
    assert_eq!(code(&output), 2);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("--lean 181: give 0 to 180 degrees"), "{said}");
}

#[test]
fn a_missing_file_has_no_line_and_a_missing_folder_is_not_made() {
    for arguments in [
        &["run", "/no/such.ron"][..],
        &["replay", "/no/such.recording"],
    ] {
        let output = sward(arguments);
        assert_eq!(code(&output), 3);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            said.contains(&format!("{}: the file", arguments[1])),
            "{said}"
        );
    }
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("no folder of this test");
    for (option, file) in [
        ("--trace", "a.csv"),
        ("--junit", "a.xml"),
        ("--out", "results"),
    ] {
        let place = folder.join(file).display().to_string();
        let output = sward(&["run", "still", "--engine", "cpu", option, &place]);
        assert_eq!(code(&output), 5, "{option}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            said.contains("does not exist; make it first"),
            "{option}: {said}"
        );
        assert!(!folder.exists(), "{option}");
    }
}

const STANDS: &str = r#"(
    duration_s: 0.1,
    terrain: (ground: Flat(size_m: (2, 2))),
    grass: (density_per_m2: 64.0),
    bodies: [(name: "ball", shape: Ball(radius_m: 0.2), position_m: (0, 0.2, 0), motion: MOTION)],
)"#;

#[test]
fn a_run_against_the_reference_is_judged() {
    let fixed = scene("stands.ron", &STANDS.replace("MOTION", "Fixed"));
    let run = |path: &str, more: &[&str]| {
        sward(
            &[
                &["run", path, "--engine", "cpu", "--against", "reference"],
                more,
            ]
            .concat(),
        )
    };
    let output = run(&fixed, &["--json"]);
    assert_eq!(code(&output), 0);
    let report = json(&output);
    let judged = &report["scenarios"][0]["against_reference"];
    let limits = judged["limits"].as_array().expect("limits");
    let all = limits.iter().all(|limit| limit["passed"] == true);
    assert!(limits.len() >= 2 && limits.iter().all(|limit| limit["limit"].is_number()));
    assert_eq!(judged["within_limits"], all);
    let text = String::from_utf8_lossy(&run(&fixed, &[]).stdout).into_owned();
    let verdict = if all {
        "reference    within its limits"
    } else {
        "reference    OVER"
    };
    assert!(
        text.contains(verdict) && text.contains("poses, root mean square"),
        "{text}"
    );

    // Other blades, and free bodies that would go another way.
    let free = scene("lies.ron", &STANDS.replace("MOTION", "Free"));
    for (path, method, why) in [
        (&fixed, "root-paper", "blades are other ones"),
        (&free, "substep-480", "free bodies"),
    ] {
        let output = run(path, &["--method", method]);
        assert_eq!(code(&output), 2, "{method}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(method) && said.contains(why), "{said}");
    }
    assert_eq!(code(&run(&fixed, &["--method", "substep-480"])), 0);
}

#[test]
fn a_blade_as_json() {
    let output = sward(&[
        "blade-shape",
        "--segments",
        "8",
        "--stiffness",
        "32",
        "--json",
    ]);
    assert_eq!(code(&output), 0);
    let shape = json(&output);
    let mut keys: Vec<_> = shape.as_object().expect("an object").keys().collect();
    keys.sort();
    assert_eq!(
        keys,
        ["angles_rad", "energy", "iterations", "nodes", "residual"]
    );
    assert_eq!(shape["angles_rad"].as_array().map(Vec::len), Some(8));
    assert_eq!(shape["nodes"].as_array().map(Vec::len), Some(9));
    let tip = shape["nodes"][8][0].as_f64().expect("a number");
    assert!((tip - 0.7575288094).abs() < 1e-10, "{tip}");
}

#[test]
fn the_gravest_scene_decides_and_the_others_still_run() {
    let still = scene("still.ron", STILL);
    let wrong = scene("wrong.ron", WRONG);
    let broken = scene("broken.ron", "(duration_s: -1.0)");
    let run = |scenes: &[&str]| sward(&[&["run", "--engine", "cpu", "--json"], scenes].concat());
    assert_eq!(code(&run(&[&still])), 0);
    assert_eq!(code(&run(&[&still, &wrong])), 1);
    let output = run(&[&broken, &still, &wrong]);
    assert_eq!(code(&output), 3);
    let report = json(&output);
    assert_eq!(report["engine"], "cpu");
    let passed: Vec<_> = (0..3)
        .map(|i| report["scenarios"][i]["passed"].as_bool())
        .collect();
    assert_eq!(passed, [Some(false), Some(true), Some(false)]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        stderr.contains("broken.ron:1:") && stderr.contains("duration_s"),
        "{stderr}"
    );
    assert_eq!(report["scenarios"][1]["metrics"]["state_bytes_peak"], 0);
}

#[test]
fn a_closed_pipe_ends_the_program_quietly() {
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    let output = Command::new(env!("CARGO_BIN_EXE_sward"))
        .arg("schema")
        .stdout(writer)
        .stderr(Stdio::piped())
        .output()
        .expect("the program starts");
    assert_eq!(code(&output), 0);
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[test]
fn every_machine_has_a_doctor() {
    let output = sward(&["doctor"]);
    assert_eq!(code(&output), 0);
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(
        text.contains("cpu engine:") && text.contains("adapter"),
        "{text}"
    );
}

#[test]
fn shipped_scenes_are_known_by_name() {
    let output = sward(&["list"]);
    assert_eq!(code(&output), 0);
    let listed = String::from_utf8(output.stdout).expect("text");
    assert!(
        listed.lines().any(|line| line.starts_with("meadow ")),
        "{listed}"
    );
    let trace = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("still.csv");
    let trace = trace.display().to_string();
    let output = sward(&[
        "run", "still", "--engine", "cpu", "--hz", "15", "--trace", &trace,
    ]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("still: "));
    let rows = std::fs::read_to_string(&trace).expect("the trace was written");
    // Two seconds of 120 sub-steps and the head.
    assert_eq!(rows.lines().count(), 241);
}

#[test]
fn pictures_and_benches_refuse_nonsense_before_they_start() {
    for wrong in [
        &["render", "still", "--at", "-1", "--out", "a.png"][..],
        &["render", "still", "--at", "NaN", "--out", "a.png"],
        &["render", "still", "--at", "1", "--out", "a.jpeg"],
        &[
            "render", "still", "--at", "1", "--size", "0x9", "--out", "a.png",
        ],
        &[
            "render", "still", "--at", "1", "--size", "9000x9", "--out", "a.png",
        ],
        &[
            "render", "still", "--at", "1", "--frames", "0", "--out", "a.png",
        ],
        &[
            "render", "still", "--at", "1", "--sun", "-5", "--out", "a.png",
        ],
        &[
            "render", "still", "--at", "1", "--count", "few", "--out", "a.png",
        ],
        &["run", "still", "--engine", "cpu", "--require-gpu"],
        &["bench", "nothing"],
        &["bench", "flight", "--spacing", "5"],
    ] {
        assert_eq!(code(&sward(wrong)), 2, "{wrong:?}");
    }
}

/// A ground for the flight that is missing or of no use is told of by its name. One that is in the current
/// folder is found there by its bare name: its own fault is told then.
#[test]
fn a_height_map_of_the_flight_is_looked_for_where_the_user_is() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("cli-flight");
    std::fs::create_dir_all(&folder).expect("a writable target folder");
    std::fs::write(folder.join("grey.png"), "no picture").expect("a writable folder");
    for (file, told) in [
        ("nowhere.png", "cannot read `nowhere.png`: No such file"),
        ("none/here.png", "cannot read `none/here.png`: No such file"),
        ("grey.png", "`grey.png` is damaged"),
        ("./grey.png", "`grey.png` is damaged"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_sward"))
            .args(["bench", "flight", "--height-map", file])
            .current_dir(&folder)
            .output()
            .expect("the program starts");
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(code(&output), 3, "{text}");
        assert!(text.contains(told) && !text.contains("--assets"), "{text}");
    }
}

/// With an adapter there is a picture that tells what it shows, without one the code is 4.
#[test]
fn a_picture_says_what_it_shows() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("cli");
    std::fs::create_dir_all(&folder).expect("a writable target folder");
    let file = folder.join("still.png");
    let path = file.display().to_string();
    let output = sward(&[
        "render", "still", "--at", "0.1", "--size", "64x36", "--out", &path,
    ]);
    if code(&output) == 4 {
        let required = std::env::var_os("SWARD_REQUIRE_GPU").is_some_and(|value| value == "1");
        assert!(!required, "SWARD_REQUIRE_GPU=1, but there is no adapter");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains("mesa-vulkan-drivers"), "{said}");
        return;
    }
    assert_eq!(code(&output), 0);
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim_end(), path);
    let png = std::fs::File::open(&file).expect("a picture");
    let reader = png::Decoder::new(std::io::BufReader::new(png))
        .read_info()
        .expect("a PNG");
    assert_eq!((reader.info().width, reader.info().height), (64, 36));
    let texts: Vec<(String, String)> = (reader.info().utf8_text.iter())
        .map(|text| (text.keyword.clone(), text.get_text().expect("a text")))
        .collect();
    for wanted in [("Scene", "still"), ("Tick", "12"), ("Seed", "1")] {
        let found = texts
            .iter()
            .any(|(key, text)| (key.as_str(), text.as_str()) == wanted);
        assert!(found, "{wanted:?} in {texts:?}");
    }
}
