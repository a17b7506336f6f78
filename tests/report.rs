//! `sward report accuracy` from outside: files, resuming, and what it refuses before it starts.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]
#![cfg(feature = "app")]

mod process;

use std::fs;
use std::path::PathBuf;
use std::process::Output;

use process::{code, sward};

/// A ball that stands in a square metre of grass for three frames.
const TINY: &str = r#"(
    description: "A ball stands in the grass.",
    duration_s: 0.1,
    terrain: (ground: Flat(size_m: (1, 1))),
    grass: (density_per_m2: 32),
    bodies: [(name: "ball", shape: Ball(radius_m: 0.2), position_m: (0, 0.2, 0), motion: Fixed)],
)"#;

fn report(arguments: &[&str]) -> Output {
    sward(&[&["report", "accuracy", "--no-gpu"], arguments].concat())
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// An empty folder of this test, with the tiny scene beside it.
fn folder(name: &str) -> (PathBuf, String) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("report")
        .join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder).expect("the test's own folder");
    }
    fs::create_dir_all(&folder).expect("a writable target folder");
    let scene = folder.join("tiny.ron");
    fs::write(&scene, TINY).expect("a writable target folder");
    (folder, scene.display().to_string())
}

#[test]
fn a_report_writes_its_files_and_resumes() {
    let (folder, scene) = folder("resume");
    let out = folder.join("out");
    let out_text = out.display().to_string();
    let arguments = [
        "--scene", &scene, "--method", "default", "--method", "analytic", "--out", &out_text,
    ];
    let first = report(&arguments);
    assert_eq!(
        code(&first),
        0,
        "{}",
        String::from_utf8_lossy(&first.stderr)
    );
    let markdown = String::from_utf8(first.stdout).expect("text");
    assert_eq!(
        fs::read_to_string(out.join("accuracy.md")).expect("the report"),
        markdown
    );
    for plot in ["tiny.svg", "all-scenes.svg"] {
        let svg = fs::read_to_string(out.join(plot)).expect("a plot");
        assert!(
            svg.contains("analytic") && svg.contains("default"),
            "{plot}"
        );
    }
    let points = fs::read_to_string(out.join("points.csv")).expect("the points");
    // Header, noise floor, two methods.
    assert_eq!(points.lines().count(), 4, "{points}");

    // As if the report had been killed while it wrote the last point.
    fs::write(out.join("points.csv"), &points[..points.len() - 3]).expect("a writable file");
    let resumed = report(&[&arguments[..], &["--resume"]].concat());
    assert_eq!(code(&resumed), 0);
    let again = fs::read_to_string(out.join("points.csv")).expect("the points");
    // The whole rows are the same to the last digit of their times: they were not run again.
    let kept = |text: &str| text.lines().take(3).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(kept(&again), kept(&points));
    assert_eq!(again.lines().count(), 4);
    assert!(String::from_utf8_lossy(&resumed.stderr).contains("measured again"));
}

#[test]
fn an_unknown_method_is_2_with_the_list() {
    let refused = report(&["--method", "bogus"]);
    assert_eq!(code(&refused), 2);
    let text = String::from_utf8_lossy(&refused.stderr);
    for name in ["default", "paper", "voxels-32"] {
        assert!(text.contains(name), "{text}");
    }
    assert_eq!(code(&report(&["--resume"])), 2);
}

/// The same program but for a byte at its end, which its loader does not read.
#[cfg(unix)]
#[test]
fn points_of_another_program_are_measured_again() {
    let (folder, scene) = folder("another program");
    let out = folder.join("out").display().to_string();
    let arguments = ["--scene", &scene, "--method", "default", "--out", &out];
    assert_eq!(code(&report(&arguments)), 0);
    let keys = || -> Vec<String> {
        let points = fs::read_to_string(folder.join("out/points.csv")).expect("the points");
        let key = |line: &str| line.split(',').next().map(str::to_owned);
        points.lines().skip(1).filter_map(key).collect()
    };
    let programs = || -> Vec<String> {
        let points = fs::read_to_string(folder.join("out/points.csv")).expect("the points");
        let program = |line: &str| line.split(',').nth(1).map(str::to_owned);
        points.lines().skip(1).filter_map(program).collect()
    };
    let first = keys();
    let resumed = report(&[&arguments[..], &["--resume"]].concat());
    assert_eq!((code(&resumed), keys()), (0, first.clone()));
    assert_eq!(said(&resumed), "");

    let measured_by = programs();
    let other = folder.join("sward");
    let mut bytes = fs::read(env!("CARGO_BIN_EXE_sward")).expect("the program");
    bytes.push(0);
    fs::copy(env!("CARGO_BIN_EXE_sward"), &other).expect("a copy that can be run");
    fs::write(&other, bytes).expect("the copy");
    let rebuilt = std::process::Command::new(&other)
        .args(["report", "accuracy", "--no-gpu", "--resume"])
        .args(arguments)
        .output()
        .expect("the copy starts");
    assert_eq!(code(&rebuilt), 0, "{}", said(&rebuilt));
    let warned = said(&rebuilt);
    assert!(
        warned.contains("2 points are of another program"),
        "{warned}"
    );
    let hashes = [measured_by, programs()].concat();
    assert!(hashes.iter().all(|hash| warned.contains(hash)), "{warned}");
    let second = keys();
    assert_eq!(second.len(), 2, "nothing of the other program is left");
    assert!(second.iter().all(|key| !first.contains(key)));
}

