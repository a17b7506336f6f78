//! The picture of how a failing scenario ended, or the reason why there is none.

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::app::Failure;
use crate::app::light_up::light_up;
use crate::gpu::{Gpu, GpuError};
use crate::render::PictureTarget;
use crate::run::{Device, Outcome, RunOptions, Stage, run_scene};
use crate::scene::LoadedScene;

/// Width and height of the picture, in pixels.
const SIZE: [u32; 2] = [960, 540];

/// How a failing scenario ended.
pub enum End {
    /// At its end, with an expectation that does not hold.
    Whole(Box<Outcome>),
    /// With an error, after so many whole sub-steps.
    BrokenOff { ticks: u32, error: String },
}

/// The scene as it stood at its end or after its last whole sub-step, as a PNG.
///
/// A run that was broken off has taken its state with it: it is done again up to there, by the cpu
/// engine, since a device may be what failed.
///
/// # Errors
///
/// Why there is no picture, in words.
pub fn picture(
    loaded: &LoadedScene,
    options: &RunOptions,
    end: End,
    device: &Device,
) -> Result<Vec<u8>, String> {
    let (outcome, gpu) = match end {
        End::Whole(outcome) => (*outcome, device.gpu().cloned()),
        End::BrokenOff { ticks, .. } => (again(loaded, options, ticks)?, None),
    };
    let gpu = match gpu {
        Some(gpu) => gpu,
        None => Gpu::headless().map_err(|error| match error {
            GpuError::NoAdapter { .. } | GpuError::NoDevice { .. } => {
                format!("no graphics adapter can draw it ({error})")
            }
            error => error.to_string(),
        })?,
    };
    drawn(loaded, outcome, &gpu).map_err(|error| error.to_string())
}

/// Runs the first sub-steps once more.
fn again(loaded: &LoadedScene, options: &RunOptions, ticks: u32) -> Result<Outcome, String> {
    let options = RunOptions {
        ticks: Some(ticks),
        against_reference: false,
        ..options.clone()
    };
    let run = || run_scene(loaded, &options, &Device::Processor, |_| {});
    match catch_unwind(AssertUnwindSafe(run)) {
        Ok(Ok(outcome)) => Ok(outcome),
        Ok(Err(error)) => Err(format!("nothing was there yet ({error})")),
        Err(_) => Err("doing the run again up to there ended in an internal error".to_owned()),
    }
}

fn drawn(loaded: &LoadedScene, outcome: Outcome, gpu: &Gpu) -> Result<Vec<u8>, Failure> {
    let target = PictureTarget::new(gpu, SIZE)?;
    let time = format!("{:.6} s", outcome.meadow.time_s());
    let mut stage = Stage::of_run(gpu, loaded, outcome, PictureTarget::FORMAT, SIZE)?;
    light_up(gpu, &mut stage)?;
    let view = stage.camera(None)?;
    stage.draw(gpu, &view, &target.view, false)?;
    let texts = [("Scene", loaded.name.as_str()), ("Time", &time)];
    Ok(target.read(gpu)?.to_png(&texts)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parse_scene;

    const ROLL: &str = r#"(
        duration_s: 0.5,
        terrain: (ground: Flat(size_m: (2, 2))),
        bodies: [(name: "ball", shape: Ball(radius_m: 0.15), position_m: (0, 0.15, 0))],
    )"#;

    fn broken_off(text: &str, ticks: u32) -> Result<Vec<u8>, String> {
        let loaded = parse_scene("roll", text, &[]).expect("a valid scene");
        let end = End::BrokenOff {
            ticks,
            error: "made up".into(),
        };
        picture(&loaded, &RunOptions::default(), end, &Device::Processor)
    }

    #[test]
    fn a_run_that_was_broken_off_is_shown_at_its_last_whole_sub_step() {
        let loaded = parse_scene("roll", ROLL, &[]).expect("a valid scene");
        let outcome = again(&loaded, &RunOptions::default(), 7).expect("seven sub-steps");
        assert_eq!(outcome.meadow.ticks, 7);
        match (broken_off(ROLL, 7), Gpu::headless()) {
            (Ok(png), _) => assert!(png.starts_with(b"\x89PNG")),
            (Err(reason), Err(_)) => assert!(reason.contains("adapter"), "{reason}"),
            (Err(reason), Ok(_)) => panic!("an adapter is there: {reason}"),
        }
    }
}
