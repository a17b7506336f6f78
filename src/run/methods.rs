//! Methods by name: settings of the solver, and of the lean of blades, that can be compared in one run.

use crate::scene::method::{Collide, CubePer, Method, Push, Recovery, Sampling, Springs};
use crate::scene::{Root, Scene, Solver};
use crate::sim::reference;

/// A setting with a name.
#[derive(Clone, Copy, Debug)]
pub struct NamedMethod {
    pub name: &'static str,
    /// Methods of one family differ in one thing: they make up one curve of a plot.
    pub family: &'static str,
    pub what: &'static str,
    apply: fn(&mut Solver),
    /// Lean of all blades at the root, in degrees, in place of the scene's.
    lean_deg: Option<f32>,
}

impl NamedMethod {
    /// Whether the blades stay what they are. Other ones have another reference, so that a pose error
    /// says nothing of them.
    pub fn keeps_blades(&self, solver: &Solver) -> bool {
        let mut changed = solver.clone();
        self.apply(&mut changed);
        changed.root == solver.root && self.lean_deg.is_none()
    }

    /// Whether the method says itself how long a sub-step is, whatever the scene's.
    pub fn has_own_substep(&self) -> bool {
        let substep_s = |scenes_own_s: f64| {
            let mut solver = Solver {
                substep_s: scenes_own_s,
                ..Solver::default()
            };
            self.apply(&mut solver);
            solver.substep_s
        };
        substep_s(0.5) == substep_s(0.25)
    }

    /// Whether the reference engine has settings of its own in place of all that the method sets.
    pub fn is_lost_on_reference(&self) -> bool {
        let scene = Solver::default();
        let mut changed = scene.clone();
        self.apply(&mut changed);
        changed != scene && reference::solver(&changed) == reference::solver(&scene)
    }

    /// Gives a scene the method's settings, and leaves the others.
    pub fn apply_to_scene(&self, scene: &mut Scene) {
        self.apply(&mut scene.solver);
        if let Some(lean_deg) = self.lean_deg {
            for species in &mut scene.grass.species {
                species.lean_deg = [lean_deg; 2];
            }
        }
    }

    /// The same for the solver alone.
    pub fn apply(&self, solver: &mut Solver) {
        (self.apply)(solver);
    }
}

/// The method that scenes have unless they say otherwise.
pub const DEFAULT: &str = "default";

/// The root of P15.
pub const ROOT_PAPER: &str = "root-paper";

/// Blades without the lean that keeps them away from the critical stiffness.
pub const LEAN_0: &str = "lean-0";

