//! Each pass on the device against its twin in Rust, from the same input. Trials need a graphics
//! adapter: without one they are ignored, and with `SWARD_REQUIRE_GPU=1` the missing adapter fails.

mod billboard_runs;
mod billboards;
mod coats;
mod compare;
mod cubes;
mod light;
mod meadows;
mod passes;
mod plants;
mod probe;
mod rigid;
mod runs;
mod scenes;

use std::sync::Arc;

use libtest_mimic::{Arguments, Failed, Trial};
use sward::gpu::{Gpu, GrassKernels};

/// What a trial runs on.
pub struct Device {
    pub gpu: Gpu,
    pub kernels: GrassKernels,
}

type Check = fn(&Device) -> Result<(), Failed>;
type NamedCheck = Box<dyn Fn(&Device) -> Result<(), Failed> + Send>;

const CHECKS: &[(&str, Check)] = &[
    ("random_words_are_equal", plants::random_words_are_equal),
    ("plants_are_equal", plants::plants_are_equal),
    (
        "kinds_by_colour_are_equal",
        plants::kinds_by_colour_are_equal,
    ),
    ("billboards_are_equal", billboards::billboards_are_equal),
    (
        "billboards_respond_alike",
        billboard_runs::billboards_respond_alike,
    ),
    (
        "a_car_falls_and_drives_off_alike",
        billboard_runs::a_car_falls_and_drives_off_alike,
    ),
    (
        "sixty_thousand_billboards_are_equal",
        billboards::sixty_thousand_billboards_are_equal,
    ),
    (
        "ranges_of_many_tiles_are_equal",
        billboards::ranges_of_many_tiles_are_equal,
    ),
    ("light_volumes_agree", light::lookups_agree),
    (
        "quads_in_the_wind_agree",
        billboards::quads_in_the_wind_agree,
    ),
    ("wind_poses_agree", plants::wind_poses_agree),
    (
        "poses_about_the_knee_agree",
        plants::poses_about_the_knee_agree,
    ),
    ("coats_are_equal", coats::coats_are_equal),
    (
        "fewer_plants_of_coats_stay",
        coats::fewer_plants_of_coats_stay,
    ),
    ("poses_are_equal", rigid::poses_are_equal),
    ("cubes_of_closed_forms_agree", cubes::closed_forms_agree),
    ("hidden_faces_agree", cubes::hidden_faces_agree),
    (
        "a_sweep_agrees_with_cubes",
        passes::a_sweep_agrees_with_cubes,
    ),
    (
        "a_sweep_agrees_with_closed_forms",
        passes::a_sweep_agrees_with_closed_forms,
    ),
    ("stiff_springs_agree", passes::stiff_springs_agree),
    (
        "every_kind_of_solid_agrees",
        passes::every_kind_of_solid_agrees,
    ),
    ("drawn_nodes_agree", passes::drawn_nodes_agree),
    (
        "state_survives_upload_and_growth",
        passes::state_survives_upload_and_growth,
    ),
    (
        "a_rolled_track_agrees_with_cubes",
        runs::a_rolled_track_agrees_with_cubes,
    ),
    (
        "a_rolled_track_agrees_with_closed_forms",
        runs::a_rolled_track_agrees_with_closed_forms,
    ),
    ("shoved_stones_agree", runs::shoved_stones_agree),
    (
        "a_still_meadow_dispatches_nothing",
        runs::a_still_meadow_dispatches_nothing,
    ),
    (
        "a_restored_collision_goes_on_with_the_same_bits",
        runs::a_restored_collision_goes_on_with_the_same_bits,
    ),
    (
        "a_full_device_refuses_and_counts",
        runs::a_full_device_refuses_and_counts,
    ),
    (
        "a_driver_that_cuts_loops_short_is_told_of",
        runs::a_driver_that_cuts_loops_short_is_told_of,
    ),
];

fn open() -> Result<Device, String> {
    let gpu = Gpu::headless().map_err(|error| error.to_string())?;
    let kernels = GrassKernels::new(&gpu).map_err(|error| error.to_string())?;
    println!("adapter: {} ({})", gpu.adapter.name, gpu.adapter.driver);
    Ok(Device { gpu, kernels })
}

fn main() {
    let arguments = Arguments::from_args();
    let required = std::env::var_os("SWARD_REQUIRE_GPU").is_some_and(|v| v == "1");
    let device = Arc::new(open());
    let missing = matches!(&*device, Err(reason) if reason.contains("no graphics adapter"));
    let on_device = |name: String, check: NamedCheck| {
        let device = Arc::clone(&device);
        let run = move || match &*device {
            Ok(device) => check(device),
            Err(reason) => Err(reason.into()),
        };
        Trial::test(name, run).with_ignored_flag(missing && !required)
    };
    let checks = CHECKS.iter();
    let mut trials: Vec<Trial> = checks
        .map(|&(name, check)| on_device(name.to_owned(), Box::new(check)))
        .collect();
    trials.extend(scenes::names().into_iter().map(|scene| {
        let name = format!("scene::{scene}");
        on_device(name, Box::new(move |device| scenes::agrees(device, &scene)))
    }));
    libtest_mimic::run(&arguments, trials).exit();
}