#[test]
fn a_narrower_report_does_not_lose_the_points_of_a_wider_one() {
    let (folder, scene) = folder("narrower");
    let out = folder.join("out").display().to_string();
    let wide = [
        "--scene", &scene, "--method", "default", "--method", "analytic", "--out", &out,
    ];
    assert_eq!(code(&report(&wide)), 0);
    let points = || fs::read_to_string(folder.join("out/points.csv")).expect("the points");
    let before = points();
    let narrow = ["--scene", &scene, "--method", "default", "--out", &out];
    for more in [&[][..], &["--resume"]] {
        let refused = report(&[&narrow[..], more].concat());
        assert_eq!(code(&refused), 2);
        let text = said(&refused);
        for told in [
            out.as_str(),
            "1 points",
            "`tiny` (analytic)",
            "another --out",
        ] {
            assert!(text.contains(told), "{told}: {text}");
        }
        assert_eq!(points(), before);
    }
    // What asks for all of them may start anew.
    assert_eq!(code(&report(&wide)), 0);
    assert_ne!(points(), "");
    fs::write(folder.join("out/points.csv"), "x,y\n1,2\n").expect("a writable file");
    let refused = report(&wide);
    assert_eq!(code(&refused), 2);
    assert!(
        said(&refused).contains("other columns"),
        "{}",
        said(&refused)
    );
    assert_eq!(points(), "x,y\n1,2\n");
}

#[test]
fn scenes_and_methods_are_listed_and_a_scene_is_asked_for_once() {
    let listed = report(&["--list"]);
    assert_eq!(code(&listed), 0);
    let text = String::from_utf8(listed.stdout).expect("text");
    let unknown = said(&report(&["--scene", "bogus"]));
    let help = String::from_utf8(report(&["--help"]).stdout).expect("text");
    for scene in ["roll", "roll-3", "box-slide", "plate", "drop", "fork"] {
        let starts = |line: &str| line.trim_start().starts_with(&format!("{scene} "));
        assert!(text.lines().any(starts), "{text}");
        assert!(unknown.contains(scene), "{unknown}");
        assert!(help.contains(scene), "{help}");
    }
    assert!(text.contains("sweep-1/8") && help.contains("sweep-1/8"));
    assert!(!unknown.contains(":1:1"), "{unknown}");
    assert_eq!(code(&report(&["--scene", "roll", "--scene", "roll"])), 2);
}

#[test]
fn an_unknown_scene_is_3_and_a_folder_that_cannot_be_written_is_5() {
    assert_eq!(code(&report(&["--scene", "no such scene"])), 3);
    let (folder, scene) = folder("refused");
    // A file stands where the folder would have to be; not even root can write into it.
    let file = folder.join("file");
    fs::write(&file, "").expect("a writable target folder");
    let out = file.join("out").display().to_string();
    let refused = report(&["--scene", &scene, "--out", &out]);
    assert_eq!(code(&refused), 5);
    assert!(refused.stdout.is_empty());
    assert!(String::from_utf8_lossy(&refused.stderr).contains(&out));
    // A slip in the path must not make folders.
    let nowhere = folder.join("no/such/folder");
    let refused = report(&["--scene", &scene, "--out", &nowhere.display().to_string()]);
    assert_eq!(code(&refused), 5);
    assert!(said(&refused).contains("does not exist"));
    assert!(!folder.join("no").exists());
}
