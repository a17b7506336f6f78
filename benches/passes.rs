//! Median milliseconds of every pass over shipped scenes on the cpu engine, with the error beside
//! them: `cargo bench --bench passes`. Tables by number of tiles come from `sward bench tiles`.

#![allow(
    clippy::expect_used,
    reason = "a bench that cannot run says why and stops"
)]

use sward::run::{Device, RunOptions, run_scene};
use sward::scene::builtin::load_builtin;

fn main() {
    println!("scene, pass, median_ms, max_penetration_m, max_strain, active_tiles_peak");
    for name in ["ball_roll", "mesh_drop", "million_blades", "hundred_bodies"] {
        let scene = load_builtin(name)
            .expect("a shipped scene")
            .expect("a sound scene");
        let outcome =
            run_scene(&scene, &RunOptions::default(), &Device::Processor, |_| {}).expect("a run");
        for (pass, ms) in &outcome.pass_ms {
            println!(
                "{name}, {pass}, {ms:.4}, {:.6}, {:.5}, {}",
                outcome.watch.max_penetration_m(),
                outcome.watch.max_strain,
                outcome.meadow.tiles.peak,
            );
        }
    }
}
