//! The hard cases: what breaks a naive method, each with the limit it must keep. Every case runs
//! on the cpu engine and on a graphics adapter, and, where bodies are involved, with depth cubes
//! and with closed forms. Without an adapter the gpu trials are ignored, unless
//! `SWARD_REQUIRE_GPU=1`. Every trial prints what it measured. The trials `fault::` plant mistakes,
//! each of which must turn one of the cases red.
//!
//! The long run of 24 simulated hours is not part of the test run:
//! `cargo test --release --test hard_cases -- --ignored day`.

#![allow(clippy::expect_used, reason = "a test says what it expects by failing")]

mod contact;
mod faults;
mod hollow;
mod input;
mod limits;
mod long;
mod motion;
mod order;
mod place;
mod recovery;
mod rest;
mod rig;
mod shapes;
mod springs;
mod time;

use std::sync::{Arc, Mutex, PoisonError};

use libtest_mimic::{Arguments, Failed, Trial};
use sward::gpu::Gpu;
use sward::run::Device;
use sward::scene::Collider;

use rig::Setting;

/// What a trial measured, in words.
type Measured = Result<String, Failed>;
type Check = fn(&Setting<'_>) -> Measured;

/// One hard case.
struct Case {
    name: &'static str,
    colliders: &'static [Collider],
    check: Check,
}

const BOTH: &[Collider] = &[Collider::Cube, Collider::Analytic];
/// For bodies that are too thin for a depth cube: `auto` knows it and takes the closed form.
const THIN: &[Collider] = &[Collider::Auto, Collider::Cube];
const ALL: &[Collider] = &[Collider::Auto, Collider::Cube, Collider::Analytic];
/// For cases in which no body has a part, or one is as good as another.
const ANY: &[Collider] = &[Collider::Auto];

const fn case(name: &'static str, colliders: &'static [Collider], check: Check) -> Case {
    Case {
        name,
        colliders,
        check,
    }
}

const CASES: &[Case] = &[
    case("rest_laid", BOTH, rest::rest_laid),
    case("rest_dropped", BOTH, rest::rest_dropped),
    case("rest_rolled", BOTH, rest::rest_rolled),
    case("rest_pushed", BOTH, rest::rest_pushed),
    case("rest_between", BOTH, rest::rest_between),
    case("rest_shapes", BOTH, rest::rest_shapes),
    case("degenerate_point", BOTH, contact::degenerate_point),
    case(
        "degenerate_point_put_back",
        BOTH,
        contact::degenerate_point_put_back,
    ),
    case("buried", BOTH, contact::buried),
    case("buried_askew", BOTH, contact::buried_askew),
    case("roll_rates", BOTH, motion::roll_rates),
    case("roll_reference", BOTH, motion::roll_reference),
    case("roll_reference_fine", BOTH, motion::roll_reference_fine),
    case("bullet", BOTH, motion::bullet),
    case("teleport", BOTH, place::teleport),
    case("over_the_edge", BOTH, place::over_the_edge),
    case("far_away", BOTH, place::far_away),
    case("far_in_a_wide_meadow", BOTH, place::far_in_a_wide_meadow),
    case("bad_time", ANY, time::bad_time),
    case("bad_time_in_the_window", ANY, time::bad_time_in_the_window),
    case("ragged_time", BOTH, time::ragged_time),
    case("release", BOTH, recovery::release),
    case("flattened", ANY, recovery::flattened),
    case("gusty_recovery", BOTH, recovery::gusty),
    case("stiff_springs", BOTH, springs::stiff),
    case("stretched", BOTH, springs::stretched),
    case("sharded", BOTH, order::sharded),
    case("order_of_bodies", BOTH, order::bodies),
    case("order_of_threads", BOTH, order::threads),
    case("poison", BOTH, input::poison),
    case(
        "removed_while_touching",
        BOTH,
        input::removed_while_touching,
    ),
    case("degenerate_plants", BOTH, input::degenerate_plants),
    case("full_of_tiles", BOTH, limits::tiles),
    case("full_of_bodies", ANY, limits::bodies),
    case("full_of_plants", ANY, limits::plants),
    case("plate", THIN, shapes::plate),
    case("rod", THIN, shapes::rod),
    case("thin_rods", ALL, shapes::thin_rods),
    case("cup", ALL, shapes::cup),
    case("hollow", BOTH, hollow::moving),
    case("long", BOTH, long::short_form),
];

/// Named commands: hours of simulated time.
const NAMED: &[Case] = &[case("day", ANY, long::day)];

fn main() {
    let arguments = Arguments::from_args();
    let required = std::env::var_os("SWARD_REQUIRE_GPU").is_some_and(|value| value == "1");
    let processor = Arc::new(Ok(Device::Processor));
    let graphics = Gpu::headless().and_then(Device::graphics);
    let graphics = Arc::new(graphics.map_err(|error| error.to_string()));
    let skips_graphics = graphics.is_err() && !required;

    let told: Told = Arc::default();
    let mut trials = Vec::new();
    for (cases, named) in [(CASES, false), (NAMED, true)] {
        for (case, &collider) in cases
            .iter()
            .flat_map(|c| c.colliders.iter().map(move |k| (c, k)))
        {
            for (engine, device) in [("cpu", &processor), ("gpu", &graphics)] {
                let title = title(engine, case, collider);
                let (device, told, check) = (device.clone(), told.clone(), case.check);
                let ignored = named || (engine == "gpu" && skips_graphics);
                let name = title.clone();
                let run = move || run(&device, check, collider, &title, &told);
                trials.push(Trial::test(name, run).with_ignored_flag(ignored));
            }
        }
    }
    trials.extend(faults::trials(&told));
    let conclusion = libtest_mimic::run(&arguments, trials);
    let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
    told.sort();
    for line in told.iter() {
        println!("{line}");
    }
    conclusion.exit();
}

/// What the trials measured, a line each.
type Told = Arc<Mutex<Vec<String>>>;

fn title(engine: &str, case: &Case, collider: Collider) -> String {
    let one = case.colliders.len() == 1;
    match collider {
        Collider::Auto if one => format!("{engine}::{}", case.name),
        Collider::Auto => format!("{engine}::{}::auto", case.name),
        Collider::Cube => format!("{engine}::{}::cube", case.name),
        Collider::Analytic => format!("{engine}::{}::analytic", case.name),
    }
}

fn run(
    device: &Result<Device, String>,
    check: Check,
    collider: Collider,
    title: &str,
    told: &Told,
) -> Result<(), Failed> {
    let device = device.as_ref().map_err(String::as_str)?;
    let started = std::time::Instant::now();
    let measured = check(&Setting {
        device,
        collider,
        mistake: None,
    })?;
    tell(told, title, &measured, started);
    Ok(())
}

fn tell(told: &Told, title: &str, measured: &str, started: std::time::Instant) {
    let seconds = started.elapsed().as_secs_f64();
    let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
    told.push(format!("{title}: {measured} ({seconds:.1} s)"));
}
