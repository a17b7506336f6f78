//! Every shipped scene as a test of its own, on the processor and on the graphics device, and a
//! scene with real data. Trials on the device are ignored without an adapter, unless
//! `SWARD_REQUIRE_GPU=1`; the one with real data is ignored unless `SWARD_DATA` names its folder.
//!
//! Each scene pins the hash of its state. `SWARD_MINT=1 cargo test --release --test scenes cpu::`
//! writes the hashes of now into the scenes; the README says when that is right.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]

use std::env;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use libtest_mimic::{Arguments, Failed, Trial};
use sward::gpu::Gpu;
use sward::run::{Device, Outcome, RunOptions, check_loaded, run_scene};
use sward::scene::{load_scene, parse_scene};

/// Names of trials, and how long they took.
type Times = Arc<Mutex<Vec<(Duration, String)>>>;

/// What stands before the hash in a scene.
const PIN: &str = "StateHash(is: \"";

/// Trials whose times are told at the end.
const SLOWEST: usize = 10;

/// A non-convex animal falls onto a real hillside.
const SPOT_ON_JACKSBORO: &str = r#"(
    description: "Spot falls into the grass of the Jacksboro fault.",
    duration_s: 3.0,
    terrain: (ground: HeightMap(file: "jacksboro_344x403_u16.png", spacing_m: 0.5, height_m: 12)),
    bodies: [
        (
            name: "spot",
            shape: Mesh(file: "spot.obj", scale: 0.5, max_parts: 24),
            position_m: (3, 1, -4),
            above_ground: true,
            mass: Kilograms(60),
        ),
    ],
    expect: [
        Imprint(body: "spot", at_s: 2.0, at_least: 0.4),
        // Two texels of its largest part: where convex parts meet, a node may leave one into the
        // other.
        Penetration(at_most_m: 0.012),
        Strain(at_most: 0.02),
        ActiveTiles(at_least: 1, at_most: 60),
    ],
)"#;

fn main() {
    let arguments = Arguments::from_args();
    let times = Times::default();
    let processor = Arc::new(Device::Processor);
    let gpu = Gpu::headless();
    let on_hardware = gpu.as_ref().is_ok_and(|gpu| !gpu.adapter.is_software);
    let graphics = gpu.and_then(Device::graphics).map(Arc::new);
    let required = env::var_os("SWARD_REQUIRE_GPU").is_some_and(|value| value == "1");

    let mut trials = Vec::new();
    for scene in shipped_scenes() {
        let name = scene.file_stem().unwrap_or_default().to_string_lossy();
        let (on_cpu, file) = (Arc::clone(&processor), scene.clone());
        trials.push(trial(format!("cpu::{name}"), &times, move || {
            run_file(&file, &on_cpu)
        }));
        let name = format!("gpu::{name}");
        if name == "gpu::meadow_60k" && !on_hardware {
            let reason = "minutes on a software adapter";
            trials.push(
                Trial::test(name, || Ok(()))
                    .with_kind(reason)
                    .with_ignored_flag(true),
            );
            continue;
        }
        trials.push(match &graphics {
            Ok(device) => {
                let (device, file) = (Arc::clone(device), scene.clone());
                trial(name, &times, move || run_file(&file, &device))
            }
            Err(error) => {
                let reason = error.to_string();
                trial(name, &times, move || Err(Failed::from(reason))).with_ignored_flag(!required)
            }
        });
    }
    let data = env::var_os("SWARD_DATA").map(PathBuf::from);
    let missing = data.is_none();
    let real = trial("cpu::spot_on_jacksboro".into(), &times, move || {
        spot_on_jacksboro(data)
    });
    trials.push(real.with_ignored_flag(missing));

    let conclusion = libtest_mimic::run(&arguments, trials);
    tell_slowest(&times);
    conclusion.exit();
}

fn shipped_scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut scenes: Vec<PathBuf> = folder
        .read_dir()
        .expect("the folder of scenes")
        .map(|entry| entry.expect("a readable entry").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "ron"))
        .collect();
    scenes.sort();
    assert!(!scenes.is_empty(), "no scene in {}", folder.display());
    scenes
}

fn trial(
    name: String,
    times: &Times,
    run: impl FnOnce() -> Result<(), Failed> + Send + 'static,
) -> Trial {
    let (times, timed) = (Arc::clone(times), name.clone());
    Trial::test(name, move || {
        let started = Instant::now();
        let result = run();
        let mut times = times.lock().unwrap_or_else(PoisonError::into_inner);
        times.push((started.elapsed(), timed));
        result
    })
}

fn run_file(scene: &Path, device: &Device) -> Result<(), Failed> {
    if env::var_os("SWARD_MINT").is_some_and(|value| value == "1") {
        mint(scene)?;
    }
    let outcome = check_loaded(&load_scene(scene, &[])?, device)?;
    sound(&outcome)
}

/// Writes the hash of a run into the scene's file, where its old one stands.
fn mint(scene: &Path) -> Result<(), Failed> {
    let loaded = load_scene(scene, &[])?;
    let outcome = run_scene(&loaded, &RunOptions::default(), &Device::Processor, |_| {})?;
    let hash = outcome.engine.state_hash().ok_or("no hash")?;
    let (before, rest) = loaded.source.split_once(PIN).ok_or("no pinned hash")?;
    let (_, after) = rest.split_once('"').ok_or("no end of the hash")?;
    std::fs::write(scene, format!("{before}{PIN}{hash:016x}\"{after}"))?;
    Ok(())
}

fn spot_on_jacksboro(data: Option<PathBuf>) -> Result<(), Failed> {
    let folder = data.ok_or("SWARD_DATA is not set")?;
    let loaded = parse_scene("spot_on_jacksboro", SPOT_ON_JACKSBORO, &[folder])?;
    let outcome = check_loaded(&loaded, &Device::Processor)?;
    // Twice the offset from which a plant counts as bent.
    if outcome.watch.max_offset_m < 0.04 {
        let found = outcome.watch.max_offset_m;
        return Err(format!("no plant was moved more than {found} m").into());
    }
    sound(&outcome)
}

/// What must hold of every run, whatever its scene expects.
fn sound(outcome: &Outcome) -> Result<(), Failed> {
    let gone = outcome.meadow.bodies.quarantined();
    if !gone.is_empty() {
        return Err(format!("bodies were quarantined: {}", gone.join(", ")).into());
    }
    Ok(())
}

fn tell_slowest(times: &Times) {
    let mut times = times.lock().unwrap_or_else(PoisonError::into_inner);
    times.sort_by(|a, b| b.cmp(a));
    println!("slowest trials:");
    for (took, name) in times.iter().take(SLOWEST) {
        println!("  {:>7.2} s  {name}", took.as_secs_f64());
    }
}
