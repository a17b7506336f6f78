//! The state of all bodies, put aside and taken up again.

use std::collections::BTreeMap;

use rapier3d::prelude::{
    BroadPhaseBvh, CCDSolver, ColliderSet, ImpulseJointSet, IntegrationParameters, IslandManager,
    MultibodyJointSet, NarrowPhase, PhysicsPipeline, PhysicsWorld, RigidBodySet, SoftBodySet,
};

use super::actor::Actor;
use super::frame::Frame;
use super::link::Link;
use super::world::Bodies;

/// Everything about bodies that a sub-step or an action changes, down to rapier's contacts and
/// islands, without which the next step would have other bits.
///
/// Ground and shapes are shared, not copied: the ground never changes, and shapes are only ever
/// added, so that those of a time that is taken back do no harm.
#[derive(Clone)]
pub struct BodiesState {
    integration_parameters: IntegrationParameters,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    impulse_joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    actors: BTreeMap<String, Actor>,
    ids: BTreeMap<String, u32>,
    quarantined: Vec<String>,
    refused: u64,
    frame: Frame,
    links: Vec<Link>,
}

impl Bodies {
    /// A copy of the state of now.
    pub fn save(&self) -> BodiesState {
        let PhysicsWorld {
            gravity: _,
            integration_parameters,
            // Workspaces: what is in them between two steps is not read again.
            physics_pipeline: _,
            collision_pipeline: _,
            ccd_solver: _,
            islands,
            broad_phase,
            narrow_phase,
            bodies,
            colliders,
            impulse_joints,
            multibody_joints,
            soft_bodies,
        } = &self.physics;
        BodiesState {
            integration_parameters: *integration_parameters,
            islands: islands.clone(),
            broad_phase: broad_phase.clone(),
            narrow_phase: narrow_phase.clone(),
            bodies: bodies.clone(),
            colliders: colliders.clone(),
            impulse_joints: impulse_joints.clone(),
            multibody_joints: multibody_joints.clone(),
            soft_bodies: soft_bodies.clone(),
            actors: self.actors.clone(),
            ids: self.ids.clone(),
            quarantined: self.quarantined.clone(),
            refused: self.refused,
            frame: self.frame,
            links: self.links.clone(),
        }
    }

    /// Takes up a state that these bodies had before.
    pub fn restore(&mut self, state: &BodiesState) {
        let state = state.clone();
        self.physics = PhysicsWorld {
            gravity: self.physics.gravity,
            integration_parameters: state.integration_parameters,
            physics_pipeline: PhysicsPipeline::new(),
            collision_pipeline: Default::default(),
            ccd_solver: CCDSolver::new(),
            islands: state.islands,
            broad_phase: state.broad_phase,
            narrow_phase: state.narrow_phase,
            bodies: state.bodies,
            colliders: state.colliders,
            impulse_joints: state.impulse_joints,
            multibody_joints: state.multibody_joints,
            soft_bodies: state.soft_bodies,
        };
        self.actors = state.actors;
        self.ids = state.ids;
        self.quarantined = state.quarantined;
        self.refused = state.refused;
        self.frame = state.frame;
        self.links = state.links;
    }
}
