//! A chassis on four wheels, each a ray with a spring: rapier's ray-cast vehicle.
//!
//! The chassis is a rigid box. A wheel is no body of the physics but a ray down from its hard
//! point; where it meets something, a spring and damper push the chassis up, and the tyre's grip
//! limits its force along and across. For the grass, the picture and the links a wheel is a
//! cylinder where the ray says. +z is ahead, +x is left, the front wheels steer.
//!
//! Springs are chosen by what they do: on level ground they give way by [`SAG`] of a radius, so
//! that cars and toys alike bounce at √(g / sag), 1.7 Hz for a wheel of 0.35 m.

use std::f32::consts::TAU;

use rapier3d::control::{DynamicRayCastVehicleController, WheelTuning};
use rapier3d::math::Vector;
use rapier3d::prelude::{MassProperties, PhysicsWorld, QueryFilter, RigidBodyHandle};

use crate::base::{Pose, Quat, Vec3};
use crate::scene::Shape;

use super::frame::turn_of_degrees;

/// Gives of a spring under the resting chassis, over the wheel's radius.
const SAG: f32 = 0.25;
/// Length of an unloaded spring over the radius: the ray starts two radii above the tyre's foot.
const REST: f32 = 1.0;
/// Way of a wheel up and down from there, over the radius.
const TRAVEL: f32 = 0.5;
/// Damping over critical damping, when a spring is pressed and when it comes back.
const PRESSED: f32 = 0.35;
const RELEASED: f32 = 0.55;
/// Force that rolling on turf takes, over the load. Without it a car rolls for ever.
const ROLLING_RESISTANCE: f32 = 0.05;
const STANDARD_GRAVITY: f32 = 9.81;
/// Front left, front right, rear left, rear right: sides along x and z.
const CORNERS: [[f32; 2]; 4] = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];

/// A vehicle's sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Build {
    chassis_m: [f32; 3],
    radius_m: f32,
    width_m: f32,
}

impl Build {
    /// `None` for any other shape.
    pub fn of(shape: &Shape) -> Option<Self> {
        match *shape {
            Shape::Vehicle {
                chassis_m,
                wheel_radius_m,
                wheel_width_m,
            } => Some(Self {
                chassis_m,
                radius_m: wheel_radius_m,
                width_m: wheel_width_m,
            }),
            _ => None,
        }
    }

    /// The shapes of its pieces: the chassis, then the four wheels with their axis along y.
    pub fn pieces(&self) -> [Shape; 5] {
        let wheel = Shape::Cylinder {
            radius_m: self.radius_m,
            height_m: self.width_m,
        };
        let chassis = Shape::Box {
            size_m: self.chassis_m,
        };
        [chassis, wheel.clone(), wheel.clone(), wheel.clone(), wheel]
    }

    /// Mass properties of the chassis: those of its box, but with the centre of mass at its floor,
    /// where engine, axles and wheels are. A box balanced at its middle would tip over in bends.
    pub fn mass_properties(&self, kilograms: f32) -> MassProperties {
        let [x, y, z] = self.chassis_m;
        let about = |a: f32, b: f32| kilograms / 12.0 * (a * a + b * b);
        MassProperties::new(
            Vector::new(0.0, -0.5 * y, 0.0),
            kilograms,
            Vector::new(about(y, z), about(z, x), about(x, y)),
        )
    }

    pub fn chassis_volume_m3(&self) -> f32 {
        self.chassis_m.iter().product()
    }

    /// Where a wheel's ray starts, in the chassis's space: beside the chassis, and so high that
    /// the sagging wheel's axle is level with the floor.
    fn hard_point(&self, [side_x, side_z]: [f32; 2]) -> Vector {
        let [x, y, z] = self.chassis_m;
        Vector::new(
            side_x * 0.5 * (x + self.width_m),
            -0.5 * y + (REST - SAG) * self.radius_m,
            side_z * (0.5 * z - self.radius_m).max(0.25 * z),
        )
    }

    fn tuning(&self, grip: f32) -> WheelTuning {
        // Four springs of stiffness k (per chassis mass) carry g at the sag; their frequency is
        // then √(4k), and a damper of c (per mass) has the ratio 4c / (2√(4k)).
        let stiffness = STANDARD_GRAVITY / (4.0 * SAG * self.radius_m);
        let critical = (4.0 * stiffness).sqrt() / 2.0;
        WheelTuning {
            suspension_stiffness: stiffness,
            suspension_compression: PRESSED * critical,
            suspension_damping: RELEASED * critical,
            max_suspension_travel: TRAVEL * self.radius_m,
            side_friction_stiffness: 1.0,
            friction_slip: grip,
            // A limit would let the chassis drop onto its floor at landing.
            max_suspension_force: f32::MAX,
        }
    }
}

