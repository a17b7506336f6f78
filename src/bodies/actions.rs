//! What the script and the player do to bodies.

use crate::base::Vec3;
use crate::scene::{Action, Body, Shape, limits};

use super::actor::{Actor, Control, Piece, collider, first_pose, radians, rigid_body};
use super::error::BodyError;
use super::frame::to_rapier;
use super::library::CoatedShape;
use super::vehicle::{Build, Controls, Vehicle};
use super::world::Bodies;

impl Bodies {
    /// Does an action at `now_s` since the start of the scene. `SetWind` is none of the bodies'
    /// business and changes nothing here. An action on a quarantined body has no effect: the body
    /// is gone through no fault of the script.
    ///
    /// # Errors
    /// If the named body is not in the world or cannot do what is asked, or a spawned one cannot
    /// be made; then nothing has changed.
    pub fn apply(&mut self, action: &Action, now_s: f64) -> Result<(), BodyError> {
        match action {
            Action::Spawn(body) => self.insert(body, now_s)?,
            Action::Remove { body } => self.remove(body)?,
            Action::Teleport {
                body,
                position_m,
                velocity_m_per_s,
            } => self.teleport(body, *position_m, *velocity_m_per_s)?,
            Action::Throw {
                body,
                velocity_m_per_s,
                spin_deg_per_s,
            } => self.throw(body, *velocity_m_per_s, *spin_deg_per_s)?,
            Action::Impulse {
                body,
                impulse_kg_m_per_s,
            } => self.push(body, *impulse_kg_m_per_s)?,
            Action::Drive {
                body,
                engine_n,
                steer_deg,
                brake_n,
            } => {
                let controls = Controls {
                    engine_n: *engine_n,
                    steer_rad: steer_deg.to_radians(),
                    brake_n: *brake_n,
                };
                self.drive(body, controls)?;
            }
            Action::SetWind(_) => return Ok(()),
        }
        self.refresh();
        Ok(())
    }

    /// Adds a body at run time under a name that is free: its own, or its own with a number.
    /// Gives the name.
    ///
    /// # Errors
    /// If the body cannot be made; then nothing has changed.
    pub fn drop_body(&mut self, body: &Body, now_s: f64) -> Result<String, BodyError> {
        let mut named = body.clone();
        let mut number = 2;
        while self.ids.contains_key(&named.name) {
            named.name = format!("{} {number}", body.name);
            number += 1;
        }
        self.insert(&named, now_s)?;
        self.refresh();
        Ok(named.name)
    }

    /// Makes the shapes of a body's pieces and their coats, so that spawning it later takes no time.
    pub(super) fn prepare_shapes(
        &mut self,
        body: &Body,
    ) -> Result<Vec<(u32, Option<u32>)>, BodyError> {
        let mut index = |shape: &Shape| {
            self.library
                .index_of(shape)
                .map_err(|source| BodyError::Shape {
                    name: body.name.clone(),
                    source,
                })
        };
        let shapes: Vec<u32> = match Build::of(&body.shape) {
            Some(build) => build.pieces().iter().map(index).collect::<Result<_, _>>()?,
            None => vec![index(&body.shape)?],
        };
        let with_coat = |shape| {
            let coated = body.coat.map(|coat| CoatedShape { shape, coat });
            (shape, coated.map(|one| self.library.index_of_coat(one)))
        };
        Ok(shapes.into_iter().map(with_coat).collect())
    }

    pub(super) fn insert(&mut self, body: &Body, now_s: f64) -> Result<(), BodyError> {
        if self.actors.contains_key(&body.name) {
            return Err(BodyError::DuplicateName {
                name: body.name.clone(),
            });
        }
        if self.actors.len() >= limits::BODIES {
            self.refused += 1;
            return Err(BodyError::TooMany {
                name: body.name.clone(),
                limit: limits::BODIES,
            });
        }
        let control = Control::of(body)?;
        let shapes = self.prepare_shapes(body)?;
        let build = Build::of(&body.shape);
        if build.is_some() && control.held().is_some() {
            return Err(BodyError::HeldVehicle {
                name: body.name.clone(),
            });
        }
        let collider = collider(body, shapes[0].0, &self.library)?;
        let pose = first_pose(body, &control, &self.ground, now_s);
        let rigid = rigid_body(body, &control, pose, &self.frame);
        let next = self.ids.values().max().map_or(0, |&id| id + 1);
        let id = *self.ids.entry(body.name.clone()).or_insert(next);
        let moves = rigid.linvel().is_finite() && rigid.angvel().is_finite();
        if !rigid.position().is_finite() || !moves {
            self.quarantine(&body.name);
            return Ok(());
        }
        // As rapier rounds it, so that a body that does not move keeps its bits.
        let pose = self.frame.pose_from_rapier(rigid.position());
        let (handle, _) = self.physics.insert(rigid, collider);
        // As rapier combines two colliders' friction.
        let grip = 0.5 * (body.friction + self.ground_friction);
        let actor = Actor {
            id,
            handle,
            control,
            vehicle: build.map(|build| Vehicle::new(handle, &build, grip)),
            pieces: shapes
                .iter()
                .map(|&(shape, coat)| Piece::new(shape, coat, pose))
                .collect(),
            grass_collider: body.collider,
            rgb: body.rgb,
        };
        self.actors.insert(body.name.clone(), actor);
        Ok(())
    }

