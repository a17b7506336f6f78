//! Points of the report: methods on a scene, timed beside the default, and the error of each split
//! by where it comes from.

use super::lane::{FRAMES_PER_S, Kind, Lane, end_of_frame_s, frames};
use super::plan::Context;
use super::relative::Relative;
use super::store::Row;
use super::truth::Truth;
use crate::base::statistics::median;
use crate::gpu::{GpuError, knows_method};
use crate::run::compare::{Comparison, Plants};
use crate::run::methods::NamedMethod;
use crate::run::scenario::RunError;
use crate::run::watch::Watch;
use crate::scene::{LoadedScene, Solver};

/// Strain that a method may leave.
pub const MOST_STRAIN: f64 = 0.02;
/// Share of touched plants that may slide to another side of a body.
pub const MOST_FLIPS: f64 = 0.01;
/// Pose error that a method may have, in metres, root mean square.
pub const MOST_RMS_M: f64 = 0.010;

/// Runs methods on a scene in turns, frame by frame: each on the cpu engine for the total error and
/// the time, and where the plan asks for it with the same kernels in `f64` for the error of the method
/// alone, and on a graphics device that knows the method. The default is timed with them in every frame.
/// `progress` gets the share done.
///
/// # Errors
///
/// A scene that cannot be laid out; the device's.
pub fn measure(
    loaded: &LoadedScene,
    methods: &[&'static NamedMethod],
    truth: &Truth,
    context: &Context<'_>,
    mut progress: impl FnMut(f64),
) -> Result<Vec<Row>, RunError> {
    let mut default = Timed::new(Lane::new(loaded, &loaded.scene.solver, Kind::Single)?);
    let points = methods
        .iter()
        .map(|&method| Point::new(loaded, method, context));
    let mut points = points.collect::<Result<Vec<Point>, RunError>>()?;
    let count = frames(loaded.scene.duration_s);
    for frame in 0..count {
        let others = points.iter_mut().map(|point| &mut point.cpu);
        let mut timed: Vec<&mut Timed> = std::iter::once(&mut default).chain(others).collect();
        // The first to run finds the caches cold: each is first in turn. Nothing else runs between.
        let first = frame as usize % timed.len();
        timed.rotate_left(first);
        for timed in timed {
            timed.advance(frame)?;
        }
        for point in &mut points {
            point.compare(frame, truth.frames.get(frame as usize))?;
        }
        progress(f64::from(frame + 1) / f64::from(count));
    }
    let rows = points.into_iter();
    Ok(rows
        .map(|point| point.row(loaded, &default.frames_ms))
        .collect())
}

/// A run on the cpu engine, and what each of its frames took.
struct Timed {
    lane: Lane,
    frames_ms: Vec<Option<f64>>,
}

impl Timed {
    fn new(lane: Lane) -> Self {
        Self {
            lane,
            frames_ms: Vec::new(),
        }
    }

    fn advance(&mut self, frame: u32) -> Result<(), RunError> {
        self.lane.advance_to(end_of_frame_s(frame))?;
        self.frames_ms.push(self.lane.take_frame_ms());
        Ok(())
    }
}

/// A method on a scene while it is measured.
struct Point {
    method: &'static NamedMethod,
    solver: Solver,
    cpu: Timed,
    double: Option<Lane>,
    gpu: Option<Lane>,
    /// Why the device's lane ended early.
    refused: String,
    watch: Watch,
    total: Comparison,
    of_method: Comparison,
    precision: Comparison,
    rounding: Comparison,
}

impl Point {
    fn new(
        loaded: &LoadedScene,
        method: &'static NamedMethod,
        context: &Context<'_>,
    ) -> Result<Self, RunError> {
        let mut solver = loaded.scene.solver.clone();
        method.apply(&mut solver);
        let device = context.device_of(method.name);
        let device = device.filter(|_| knows_method(&solver.method));
        let lane = |kind| Lane::new(loaded, &solver, kind);
        let double = context.splits(method.name).then_some(Kind::Double);
        Ok(Self {
            method,
            cpu: Timed::new(Lane::new(loaded, &solver, Kind::Single)?),
            double: double.map(lane).transpose()?,
            gpu: device.map(Kind::Device).map(lane).transpose()?,
            solver,
            refused: String::new(),
            watch: Watch::default(),
            total: Comparison::default(),
            of_method: Comparison::default(),
            precision: Comparison::default(),
            rounding: Comparison::default(),
        })
    }

    /// What is measured at the end of a frame.
    fn compare(&mut self, frame: u32, truth: Option<&Plants>) -> Result<(), RunError> {
        let end_s = end_of_frame_s(frame);
        let cpu = &mut self.cpu.lane;
        let watched = self.watch.frame(&cpu.meadow, &mut cpu.engine);
        watched.map_err(|error| cpu.error(error))?;
        let plants = cpu.plants()?;
        if let Some(double) = &mut self.double {
            double.advance_to(end_s)?;
            let exact = double.plants()?;
            self.precision.frame(&plants, &exact);
            if let Some(truth) = truth {
                self.of_method.frame(&exact, truth);
            }
        }
        self.compare_device(end_s, &plants)?;
        if let Some(truth) = truth {
            self.total.frame(&plants, truth);
        }
        Ok(())
    }

    /// A driver that cannot run the kernels to their end says nothing about other points: its lane ends.
    fn compare_device(&mut self, end_s: f64, cpu: &Plants) -> Result<(), RunError> {
        let Some(gpu) = &mut self.gpu else {
            return Ok(());
        };
        match gpu.advance_to(end_s).and_then(|()| gpu.plants()) {
            Ok(plants) => {
                self.rounding.frame(&plants, cpu);
                Ok(())
            }
            Err(RunError::Gpu {
                source: source @ GpuError::CutShort { .. },
                ..
            }) => {
                self.refused = source.to_string();
                self.gpu = None;
                Ok(())
            }
            Err(error) => Err(error),
        }
    }

    fn row(&self, loaded: &LoadedScene, default_ms: &[Option<f64>]) -> Row {
        let field = &self.cpu.lane.meadow.field;
        let rms_m = |comparison: &Comparison| finite(comparison.finish(field).pose_rms_m);
        let difference = self.total.finish(field);
        let watch = &self.watch;
        let default_ms_per_s = ms_per_s(default_ms);
        let relative = Relative::of(&self.cpu.frames_ms, default_ms);
        Row {
            key: String::new(),
            program: String::new(),
            scene: loaded.name.clone(),
            method: self.method.name.to_owned(),
            family: self.method.family.to_owned(),
            substep_s: self.solver.substep_s,
            times_default: relative.map(|r| r.median),
            times_default_low: relative.map(|r| r.low),
            times_default_high: relative.map(|r| r.high),
            default_ms_per_s,
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
            rounding_rms_m: self.gpu.as_ref().and_then(|_| rms_m(&self.rounding)),
            precision_rms_m: self.double.as_ref().and_then(|_| rms_m(&self.precision)),
            method_rms_m: self.double.as_ref().and_then(|_| rms_m(&self.of_method)),
            rounding_refused: self.refused.clone(),
        }
    }
}

/// Milliseconds per simulated second, from the median frame in which a body was near grass.
fn ms_per_s(frames_ms: &[Option<f64>]) -> f64 {
    let at_work: Vec<f64> = frames_ms.iter().copied().flatten().collect();
    median(&at_work).unwrap_or(0.0) * FRAMES_PER_S
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
    /// The limits that this point misses, in words; none for a point that passes. Where the references
    /// differ by more than the limit themselves, poses and sides are not judged.
    pub fn misses(&self, floor: &Self) -> Vec<&'static str> {
        let judged = floor.judges_poses();
        let flips = self.side_flips as f64 > MOST_FLIPS * self.touched_plants as f64;
        let checks = [
            ("not finite", self.not_finite > 0 || self.rms_m.is_none()),
            ("penetration", self.penetration_over_limit > 1.0),
            ("strain", self.strain > MOST_STRAIN),
            ("sides", judged && flips),
            (
                "poses",
                judged && self.rms_m.is_some_and(|rms| rms > MOST_RMS_M),
            ),
        ];
        let missed = checks.into_iter().filter(|check| check.1);
        missed.map(|check| check.0).collect()
    }

    /// Of a noise floor: whether it is below the limit of poses.
    pub fn judges_poses(&self) -> bool {
        self.rms_m.is_none_or(|floor_m| floor_m <= MOST_RMS_M)
    }

    /// The time over that of the default, where the scene had any work.
    pub fn relative(&self) -> Option<Relative> {
        Some(Relative {
            median: self.times_default?,
            low: self.times_default_low?,
            high: self.times_default_high?,
        })
    }
}
