//! The program from outside: exit codes, what goes to stdout, closed pipes.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]
#![cfg(feature = "app")]

mod process;

use std::io::{BufRead, BufReader};
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

/// What a newcomer may well write, and what they are told: the thing, its value, and what to do.
#[test]
fn wrong_words_are_told_by_name_with_what_to_do() {
    let here = scene("told.ron", STILL);
    let folder = env!("CARGO_TARGET_TMPDIR");
    let csv = format!("{folder}/cli/twice.csv");
    let recording = scene("any.recording", "(format: 1)");
    for (wrong, exit, told) in [
        (
            &["still"][..],
            2,
            &["`still` is a scene", "sward view still"][..],
        ),
        (&[&here], 2, &["told.ron", "sward run"]),
        (&["run", &recording], 3, &["any.recording", "sward replay"]),
        (
            &["replay", &here],
            3,
            &["told.ron", "no recording", "sward run"],
        ),
        (&["run", folder], 3, &[folder, "folder"]),
        (&["list", &here], 3, &["told.ron", "folder"]),
        (&["view", "nowhere"], 3, &["nowhere", "sward list"]),
        (
            &["run", "still", "--seed", "-3"],
            2,
            &["-3", "--seed", "0 to 4294967295"],
        ),
        (
            &["run", "still", "--seed", "lush"],
            2,
            &["lush", "whole number from 0"],
        ),
        (
            &["run", "still", "--hz", "fast"],
            2,
            &["fast", "--hz", "give a number"],
        ),
        (
            &["run", "still", "--assets", "/nodir"],
            2,
            &["--assets /nodir", "folder"],
        ),
        (
            &["list", folder, "--assets", &here],
            2,
            &["--assets", "a file"],
        ),
        (
            &["replay", &recording, "--assets", "/nodir"],
            2,
            &["--assets /nodir"],
        ),
        (
            &["run", "still", "--out", &here],
            5,
            &["told.ron", "give a folder"],
        ),
        (
            &["run", "still", "--record", "a.rec"],
            2,
            &["a.rec", ".recording"],
        ),
        (
            &["run", "still", "--trace", &csv, "--junit", &csv],
            2,
            &["--trace and --junit", &csv],
        ),
        (
            &["run", &here, "--trace", &here],
            2,
            &["--trace", "overwrite"],
        ),
        (
            &["replay", &recording, "--trace", &recording],
            2,
            &["overwrite"],
        ),
        (
            &["blade-shape", "--segments", "-1", "--stiffness", "1"],
            2,
            &["-1", "from 1 to 64"],
        ),
        (
            &[
                "render", "still", "--at", "0", "--hz", "9", "--out", "a.png",
            ],
            2,
            &["--frames"],
        ),
    ] {
        let output = sward(wrong);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(code(&output), exit, "{wrong:?}: {said}");
        for told in told {
            assert!(said.contains(told), "{wrong:?}: no {told} in {said}");
        }
    }
    assert_eq!(std::fs::read_to_string(&here).expect("the scene"), STILL);
}

/// The report measures at the ends of frames, a trace at those of sub-steps: at one rate they agree.
#[test]
fn a_trace_agrees_with_the_report_at_the_rate_of_the_sub_steps() {
    let rolls = STANDS.replace("MOTION", "Thrown(velocity_m_per_s: (1.5, 0, 0))");
    let path = scene("traced.ron", &rolls);
    let trace = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("cli/traced.csv");
    let file = trace.display().to_string();
    let output = sward(&[
        "run", &path, "--engine", "cpu", "--json", "--hz", "120", "--trace", &file,
    ]);
    let report = json(&output);
    let metrics = &report["scenarios"][0]["metrics"];
    let rows = std::fs::read_to_string(&trace).expect("the trace");
    let mut lines = rows.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().expect("a head");
    let lines: Vec<Vec<&str>> = lines.collect();
    for name in [
        "max_penetration_m",
        "over_push_m",
        "max_length_strain",
        "max_offset_m",
    ] {
        let column = head.iter().position(|column| *column == name).expect(name);
        let values = lines
            .iter()
            .map(|line| line[column].parse::<f64>().expect("a number"));
        let largest = values.fold(0.0, f64::max);
        assert_eq!(metrics[name].as_f64(), Some(largest), "{name}");
    }
    assert!(metrics["over_push_m"].as_f64() > Some(0.0));
}

/// None of two options is dropped in silence.
#[test]
fn options_that_would_change_nothing_are_refused_by_name() {
    for (wrong, told) in [
        (
            &[
                "run",
                "still",
                "--method",
                "substep-30",
                "--substep",
                "0.01",
            ][..],
            ["--method substep-30", "--substep 0.01"],
        ),
        (
            &[
                "run",
                "still",
                "--engine",
                "reference",
                "--method",
                "nearest-64",
            ],
            ["--method nearest-64", "--engine reference"],
        ),
        (
            &[
                "run",
                "still",
                "--engine",
                "reference",
                "--against",
                "reference",
            ],
            ["--against reference", "--engine reference"],
        ),
        (
            &["bench", "terrain", "--engine", "cpu"],
            ["bench terrain", "--engine"],
        ),
        (
            &[
                "report", "accuracy", "--quick", "--scene", "roll", "--method", "default",
            ],
            ["--quick", "--scene"],
        ),
    ] {
        let output = sward(wrong);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(code(&output), 2, "{wrong:?}: {said}");
        assert!(output.stdout.is_empty());
        for told in told {
            assert!(said.contains(told), "{wrong:?}: no {told} in {said}");
        }
    }
    let both = ["--method", "segments-4", "--substep", "0.01"];
    let kept = sward(&[&["run", "still", "--engine", "cpu", "--json"], &both[..]].concat());
    assert_eq!(json(&kept)["scenarios"][0]["ticks"], 200);
}

/// Two days of grass follow the first scene: nobody waits for them to see its verdict.
#[test]
fn scenes_are_printed_as_they_end() {
    let still = scene("first.ron", STILL);
    let endless = r#"(duration_s: 172800, bodies: [(name: "ball", shape: Ball(radius_m: 0.15),
        position_m: (0, 0.15, 0))])"#;
    let endless = scene("endless.ron", endless);
    let mut child = Command::new(env!("CARGO_BIN_EXE_sward"))
        .args(["run", "--engine", "cpu", &still, &endless])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let stdout = child.stdout.take().expect("a pipe");
    let mut line = String::new();
    let read = BufReader::new(stdout).read_line(&mut line);
    child.kill().expect("a running program");
    child.wait().expect("its end");
    read.expect("a line");
    assert!(line.starts_with("first: passed"), "{line}");
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
        &["run", "still", "--engine", "cpu", "--require-gpu"],
        &["bench", "nothing"],
    ] {
        assert_eq!(code(&sward(wrong)), 2, "{wrong:?}");
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