    /// `None` for a quarantined body.
    fn find(&mut self, name: &str) -> Result<Option<&mut Actor>, BodyError> {
        match self.actors.get_mut(name) {
            Some(actor) => Ok(Some(actor)),
            None if self.quarantined.iter().any(|other| other == name) => Ok(None),
            None => Err(BodyError::UnknownBody { name: name.into() }),
        }
    }

    fn remove(&mut self, name: &str) -> Result<(), BodyError> {
        if let Some(actor) = self.find(name)? {
            let handle = actor.handle;
            self.actors.remove(name);
            self.physics.remove_body(handle);
        }
        Ok(())
    }

    /// Keeps the body's turn and stops its spin.
    fn teleport(
        &mut self,
        name: &str,
        position_m: [f64; 3],
        velocity_m_per_s: [f32; 3],
    ) -> Result<(), BodyError> {
        let Some(actor) = self.find(name)? else {
            return Ok(());
        };
        let wish = "be put elsewhere";
        if let Control::Path(_) = actor.control {
            return Err(held(name, &actor.control, wish));
        }
        let handle = actor.handle;
        let place = self.frame.place_to_rapier(Vec3::of(position_m));
        let velocity = to_rapier(Vec3::of_f32(velocity_m_per_s));
        if !place.is_finite() || !velocity.is_finite() {
            self.quarantine(name);
            return Ok(());
        }
        let Some(body) = self.physics.bodies.get_mut(handle) else {
            return Ok(());
        };
        body.set_translation(place, true);
        body.set_linvel(velocity, true);
        body.set_angvel(rapier3d::math::Vector::ZERO, true);
        let pose = self.frame.pose_from_rapier(body.position());
        if let Some(actor) = self.actors.get_mut(name) {
            let poses = actor.piece_poses(pose);
            for (piece, pose) in actor.pieces.iter_mut().zip(poses) {
                piece.put(pose);
            }
        }
        Ok(())
    }

    fn drive(&mut self, name: &str, controls: Controls) -> Result<(), BodyError> {
        let Some(actor) = self.find(name)? else {
            return Ok(());
        };
        let Some(vehicle) = &mut actor.vehicle else {
            return Err(BodyError::NotAVehicle { name: name.into() });
        };
        vehicle.drive(controls);
        let handle = actor.handle;
        if !controls.are_finite() {
            self.quarantine(name);
        } else if let Some(body) = self.physics.bodies.get_mut(handle) {
            body.wake_up(true);
        }
        Ok(())
    }

    fn throw(
        &mut self,
        name: &str,
        velocity_m_per_s: [f32; 3],
        spin_deg_per_s: [f32; 3],
    ) -> Result<(), BodyError> {
        let velocity = to_rapier(Vec3::of_f32(velocity_m_per_s));
        let spin = to_rapier(radians(spin_deg_per_s));
        self.disturb(name, "be thrown", |body| {
            body.set_linvel(velocity, true);
            body.set_angvel(spin, true);
        })
    }

    fn push(&mut self, name: &str, impulse_kg_m_per_s: [f32; 3]) -> Result<(), BodyError> {
        let impulse = to_rapier(Vec3::of_f32(impulse_kg_m_per_s));
        self.disturb(name, "take an impulse", |body| {
            body.apply_impulse(impulse, true);
        })
    }

    /// Changes the velocity of a free body.
    fn disturb(
        &mut self,
        name: &str,
        wish: &'static str,
        change: impl FnOnce(&mut rapier3d::prelude::RigidBody),
    ) -> Result<(), BodyError> {
        let Some(actor) = self.find(name)? else {
            return Ok(());
        };
        if actor.control.held().is_some() {
            return Err(held(name, &actor.control, wish));
        }
        let handle = actor.handle;
        if let Some(body) = self.physics.bodies.get_mut(handle) {
            change(body);
            if !body.linvel().is_finite() || !body.angvel().is_finite() {
                self.quarantine(name);
            }
        }
        Ok(())
    }
}

fn held(name: &str, control: &Control, wish: &'static str) -> BodyError {
    BodyError::NotFree {
        name: name.into(),
        held: control.held().unwrap_or("moves freely"),
        wish,
    }
}
