//! The bench of popping: how much of a picture's change from frame to frame comes from plants that
//! appear and vanish, as P15 section 4 leaves them.
//!
//! A camera moves slowly through still grass. Popping is what its way changes and its motion does not:
//! every picture is compared with one from the same place whose plants are still those of the place
//! before, as a root mean square. Beside it stands the change from frame to frame of the same path at full
//! density, where nothing comes or goes: that of the motion, within which popping is seen. (Taken from the
//! change from frame to frame instead, popping cannot be told: fewer and wider blades move fewer edges.)
//!
//! A blade that grows flips single samples of pixels, as every moving edge does: the grain of the
//! rasteriser. So pictures are also compared after taking the mean over squares of pixels, where single
//! samples hardly count and whole blades do.

use serde::Serialize;

use super::machine::Machine;
use super::still_field::{DrawBenchError, StillField};
use super::tiles::Limit;
use crate::base::Vec3;
use crate::field::WindNow;
use crate::gpu::Gpu;
use crate::render::{BladeDetail, Picture, PictureTarget, Transition, View};
use crate::run::report::Adapter;
use crate::scene::{Ground, Terrain};
use crate::terrain::HeightGrid;

/// Field along x and z, in metres.
const FIELD_M: [f32; 2] = [60.0, 54.0];
/// Steps of the camera, in metres, and their number.
const STEP_M: f64 = 0.008;
const FRAMES: u32 = 13;
/// Of the path at full density, millions of plants each.
const FULL_FRAMES: u32 = 3;
const EYE_M: f64 = 1.2;
const PICTURE: [u32; 2] = [1920, 1080];
/// Sides of the squares of pixels over which pictures are averaged.
const SQUARES_PX: [usize; 3] = [1, 16, 48];
/// Least ratio of plain to smooth popping that `--check` lets pass, and the square it is taken over.
const LEAST_RATIO: f64 = 5.0;
const JUDGED: usize = 2;

/// Results of the whole bench.
#[derive(Clone, Debug, Serialize)]
pub struct PoppingBench {
    pub schema_version: u32,
    /// Version of sward.
    pub sward: &'static str,
    pub machine: Machine,
    pub adapter: Adapter,
    pub frames: u32,
    pub picture: [u32; 2],
    pub rows: Vec<PoppingRow>,
    pub limits: Vec<Limit>,
}

/// Root mean square changes per frame over squares of one size, in steps of 8 bits.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PoppingRow {
    pub square_px: usize,
    /// Of the motion, at full density.
    pub motion: f64,
    pub smooth_popping: f64,
    pub plain_popping: f64,
}

impl PoppingRow {
    /// How much less smooth transitions pop.
    pub fn ratio(&self) -> f64 {
        self.plain_popping / self.smooth_popping
    }
}

impl PoppingBench {
    pub fn all_kept(&self) -> bool {
        self.limits.iter().all(|limit| limit.kept)
    }
}

/// Runs the bench; `progress` gets the share done.
///
/// # Errors
///
/// A device that cannot hold the plants.
pub fn bench_popping(
    gpu: &Gpu,
    mut progress: impl FnMut(f64),
) -> Result<PoppingBench, DrawBenchError> {
    let machine = Machine::now();
    let mut rig = Rig::new(gpu)?;
    // The coarsest that the program itself chooses, where most comes and goes.
    let near = BladeDetail {
        // They end with `full_m`, which differs between the paths.
        shadows: false,
        ..BladeDetail::software()
    };
    let plain = BladeDetail {
        transition: Transition::Plain,
        ..near
    };
    let full = BladeDetail {
        full_m: 1000.0,
        reach_m: 2000.0,
        ..near
    };
    let motion = rig.changes(gpu, full, Compared::FrameBefore, FULL_FRAMES, |part| {
        progress(0.2 * part)
    })?;
    let smooth = rig.changes(gpu, near, Compared::PlantsBefore, FRAMES, |part| {
        progress(0.2 + 0.4 * part);
    })?;
    let plain = rig.changes(gpu, plain, Compared::PlantsBefore, FRAMES, |part| {
        progress(0.6 + 0.4 * part);
    })?;
    let rows: Vec<PoppingRow> = (SQUARES_PX.iter().enumerate())
        .map(|(n, &square_px)| PoppingRow {
            square_px,
            motion: motion[n],
            smooth_popping: smooth[n],
            plain_popping: plain[n],
        })
        .collect();
    let ratio = rows[JUDGED].ratio();
    Ok(PoppingBench {
        schema_version: 1,
        sward: env!("CARGO_PKG_VERSION"),
        machine,
        adapter: Adapter::of(gpu),
        frames: FRAMES,
        picture: PICTURE,
        limits: vec![Limit {
            what: "smooth transitions pop less, over squares of 48 pixels, by a factor of at least",
            measured: ratio,
            limit: LEAST_RATIO,
            unit: "",
            kept: ratio >= LEAST_RATIO,
        }],
        rows,
    })
}

