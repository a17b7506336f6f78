//! The work of one sub-step as the shaders see it. Twins: `shaders/shared/tick.wgsl`,
//! `contact.wgsl`, `solid.wgsl`, and `shaders/depth_cube.wgsl` for parts and jobs.

use super::field_data::WindUniform;
use super::turns::PassTurns;
use crate::base::{Pose, Vec3};
use crate::gpu_struct;
use crate::scene::Solver;
use crate::sim::contact::{HOLD_M, memory_key};
use crate::sim::meadow::Meadow;
use crate::sim::parts::Tested;
use crate::sim::relax::RelaxSettings;
use crate::sim::solid::Solid;
use crate::sim::work::Contact;

pub const SOLID_BALL: u32 = 0;
pub const SOLID_BOX: u32 = 1;
pub const SOLID_CAPSULE: u32 = 2;
pub const SOLID_CYLINDER: u32 = 3;
pub const SOLID_CONVEX: u32 = 4;

gpu_struct! {
    /// Numbers of one sub-step.
    pub struct TickUniform {
        pub now: u32,
        pub tiles: u32,
        pub colliding: u32,
        pub fewest_rounds: u32,
        pub most_rounds: u32,
        pub step_over_t: f32,
        pub bend: f32,
        pub strain_limit: f32,
        pub collide_sweeps: u32,
        pub relax_sweeps: u32,
        pub cover_m: f32,
        pub spare: u32,
        pub wind_before: WindUniform,
    }
}

gpu_struct! {
    /// The closed form of a convex part, and where its depth cube lies.
    pub struct SolidRecord {
        pub kind: u32,
        pub first_plane: u32,
        pub plane_count: u32,
        pub resolution: u32,
        pub dims: [f32; 3],
        pub first_texel: u32,
        pub low: [f32; 3],
        pub spare_a: u32,
        pub high: [f32; 3],
        pub spare_b: u32,
    }
}

gpu_struct! {
    /// One part near a tile.
    pub struct ContactRecord {
        pub from_turn: [f32; 4],
        pub to_turn: [f32; 4],
        pub from_place: [f32; 3],
        pub radius_m: f32,
        pub to_place: [f32; 3],
        pub sweeps: u32,
        pub key: u32,
        pub uses_cube: u32,
        pub hold_m: f32,
        pub part_in_body: u32,
        pub parts_of_body: u32,
        pub spare_a: u32,
        pub spare_b: [u32; 2],
        pub solid: SolidRecord,
    }
}

gpu_struct! {
    /// One convex part, for drawing its depth cube.
    pub struct PartRecord {
        pub turn: [f32; 4],
        pub place: [f32; 3],
        pub first_sibling: u32,
        pub end_sibling: u32,
        pub spare_a: u32,
        pub spare_b: [u32; 2],
        pub solid: SolidRecord,
    }
}

gpu_struct! {
    /// A depth cube to draw.
    pub struct CubeJob {
        pub part: u32,
        pub cover_m: f32,
    }
}

impl TickUniform {
    /// Numbers of the meadow's current sub-step, of which `colliding` tiles collide, and whose
    /// passes run in the given turns.
    pub fn new(meadow: &Meadow, colliding: u32, turns: PassTurns) -> Self {
        let solver: &Solver = &meadow.scene.solver;
        let settings = RelaxSettings::<f32>::new(solver);
        Self {
            now: meadow.work.now,
            tiles: meadow.work.tiles.len() as u32,
            colliding,
            fewest_rounds: settings.fewest_rounds,
            most_rounds: settings.most_rounds,
            step_over_t: meadow.step_over_t() as f32,
            bend: settings.bend,
            strain_limit: settings.strain_limit,
            collide_sweeps: turns.collide.sweeps,
            relax_sweeps: turns.relax.sweeps,
            cover_m: settings.cover_m,
            spare: 0,
            wind_before: (&meadow.work.wind_before).into(),
        }
    }
}

impl SolidRecord {
    /// A solid without a depth cube. A convex one adds its planes to `planes`.
    pub fn new(solid: &Solid<f32>, planes: &mut Vec<[f32; 4]>) -> Self {
        let first_plane = planes.len() as u32;
        let (kind, dims) = match solid {
            Solid::Ball { radius } => (SOLID_BALL, [*radius, 0.0, 0.0]),
            Solid::Box { half } => (SOLID_BOX, half.to_f32()),
            Solid::Capsule { radius, half } => (SOLID_CAPSULE, [*radius, *half, 0.0]),
            Solid::Cylinder { radius, half } => (SOLID_CYLINDER, [*radius, *half, 0.0]),
            Solid::Convex { planes: own, .. } => {
                planes.extend(own.iter().map(|plane| {
                    let [x, y, z] = plane.normal.to_f32();
                    [x, y, z, plane.offset]
                }));
                (SOLID_CONVEX, [0.0; 3])
            }
            // Methods with whole bodies are refused before a kernel could meet one: see
            // `GpuGrass::new`. A convex solid without planes would hold everything.
            Solid::Union(_) | Solid::Mesh { .. } => (SOLID_BALL, [0.0; 3]),
        };
        let [low, high] = solid.bounds().map(Vec3::to_f32);
        Self {
            kind,
            first_plane,
            plane_count: planes.len() as u32 - first_plane,
            resolution: 0,
            dims,
            first_texel: 0,
            low,
            spare_a: 0,
            high,
            spare_b: 0,
        }
    }

    pub fn has_cube(&self) -> bool {
        self.resolution > 0
    }
}

impl ContactRecord {
    /// A contact with the part's solid. A part whose cube is not drawn is tested by its closed
    /// form.
    pub fn new(contact: &Contact, solid: &SolidRecord) -> Self {
        let (from, to): (Pose<f32>, Pose<f32>) = (contact.from.cast(), contact.to.cast());
        let uses_cube = contact.tested == Tested::Cube && solid.has_cube();
        Self {
            from_turn: from.turn.to_array(),
            to_turn: to.turn.to_array(),
            from_place: from.place.to_f32(),
            radius_m: contact.radius_m as f32,
            to_place: to.place.to_f32(),
            sweeps: contact.sweeps,
            key: memory_key(contact),
            uses_cube: u32::from(uses_cube),
            hold_m: hold_m(solid, uses_cube),
            part_in_body: contact.part_in_body,
            parts_of_body: contact.parts_of_body,
            spare_a: 0,
            spare_b: [0; 2],
            solid: *solid,
        }
    }
}

/// How far off a part still holds a plant it pushed before, in metres; see
/// [`sim::contact::hold_m`](crate::sim::contact::hold_m).
fn hold_m(solid: &SolidRecord, uses_cube: bool) -> f32 {
    let size = [0, 1, 2].map(|a| solid.high[a] - solid.low[a]);
    let longest = size[0].max(size[1]).max(size[2]);
    let texel_m = longest / solid.resolution.max(1) as f32;
    let half_texel_m = if uses_cube {
        0.5 * f64::from(texel_m)
    } else {
        0.0
    };
    (HOLD_M + half_texel_m) as f32
}
