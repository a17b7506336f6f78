//! Billboards under bodies on both engines, side by side: who is touched, and where nodes are.

use std::path::Path;

use libtest_mimic::Failed;
use sward::run::Engine;
use sward::scene::{LoadedScene, load_scene, parse_scene};
use sward::sim::Meadow;
use sward::sim::measure::StandingBillboard;

use super::Device;
use super::compare::ensure;

/// A node that is this far from its twin is on its own way, in metres: whoever folds otherwise is
/// centimetres away.
const APART_M: f64 = 1e-3;
/// Nodes of touched billboards that may be on their own way, as a share: growth directions differ by up to a
/// step of 2⁻¹⁵ between the engines' lists, in 7% of billboards, which moves tops by 2e-5 m, and which way
/// a billboard folds hangs on less: of those under a car a third fold otherwise in the reference.
const APART_SHARE: f64 = 0.07 / 3.0;
/// Billboards that only one engine touches, as a share.
const TOUCHED_SHARE: f64 = 5e-3;
/// The others, root mean square, in metres: those steps over a height of 0.5 m, in 7% of billboards, are
/// 4e-6 m; sheets pass them on some times larger, from row to row and round to round.
const RMS_M: f64 = 1e-4;

/// A ball, a box that drops and a wheeled body of several parts on uneven ground; nodes, collider and wind
/// as asked.
fn scene(nodes: &str, collide: &str) -> String {
    format!(
        r#"(
    duration_s: 0.6,
    terrain: (ground: Rolling(size_m: (6, 5), amplitude_m: 0.1, wavelength_m: 4)),
    grass: (species: []),
    billboards: (density_per_m2: 40, nodes: ({nodes})),
    wind: (strength: 0.1, gust: 0.1),
    solver: (recovery_s: 0.3, method: (collide: {collide})),
    bodies: [
        (name: "ball", shape: Ball(radius_m: 0.15), position_m: (-1.5, 0.16, 0), above_ground: true,
         motion: Thrown(velocity_m_per_s: (2, 0, 0))),
        (name: "box", shape: Box(size_m: (0.5, 0.3, 0.4)), position_m: (1.2, 0.5, 0.9), above_ground: true),
        (name: "bar", shape: Capsule(radius_m: 0.08, length_m: 0.6), position_m: (0.3, 0.4, -1),
         rotation_deg: (0, 30, 90), above_ground: true),
    ],
)"#
    )
}

/// What differed.
#[derive(Debug, Default)]
struct Found {
    touched: usize,
    touched_in_one: usize,
    nodes: usize,
    apart: usize,
    squares: f64,
}

impl Found {
    fn add(&mut self, here: &StandingBillboard<f64>, there: &StandingBillboard<f64>) {
        if here.touched_at == 0 && there.touched_at == 0 {
            return;
        }
        self.touched += 1;
        self.touched_in_one += usize::from((here.touched_at == 0) != (there.touched_at == 0));
        for (a, b) in here.nodes.iter().zip(&there.nodes) {
            let apart_m = (*a - *b).length();
            self.nodes += 1;
            if apart_m > APART_M {
                self.apart += 1;
            } else {
                self.squares += apart_m * apart_m;
            }
        }
    }

    fn check(&self, what: &str) -> Result<(), Failed> {
        let rms_m = (self.squares / self.nodes.max(1) as f64).sqrt();
        println!("{what}: {self:?}, rms {rms_m:.2e} m");
        ensure(self.touched > 500, || format!("{what}: {self:?}"))?;
        let apart = self.apart as f64 / self.nodes as f64;
        let in_one = self.touched_in_one as f64 / self.touched as f64;
        let agree = apart <= APART_SHARE && in_one <= TOUCHED_SHARE && rms_m <= RMS_M;
        ensure(agree, || format!("{what}: {self:?}, rms {rms_m:.2e} m"))
    }
}

fn agree(device: &Device, nodes: &str, collide: &str) -> Result<(), Failed> {
    let loaded = parse_scene("billboards", &scene(nodes, collide), &[])?;
    let found = compare(device, &loaded, loaded.scene.duration_s)?;
    found.check(&format!("{nodes} nodes, {collide}"))
}

/// Runs the begin of a scene on both engines and compares every billboard of active tiles.
fn compare(device: &Device, loaded: &LoadedScene, until_s: f64) -> Result<Found, Failed> {
    let meadow = || Meadow::new(loaded.scene.clone(), &loaded.assets);
    let (mut here, mut there) = (meadow()?, meadow()?);
    let mut cpu = Engine::cpu();
    let mut gpu = Engine::gpu(&device.gpu, &device.kernels, &mut there)?;
    let mut found = Found::default();
    while here.time_s() + 1e-9 < until_s {
        cpu.tick(&mut here)?;
        gpu.tick(&mut there)?;
        if here.ticks % 6 != 0 {
            continue;
        }
        for (tile, twin) in here.work.tiles.iter().zip(&there.work.tiles) {
            let ours = cpu.standing_billboards(&here, tile)?;
            let theirs = gpu.standing_billboards(&there, twin)?;
            ensure(ours.len() == theirs.len(), || format!("tile {}", tile.tile))?;
            for (a, b) in ours.iter().zip(&theirs) {
                found.add(a, b);
            }
        }
    }
    Ok(found)
}

/// The begin of the scene of O09's measurements, in which the car falls and drives off. A whole run takes
/// minutes on a software adapter: `sward run meadow_60k --engine gpu`.
pub fn a_car_falls_and_drives_off_alike(device: &Device) -> Result<(), Failed> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/meadow_60k.ron");
    let found = compare(device, &load_scene(&file, &[])?, 0.9)?;
    found.check("meadow_60k")
}

pub fn billboards_respond_alike(device: &Device) -> Result<(), Failed> {
    agree(device, "4, 4", "cube")?;
    agree(device, "4, 4", "analytic")?;
    agree(device, "3, 3", "cube")?;
    agree(device, "5, 6", "analytic")
}
