//! The layers' arrows run one way, the three files of a pass share a stem, files stay short.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]

use std::fs;
use std::path::{Path, PathBuf};

/// Each layer uses only itself and those before it.
const LAYERS: [&str; 10] = [
    "base", "scene", "terrain", "field", "bodies", "sim", "gpu", "render", "run", "app",
];

/// Longest source file, in lines.
const MOST_LINES: usize = 500;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Every file under `folder` with the given ending; none if there is no such folder.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for entry in entries {
        let path = entry.expect("a readable entry").path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.extension().is_some_and(|e| e == ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn stem(path: &Path) -> String {
    path.file_stem()
        .expect("a file")
        .to_string_lossy()
        .into_owned()
}

/// The path of a file within a folder, without its ending.
fn name_in(path: &Path, folder: &Path) -> String {
    let within = path.strip_prefix(folder).expect("a file of the folder");
    within.with_extension("").to_string_lossy().into_owned()
}

/// Names of the layers that a source text uses: what follows `crate::` directly, or stands in
/// braces after it.
fn layers_used(text: &str) -> Vec<(usize, String)> {
    let mut used = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let code = line.split("//").next().unwrap_or_default();
        for rest in code.split("crate::").skip(1) {
            let names = match rest.strip_prefix('{') {
                Some(list) => list.split('}').next().unwrap_or_default(),
                None => rest,
            };
            for name in names.split(',') {
                let word: String = name
                    .trim()
                    .chars()
                    .take_while(|c| c.is_alphanumeric() || *c == '_')
                    .collect();
                used.push((index + 1, word));
                if !rest.starts_with('{') {
                    break;
                }
            }
        }
    }
    used
}

#[test]
fn each_layer_uses_only_earlier_ones() {
    let mut failures = Vec::new();
    for (rank, layer) in LAYERS.iter().enumerate() {
        let folder = root().join("src").join(layer);
        for path in files(&folder, "rs") {
            let text = fs::read_to_string(&path).expect("a source file");
            for (line, word) in layers_used(&text) {
                if LAYERS.iter().skip(rank + 1).any(|later| *later == word) {
                    failures.push(format!("{}:{line} uses {word}", path.display()));
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn use_lines_are_understood() {
    let names = |text| -> Vec<String> { layers_used(text).into_iter().map(|u| u.1).collect() };
    assert_eq!(names("use crate::app::ui;"), ["app"]);
    assert_eq!(names("use crate::{base::Vec3, run};"), ["base", "run"]);
    assert_eq!(names("let x = crate::run::go(); // crate::app"), ["run"]);
}

#[test]
fn every_pass_has_its_three_files() {
    let root = root();
    let mut failures = Vec::new();
    for host in files(&root.join("src/gpu/passes"), "rs") {
        let pass = name_in(&host, &root.join("src/gpu/passes"));
        if stem(&host) == "mod" {
            continue;
        }
        for twin in [format!("shaders/{pass}.wgsl"), format!("src/sim/{pass}.rs")] {
            if !root.join(&twin).is_file() {
                failures.push(format!("{} has no {twin}", host.display()));
            }
        }
    }
    for path in files(&root.join("shaders"), "wgsl") {
        let stem = name_in(&path, &root.join("shaders"));
        if stem.starts_with("shared/") {
            continue;
        }
        let hosts = [
            format!("src/gpu/passes/{stem}.rs"),
            format!("src/render/{stem}.rs"),
            // What all passes have in common has no pass of its own.
            format!("src/gpu/{stem}.rs"),
        ];
        if !hosts.iter().any(|host| root.join(host).is_file()) {
            failures.push(format!("{} has no host file {hosts:?}", path.display()));
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn files_stay_short() {
    let root = root();
    let mut sources = files(&root.join("src"), "rs");
    sources.extend(files(&root.join("tests"), "rs"));
    sources.extend(files(&root.join("benches"), "rs"));
    sources.extend(files(&root.join("shaders"), "wgsl"));
    assert!(!sources.is_empty());
    let long: Vec<String> = sources
        .iter()
        .filter_map(|path| {
            let lines = fs::read_to_string(path).ok()?.lines().count();
            (lines > MOST_LINES).then(|| format!("{} has {lines} lines", path.display()))
        })
        .collect();
    assert!(long.is_empty(), "\n{}", long.join("\n"));
}
