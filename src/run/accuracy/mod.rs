//! The accuracy report: how wrong every method is, and how fast.
//!
//! A point is a method on a scene. For each scene the reference engine runs once and its poses are
//! kept; every method is then compared with them frame by frame, and its error split into rounding
//! (gpu − cpu), precision (cpu in `f32` − the same in `f64`) and the method's own (in `f64` −
//! reference).

mod blades;
mod cost;
mod lane;
mod measure;
mod plot;
pub mod scenes;
mod store;
mod summary;
mod table;
mod truth;

use std::io;

pub use blades::Blades;
pub use cost::{CostRow, METHODS as COST_METHODS, SCENE as COST_SCENE};
pub use plot::{PlotError, error_plot, summary_plot};
pub use store::{Row, Store};
pub use table::write_markdown;

use super::bench::Machine;
use super::methods::{METHODS, NamedMethod, method};
use super::report::Adapter;
use super::scenario::{Device, RunError};
use crate::field::blade_table::TableError;
use crate::scene::{LoadedScene, Motion, Scene, to_ron};
use truth::Truth;

/// Name under which the distance of two references is listed.
pub const FLOOR: &str = "noise floor";

/// Methods that the quick report leaves out: inner points of curves whose ends it has.
const NOT_QUICK: [&str; 8] = [
    "cube-128",
    "bilinear-16",
    "voxels-64",
    "rounds-2",
    "segments-6",
    "grass-steps-2",
    "table-32",
    "table-256",
];

/// Frames of a reference count as so many points in the progress: two of them in `f64` at eight
/// and eleven times the sub-steps.
const TRUTH_POINTS: f64 = 6.0;

/// Scenes, and the methods that are run on each.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    pub scenes: Vec<Planned>,
    /// Whether the resting shapes of blades are measured too.
    pub blades: bool,
}

/// A scene of a plan.
#[derive(Clone, Debug)]
pub struct Planned {
    pub loaded: LoadedScene,
    pub methods: Vec<&'static NamedMethod>,
    pub left_out: Vec<LeftOut>,
}

/// A method that cannot be compared on a scene, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    pub method: &'static str,
    pub why: &'static str,
}

impl Planned {
    /// A scene with the methods that can be compared on it.
    pub fn new(loaded: LoadedScene, methods: &[&'static NamedMethod]) -> Self {
        let free = has_free_bodies(&loaded.scene);
        let mut planned = Self {
            loaded,
            methods: Vec::new(),
            left_out: Vec::new(),
        };
        for &method in methods {
            let scene = &planned.loaded.scene;
            let why = if !method.keeps_blades(&scene.solver) {
                "its blades are other ones, whose rest the section on segments and root compares"
            } else if free && !keeps_body_step(scene, method) {
                "it steps the bodies otherwise, and free bodies would go another way"
            } else {
                planned.methods.push(method);
                continue;
            };
            planned.left_out.push(LeftOut {
                method: method.name,
                why,
            });
        }
        planned
    }
}

/// The methods of the quick report.
pub fn quick_methods() -> Vec<&'static NamedMethod> {
    let quick = METHODS.iter().filter(|m| !NOT_QUICK.contains(&m.name));
    quick.collect()
}

/// Every method.
pub fn all_methods() -> Vec<&'static NamedMethod> {
    METHODS.iter().collect()
}

/// The methods whose cost is compared at equal sub-steps.
pub fn cost_methods() -> Vec<&'static NamedMethod> {
    COST_METHODS
        .iter()
        .filter_map(|name| method(name))
        .collect()
}

/// Whether rapier moves any body of a scene, or its script may.
pub fn has_free_bodies(scene: &Scene) -> bool {
    let led = |motion: &Motion| matches!(motion, Motion::Fixed | Motion::Path { .. });
    !scene.script.is_empty() || !scene.bodies.iter().all(|body| led(&body.motion))
}

