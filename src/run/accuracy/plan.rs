//! What a report is to measure: scenes, the methods of each, and how a point is told from others.

use std::collections::BTreeSet;
use std::io;

use super::cost::METHODS as COST_METHODS;
use super::{FLOOR, Row};
use crate::base::hash::Hash64;
use crate::run::methods::{METHODS, NamedMethod, method};
use crate::run::report::Adapter;
use crate::run::scenario::Device;
use crate::run::spring_clamp::SpringClamp;
use crate::scene::{LoadedScene, Motion, Scene, Solver, to_ron};

/// Methods that the quick report leaves out: inner points of curves whose ends it has.
const NOT_QUICK: [&str; 18] = [
    "cube-128",
    "masked-16",
    "nearest-16",
    "bilinear-16",
    "bilinear-256",
    "body-cube-256",
    "voxels-32",
    "voxels-64",
    "substep-120",
    "substep-240",
    "grass-steps-2",
    "sweep-1/2",
    "rounds-2",
    "rounds-12",
    "segments-6",
    "table-32",
    "table-64",
    "table-256",
];

/// Methods whose error the quick report splits: the default, closed forms, and long sub-steps.
/// A run in `f64` doubles what a method takes, and a software adapter takes several times as long as the
/// processor.
const QUICK_SPLIT: [&str; 3] = ["default", "analytic", "substep-30"];

/// Scenes, and the methods that are run on each.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    pub scenes: Vec<Planned>,
    /// Whether the resting shapes of blades are measured too.
    pub blades: bool,
    /// Whatever tells this program from another: points of another one are not comparable.
    pub program: u64,
    /// Whether rounding and precision are measured of a few methods only.
    pub quick: bool,
}

impl Plan {
    /// Version and hash of the program, as rows have it.
    pub fn program_name(&self) -> String {
        program_name(self.program)
    }

    /// Whether a row is a point of this plan by its names.
    pub fn asks_for(&self, row: &Row) -> bool {
        let scene = |planned: &&Planned| planned.loaded.name == row.scene;
        let Some(planned) = self.scenes.iter().find(scene) else {
            return false;
        };
        planned.names().any(|name| name == row.method)
    }

    /// What its points depend on, on a device.
    pub fn context<'a>(&self, gpu: Option<&'a Device>) -> Context<'a> {
        Context {
            program: self.program,
            quick: self.quick,
            gpu,
        }
    }

    /// The keys of all points, as they would be measured now.
    pub fn keys(&self, gpu: Option<&Device>) -> BTreeSet<String> {
        let context = self.context(gpu);
        let keys = |planned| keys_of_scene(&context, planned);
        self.scenes.iter().flat_map(keys).collect()
    }
}

fn keys_of_scene(context: &Context<'_>, planned: &Planned) -> Vec<String> {
    let names = planned.names();
    names
        .map(|name| context.key(&planned.loaded, name))
        .collect()
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
    /// Names of the scene's points: the noise floor and the methods.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        let methods = self.methods.iter().map(|method| method.name);
        std::iter::once(FLOOR).chain(methods)
    }

    /// What the stability clamp does in its methods that have literal springs.
    pub(super) fn clamps(&self) -> Vec<(&'static str, SpringClamp)> {
        let clamp = |method: &&'static NamedMethod| {
            let mut solver = self.loaded.scene.solver.clone();
            method.apply(&mut solver);
            Some((method.name, SpringClamp::of(&solver)?))
        };
        self.methods.iter().filter_map(clamp).collect()
    }

    /// A scene with the methods that can be compared on it.
    pub fn new(loaded: LoadedScene, methods: &[&'static NamedMethod]) -> Self {
        let mut planned = Self {
            loaded,
            methods: Vec::new(),
            left_out: Vec::new(),
        };
        for &method in methods {
            match why_not_comparable(&planned.loaded.scene, method) {
                None => planned.methods.push(method),
                Some(why) => planned.left_out.push(LeftOut {
                    method: method.name,
                    why,
                }),
            }
        }
        planned
    }
}