/// What drives and steers, until the next time it is set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Controls {
    /// Over the four wheels, in newtons; negative drives backwards.
    pub engine_n: f32,
    /// Positive steers to the left, towards +x.
    pub steer_rad: f32,
    /// Over the four wheels, in newtons. A pressed brake takes the engine's force away.
    pub brake_n: f32,
}

impl Controls {
    pub fn are_finite(&self) -> bool {
        let Self {
            engine_n,
            steer_rad,
            brake_n,
        } = self;
        engine_n.is_finite() && steer_rad.is_finite() && brake_n.is_finite()
    }
}

/// A vehicle in the world.
#[derive(Clone)]
pub(super) struct Vehicle {
    rays: DynamicRayCastVehicleController,
    controls: Controls,
    /// False until the rays were cast once and the wheels have a place.
    stands: bool,
}

impl Vehicle {
    /// `grip` is the friction coefficient between tyre and ground.
    pub fn new(chassis: RigidBodyHandle, build: &Build, grip: f32) -> Self {
        let mut rays = DynamicRayCastVehicleController::new(chassis);
        rays.index_up_axis = 1;
        rays.index_forward_axis = 2;
        let tuning = build.tuning(grip);
        for corner in CORNERS {
            rays.add_wheel(
                build.hard_point(corner),
                -Vector::Y,
                // Rapier drives along normal × axle: up × −x is +z.
                -Vector::X,
                REST * build.radius_m,
                build.radius_m,
                &tuning,
            );
        }
        Self {
            rays,
            controls: Controls::default(),
            stands: false,
        }
    }

    pub fn drive(&mut self, controls: Controls) {
        self.controls = controls;
    }

    /// Springs, tyres and engine push the chassis for one sub-step. A sleeping vehicle is left to
    /// sleep.
    pub fn push(&mut self, physics: &mut PhysicsWorld, dt_s: f32) {
        let handle = self.rays.chassis;
        let Some(chassis) = physics.bodies.get(handle) else {
            return;
        };
        if chassis.is_sleeping() {
            return;
        }
        self.set_wheels(chassis.mass() * STANDARD_GRAVITY, dt_s);
        let queries = physics.broad_phase.as_query_pipeline_mut(
            physics.narrow_phase.query_dispatcher(),
            &mut physics.bodies,
            &mut physics.colliders,
            QueryFilter::default().exclude_rigid_body(handle),
        );
        self.rays.update_vehicle(dt_s, queries);
        for wheel in self.rays.wheels_mut() {
            // After a day of driving f32 would no longer tell one angle from the next.
            wheel.rotation %= TAU;
        }
    }

    /// Casts the rays of a new vehicle, so that its wheels stand where they will start from. True
    /// the first time only.
    pub fn set_down(&mut self, physics: &mut PhysicsWorld) -> bool {
        let new = !self.stands;
        if new {
            self.stands = true;
            self.push(physics, 0.0);
        }
        new
    }

    fn set_wheels(&mut self, weight_n: f32, dt_s: f32) {
        let Controls {
            engine_n,
            steer_rad,
            brake_n,
        } = self.controls;
        let resistance_n = ROLLING_RESISTANCE * weight_n;
        // Against the motion, and fading out at rest lest it push backwards.
        let resisting_n = resistance_n * (self.rays.current_vehicle_speed / 0.1).clamp(-1.0, 1.0);
        let drives = engine_n != 0.0 && brake_n <= 0.0;
        for (wheel, [_, side_z]) in self.rays.wheels_mut().iter_mut().zip(CORNERS) {
            wheel.engine_force = if drives {
                0.25 * (engine_n - resisting_n)
            } else {
                0.0
            };
            // Rapier takes an impulse per step here, not a force.
            wheel.brake = 0.25 * (brake_n.max(0.0) + resistance_n) * dt_s;
            wheel.steering = if side_z > 0.0 { steer_rad } else { 0.0 };
        }
    }

    /// `world_from_body` of the wheels, for a pose of the chassis.
    pub fn wheel_poses(&self, chassis: Pose<f64>) -> impl Iterator<Item = Pose<f64>> {
        // A scene's cylinder stands along y; turned about z it lies along the axle.
        let lying = turn_of_degrees([0.0, 0.0, 90.0]);
        self.rays.wheels().iter().map(move |wheel| {
            let hard = wheel.chassis_connection_point_cs;
            let down = f64::from(wheel.raycast_info().suspension_length);
            let place = Vec3::of_f32([hard.x, hard.y, hard.z]) - Vec3::UP * down;
            let steered = turn_of_degrees([0.0, f64::from(wheel.steering).to_degrees(), 0.0]);
            let rolled = turn_of_degrees([f64::from(wheel.rotation).to_degrees(), 0.0, 0.0]);
            let turn: Quat<f64> = lying.then(rolled).then(steered).then(chassis.turn);
            Pose {
                turn,
                place: chassis.point(place),
            }
        })
    }
}