/// Every method, the default first.
pub const METHODS: &[NamedMethod] = &[
    named(DEFAULT, "default", "the scene as it is", |_| {}),
    named(
        "paper",
        "literal",
        "O09 as printed: one cube per body read at the nearest texel, pushes by |d|, springs behind \
         the stability clamp, recovery on the blended pose, one sweep",
        |solver| {
            solver.method = Method {
                collide: Collide::Cube,
                sampling: Sampling::Nearest,
                cube_per: CubePer::Body,
                push: Push::Literal,
                springs: Springs::Literal,
                recovery: Recovery::Literal,
                sweep_share: ONE_SWEEP,
                grass_steps: 1,
            };
        },
    ),
    named(
        "springs-literal",
        "literal",
        "O09 eq. 6-7 once after the push, behind the stability clamp",
        |solver| solver.method.springs = Springs::Literal,
    ),
    named(
        "recovery-literal",
        "literal",
        "O09 eq. 8 upon what is already blended",
        |solver| solver.method.recovery = Recovery::Literal,
    ),
    named(
        "recovery-positions",
        "recovery",
        "offsets fade, lengths are not restored",
        |solver| solver.method.recovery = Recovery::Positions,
    ),
    named(
        "recovery-angles",
        "recovery",
        "the angles of the segments fade",
        |solver| solver.method.recovery = Recovery::Angles,
    ),
    named(
        "push-literal",
        "literal",
        "pushes by |d| instead of |d| |n·a| (O09 eq. 4-5)",
        |solver| {
            solver.method.collide = Collide::Cube;
            solver.method.push = Push::Literal;
        },
    ),
    named("cube-16", "planes", "depth cubes of 16 texels", |s| {
        cube(s, 16)
    }),
    named("cube-32", "planes", "depth cubes of 32 texels", |s| {
        cube(s, 32)
    }),
    named("cube-64", "planes", "depth cubes of 64 texels", |s| {
        cube(s, 64)
    }),
    named("cube-128", "planes", "depth cubes of 128 texels", |s| {
        cube(s, 128)
    }),
    named("cube-256", "planes", "depth cubes of 256 texels", |s| {
        cube(s, 256)
    }),
    named("masked-16", "masked", "16 texels, masked depths", |s| {
        masked(s, 16)
    }),
    named("masked-64", "masked", "64 texels, masked depths", |s| {
        masked(s, 64)
    }),
    named("masked-256", "masked", "256 texels, masked depths", |s| {
        masked(s, 256)
    }),
    named("nearest-16", "nearest", "16 texels, nearest", |s| {
        nearest(s, 16)
    }),
    named("nearest-64", "nearest", "64 texels, nearest", |s| {
        nearest(s, 64)
    }),
    named("nearest-256", "nearest", "256 texels, nearest", |s| {
        nearest(s, 256)
    }),
    named(
        "bilinear-16",
        "bilinear",
        "16 texels, plain bilinear",
        |s| bilinear(s, 16),
    ),
    named(
        "bilinear-64",
        "bilinear",
        "64 texels, plain bilinear",
        |s| bilinear(s, 64),
    ),
    named(
        "bilinear-256",
        "bilinear",
        "256 texels, plain bilinear",
        |s| bilinear(s, 256),
    ),
    named(
        "body-cube-64",
        "per body",
        "one cube of 64 texels per body, as O09",
        |s| {
            cube(s, 64);
            s.method.cube_per = CubePer::Body;
        },
    ),
    named(
        "body-cube-256",
        "per body",
        "one cube of 256 texels per body",
        |s| {
            cube(s, 256);
            s.method.cube_per = CubePer::Body;
        },
    ),
    named(
        "voxels-16",
        "voxels",
        "a field of 16³ distances per part",
        |s| voxels(s, 16),
    ),
    named(
        "voxels-32",
        "voxels",
        "a field of 32³ distances per part",
        |s| voxels(s, 32),
    ),
    named(
        "voxels-64",
        "voxels",
        "a field of 64³ distances per part",
        |s| voxels(s, 64),
    ),
    named(
        "analytic",
        "analytic",
        "closed forms of the convex parts",
        |solver| {
            solver.method.collide = Collide::Analytic;
        },
    ),
    named("substep-30", "sub-steps", "sub-steps of 1/30 s", |s| {
        substep(s, 30.0)
    }),
    named("substep-60", "sub-steps", "sub-steps of 1/60 s", |s| {
        substep(s, 60.0)
    }),
    named("substep-120", "sub-steps", "sub-steps of 1/120 s", |s| {
        substep(s, 120.0)
    }),
    named("substep-240", "sub-steps", "sub-steps of 1/240 s", |s| {
        substep(s, 240.0)
    }),
    named("substep-480", "sub-steps", "sub-steps of 1/480 s", |s| {
        substep(s, 480.0)
    }),
    named(
        "grass-steps-2",
        "grass steps",
        "2 steps of the grass per step of the bodies",
        |s| {
            grass_steps(s, 2);
        },
    ),
    named(
        "grass-steps-4",
        "grass steps",
        "4 steps of the grass per step of the bodies",
        |s| {
            grass_steps(s, 4);
        },
    ),
    named(
        "one-sweep",
        "sweeps",
        "one sweep per sub-step, however fast a body is",
        |s| {
            s.method.sweep_share = ONE_SWEEP;
        },
    ),
    named(
        "sweep-1",
        "sweeps",
        "a body travels its half thickness in a sweep",
        |s| {
            s.method.sweep_share = 1.0;
        },
    ),
    named("sweep-1/2", "sweeps", "half of its half thickness", |s| {
        s.method.sweep_share = 0.5;
    }),
    named(
        "sweep-1/8",
        "sweeps",
        "an eighth of its half thickness",
        |s| {
            s.method.sweep_share = 0.125;
        },
    ),
    named("rounds-1", "rounds", "one round of lengths and push", |s| {
        s.rounds = [1, 1]
    }),
    named("rounds-2", "rounds", "two rounds", |s| s.rounds = [2, 2]),
    named("rounds-12", "rounds", "twelve rounds", |s| {
        s.rounds = [12, 12]
    }),
    named("segments-3", "segments", "blades of 3 segments", |s| {
        s.segments = 3
    }),
    named("segments-4", "segments", "blades of 4 segments", |s| {
        s.segments = 4
    }),
    named("segments-6", "segments", "blades of 6 segments", |s| {
        s.segments = 6
    }),
    named("segments-16", "segments", "blades of 16 segments", |s| {
        s.segments = 16
    }),
    named(
        "table-16",
        "blade table",
        "resting blades from 16 × 8 entries over stiffness and lean",
        |s| s.blade_table = Some([16, 8]),
    ),
    named("table-32", "blade table", "32 × 16 entries", |s| {
        s.blade_table = Some([32, 16])
    }),
    named("table-64", "blade table", "64 × 32 entries", |s| {
        s.blade_table = Some([64, 32])
    }),
    named("table-256", "blade table", "256 × 128 entries", |s| {
        s.blade_table = Some([256, 128])
    }),
    named(
        ROOT_PAPER,
        "root",
        "the root's hinge as stiff as the others, k′ (P15), instead of 2k′: another blade",
        |s| s.root = Root::Paper,
    ),
    leaning(
        LEAN_0,
        0.0,
        "every blade grows upright from its root: another blade",
    ),
    leaning(
        "lean-5",
        5.0,
        "every blade leans by 5° at its root: another blade",
    ),
];

