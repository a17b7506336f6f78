//! Time that is zero, negative, not a number, far too long or ragged.

use libtest_mimic::Failed;
use sward::base::philox::{philox2x32, unit};
use sward::run::{Device, EngineChoice, RunOptions, Stage, Timeline, run_scene};
use sward::sim::measure;

use super::Measured;
use super::rig::{CALM, Rig, Setting, ensure, parse};

const SUBSTEP_S: f64 = 1.0 / 120.0;
/// Longest time that a displayed frame of the window may add, in seconds.
const LONGEST_FRAME_S: f64 = 0.25;
/// Times that no clock may hand out.
const BAD_S: [f64; 5] = [-1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e-9];

/// A ball on its way through a small meadow.
fn rolling(setting: &Setting, velocity_m_per_s: f64, solver: &str) -> String {
    format!(
        "(duration_s: 2, terrain: (ground: Flat(size_m: (3, 2))), {CALM}, bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.15), position_m: (-0.9, 0.15, 0),
             motion: Thrown(velocity_m_per_s: ({velocity_m_per_s:?}, 0, 0)), collider: {})],
          solver: ({solver}))",
        setting.collider()
    )
}

/// Lets a clock run for a frame.
fn frame(rig: &mut Rig, timeline: &mut Timeline, frame_s: f64) -> Result<u32, Failed> {
    let due = timeline.advance(frame_s);
    rig.ticks(due)?;
    Ok(due)
}

/// dt 0, negative, not a number, tiny, half a second and five. A method that multiplies by Δt
/// explodes at 0.5 s, divides by zero at 0, and keeps a NaN for ever.
pub fn bad_time(setting: &Setting) -> Measured {
    let mut rig = setting.rig(&rolling(setting, 1.0, ""))?;
    let mut timeline = Timeline::unlimited(SUBSTEP_S);
    frame(&mut rig, &mut timeline, 0.25)?;
    let before = rig.bits()?;
    for frame_s in BAD_S.into_iter().chain([0.0]) {
        let due = frame(&mut rig, &mut timeline, frame_s)?;
        let same = rig.bits()? == before;
        ensure(due == 0 && same, || {
            format!("a frame of {frame_s} s changed something")
        })?;
    }
    for _ in 0..1000 {
        frame(&mut rig, &mut timeline, 1e-9)?;
    }
    ensure(rig.bits()? == before, || {
        "1000 frames of 1e-9 s changed something".into()
    })?;
    // Headless: every sub-step of a long frame, whether it comes as one frame or as many.
    let long = frame(&mut rig, &mut timeline, 0.5)? + frame(&mut rig, &mut timeline, 5.0)?;
    ensure(long == 660, || {
        format!("5.5 s gave {long} sub-steps, not 660")
    })?;
    rig.look()?;
    let mut steady = setting.rig(&rolling(setting, 1.0, ""))?;
    steady.ticks(30 + 660)?;
    ensure(rig.bits()? == steady.bits()?, || {
        "a long frame is not its sub-steps".into()
    })?;

    let refused = refuses_bad_sub_steps(setting)?;
    let capped = reports_capped_sweeps(setting)?;
    Ok(format!(
        "dt 0 and 6 bad ones change no bit, 5.5 s give 660 sub-steps, {refused} sub-steps refused, \
         {capped} capped sub-steps reported"
    ))
}

/// Sub-steps outside the range of a scene's are refused with a sentence, before anything runs.
fn refuses_bad_sub_steps(setting: &Setting) -> Result<usize, Failed> {
    let loaded = parse(&rolling(setting, 1.0, ""))?;
    let bad: Vec<f64> = BAD_S.into_iter().chain([0.0, 1e-9, 0.5, 5.0]).collect();
    for &substep_s in &bad {
        let options = RunOptions {
            substep_s: Some(substep_s),
            ..RunOptions::default()
        };
        let told = match run_scene(&loaded, &options, setting.device, |_| {}) {
            Ok(_) => return Err(format!("a sub-step of {substep_s} s was accepted").into()),
            Err(error) => error.to_string(),
        };
        ensure(told.contains("substep"), || {
            format!("{substep_s} s: {told}")
        })?;
    }
    Ok(bad.len())
}