/// What a frame's picture is compared with.
#[derive(Clone, Copy, Eq, PartialEq)]
enum Compared {
    FrameBefore,
    /// The same view with the plants of the frame before.
    PlantsBefore,
}

/// A field and the picture that it is drawn into.
struct Rig {
    still: StillField,
    target: PictureTarget,
}

impl Rig {
    fn new(gpu: &Gpu) -> Result<Self, DrawBenchError> {
        let terrain = Terrain {
            ground: Ground::Flat {
                size_m: FIELD_M,
                spacing_m: 1.0,
            },
            ..Terrain::default()
        };
        let [columns, rows] = FIELD_M.map(|side| side as u32 + 1);
        let ground = HeightGrid::flat(columns, rows, 1.0);
        let wind = WindNow::default();
        Ok(Self {
            still: StillField::new(gpu, &terrain, ground, wind, PICTURE)?,
            target: PictureTarget::new(gpu, PICTURE)?,
        })
    }

    /// Root mean square changes over the path, for every size of squares.
    fn changes(
        &mut self,
        gpu: &Gpu,
        detail: BladeDetail,
        compared: Compared,
        frames: u32,
        mut progress: impl FnMut(f64),
    ) -> Result<[f64; SQUARES_PX.len()], DrawBenchError> {
        let mut sums = [0.0; SQUARES_PX.len()];
        let mut last = self.shoot(gpu, [0, 0], detail)?;
        for frame in 1..frames {
            let picture = self.shoot(gpu, [frame, frame], detail)?;
            if compared == Compared::PlantsBefore {
                last = self.shoot(gpu, [frame, frame - 1], detail)?;
            }
            for (sum, square) in sums.iter_mut().zip(SQUARES_PX) {
                *sum += mean_square_change(&last, &picture, square);
            }
            last = picture;
            progress(f64::from(frame) / f64::from(frames - 1));
        }
        Ok(sums.map(|sum| (sum / f64::from(frames - 1)).sqrt()))
    }

    /// The picture from the place of one frame with the plants of another.
    fn shoot(
        &mut self,
        gpu: &Gpu,
        [seen, judged]: [u32; 2],
        detail: BladeDetail,
    ) -> Result<Picture, DrawBenchError> {
        let eye = eye_at(seen);
        let detail = BladeDetail {
            judged_from: Some(eye_at(judged)),
            ..detail
        };
        let view = View::look_at(eye, eye + Vec3::new(0.0, -0.28, -1.0), 45.0);
        let (renderer, timer, input) = self.still.frame(&view, detail);
        renderer.draw(gpu, &input, &self.target.view, timer)?;
        Ok(self.target.read(gpu)?)
    }
}

fn eye_at(frame: u32) -> Vec3<f64> {
    let z = 0.5 * f64::from(FIELD_M[1]) - 1.0 - STEP_M * f64::from(frame);
    Vec3::new(0.1, EYE_M, z)
}

/// Mean square of the differences of two pictures' colours, each averaged over squares of pixels.
fn mean_square_change(a: &Picture, b: &Picture, square: usize) -> f64 {
    let (width, height) = (a.width as usize, a.height as usize);
    let (mut sum, mut count) = (0.0, 0.0);
    for top in (0..=height - square).step_by(square) {
        for left in (0..=width - square).step_by(square) {
            for channel in 0..3 {
                let mut apart = 0.0;
                for y in top..top + square {
                    for x in left..left + square {
                        let at = (y * width + x) * 4 + channel;
                        apart += f64::from(a.rgba8[at]) - f64::from(b.rgba8[at]);
                    }
                }
                apart /= (square * square) as f64;
                sum += apart * apart;
                count += 1.0;
            }
        }
    }
    sum / count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_averaged_over_squares() {
        let black = Picture {
            width: 4,
            height: 4,
            rgba8: vec![0; 64],
        };
        let mut dotted = black.clone();
        dotted.rgba8[..4].fill(16);
        assert_eq!(mean_square_change(&black, &dotted, 1), 16.0);
        assert_eq!(mean_square_change(&black, &dotted, 2), 4.0);
        assert_eq!(mean_square_change(&black, &dotted, 4), 1.0);
    }
}
