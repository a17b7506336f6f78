//! One body of the world: who it is, what it is made of, what moves it.

use rapier3d::prelude::{
    CoefficientCombineRule, Collider, ColliderBuilder, RigidBody, RigidBodyBuilder, RigidBodyHandle,
};

use crate::base::{Pose, Vec3};
use crate::scene::{Body, Collider as GrassCollider, Mass, Motion};
use crate::terrain::HeightGrid;

use super::error::BodyError;
use super::frame::{Frame, to_rapier, turn_of_degrees};
use super::library::ShapeLibrary;
use super::path::Path;
use super::vehicle::{Build, Vehicle};

/// A body that is in the world.
#[derive(Clone)]
pub(super) struct Actor {
    /// Rank of its name, see [`super::Link::body`].
    pub id: u32,
    pub handle: RigidBodyHandle,
    pub control: Control,
    pub vehicle: Option<Vehicle>,
    /// At least one; a vehicle's chassis is the first.
    pub pieces: Vec<Piece>,
    pub grass_collider: GrassCollider,
    pub rgb: [f32; 3],
}

/// What moves a body.
#[derive(Clone)]
pub(super) enum Control {
    Free,
    Fixed,
    Path(Path),
}

/// A rigid piece and where the last sub-step took it.
#[derive(Clone)]
pub(super) struct Piece {
    /// Index into the shape library.
    pub shape: u32,
    /// Index of the coat on it.
    pub coat: Option<u32>,
    pub from: Pose<f64>,
    pub to: Pose<f64>,
    /// It came to `from` by a jump.
    pub placed: bool,
    /// It was put where it is since the last sub-step.
    arrives: bool,
}

impl Piece {
    /// One that appears at a pose before the next sub-step.
    pub fn new(shape: u32, coat: Option<u32>, pose: Pose<f64>) -> Self {
        Self {
            shape,
            coat,
            from: pose,
            to: pose,
            placed: true,
            arrives: true,
        }
    }

    /// Moves on by a sub-step.
    pub fn advance(&mut self, to: Pose<f64>) {
        self.from = self.to;
        self.to = to;
        self.placed = std::mem::take(&mut self.arrives);
    }

    /// Is at once somewhere else at the end of a sub-step; nothing in between is touched.
    pub fn jump(&mut self, to: Pose<f64>) {
        self.from = to;
        self.to = to;
        self.placed = true;
        self.arrives = false;
    }

    /// Is at once somewhere else before the next sub-step.
    pub fn put(&mut self, to: Pose<f64>) {
        *self = Self::new(self.shape, self.coat, to);
    }
}

impl Actor {
    /// `world_from_body` of every piece, for a pose of the body.
    pub fn piece_poses(&self, body: Pose<f64>) -> Vec<Pose<f64>> {
        let wheels = self.vehicle.iter().flat_map(|v| v.wheel_poses(body));
        std::iter::once(body).chain(wheels).collect()
    }
}

impl Control {
    pub fn of(body: &Body) -> Result<Self, BodyError> {
        Ok(match &body.motion {
            Motion::Free | Motion::Thrown { .. } => Self::Free,
            Motion::Fixed => Self::Fixed,
            Motion::Path { waypoints, repeat } => {
                let path = Path::new(waypoints, *repeat, body.above_ground);
                Self::Path(path.map_err(|problem| BodyError::Path {
                    name: body.name.clone(),
                    problem,
                })?)
            }
        })
    }

    /// What holds a body that does not move freely.
    pub fn held(&self) -> Option<&'static str> {
        match self {
            Self::Free => None,
            Self::Fixed => Some("is fixed"),
            Self::Path(_) => Some("follows a path"),
        }
    }
}

/// `world_from_body` of a body at its start, at `now_s` since the start of the scene. A body on a
/// path is where the path is; its own position and rotation do not matter.
pub(super) fn first_pose(
    body: &Body,
    control: &Control,
    ground: &HeightGrid,
    now_s: f64,
) -> Pose<f64> {
    if let Control::Path(path) = control {
        return path.pose(now_s, ground);
    }
    let mut place = Vec3::of(body.position_m);
    if body.above_ground {
        place.y += ground.height_in_world(place.x, place.z);
    }
    Pose {
        turn: turn_of_degrees(body.rotation_deg.map(f64::from)),
        place,
    }
}

/// The body as rapier takes it.
pub(super) fn rigid_body(
    body: &Body,
    control: &Control,
    at: Pose<f64>,
    frame: &Frame,
) -> RigidBody {
    let builder = match control {
        Control::Free => RigidBodyBuilder::dynamic().ccd_enabled(true),
        Control::Fixed => RigidBodyBuilder::fixed(),
        Control::Path(_) => RigidBodyBuilder::kinematic_position_based(),
    };
    let [linear, angular] = body.damping.map(damping_per_s);
    let mut builder = builder
        .pose(frame.pose_to_rapier(at))
        .linear_damping(linear)
        .angular_damping(angular);
    if let Motion::Thrown {
        velocity_m_per_s,
        spin_deg_per_s,
    } = &body.motion
    {
        builder = builder
            .linvel(to_rapier(Vec3::of_f32(*velocity_m_per_s)))
            .angvel(to_rapier(radians(*spin_deg_per_s)));
    }
    builder.build()
}

/// The collider of one of the library's shapes, a vehicle's chassis for one, with the body's mass,
/// friction and restitution. The ground has no restitution of its own, so the larger of two
/// bodies' counts.
///
/// # Errors
/// If the mass is not more than 0 and finite, in rapier's f32.
pub(super) fn collider(
    body: &Body,
    shape: u32,
    library: &ShapeLibrary,
) -> Result<Collider, BodyError> {
    let builder = ColliderBuilder::new(library.collider(shape));
    let builder = match (Build::of(&body.shape), body.mass) {
        (Some(build), Mass::Kilograms(kilograms)) => {
            builder.mass_properties(build.mass_properties(kilograms))
        }
        (Some(build), Mass::Density(density)) => {
            let kilograms = density * build.chassis_volume_m3();
            builder.mass_properties(build.mass_properties(kilograms))
        }
        (None, Mass::Kilograms(kilograms)) => builder.mass(kilograms),
        (None, Mass::Density(density)) => builder.density(density),
    };
    let collider = builder
        .friction(body.friction)
        .restitution(body.restitution)
        .restitution_combine_rule(CoefficientCombineRule::Max)
        .build();
    let kilograms = f64::from(collider.mass());
    if kilograms > 0.0 && kilograms.is_finite() {
        Ok(collider)
    } else {
        Err(BodyError::Mass {
            name: body.name.clone(),
            kilograms,
        })
    }
}

/// Radians per second, or radians.
pub(super) fn radians(degrees: [f32; 3]) -> Vec3<f64> {
    Vec3::of_f32(degrees) * (std::f64::consts::PI / 180.0)
}

/// Rapier's damping rate c, with which a velocity falls as e^(−ct), for the fraction f that is
/// lost per second: 1 − e^(−c) = f.
fn damping_per_s(lost_per_s: f32) -> f32 {
    let rate = -libm::log(1.0 - f64::from(lost_per_s.clamp(0.0, 1.0)));
    // All of it: a rate at which a single sub-step leaves nothing, but finite.
    (rate as f32).min(1e30)
}
