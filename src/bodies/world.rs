//! The bodies of a scene in a rapier world.

use std::collections::{BTreeMap, BTreeSet};

use rapier3d::math::Vector;
use rapier3d::prelude::{ColliderHandle, PhysicsWorld, QueryFilter, Ray};

use crate::base::{Hash64, Pose, Vec3};
use crate::scene::assets::Assets;
use crate::scene::{Action, Body, Motion, Scene};
use crate::terrain::HeightGrid;

use super::actor::{Actor, Control};
use super::collider;
use super::error::BodyError;
use super::frame::{Frame, from_rapier, to_rapier};
use super::library::{CoatedShape, ShapeLibrary};
use super::link::Link;
use super::shape::RigidShape;

/// m/s², along y.
const GRAVITY: f32 = -9.81;
/// Rapier's slop, in metres: how far bodies may overlap at rest. Blades are a few millimetres
/// wide, so its usual 5 mm would show.
const ALLOWED_ERROR_M: f32 = 0.0005;

/// A body this far below the ground is lost, in metres.
const LOST_BELOW_M: f64 = 10.0;

/// Every body of a scene, advanced in sub-steps.
///
/// Bodies enter rapier in the order of their names, since its result depends on that order: the
/// order in the file does not matter. A body whose pose or velocity stops being finite is taken
/// out and named by [`Bodies::quarantined`]; the others go on.
pub struct Bodies {
    pub(super) physics: PhysicsWorld,
    pub(super) frame: Frame,
    /// The ground's colliders, with where they are in the world.
    grounds: Vec<(ColliderHandle, Vec3<f64>)>,
    pub(super) ground: HeightGrid,
    pub(super) ground_friction: f32,
    pub(super) library: ShapeLibrary,
    pub(super) actors: BTreeMap<String, Actor>,
    /// Rank of each name that the scene knows, then names dropped later.
    pub(super) ids: BTreeMap<String, u32>,
    pub(super) quarantined: Vec<String>,
    pub(super) refused: u64,
    pub(super) links: Vec<Link>,
}

/// What there is to say of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyInfo<'a> {
    pub name: &'a str,
    /// As in [`Link::body`].
    pub id: u32,
    /// `world_from_body`; of the chassis for a vehicle.
    pub pose: Pose<f64>,
    /// Of the centre of mass, in metres per second.
    pub velocity_m_per_s: [f64; 3],
    /// About x, y, z of the world, in radians per second.
    pub spin_rad_per_s: [f64; 3],
    /// 0 for a fixed body or one on a path.
    pub mass_kg: f64,
    /// False once rapier lets it sleep, and for a fixed body.
    pub awake: bool,
    /// Index into [`Bodies::shapes`]; the chassis's for a vehicle.
    pub shape: u32,
    pub is_vehicle: bool,
}

/// What a ray meets first.
#[derive(Clone, Debug, PartialEq)]
pub struct RayHit<'a> {
    pub point_m: [f64; 3],
    /// The body's name, or `None` for the ground.
    pub body: Option<&'a str>,
}

impl Bodies {
    /// Puts the scene's bodies into a new world.
    ///
    /// # Errors
    /// If a name is taken twice, or a shape, mass or path cannot be used; shapes of bodies that
    /// the script spawns are made and checked here too.
    pub fn new(scene: &Scene, assets: &Assets, ground: &HeightGrid) -> Result<Self, BodyError> {
        let mut bodies = Self {
            physics: physics_world(),
            frame: Frame::around(&first_places(scene, ground), ground.centre_m),
            grounds: Vec::new(),
            ground: ground.clone(),
            ground_friction: scene.terrain.friction,
            library: ShapeLibrary::new(assets.meshes.clone()),
            actors: BTreeMap::new(),
            ids: ids(scene),
            quarantined: Vec::new(),
            refused: 0,
            links: Vec::new(),
        };
        let field = collider::ground(ground, scene.terrain.friction)?;
        let land = collider::land(ground, scene.terrain.friction);
        for (place, collider) in field.into_iter().chain(land) {
            let at = bodies.frame.place_to_rapier(place);
            let mut collider = collider;
            collider.set_translation(at);
            let handle = bodies.physics.insert_collider(collider, None);
            bodies.grounds.push((handle, place));
        }
        let mut in_order: Vec<_> = scene.bodies.iter().collect();
        in_order.sort_by(|a, b| a.name.cmp(&b.name));
        for body in in_order {
            bodies.insert(body, 0.0)?;
        }
        for event in &scene.script {
            if let Action::Spawn(body) = &event.action {
                bodies.prepare_shapes(body)?;
            }
        }
        bodies.refresh();
        Ok(bodies)
    }

