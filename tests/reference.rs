//! The references for people say all that there is: every key of a scene, every option of a command,
//! every column of a trace.
//!
//! `scenes/README.md` is written by `SWARD_MINT=1 cargo test --test reference` from the schema, whose
//! words are the documentation of the types in `src/scene`.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]
#![cfg(feature = "app")]

mod process;

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use process::{code, sward};
use serde_json::Value;

const INTRODUCTION: &str = "\
# What a scene may say

A scene is a file in [RON](https://github.com/ron-rs/ron). Everything has a default but what is marked
*needed*: the smallest scene is `()`. An unknown key is an error with file, line and column. A key's
ending is its unit: `_m` metres, `_s` seconds, `_deg` degrees, `_m_per_s` metres per second,
`_deg_per_s` degrees per second, `_n` newtons. The world is right-handed with y up; colours are linear
RGB in 0 to 1. `(x, y, z)` is a tuple of so many numbers, `[…]` a list of any length. The scenes in this
folder are examples; `sward schema` prints the same for an editor. `Name(…)` is written with its keys, as in
`Strain(at_most: 0.02)`, or `Penetration()` where all have a default.

This page is written from the program: see `tests/reference.rs`.
";

/// The types in the order a reader wants them; others follow by name.
const FIRST: [&str; 21] = [
    "Terrain",
    "Ground",
    "Grass",
    "Species",
    "Form",
    "Likes",
    "Billboards",
    "Messiness",
    "ClumpKind",
    "ClumpLook",
    "Season",
    "Wind",
    "Body",
    "Shape",
    "Motion",
    "Event",
    "Action",
    "Camera",
    "Expectation",
    "Solver",
    "Method",
];

fn root(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

fn read(file: &str) -> String {
    std::fs::read_to_string(root(file)).expect("a file of this repository")
}

#[test]
fn the_page_on_scenes_says_what_the_schema_says() {
    let wanted = page(&sward::scene::json_schema());
    let path = root("scenes/README.md");
    if std::env::var_os("SWARD_MINT").is_some_and(|value| value == "1") {
        std::fs::write(&path, &wanted).expect("a writable file");
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    let differs = wanted
        .lines()
        .zip(found.lines())
        .find(|(want, found)| want != found);
    assert!(
        found == wanted,
        "scenes/README.md is not what the types say, first at {differs:?}; write it anew with \
         `SWARD_MINT=1 cargo test --test reference`"
    );
    assert!(!wanted.contains("| |"), "a key without a word on it");
}

fn page(schema: &Value) -> String {
    let mut page = INTRODUCTION.to_owned();
    write_keys(&mut page, "The scene", schema);
    let types = schema["$defs"].as_object().expect("types");
    let others = types.keys().map(String::as_str);
    let others = others.filter(|name| !FIRST.contains(name));
    for name in FIRST.into_iter().chain(others) {
        let of = &types[name];
        match of["oneOf"].as_array() {
            Some(variants) => write_choices(&mut page, name, of, variants),
            None => write_keys(&mut page, name, of),
        }
    }
    page
}

fn write_keys(page: &mut String, name: &str, of: &Value) {
    let _ = write!(page, "\n## {name}\n\n{}\n\n", words(of));
    page.push_str("| key | value | default | meaning |\n|---|---|---|---|\n");
    for (key, value) in of["properties"].as_object().expect("keys") {
        let default = default(of, key, value);
        let _ = writeln!(
            page,
            "| `{key}` | {} | {default} | {} |",
            kind(value),
            words(value)
        );
    }
}

/// A list of what may stand there, each with its own keys.
fn write_choices(page: &mut String, name: &str, of: &Value, variants: &[Value]) {
    let _ = write!(page, "\n## {name}\n\n{}\n\n", words(of));
    for variant in variants {
        let plain = variant["const"].as_str().map(str::to_owned);
        let several = variant["enum"].as_array();
        let names = several.into_iter().flatten().filter_map(Value::as_str);
        for name in plain.into_iter().chain(names.map(str::to_owned)) {
            let _ = writeln!(page, "- `{name}`: {}", words(variant));
        }
        for (name, inside) in variant["properties"].as_object().into_iter().flatten() {
            let Some(keys) = inside["properties"].as_object() else {
                let _ = writeln!(page, "- `{name}(…)`, {}: {}", kind(inside), words(variant));
                continue;
            };
            let _ = writeln!(page, "- `{name}(…)`: {}", words(variant));
            for (key, value) in keys {
                let (kind, default) = (kind(value), default(inside, key, value));
                let _ = writeln!(page, "  - `{key}`, {kind}, {default}: {}", words(value));
            }
        }
    }
}

fn words(of: &Value) -> String {
    let text = of["description"].as_str().unwrap_or_default();
    text.split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
        .replace('|', "\\|")
}

fn default(of: &Value, key: &str, value: &Value) -> String {
    let needed = of["required"].as_array();
    if needed.is_some_and(|keys| keys.iter().any(|needed| needed == key)) {
        return "*needed*".to_owned();
    }
    match &value["default"] {
        Value::Object(inside) if value["$ref"] == "#/$defs/Mass" => ron_of_mass(inside),
        Value::Object(_) => "see there".to_owned(),
        Value::Array(items) if items.iter().any(Value::is_object) => {
            "one of its default".to_owned()
        }
        Value::String(name) if value["$ref"].is_string() => format!("`{name}`"),
        Value::Null => "none".to_owned(),
        other => format!("`{}`", literal(other, is_tuple(value))),
    }
}

fn ron_of_mass(inside: &serde_json::Map<String, Value>) -> String {
    let kinds = inside
        .iter()
        .map(|(kind, value)| format!("`{kind}({value})`"));
    kinds.collect()
}

fn literal(value: &Value, is_tuple: bool) -> String {
    match value {
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(|item| literal(item, false)).collect();
            match is_tuple {
                true => format!("({})", items.join(", ")),
                false => format!("[{}]", items.join(", ")),
            }
        }
        Value::Number(number) => number
            .as_f64()
            .map_or(number.to_string(), |x| x.to_string()),
        other => other.to_string(),
    }
}

/// What may stand there, with its limits.
fn kind(value: &Value) -> String {
    if let Some(name) = value["$ref"]
        .as_str()
        .and_then(|path| path.rsplit('/').next())
    {
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if let Some(either) = value["anyOf"].as_array() {
        let named = either.iter().find(|one| one["$ref"].is_string());
        return named.map_or("any".to_owned(), kind);
    }
    let types = match &value["type"] {
        Value::Array(types) => types.first().and_then(Value::as_str),
        one => one.as_str(),
    };
    match types {
        Some("string") => "text".to_owned(),
        Some("boolean") => "`true` or `false`".to_owned(),
        Some("integer") => format!("whole number{}", limits(value)),
        Some("number") => format!("number{}", limits(value)),
        Some("array") if is_tuple(value) => {
            let count = value["minItems"].as_u64().unwrap_or_default();
            format!("({} × {})", count, kind(&value["items"]))
        }
        Some("array") => {
            let count = match (value["minItems"].as_u64(), value["maxItems"].as_u64()) {
                (least, Some(most)) => format!(" of {} to {most}", least.unwrap_or(0)),
                _ => String::new(),
            };
            format!("list{count}: {}", kind(&value["items"]))
        }
        _ => "any".to_owned(),
    }
}

fn is_tuple(value: &Value) -> bool {
    value["minItems"].is_u64() && value["maxItems"] == value["minItems"]
}

fn limits(value: &Value) -> String {
    match (value["minimum"].as_f64(), value["maximum"].as_f64()) {
        (Some(least), Some(most)) => format!(", {} to {}", short(least), short(most)),
        (Some(least), None) => format!(", {least} or more"),
        _ => String::new(),
    }
}

/// A number with an exponent where it would be many zeros.
fn short(value: f64) -> String {
    match value.abs() {
        size if size != 0.0 && !(1e-4..1e7).contains(&size) => format!("{value:e}"),
        _ => value.to_string(),
    }
}

const COMMANDS: [&str; 10] = [
    "view",
    "run",
    "replay",
    "render",
    "bench",
    "report accuracy",
    "blade-shape",
    "list",
    "schema",
    "doctor",
];

/// The options that a help text has, without those of every command.
fn options(help: &str) -> BTreeSet<String> {
    let lines = help
        .lines()
        .map(str::trim_start)
        .filter(|line| line.starts_with('-'));
    let words = lines.flat_map(|line| line.split([' ', ',']));
    let names = words.filter(|word| word.starts_with("--") && word.len() > 2);
    let own = names.filter(|name| !["--help", "--verbose", "--version"].contains(name));
    own.map(str::to_owned).collect()
}

#[test]
fn the_readme_has_every_option_of_every_command() {
    let readme = read("README.md");
    for command in COMMANDS {
        let mut arguments: Vec<&str> = command.split(' ').collect();
        arguments.push("--help");
        let output = sward(&arguments);
        assert_eq!(code(&output), 0, "{command}");
        let help = String::from_utf8_lossy(&output.stdout).into_owned();
        let start = format!("- `sward {command}");
        let told = readme
            .split("\n\n")
            .flat_map(|block| block.split("\n- ").map(str::to_owned));
        let told = told.map(|item| format!("- {}", item.trim_start_matches("- ")));
        let told = told
            .filter(|item| item.starts_with(&start))
            .collect::<String>();
        assert!(
            !told.is_empty(),
            "README.md has no line that begins `{start}`"
        );
        for option in options(&help) {
            assert!(
                told.contains(&format!("`{option}")),
                "{command}: no {option} in README.md"
            );
        }
        let written = told.split('`').filter(|word| word.starts_with("--"));
        for option in written {
            let name = option.split(' ').next().unwrap_or(option);
            assert!(
                help.contains(name),
                "README.md has {name} of {command}, which there is not"
            );
        }
    }
}

#[test]
fn the_readme_has_every_column_of_a_trace() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("reference");
    std::fs::create_dir_all(&folder).expect("a writable target folder");
    let (scene, trace) = (folder.join("short.ron"), folder.join("short.csv"));
    std::fs::write(&scene, "(duration_s: 0.05)").expect("a writable target folder");
    let [scene, trace] = [scene, trace].map(|path| path.display().to_string());
    let output = sward(&["run", &scene, "--engine", "cpu", "--trace", &trace]);
    assert_eq!(code(&output), 0);
    let table = std::fs::read_to_string(&trace).expect("the trace");
    let readme = read("README.md");
    let columns: Vec<&str> = table.lines().next().expect("a head").split(',').collect();
    assert!(columns.len() > 10);
    for column in columns {
        assert!(
            readme.contains(&format!("`{column}`")),
            "no {column} in README.md"
        );
    }
}
