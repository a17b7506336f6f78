//! `sward view` where there is no display.

use std::io::Write;

use super::scenes::SceneList;
use super::{Options, complain};
use crate::app::Failure;
use crate::app::commands::outputs::{ResultFile, make_folder};
use crate::app::light_up::light_up;
use crate::gpu::{Gpu, GpuError};
use crate::render::PictureTarget;
use crate::run::{Engine, EngineChoice, Exit, Stage, StageError};
use crate::scene::LoadedScene;
use crate::sim::Meadow;

/// Runs the current scene for its length, writes `sward-SCENE.png` where an adapter exists, and
/// prints a line.
///
/// # Errors
/// An invalid scene, a picture that cannot be drawn or written, no adapter for the gpu engine if
/// that was asked for.
pub fn run(
    reason: &str,
    scenes: &SceneList,
    options: &Options,
    out: &mut impl Write,
) -> Result<Exit, Failure> {
    let loaded = scenes.load()?;
    complain(&format!(
        "no display ({reason}), so '{}' runs without a window",
        loaded.name
    ));
    match Gpu::headless() {
        Ok(gpu) => with_picture(&gpu, &loaded, options, out)?,
        Err(error @ (GpuError::NoAdapter { .. } | GpuError::NoDevice { .. }))
            if options.engine != EngineChoice::Gpu =>
        {
            complain(&format!("no picture: {error}"));
            without_picture(&loaded, out)?;
        }
        Err(error) => return Err(error.into()),
    }
    Ok(Exit::Ok)
}

fn with_picture(
    gpu: &Gpu,
    loaded: &LoadedScene,
    options: &Options,
    out: &mut impl Write,
) -> Result<(), Failure> {
    // A place that cannot be written to is told before time is spent on the run.
    make_folder(&options.out)?;
    let path = options.out.join(format!("sward-{}.png", loaded.name));
    let file = ResultFile::create(&path)?;
    let target = PictureTarget::new(gpu, options.size)?;
    let mut stage = Stage::new(
        gpu,
        loaded,
        options.engine,
        PictureTarget::FORMAT,
        options.size,
    )?;
    stage.detail.density = options.density;
    stage.detail.count = options.count;
    while stage.meadow().time_s() < loaded.scene.duration_s {
        stage.tick()?;
    }
    stage.engine().check()?;
    light_up(gpu, &mut stage)?;
    let view = stage.camera(None)?;
    stage.draw(gpu, &view, &target.view, false)?;
    let picture = target.read(gpu)?;
    let png = super::screenshot::encode(&picture, &stage, gpu)?;
    file.write(&png)?;
    print_line(loaded, stage.meadow(), out)?;
    writeln!(out, "picture: {}", path.display())?;
    Ok(())
}

fn without_picture(loaded: &LoadedScene, out: &mut impl Write) -> Result<(), Failure> {
    let mut meadow = Meadow::new(loaded.scene.clone(), &loaded.assets).map_err(StageError::from)?;
    let mut engine = Engine::cpu();
    while meadow.time_s() < loaded.scene.duration_s {
        engine.tick(&mut meadow).map_err(StageError::from)?;
    }
    print_line(loaded, &meadow, out)
}

fn print_line(loaded: &LoadedScene, meadow: &Meadow, out: &mut impl Write) -> Result<(), Failure> {
    writeln!(
        out,
        "{}: {:.2} s simulated, {} of {} tiles awake at most, {} now",
        loaded.name,
        meadow.time_s(),
        meadow.tiles.peak,
        meadow.field.grid.tile_count(),
        meadow.tiles.len()
    )?;
    Ok(())
}
