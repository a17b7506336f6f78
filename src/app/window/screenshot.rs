//! Pictures of the window as files that say what they show.

use std::fs;
use std::path::{Path, PathBuf};

use crate::app::Failure;
use crate::gpu::Gpu;
use crate::render::{Picture, RenderError};
use crate::run::Stage;

/// A picture as PNG, with scene, tick, seed, version, engine and adapter in its texts.
///
/// # Errors
/// The encoder's.
pub fn encode(picture: &Picture, stage: &Stage, gpu: &Gpu) -> Result<Vec<u8>, RenderError> {
    let meadow = stage.meadow();
    picture.to_png(&[
        ("Scene", &stage.loaded().name),
        ("Tick", &meadow.ticks.to_string()),
        ("Seed", &meadow.scene.grass.seed.to_string()),
        ("Software", concat!("sward ", env!("CARGO_PKG_VERSION"))),
        ("Engine", stage.engine().name()),
        ("Adapter", &gpu.adapter.name),
    ])
}

/// Writes a picture into a folder, as `sward-SCENE-TICK.png` or, where that exists, with a number.
/// The file appears complete or not at all.
///
/// # Errors
/// The encoder's and the file system's.
pub fn save(
    picture: &Picture,
    stage: &Stage,
    gpu: &Gpu,
    folder: &Path,
) -> Result<PathBuf, Failure> {
    let png = encode(picture, stage, gpu)?;
    fs::create_dir_all(folder).map_err(|e| Failure::file(folder, e))?;
    let name = format!("sward-{}-{}", stage.loaded().name, stage.meadow().ticks);
    let mut path = folder.join(format!("{name}.png"));
    let mut number = 2;
    while path.exists() {
        path = folder.join(format!("{name}-{number}.png"));
        number += 1;
    }
    let unfinished = path.with_extension("png.part");
    fs::write(&unfinished, png).map_err(|e| Failure::file(&unfinished, e))?;
    fs::rename(&unfinished, &path).map_err(|e| Failure::file(&path, e))?;
    Ok(path)
}