/// A share no body can travel in one sub-step.
const ONE_SWEEP: f64 = 1e6;

/// The method of a name.
pub fn method(name: &str) -> Option<&'static NamedMethod> {
    METHODS.iter().find(|method| method.name == name)
}

const fn named(
    name: &'static str,
    family: &'static str,
    what: &'static str,
    apply: fn(&mut Solver),
) -> NamedMethod {
    NamedMethod {
        name,
        family,
        what,
        apply,
        lean_deg: None,
    }
}

const fn leaning(name: &'static str, lean_deg: f32, what: &'static str) -> NamedMethod {
    NamedMethod {
        lean_deg: Some(lean_deg),
        ..named(name, "lean", what, |_| {})
    }
}

fn cube(solver: &mut Solver, resolution: u32) {
    solver.method.collide = Collide::Cube;
    solver.cube_resolution = resolution;
}

fn masked(solver: &mut Solver, resolution: u32) {
    cube(solver, resolution);
    solver.method.sampling = Sampling::Masked;
}

fn nearest(solver: &mut Solver, resolution: u32) {
    cube(solver, resolution);
    solver.method.sampling = Sampling::Nearest;
}

fn bilinear(solver: &mut Solver, resolution: u32) {
    cube(solver, resolution);
    solver.method.sampling = Sampling::Bilinear;
}

fn voxels(solver: &mut Solver, resolution: u32) {
    solver.method.collide = Collide::Voxels;
    solver.cube_resolution = resolution;
}

fn substep(solver: &mut Solver, hz: f64) {
    solver.substep_s = 1.0 / hz;
}

fn grass_steps(solver: &mut Solver, steps: u32) {
    solver.substep_s /= f64::from(steps);
    solver.method.grass_steps = steps;
}

#[cfg(test)]
mod tests;