/// A body that needs more sweeps than the solver allows is told of, and the run fails.
fn reports_capped_sweeps(setting: &Setting) -> Result<u64, Failed> {
    let options = RunOptions::default();
    let loaded = parse(&rolling(setting, 40.0, "max_sweeps: 2"))?;
    let outcome = run_scene(&loaded, &options, setting.device, |_| {})?;
    let capped = outcome.meadow.counters.capped_sweeps;
    let told = outcome
        .verdicts
        .iter()
        .find(|v| v.what.contains("max_sweeps"));
    ensure(
        capped > 0 && told.is_some_and(|v| v.passed == Some(false)),
        || format!("{capped} sub-steps were capped, verdict {told:?}"),
    )?;
    Ok(capped)
}

/// The window's clock: at most 0.25 s per frame, the rest discarded and counted. A method that
/// catches up falls further behind with every frame.
pub fn bad_time_in_the_window(setting: &Setting) -> Measured {
    let frames = [0.0, -1.0, f64::NAN, 1e-9, 0.5, 5.0];
    let discarded = 0.25 + 4.75;
    let Device::Graphics(gpu, _) = setting.device else {
        let mut timeline = Timeline::limited(SUBSTEP_S, LONGEST_FRAME_S);
        let due: u32 = frames.iter().map(|&s| timeline.advance(s)).sum();
        let text = format!("{due} sub-steps, {} s discarded", timeline.discarded_s);
        let as_wanted = due == 60 && (timeline.discarded_s - discarded).abs() < 1e-9;
        ensure(as_wanted, || text.clone())?;
        return Ok(text);
    };
    let loaded = parse(&rolling(setting, 1.0, ""))?;
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let mut stage = Stage::new(gpu, &loaded, EngineChoice::Gpu, format, [64, 64])?;
    let mut due = 0;
    for frame_s in frames {
        let before = stage.meadow().ticks;
        due += stage.advance(frame_s)?;
        let done = stage.meadow().ticks - before;
        ensure(done <= 30, || {
            format!("a frame of {frame_s} s ran {done} sub-steps")
        })?;
    }
    let text = format!("{due} sub-steps, {} s discarded", stage.discarded_s());
    let as_wanted = due == 60 && (stage.discarded_s() - discarded).abs() < 1e-9;
    ensure(as_wanted, || text.clone())?;
    Ok(text)
}

/// Seeds of ragged frames.
const SEEDS: u32 = 20;

/// Frames of 1 to 50 ms, drawn at random. A method whose sub-step is the frame gives another
/// result for every seed.
pub fn ragged_time(setting: &Setting) -> Measured {
    let scene = rolling(setting, 2.0, "");
    let ticks = 96;
    let mut steady = setting.rig(&scene)?;
    let mut hashes = vec![steady.bits()?];
    for _ in 0..ticks {
        steady.tick()?;
        hashes.push(steady.bits()?);
    }
    let mut compared = 0;
    for seed in 0..SEEDS {
        let mut rig = setting.rig(&scene)?;
        let mut timeline = Timeline::unlimited(SUBSTEP_S);
        let mut time_s = 0.0;
        for n in 0.. {
            let share = f64::from(unit(philox2x32([n, seed], 11, 7)[0]));
            let frame_s = 0.001 + 0.049 * share;
            time_s += frame_s;
            if time_s > f64::from(ticks) * SUBSTEP_S {
                break;
            }
            frame(&mut rig, &mut timeline, frame_s)?;
            let now = rig.meadow.ticks;
            let want = (time_s / SUBSTEP_S + 1e-6).floor() as u32;
            ensure(now == want, || {
                format!("seed {seed}: {now} sub-steps after {time_s} s")
            })?;
            ensure(rig.bits()? == hashes[now as usize], || {
                format!("seed {seed}: another state after {time_s} s")
            })?;
            compared += 1;
        }
    }
    let snapshot = steady.look().map(|plants| plants.len())?;
    let moved = measure_moved(&mut steady)?;
    ensure(moved > 50, || {
        format!("only {moved} of {snapshot} plants moved")
    })?;
    Ok(format!(
        "{SEEDS} seeds, {compared} frames, all of equal bits, {moved} plants moved"
    ))
}

fn measure_moved(rig: &mut Rig) -> Result<usize, Failed> {
    let plants = rig.plants()?;
    Ok(plants
        .values()
        .filter(|p: &&measure::Standing<f64>| p.offset_m() > 0.02)
        .count())
}
