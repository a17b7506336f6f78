//! What the renderer does not take.

use libtest_mimic::Failed;
use sward::gpu::{Gpu, PassTimer};
use sward::render::{Exposure, FrameInput, PictureTarget, Renderer, Sun, bodies_at};

use super::{ALL, BALL, Stage, hold};

pub fn what_cannot_be_drawn_is_refused(gpu: &Gpu) -> Result<(), Failed> {
    for size in [[0, 10], [10, 0], [1 << 20, 10], [8192, 8192]] {
        match Renderer::new(gpu, PictureTarget::FORMAT, size) {
            Err(error) => {
                let text = error.to_string();
                let named = size.iter().all(|side| text.contains(&side.to_string()));
                hold(named, format!("{size:?}: {text}"))?;
            }
            Ok(_) => {
                // A device may well hold the last one.
                hold(size == [8192, 8192], format!("{size:?} was taken"))?;
            }
        }
    }
    let mut stage = Stage::new(gpu, BALL, 1)?;
    let mut bodies = bodies_at(&stage.meadow, 1.0);
    bodies[0].shape = 99;
    let input = FrameInput {
        view: &ALL.view,
        sun: Sun::default(),
        exposure: Exposure::default(),
        bodies: &bodies,
        blades: None,
        marks: &[],
        time_s: 0.0,
    };
    let mut timer = PassTimer::new(gpu, 8);
    let refused = stage
        .renderer
        .draw(gpu, &input, &stage.target.view, &mut timer);
    let text = refused.err().map(|error| error.to_string());
    hold(
        text.as_ref().is_some_and(|text| text.contains("shape 99")),
        format!("{text:?}"),
    )
}
