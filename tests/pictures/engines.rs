//! The same scene drawn from the state of both engines.

use std::path::Path;

use libtest_mimic::Failed;
use sward::gpu::Gpu;
use sward::render::{Picture, PictureTarget};
use sward::run::{EngineChoice, Stage};
use sward::scene::{load_scene, parse_scene};

use super::{WHOLE, difference, hold};

const SIZE: [u32; 2] = [320, 200];
/// A ball lies in blades and clumps, and is taken out of them.
const PRESSED: &str = "(terrain: (ground: Flat(size_m: (6, 6))), \
    billboards: (density_per_m2: 30), solver: (recovery_s: 0.4), \
    bodies: [(name: \"ball\", shape: Ball(radius_m: 0.35), position_m: (0, 0.35, 0), motion: Fixed)], \
    script: [(at_s: 0.3, action: Remove(body: \"ball\"))], \
    cameras: [(name: \"over\", eye_m: (0.8, 1.6, 2.2), target_m: (0, 0.1, 0))])";
/// Poses of the engines differ by less than 0.1 mm, root mean square, which is a thirtieth of a pixel at two
/// metres; a tenth of the texels of a clump's edge may then be of another of five grey levels of coverage,
/// 51 apart. Edges are less than a tenth of the picture.
const MOST_RMS: f64 = 5.0;

fn shoot(gpu: &Gpu, stage: &mut Stage) -> Result<Picture, Failed> {
    let target = PictureTarget::new(gpu, SIZE)?;
    let view = stage.camera(Some("over"))?;
    stage.draw(gpu, &view, &target.view, false)?;
    Ok(target.read(gpu)?)
}

/// State and geometry of 60,000 billboards on the device with one body among them: O09's figure.
const MOST_BYTES: u64 = 12_000_000;

/// Of the scene of O09's measurements when its car drives off, on both engines.
pub fn sixty_thousand_clumps_fit(gpu: &Gpu) -> Result<(), Failed> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/meadow_60k.ron");
    let loaded = load_scene(&file, &[])?;
    for engine in [EngineChoice::Cpu, EngineChoice::Gpu] {
        let mut stage = Stage::new(gpu, &loaded, engine, PictureTarget::FORMAT, SIZE)?;
        while stage.meadow().time_s() < 0.6 {
            stage.tick()?;
        }
        let target = PictureTarget::new(gpu, SIZE)?;
        let view = stage.camera(Some("chase"))?;
        stage.draw(gpu, &view, &target.view, false)?;
        let bytes = stage.billboard_bytes().unwrap_or_default();
        let counts = stage.billboard_counts().unwrap_or_default();
        println!("{engine:?}: {bytes} bytes, {counts:?}");
        let all = stage
            .meadow()
            .field
            .billboards
            .as_ref()
            .map_or(0, |b| b.all.len());
        hold(
            all > 59_000 && counts.refined > 100,
            format!("{all}, {counts:?}"),
        )?;
        // A record has 32 bytes.
        hold(
            (32 * all as u64..=MOST_BYTES).contains(&bytes),
            format!("{bytes} bytes"),
        )?;
    }
    Ok(())
}

/// While a ball presses them, while they rise, and at rest.
pub fn both_engines_draw_alike(gpu: &Gpu) -> Result<(), Failed> {
    let loaded = parse_scene("pressed", PRESSED, &[])?;
    let stage = |engine| Stage::new(gpu, &loaded, engine, PictureTarget::FORMAT, SIZE);
    let mut stages = [stage(EngineChoice::Cpu)?, stage(EngineChoice::Gpu)?];
    let first = shoot(gpu, &mut stages[1])?;
    for until_s in [0.2, 0.45, 1.2] {
        let mut pictures = Vec::new();
        for stage in &mut stages {
            while stage.meadow().time_s() < until_s {
                stage.tick()?;
            }
            pictures.push(shoot(gpu, stage)?);
        }
        let counts = stages[1].billboard_counts().unwrap_or_default();
        let is_awake = until_s < 1.0;
        hold(
            (counts.refined > 0) == is_awake,
            format!("at {until_s} s: {counts:?}"),
        )?;
        let apart = difference(&pictures[0], &pictures[1], WHOLE);
        let since = difference(&pictures[1], &first, WHOLE);
        println!("at {until_s} s: engines {apart:.3} steps apart, {since:.2} from the begin");
        hold(
            apart <= MOST_RMS.min(0.2 * since),
            format!("{apart} steps at {until_s} s"),
        )?;
    }
    Ok(())
}
