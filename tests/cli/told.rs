//! What people are told: as it happens, in numbers that agree, and of what they wrote wrong.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use super::process::{code, sward};
use super::{STANDS, STILL, json, scene};

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
            &["bench", "flight", "--quick", "--engine", "gpu"],
            ["bench flight", "--engine"],
        ),
        (
            &["bench", "popping", "--require-gpu"],
            ["bench popping", "--require-gpu"],
        ),
        (
            &["bench", "submission", "--engine", "cpu"],
            ["bench submission", "--engine"],
        ),
        (
            &["bench", "terrain", "--quick"],
            ["bench flight", "--quick"],
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
        // The reader of the JSON is right to a rounding only.
        let told = metrics[name].as_f64().expect(name);
        let off = (told - largest).abs();
        assert!(off <= f64::EPSILON * largest, "{name}: {told} {largest}");
    }
    assert!(metrics["over_push_m"].as_f64() > Some(0.0));
}

/// The clamp of the printed springs either acts in every sub-step or never, and says so.
#[test]
fn the_clamp_of_literal_springs_is_told() {
    let soft = scene("soft.ron", STILL);
    let stiff = STILL.replace("grass:", "solver: (spring_rate_per_s: 200), grass:");
    let stiff = scene("stiff.ron", &stiff);
    let run = |more: &[&str]| sward(&[&["run", "--engine", "cpu", &soft, &stiff], more].concat());
    let report = json(&run(&["--method", "springs-literal", "--json"]));
    let acts = |n: usize| report["scenarios"][n]["literal_springs"]["acts"].as_bool();
    assert_eq!([acts(0), acts(1)], [Some(false), Some(true)]);
    let text = run(&["--method", "springs-literal"]).stdout;
    let text = String::from_utf8_lossy(&text).into_owned();
    assert!(
        text.contains("never acts") && text.contains("acts in every sub-step"),
        "{text}"
    );
    assert!(json(&run(&["--json"]))["scenarios"][0]["literal_springs"].is_null());
}

const CLUMPS: &str = r#"(
    description: "A ball drops into clumps.",
    duration_s: 0.2,
    terrain: (ground: Flat(size_m: (4, 4))),
    grass: (species: []),
    billboards: (density_per_m2: 40),
    bodies: [(name: "ball", shape: Ball(radius_m: 0.2), position_m: (0, 0.3, 0))],
    expect: [
        SimulatedPlants(at_least: 1),
        Lean(at_s: 0.15, near_m: (0, 0), within_m: 0.5, at_least_deg: 1),
        Offset(at_s: 0.15, near_m: (0, 0), within_m: 0.5, at_least_m: 0.001),
        Imprint(body: "ball", at_s: 0.15, at_least: 0.9),
    ],
)"#;

/// Every engine has billboards.
#[test]
fn billboards_run_on_every_engine() {
    let clumps = scene("clumps.ron", CLUMPS);
    let output = sward(&["run", &clumps, "--engine", "gpu", "--json"]);
    if code(&output) != 4 {
        let report = json(&output);
        assert_eq!(code(&output), 0, "{report}");
        assert_eq!(report["engine"], "gpu");
    }
    let output = sward(&["run", &clumps, "--engine", "cpu", "--json"]);
    let report = json(&output);
    assert_eq!(code(&output), 0, "{report}");
    let output = sward(&["run", &clumps, "--against", "reference", "--json"]);
    let told = json(&output).to_string();
    assert!(
        told.contains("billboards are not compared with the reference yet"),
        "{told}"
    );
}

/// Volumes past the device's limit are refused with key, value and limit before anything is traced; a cache
/// that cannot be written to is told of, and the picture is there.
#[test]
fn light_volumes_are_refused_or_told_of() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("cli");
    let picture = folder.join("lit.png").display().to_string();
    let render = |name: &str, light: &str| {
        let text = format!("(terrain: (ground: Flat(size_m: (2, 2))), light: ({light}))");
        let scene = scene(name, &text);
        Command::new(env!("CARGO_BIN_EXE_sward"))
            .args([
                "render", &scene, "--at", "0", "--size", "64x36", "--out", &picture,
            ])
            // A file where the folder ought to be.
            .env("SWARD_CACHE", &scene)
            .stdin(Stdio::null())
            .output()
            .expect("the program starts")
    };
    let output = render("lit.ron", "slices: 2, rays: 16");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    if text.contains("no graphics adapter") {
        assert_eq!(code(&output), 4, "{text}");
        return;
    }
    assert_eq!(code(&output), 0, "{text}");
    assert!(
        text.contains("SWARD_CACHE") && text.contains("not kept"),
        "{text}"
    );

    let output = render("tall.ron", "slices: 512, rays: 16");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    // Some devices have 2,048 layers, and are asked for the 256 that all have.
    assert_eq!(code(&output), 4, "{text}");
    for word in [
        "light.slices is 512",
        "1536 layers",
        "at most 256",
        "85 or less",
    ] {
        assert!(text.contains(word), "{text}");
    }
}
