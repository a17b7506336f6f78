//! Where blades end: the ground takes over their look.

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::gpu::Gpu;
use sward::render::{Picture, Sun, View};

use super::{ALL, Shown, Stage, hold};

/// How much lighter or darker the ground may be than the blades that it stands for. Their meeting is drawn
/// over tens of metres, and single blades differ by far more than this from each other; with the light of
/// bare ground in place of the blades' own a low sun left it 0.4 times as light.
const MOST_APART: f64 = 0.12;

/// Mean light, linear and weighted as the eye does, of what is not sky.
fn light(picture: &Picture) -> f64 {
    let linear = |byte: u8| {
        let value = f64::from(byte) / 255.0;
        if value <= 0.04045 {
            value / 12.92
        } else {
            ((value + 0.055) / 1.055).powf(2.4)
        }
    };
    let texels = picture.rgba8.chunks_exact(4);
    let count = texels.len() as f64;
    let sum = texels.fold(0.0, |sum, texel| {
        sum + 0.2126 * linear(texel[0]) + 0.7152 * linear(texel[1]) + 0.0722 * linear(texel[2])
    });
    sum / count
}

/// The same place drawn with every blade and with none, from the heights and directions of a day's suns.
pub fn ground_far_off_looks_like_its_plants(gpu: &Gpu) -> Result<(), Failed> {
    let scene = "(terrain: (ground: Flat(size_m: (48, 48))), wind: (strength: 0, gust: 0))";
    let mut stage = Stage::new(gpu, scene, 0)?;
    let mut worst = 0.0_f64;
    for elevation_deg in [50.0, 20.0, 10.0, 6.0] {
        for azimuth_deg in [90.0, 0.0, -90.0] {
            let sun = Sun {
                elevation_deg,
                azimuth_deg,
            };
            let near = Shown {
                view: View::look_at(Vec3::new(0.0, 3.0, 12.0), Vec3::new(0.0, 0.0, 0.0), 12.0),
                sun,
                full_m: 40.0,
                reach_m: 80.0,
                tuft: 4,
                ..ALL
            };
            let far = Shown {
                full_m: 0.5,
                reach_m: 1.0,
                ..near
            };
            let [blades, ground] =
                [stage.shoot(gpu, near)?, stage.shoot(gpu, far)?].map(|p| light(&p));
            let ratio = ground / blades;
            println!(
                "sun at {elevation_deg}, {azimuth_deg}: ground {ground:.4}, blades {blades:.4}: {ratio:.3}"
            );
            worst = worst.max((ratio - 1.0).abs());
        }
    }
    hold(worst <= MOST_APART, format!("light differs by {worst:.3}"))
}