fn keeps_body_step(scene: &Scene, method: &NamedMethod) -> bool {
    let mut solver = scene.solver.clone();
    method.apply(&mut solver);
    let body_step_s = |s: &crate::scene::Solver| s.substep_s * f64::from(s.method.grass_steps);
    (body_step_s(&solver) - body_step_s(&scene.solver)).abs() < 1e-12
}

/// What a report came to.
#[derive(Clone, Debug)]
pub struct Report {
    pub machine: Machine,
    pub adapter: Option<Adapter>,
    pub scenes: Vec<SceneReport>,
    /// Cost at equal sub-steps, where the plan has its scene.
    pub cost: Vec<CostRow>,
    pub blades: Option<Blades>,
}

/// The points of a scene.
#[derive(Clone, Debug)]
pub struct SceneReport {
    pub name: String,
    pub what: String,
    /// Half the mean width of a blade, in metres: an error that can be seen.
    pub half_blade_m: f64,
    pub floor: Row,
    pub rows: Vec<Row>,
    pub left_out: Vec<LeftOut>,
}

/// Why a report ended early. What was measured is in the file.
#[derive(Debug, thiserror::Error)]
pub enum AccuracyError {
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Blades(#[from] TableError),
    #[error("cannot write a measured point: {0}")]
    Store(#[from] io::Error),
}

/// Measures every point that the store does not have yet. `progress` gets the share done.
///
/// # Errors
///
/// A scene that cannot be laid out; a file that can no longer be written.
pub fn run(
    plan: &Plan,
    store: &mut Store,
    gpu: Option<&Device>,
    mut progress: impl FnMut(f64),
) -> Result<Report, AccuracyError> {
    let machine = Machine::now();
    let adapter = gpu.and_then(Device::gpu).map(Adapter::of);
    let points = |planned: &Planned| TRUTH_POINTS + planned.methods.len() as f64;
    let total: f64 = plan.scenes.iter().map(points).sum();
    let mut done = 0.0;
    let mut scenes = Vec::new();
    for planned in &plan.scenes {
        let share = |points: f64| (done + points) / total;
        scenes.push(run_scene(planned, store, gpu, |points| {
            progress(share(points));
        })?);
        done += points(planned);
    }
    let timed = plan
        .scenes
        .iter()
        .find(|planned| planned.loaded.name == COST_SCENE);
    let cost = match timed {
        Some(planned) => cost::measure(&planned.loaded, &planned.methods)?,
        None => Vec::new(),
    };
    let blades = plan.blades.then(Blades::measure).transpose()?;
    Ok(Report {
        machine,
        adapter,
        scenes,
        cost,
        blades,
    })
}

/// `progress` gets the number of points done.
fn run_scene(
    planned: &Planned,
    store: &mut Store,
    gpu: Option<&Device>,
    mut progress: impl FnMut(f64),
) -> Result<SceneReport, AccuracyError> {
    let loaded = &planned.loaded;
    let names = planned.methods.iter().map(|method| method.name);
    let missing = std::iter::once(FLOOR)
        .chain(names)
        .any(|name| store.get(&key(loaded, name, gpu)).is_none());
    if missing {
        let truth = Truth::record(loaded, |share| progress(TRUTH_POINTS * share))?;
        log::info!(
            "{}: {:.1} MB of reference poses",
            loaded.name,
            truth.bytes() as f64 * 1e-6
        );
        let floor_key = key(loaded, FLOOR, gpu);
        if store.get(&floor_key).is_none() {
            let floor = measure::floor_row(loaded, &truth);
            store.add(Row {
                key: floor_key,
                ..floor
            })?;
        }
        for (n, method) in planned.methods.iter().enumerate() {
            let key = key(loaded, method.name, gpu);
            if store.get(&key).is_none() {
                let row = measure::measure(loaded, method, &truth, gpu)?;
                store.add(Row { key, ..row })?;
            }
            progress(TRUTH_POINTS + (n + 1) as f64);
        }
    }
    let rows = planned.methods.iter();
    let row = |name| store.get(&key(loaded, name, gpu)).cloned();
    Ok(SceneReport {
        name: loaded.name.clone(),
        what: loaded.scene.description.clone(),
        half_blade_m: half_blade_m(&loaded.scene),
        floor: row(FLOOR).unwrap_or_default(),
        rows: rows.filter_map(|method| row(method.name)).collect(),
        left_out: planned.left_out.clone(),
    })
}

/// The key of a point: the same for the same program, scene, settings and device.
fn key(loaded: &LoadedScene, name: &str, gpu: Option<&Device>) -> String {
    let mut solver = loaded.scene.solver.clone();
    if let Some(method) = method(name) {
        method.apply(&mut solver);
    }
    // A scene that was read can be written; one that could not would only share its key.
    let scene = to_ron(&loaded.scene).unwrap_or_default();
    let device = gpu.and_then(Device::gpu).map(Adapter::of);
    let version = env!("CARGO_PKG_VERSION");
    let truth = lane::REFERENCE_TABLE;
    let whole = format!("{version}\n{name}\n{scene}\n{solver:?}\n{device:?}\n{truth:?}");
    // FNV-1a.
    let hash = whole.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
}

fn half_blade_m(scene: &Scene) -> f64 {
    let species = &scene.grass.species;
    let widths = species.iter().flat_map(|s| s.width_m).map(f64::from);
    0.5 * widths.sum::<f64>() / (2 * species.len()).max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::methods::ROOT_PAPER;

    fn loaded() -> LoadedScene {
        crate::scene::parse_scene(
            "tiny",
            r#"(duration_s: 0.1, terrain: (ground: Flat(size_m: (1, 1))),
                grass: (density_per_m2: 16),
                bodies: [(name: "ball", shape: Ball(radius_m: 0.2), position_m: (0, 0.2, 0), motion: Fixed)])"#,
            &[],
        )
        .expect("a valid scene")
    }

    #[test]
    fn what_a_store_has_is_not_measured_again() {
        let methods = [method("default"), method("analytic")].map(|m| m.expect("a name"));
        let plan = Plan {
            scenes: vec![Planned::new(loaded(), &methods)],
            ..Plan::default()
        };
        let mut store = Store::in_memory();
        run(&plan, &mut store, None, |_| {}).expect("a scene that runs");
        let known = key(&loaded(), "default", None);
        let marked = Row {
            // No run takes so long.
            ms_per_s: 1e30,
            ..store.get(&known).expect("a measured point").clone()
        };
        store.add(marked).expect("memory");
        let again = run(&plan, &mut store, None, |_| {}).expect("a scene that runs");
        let times: Vec<f64> = again.scenes[0]
            .rows
            .iter()
            .map(|row| row.ms_per_s)
            .collect();
        assert!(times[0] == 1e30 && times[1] < 1e30, "{times:?}");
    }

    #[test]
    fn every_method_of_the_quick_and_the_cost_table_has_a_name() {
        for name in NOT_QUICK.iter().chain(&COST_METHODS) {
            assert!(method(name).is_some(), "{name}");
        }
        assert_eq!(quick_methods().len() + NOT_QUICK.len(), METHODS.len());
    }

    #[test]
    fn free_bodies_leave_out_other_body_steps_and_all_leave_out_other_blades() {
        let names = |planned: &Planned| -> Vec<&str> {
            planned.left_out.iter().map(|out| out.method).collect()
        };
        let led = Planned::new(loaded(), &all_methods());
        assert_eq!(names(&led), [ROOT_PAPER]);
        let mut free = loaded();
        free.scene.bodies[0].motion = Motion::Free;
        let left_out = Planned::new(free, &all_methods());
        assert!(names(&left_out).contains(&"substep-480"));
        assert!(!names(&left_out).contains(&"grass-steps-4"));
    }
}