    /// Advances everything by one sub-step that begins `start_s` after the start of the scene.
    /// A time that is not finite, or a length that is not more than 0, moves nothing.
    pub fn step(&mut self, start_s: f64, dt_s: f64) {
        let moves = dt_s > 0.0 && dt_s.is_finite() && start_s.is_finite();
        if !moves {
            return;
        }
        self.follow_bodies();
        self.physics.integration_parameters.dt = dt_s as f32;
        // Rapier's own ratio of the shortest piece of a step to the whole.
        self.physics.integration_parameters.min_ccd_dt = dt_s as f32 / 100.0;
        self.aim_at_paths(start_s, start_s + dt_s);
        for actor in self.actors.values_mut() {
            if let Some(vehicle) = &mut actor.vehicle {
                vehicle.push(&mut self.physics, dt_s as f32);
            }
        }
        self.physics.step();
        self.expel_broken();
        self.read_poses(start_s, start_s + dt_s);
        self.list_links();
    }

    /// The rigid pieces and their way through the last sub-step, by the name of their body and
    /// then by piece. Removed and quarantined bodies have none.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Every shape so far. Indices stay valid; new shapes are appended.
    pub fn shapes(&self) -> &[RigidShape] {
        self.library.shapes()
    }

    /// Every coat on one of the shapes so far; as for [`Bodies::shapes`].
    pub fn coated(&self) -> &[CoatedShape] {
        self.library.coated()
    }

    /// The id of a name that the scene knows, or that was dropped since.
    pub fn id_of(&self, name: &str) -> Option<u32> {
        self.ids.get(name).copied()
    }

