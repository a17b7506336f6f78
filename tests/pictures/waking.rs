//! What a tile that wakes does to a picture.

use libtest_mimic::Failed;
use sward::gpu::Gpu;

use super::{ALL, Shown, Stage, WHOLE, difference, hold};

/// A ball 1 cm below the longest blade's length wakes the tiles under it; no blade stands so straight that
/// it touches.
const BALL: &str = "bodies: [(name: \"ball\", shape: Ball(radius_m: 0.1), position_m: (0.0, 0.69, 0.0), \
    motion: Fixed)]";
/// Kinds by their shares alone.
const BY_SHARE: &str = "grass: (species: [(height_m: (0.3, 0.6)), (form: Leaf, height_m: (0.1, 0.2)), \
    (form: Gravel, response: Shoved, height_m: (0.05, 0.1), width_m: (0.02, 0.05)), \
    (form: Flower(head_m: 0.05, petal_rgb: (0.8, 0.7, 0.1), centre_rgb: (0.3, 0.2, 0.1)))])";
/// Kinds by the ground's colours, in clusters, in strong wind.
const BY_COLOUR: &str = "wind: (strength: 0.3, gust: 0.3), grass: (density_per_m2: 300, cluster: 8, species: [\
    (name: \"a\", height_m: (0.3, 0.6), likes: Some((hsv: (88, 0.5, 0.45)))), \
    (name: \"b\", form: Twig, height_m: (0.02, 0.04), likes: Some((hsv: (75, 0.43, 0.5)))), \
    (name: \"c\", form: Gravel, response: Stays, height_m: (0.05, 0.1), width_m: (0.02, 0.05), \
     likes: Some((hsv: (55, 0.36, 0.54))))])";

/// A tile that wakes draws its plants from its nodes instead of their seeds. Where nothing pushes them
/// that changes no pixel, near by and where plants are left out and simpler.
pub fn waking_changes_no_pixel(gpu: &Gpu) -> Result<(), Failed> {
    for grass in [BY_SHARE, BY_COLOUR] {
        changes_no_pixel(gpu, &format!("({grass}, {BALL})"))?;
    }
    Ok(())
}

fn changes_no_pixel(gpu: &Gpu, scene: &str) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, scene, 2)?;
    hold(!stage.nodes.tiles.is_empty(), "no tile is awake")?;
    let distances = [12.0, 2.0, 0.7];
    let shot = |stage: &mut Stage, full_m: f32, active: bool| {
        let shown = Shown {
            full_m,
            active,
            ..ALL
        };
        stage.shoot(gpu, shown)
    };
    let mut awake = Vec::new();
    for full_m in distances {
        awake.push(shot(&mut stage, full_m, true)?);
    }
    // What a wrong pose would change.
    let lost = vec![[0.0, -9.0, 0.0, 0.0]; stage.nodes.nodes.len()];
    stage.nodes.nodes.write(gpu, 0, &lost)?;
    for (full_m, awake) in distances.into_iter().zip(&awake) {
        let asleep = shot(&mut stage, full_m, false)?;
        let changed = (awake
            .rgba8
            .chunks_exact(4)
            .zip(asleep.rgba8.chunks_exact(4)))
        .filter(|(a, b)| a != b)
        .count();
        let spoiled = difference(&shot(&mut stage, full_m, true)?, &asleep, WHOLE);
        hold(
            changed == 0 && spoiled > 2.0,
            format!("in full up to {full_m} m {changed} pixels change, {spoiled} by lost nodes"),
        )?;
    }
    Ok(())
}
