//! Whole scenes on both engines, side by side: the shipped ones and those of the accuracy report.

use std::fs;
use std::path::Path;

use libtest_mimic::Failed;
use sward::run::Engine;
use sward::run::accuracy::scenes::SCENES;
use sward::run::compare::{Comparison, touched_plants};
use sward::scene::{LoadedScene, load_scene};
use sward::sim::Meadow;

use super::Device;
use super::compare::ensure;

/// Promised: root mean square of the nodes' distances between the engines, in metres, and the share
/// of plants that end on another side of a body.
const RMS_M: f64 = 1e-4;
const FLIPPED_SHARE: f64 = 1e-3;
/// Frames per second at which poses are compared.
const FRAMES_PER_S: f64 = 30.0;

/// Names of the scenes, shipped ones first.
pub fn names() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = fs::read_dir(folder).into_iter().flatten().flatten();
    let shipped = files.filter_map(|file| {
        let name = file.file_name().into_string().ok()?;
        Some(name.strip_suffix(".ron")?.to_owned())
    });
    let mut names: Vec<String> = shipped.collect();
    // Nothing is touched in `still`, by design, and no plant in `meadow_60k`, whose billboards are compared
    // by themselves.
    names.retain(|name| name != "still" && name != "meadow_60k");
    names.sort();
    names.extend(SCENES.iter().map(|scene| scene.name.to_owned()));
    names
}

fn load(name: &str) -> Result<LoadedScene, Failed> {
    if let Some(scene) = SCENES.iter().find(|scene| scene.name == name) {
        return Ok(scene.load()?);
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    Ok(load_scene(&folder.join(format!("{name}.ron")), &[])?)
}

/// Runs a scene on both engines and compares every touched plant in every frame.
pub fn agrees(device: &Device, name: &str) -> Result<(), Failed> {
    let loaded = load(name)?;
    let meadow = || Meadow::new(loaded.scene.clone(), &loaded.assets);
    let (mut here, mut there) = (meadow()?, meadow()?);
    let mut cpu = Engine::cpu();
    let mut gpu = Engine::gpu(&device.gpu, &device.kernels, &mut there)?;
    let substeps = |seconds: f64| (seconds / here.scene.solver.substep_s).round() as u32;
    let (ticks, frame) = (
        substeps(loaded.scene.duration_s),
        substeps(1.0 / FRAMES_PER_S).max(1),
    );
    let mut comparison = Comparison::default();
    while here.ticks < ticks {
        cpu.tick(&mut here)?;
        gpu.tick(&mut there)?;
        if here.ticks % frame == 0 {
            let theirs = touched_plants(&there, &mut gpu)?;
            comparison.frame(&theirs, &touched_plants(&here, &mut cpu)?);
        }
    }
    let found = comparison.finish(&here.field);
    let share = found.side_flips as f64 / found.touched_plants.max(1) as f64;
    let text = format!(
        "rms {:.1e} m (limit {RMS_M:.0e}), {} of {} plants on another side (limit \
         {FLIPPED_SHARE:.0e} of them): {:?}",
        found.pose_rms_m, found.side_flips, found.touched_plants, found.flipped_roots_m
    );
    println!("{name}: {text}");
    ensure(found.touched_plants > 10, || {
        format!("only {} plants touched", found.touched_plants)
    })?;
    let agree = found.pose_rms_m <= RMS_M && share <= FLIPPED_SHARE;
    ensure(agree && here.tiles.len() == there.tiles.len(), || text)
}