    /// Every body in the world, by name.
    pub fn info(&self) -> impl Iterator<Item = BodyInfo<'_>> {
        self.actors.iter().filter_map(|(name, actor)| {
            let body = self.physics.bodies.get(actor.handle)?;
            let piece = actor.pieces.first()?;
            Some(BodyInfo {
                name,
                id: actor.id,
                pose: piece.to,
                velocity_m_per_s: from_rapier(body.linvel()).to_f64(),
                spin_rad_per_s: from_rapier(body.angvel()).to_f64(),
                mass_kg: match actor.control.held() {
                    Some(_) => 0.0,
                    None => f64::from(body.mass()),
                },
                awake: !body.is_sleeping() && !body.is_fixed(),
                shape: piece.shape,
                is_vehicle: actor.vehicle.is_some(),
            })
        })
    }

    /// What a body is, by name.
    pub fn info_of(&self, name: &str) -> Option<BodyInfo<'_>> {
        self.info().find(|info| info.name == name)
    }

    /// Names of the bodies whose pose or velocity was not finite, in the order of their failure.
    pub fn quarantined(&self) -> &[String] {
        &self.quarantined
    }

    /// How many bodies were refused because the world was full.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// What a ray meets first within `reach_m`; `direction` need not be of unit length. `None`
    /// also if a number is not finite.
    pub fn ray(&self, from_m: [f64; 3], direction: [f64; 3], reach_m: f64) -> Option<RayHit<'_>> {
        let (from, along) = (Vec3::of(from_m), Vec3::of(direction));
        if !from.is_finite() || !along.is_finite() || !reach_m.is_finite() {
            return None;
        }
        let along = along.unit_or(Vec3::ZERO);
        let ray = Ray::new(self.frame.place_to_rapier(from), to_rapier(along));
        let filter = QueryFilter::default();
        let (collider, distance) = self.physics.cast_ray(&ray, reach_m as f32, true, filter)?;
        Some(RayHit {
            point_m: (from + along * f64::from(distance)).to_f64(),
            body: self.owner(collider),
        })
    }

    /// A hash over the bits of every pose and velocity, by name: equal runs have equal hashes.
    pub fn hash(&self) -> u64 {
        let mut hash = Hash64::default();
        for (name, actor) in &self.actors {
            hash.bytes(name.as_bytes());
            if let Some(body) = self.physics.bodies.get(actor.handle) {
                let q = body.rotation();
                let vectors = [body.translation(), body.linvel(), body.angvel()];
                let floats = vectors.into_iter().flat_map(|v| [v.x, v.y, v.z]);
                for x in floats.chain([q.x, q.y, q.z, q.w]) {
                    hash.word(u64::from(x.to_bits()));
                }
            }
            for piece in &actor.pieces {
                let place = piece.to.place.to_f64();
                for c in piece.to.turn.to_array().iter().chain(&place) {
                    hash.word(c.to_bits());
                }
            }
        }
        hash.value()
    }

    /// Makes queries and links agree with the bodies as they are now. A step of no time is how
    /// rapier takes in changes without moving anything.
    pub(super) fn refresh(&mut self) {
        self.physics.integration_parameters.dt = 0.0;
        self.physics.step();
        self.expel_broken();
        for actor in self.actors.values_mut() {
            let Some(vehicle) = &mut actor.vehicle else {
                continue;
            };
            if vehicle.set_down(&mut self.physics) {
                let poses = actor.piece_poses(actor.pieces[0].to);
                for (piece, pose) in actor.pieces.iter_mut().zip(poses) {
                    piece.put(pose);
                }
            }
        }
        self.list_links();
    }

    /// Takes a body out for good and names it.
    pub(super) fn quarantine(&mut self, name: &str) {
        if let Some(actor) = self.actors.remove(name) {
            self.physics.remove_body(actor.handle);
        }
        if !self.quarantined.iter().any(|other| other == name) {
            self.quarantined.push(name.to_owned());
        }
    }

    /// Moves rapier's origin to where the bodies are now, if they have gone far from it.
    fn follow_bodies(&mut self) {
        let places: Vec<Vec3<f64>> = self
            .actors
            .values()
            .filter_map(|actor| Some(actor.pieces.first()?.to.place))
            .filter(|&place| is_over(&self.ground, place))
            .collect();
        if self.frame.is_near(&places) {
            return;
        }
        let frame = Frame::around(&places, self.ground.centre_m);
        let shift = self.frame.shift_to(&frame);
        for actor in self.actors.values() {
            if let Some(body) = self.physics.bodies.get_mut(actor.handle) {
                let place = body.translation() + shift;
                body.set_translation(place, false);
            }
        }
        for &(handle, place) in &self.grounds {
            if let Some(collider) = self.physics.colliders.get_mut(handle) {
                collider.set_translation(frame.place_to_rapier(place));
            }
        }
        self.frame = frame;
    }

    fn owner(&self, collider: ColliderHandle) -> Option<&str> {
        let parent = self.physics.colliders.get(collider)?.parent()?;
        let mut all = self.actors.iter();
        all.find(|(_, actor)| actor.handle == parent)
            .map(|(name, _)| name.as_str())
    }

    fn aim_at_paths(&mut self, start_s: f64, end_s: f64) {
        for actor in self.actors.values() {
            let Control::Path(path) = &actor.control else {
                continue;
            };
            let Some(body) = self.physics.bodies.get_mut(actor.handle) else {
                continue;
            };
            let pose = self.frame.pose_to_rapier(path.pose(end_s, &self.ground));
            if path.jumps(start_s, end_s) {
                // Without a velocity: what it lands on is not struck, what it leaves not dragged.
                body.set_position(pose, true);
            }
            body.set_next_kinematic_position(pose);
        }
    }

    /// Quarantines what rapier found broken, and whatever else is not finite.
    fn expel_broken(&mut self) {
        let report = self.physics.quarantine();
        let colliders = report.colliders().iter();
        let owners = colliders.filter_map(|&c| self.physics.colliders.get(c)?.parent());
        let broken: Vec<_> = report.bodies().iter().copied().chain(owners).collect();
        let lost = |actor: &Actor| match self.physics.bodies.get(actor.handle) {
            Some(body) => {
                broken.contains(&actor.handle)
                    || !body.position().is_finite()
                    || !body.linvel().is_finite()
                    || !body.angvel().is_finite()
            }
            None => true,
        };
        let names: Vec<String> = self
            .actors
            .iter()
            .filter(|(_, actor)| lost(actor))
            .map(|(name, _)| name.clone())
            .collect();
        for name in names {
            self.quarantine(&name);
        }
    }

    fn read_poses(&mut self, start_s: f64, end_s: f64) {
        for actor in self.actors.values_mut() {
            let Some(body) = self.physics.bodies.get(actor.handle) else {
                continue;
            };
            let pose = self.frame.pose_from_rapier(body.position());
            let jumps = match &actor.control {
                Control::Path(path) => path.jumps(start_s, end_s),
                Control::Free | Control::Fixed => false,
            };
            let poses = actor.piece_poses(pose);
            for (piece, pose) in actor.pieces.iter_mut().zip(poses) {
                if jumps {
                    piece.jump(pose);
                } else {
                    piece.advance(pose);
                }
            }
        }
    }

    fn list_links(&mut self) {
        self.links.clear();
        for actor in self.actors.values() {
            self.links.extend(actor.pieces.iter().map(|piece| Link {
                body: actor.id,
                shape: piece.shape,
                from: piece.from,
                to: piece.to,
                placed: piece.placed,
                collider: actor.grass_collider,
                rgb: actor.rgb,
                coat: piece.coat,
            }));
        }
    }
}