/// Why a run of a method has no pose error beside the reference of a scene, if so.
pub fn why_not_comparable(scene: &Scene, method: &NamedMethod) -> Option<&'static str> {
    if !method.keeps_blades(&scene.solver) {
        Some(
            "its blades are other ones, whose rest the report's sections on resting blades compare",
        )
    } else if has_free_bodies(scene) && !keeps_body_step(scene, method) {
        Some("it steps the bodies otherwise, and free bodies would go another way")
    } else {
        None
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
    let body_step_s = |s: &Solver| s.substep_s * f64::from(s.method.grass_steps);
    (body_step_s(&solver) - body_step_s(&scene.solver)).abs() < 1e-12
}

/// What a point depends on besides its scene and its method.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// As in [`Plan::program`].
    pub program: u64,
    /// As in [`Plan::quick`].
    pub quick: bool,
    pub gpu: Option<&'a Device>,
}

impl<'a> Context<'a> {
    /// Whether a method's error is split into rounding, precision and the method's own.
    pub fn splits(&self, name: &str) -> bool {
        !self.quick || QUICK_SPLIT.contains(&name)
    }

    /// The device that a method's rounding is measured on, if it is.
    pub fn device_of(&self, name: &str) -> Option<&'a Device> {
        self.gpu.filter(|_| self.splits(name))
    }

    /// The key of a point: the same for the same program, scene, settings and device.
    pub fn key(&self, loaded: &LoadedScene, name: &str) -> String {
        let mut solver = loaded.scene.solver.clone();
        if let Some(method) = method(name) {
            method.apply(&mut solver);
        }
        // A scene that was read can be written; one that could not would only share its key.
        let scene = to_ron(&loaded.scene).unwrap_or_default();
        let device = self.device_of(name).and_then(Device::gpu).map(Adapter::of);
        let splits = self.splits(name);
        let assets = &loaded.assets.file_hashes;
        let mut hash = Hash64::default();
        hash.word(self.program);
        hash.bytes(
            format!("{name}\n{scene}\n{solver:?}\n{splits}\n{device:?}\n{assets:?}").as_bytes(),
        );
        format!("{:016x}", hash.value())
    }
}

/// Version and hash of a program in words.
pub(super) fn program_name(hash: u64) -> String {
    format!("{}+{hash:016x}", env!("CARGO_PKG_VERSION"))
}

/// A hash of the running program's own file: whatever changes a result or a time, kernels, shaders,
/// scenes, measures or the compiler's settings, changes it.
///
/// # Errors
///
/// A program whose file the system does not show.
pub fn hash_of_this_program() -> io::Result<u64> {
    let program = std::fs::read(std::env::current_exe()?)?;
    let mut hash = Hash64::default();
    hash.bytes(&program);
    Ok(hash.value())
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::run::methods::{LEAN_0, ROOT_PAPER};

    pub fn loaded() -> LoadedScene {
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
    fn the_running_program_has_one_hash() {
        let [first, second] = [(); 2].map(|()| hash_of_this_program().expect("its file"));
        assert_eq!(first, second);
        assert_ne!(first, 0);
    }

    #[test]
    fn every_method_of_the_quick_and_the_cost_table_has_a_name() {
        for name in NOT_QUICK.iter().chain(&COST_METHODS) {
            assert!(method(name).is_some(), "{name}");
        }
        assert_eq!(quick_methods().len() + NOT_QUICK.len(), METHODS.len());
        for name in QUICK_SPLIT {
            assert!(
                quick_methods().iter().any(|method| method.name == name),
                "{name}"
            );
        }
    }

    #[test]
    fn free_bodies_leave_out_other_body_steps_and_all_leave_out_other_blades() {
        let names = |planned: &Planned| -> Vec<&str> {
            planned.left_out.iter().map(|out| out.method).collect()
        };
        let led = Planned::new(loaded(), &all_methods());
        assert_eq!(names(&led), [ROOT_PAPER, LEAN_0, "lean-5"]);
        let mut free = loaded();
        free.scene.bodies[0].motion = Motion::Free;
        let left_out = Planned::new(free, &all_methods());
        assert!(names(&left_out).contains(&"substep-480"));
        assert!(!names(&left_out).contains(&"grass-steps-4"));
    }
}
