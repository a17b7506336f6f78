//! One point of the report: a method on a scene, timed, and its error split by where it comes from.

use super::lane::{Kind, Lane, end_of_frame_s, frames};
use super::store::Row;
use super::truth::Truth;
use crate::base::statistics::median;
use crate::gpu::knows_method;
use crate::run::compare::Comparison;
use crate::run::methods::NamedMethod;
use crate::run::scenario::{Device, RunError};
use crate::run::watch::Watch;
use crate::scene::LoadedScene;

/// Strain that a method may leave.
const MOST_STRAIN: f64 = 0.02;
/// Share of touched plants that may slide to another side of a body.
const MOST_FLIPS: f64 = 0.01;
/// Pose error that a method may have, in metres, root mean square.
pub const MOST_RMS_M: f64 = 0.010;

/// Runs a method on a scene: on the cpu engine for the total error and the time, with the same
/// kernels in `f64` for the error of the method alone, and on a graphics device where there is one
/// that knows the method. Nothing else runs in the timed part.
///
/// # Errors
///
/// A scene that cannot be laid out; the device's.
pub fn measure(
    loaded: &LoadedScene,
    method: &NamedMethod,
    truth: &Truth,
    gpu: Option<&Device>,
) -> Result<Row, RunError> {
    let mut solver = loaded.scene.solver.clone();
    method.apply(&mut solver);
    let mut cpu = Lane::new(loaded, &solver, Kind::Single)?;
    let mut double = Lane::new(loaded, &solver, Kind::Double)?;
    let gpu = gpu.filter(|_| knows_method(&solver.method));
    let device = |device| Lane::new(loaded, &solver, Kind::Device(device));
    let mut gpu = gpu.map(device).transpose()?;
    let mut watch = Watch::default();
    let [mut total, mut of_method, mut precision, mut rounding] =
        std::array::from_fn(|_| Comparison::default());
    for frame in 0..frames(loaded.scene.duration_s) {
        let end_s = end_of_frame_s(frame);
        cpu.advance_to(end_s)?;
        let watched = watch.frame(&cpu.meadow, &mut cpu.engine);
        watched.map_err(|error| cpu.error(error))?;
        let plants = cpu.plants()?;
        double.advance_to(end_s)?;
        let exact = double.plants()?;
        if let Some(gpu) = &mut gpu {
            gpu.advance_to(end_s)?;
            rounding.frame(&gpu.plants()?, &plants);
        }
        precision.frame(&plants, &exact);
        if let Some(truth) = truth.frames.get(frame as usize) {
            total.frame(&plants, truth);
            of_method.frame(&exact, truth);
        }
    }
    let field = &cpu.meadow.field;
    let rms_m = |comparison: &Comparison| finite(comparison.finish(field).pose_rms_m);
    let difference = total.finish(field);
    let ms_per_substep = median(&cpu.grass_ms).unwrap_or(0.0);
    Ok(Row {
        key: String::new(),
        scene: loaded.name.clone(),
        method: method.name.to_owned(),
        family: method.family.to_owned(),
        substep_s: solver.substep_s,
        ms_per_substep,
        ms_per_s: ms_per_substep / solver.substep_s,
        rms_m: finite(difference.pose_rms_m),
        p95_m: finite(difference.pose_p95_m),
        rms_lengths: finite(difference.pose_rms_lengths),
        p95_lengths: finite(difference.pose_p95_lengths),
        imprint_iou: difference.imprint_iou,
        side_flips: difference.side_flips,
        touched_plants: difference.touched_plants,
        penetration_max_m: watch.max_penetration_m(),
        penetration_p999_m: watch.p999_penetration_m(),
        penetration_rms_m: watch.rms_penetration_m(),
        penetration_middle_m: watch.max_middle_m,
        penetration_over_limit: watch.worst.depth_m / watch.worst.limit_m,
        over_push_m: watch.over_push_m,
        strain: watch.max_strain,
        not_finite: watch.not_finite,
        rounding_rms_m: gpu.and_then(|_| rms_m(&rounding)),
        precision_rms_m: rms_m(&precision),
        method_rms_m: rms_m(&of_method),
    })
}

/// A number that can be stored; `None` for what blew up.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// The noise floor of a scene as a row of its own.
pub fn floor_row(loaded: &LoadedScene, truth: &Truth) -> Row {
    let floor = &truth.floor;
    Row {
        scene: loaded.name.clone(),
        method: super::FLOOR.to_owned(),
        family: super::FLOOR.to_owned(),
        rms_m: finite(floor.pose_rms_m),
        p95_m: finite(floor.pose_p95_m),
        rms_lengths: finite(floor.pose_rms_lengths),
        p95_lengths: finite(floor.pose_p95_lengths),
        imprint_iou: floor.imprint_iou,
        side_flips: floor.side_flips,
        touched_plants: floor.touched_plants,
        ..Row::default()
    }
}

impl Row {
    /// The limits that this point misses, in words; none for a point that passes.
    pub fn misses(&self) -> Vec<&'static str> {
        let flips = self.side_flips as f64 > MOST_FLIPS * self.touched_plants as f64;
        let checks = [
            ("not finite", self.not_finite > 0 || self.rms_m.is_none()),
            ("penetration", self.penetration_over_limit > 1.0),
            ("strain", self.strain > MOST_STRAIN),
            ("sides", flips),
            ("poses", self.rms_m.is_some_and(|rms| rms > MOST_RMS_M)),
        ];
        let missed = checks.into_iter().filter(|check| check.1);
        missed.map(|check| check.0).collect()
    }
}