/// True of a place that rapier's origin is kept near to. A body that has gone over the edge falls for
/// ever, and would take the origin away from the others.
fn is_over(ground: &HeightGrid, place: Vec3<f64>) -> bool {
    let surface_m = || ground.height_in_world(place.x, place.z);
    ground.contains(place.x, place.z) && place.y > surface_m() - LOST_BELOW_M
}

/// Where the scene's bodies are at its start, as far as the scene itself says it.
fn first_places(scene: &Scene, ground: &HeightGrid) -> Vec<Vec3<f64>> {
    let place = |body: &Body| match &body.motion {
        Motion::Path { waypoints, .. } => waypoints.first().map(|w| w.position_m),
        Motion::Free | Motion::Thrown { .. } | Motion::Fixed => Some(body.position_m),
    };
    let places = scene.bodies.iter().filter_map(place).map(Vec3::of);
    places.filter(|&place| is_over(ground, place)).collect()
}

fn physics_world() -> PhysicsWorld {
    let mut world = PhysicsWorld {
        gravity: Vector::Y * GRAVITY,
        ..PhysicsWorld::default()
    };
    let parameters = &mut world.integration_parameters;
    parameters.normalized_allowed_linear_error = ALLOWED_ERROR_M;
    // No silent limit on the speed of a thrown body.
    parameters.normalized_max_linear_velocity = f32::MAX;
    world
}

/// Ranks of all names of the scene, spawned ones included.
fn ids(scene: &Scene) -> BTreeMap<String, u32> {
    let spawned = scene.script.iter().filter_map(|event| match &event.action {
        Action::Spawn(body) => Some(&body.name),
        _ => None,
    });
    let present = scene.bodies.iter().map(|body| &body.name);
    let names: BTreeSet<&String> = present.chain(spawned).collect();
    names.into_iter().cloned().zip(0..).collect()
}
