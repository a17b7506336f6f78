//! Pictures as they were when somebody looked at them and found them right.
//!
//! The rasteriser is part of a golden: it lies in a folder named after the adapter and its driver,
//! and on any other adapter the trial is ignored. `SWARD_BLESS=1 cargo test --release --test goldens`
//! draws them anew; look at them before committing. On failure the picture that was drawn is left
//! beside its golden as `NAME.actual.png`.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use libtest_mimic::{Arguments, Failed, Trial};
use sward::gpu::Gpu;
use sward::render::{Picture, PictureTarget};
use sward::run::{EngineChoice, Stage};
use sward::scene::builtin::load_builtin;

/// Scene, camera and the sub-step at which its picture is taken.
const GOLDENS: &[(&str, &str, u32)] = &[
    ("ball_roll", "side", 192),
    ("meadow", "above", 60),
    ("mesh_drop", "above", 120),
];
const SIZE: [u32; 2] = [160, 90];
/// Largest root mean square difference, in 8-bit steps: a thread count may move a few samples on
/// an edge by one of four coverage steps (64), which in 1 pixel of 1,000 gives 2.
const LARGEST_RMS: f64 = 2.0;

fn folder(gpu: &Gpu) -> PathBuf {
    let name = format!("{} {}", gpu.adapter.name, gpu.adapter.driver);
    let slug: String = name
        .chars()
        .map(|c| {
            if c.is_ascii_alphanumeric() {
                c.to_ascii_lowercase()
            } else {
                '-'
            }
        })
        .collect();
    let slug: Vec<&str> = slug.split('-').filter(|part| !part.is_empty()).collect();
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/goldens")
        .join(slug.join("-"))
}

fn draw(gpu: &Gpu, scene: &str, camera: &str, ticks: u32) -> Result<Picture, Failed> {
    let loaded = load_builtin(scene).ok_or("no such scene")??;
    let target = PictureTarget::new(gpu, SIZE)?;
    let mut stage = Stage::new(gpu, &loaded, EngineChoice::Cpu, PictureTarget::FORMAT, SIZE)?;
    for _ in 0..ticks {
        stage.tick()?;
    }
    let view = stage.camera(Some(camera))?;
    stage.draw(gpu, &view, &target.view, false)?;
    Ok(target.read(gpu)?)
}

fn read(path: &Path) -> Result<Vec<u8>, Failed> {
    let file = std::io::BufReader::new(fs::File::open(path)?);
    let mut reader = png::Decoder::new(file).read_info()?;
    let size = reader
        .output_buffer_size()
        .ok_or("a golden too large to read")?;
    let mut pixels = vec![0; size];
    reader.next_frame(&mut pixels)?;
    Ok(pixels)
}

fn compare(gpu: &Gpu, (scene, camera, ticks): (&str, &str, u32)) -> Result<(), Failed> {
    let golden = folder(gpu).join(format!("{scene}.png"));
    let picture = draw(gpu, scene, camera, ticks)?;
    if std::env::var_os("SWARD_BLESS").is_some_and(|v| v == "1") {
        fs::create_dir_all(folder(gpu))?;
        fs::write(&golden, picture.to_png(&[("driver", &gpu.adapter.driver)])?)?;
        return Ok(());
    }
    let wanted = read(&golden)?;
    if wanted.len() != picture.rgba8.len() {
        return Err(format!("{} has another size or format", golden.display()).into());
    }
    let squares = wanted.iter().zip(&picture.rgba8);
    let sum: f64 = squares
        .map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2))
        .sum();
    let rms = (sum / wanted.len() as f64).sqrt();
    if rms > LARGEST_RMS {
        let actual = golden.with_extension("actual.png");
        fs::write(&actual, picture.to_png(&[])?)?;
        let place = actual.display();
        return Err(
            format!("differs by {rms:.2} steps RMS, limit {LARGEST_RMS}: see {place}").into(),
        );
    }
    Ok(())
}

fn main() {
    let arguments = Arguments::from_args();
    let gpu = Arc::new(Gpu::headless());
    let bless = std::env::var_os("SWARD_BLESS").is_some_and(|v| v == "1");
    // A golden belongs to one adapter and driver: elsewhere there is nothing to compare with.
    let known = |scene: &str| match &*gpu {
        Ok(gpu) => bless || folder(gpu).join(format!("{scene}.png")).exists(),
        Err(_) => false,
    };
    let trials = GOLDENS
        .iter()
        .map(|&golden| {
            let shared = Arc::clone(&gpu);
            let run = move || match &*shared {
                Ok(gpu) => compare(gpu, golden),
                Err(error) => Err(error.to_string().into()),
            };
            Trial::test(golden.0, run).with_ignored_flag(!known(golden.0))
        })
        .collect();
    libtest_mimic::run(&arguments, trials).exit();
}
