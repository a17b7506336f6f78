//! What never moves, as rays see it: the ground, and bodies of the motion `Fixed`.

use rapier3d::prelude::{ColliderBuilder, PhysicsWorld, QueryFilter, Ray};

use crate::base::{Hash64, Pose, Vec3};
use crate::terrain::HeightGrid;

use super::actor::Control;
use super::collider::{ground, land, shared_shape};
use super::error::BodyError;
use super::frame::{Frame, to_rapier};
use super::shape::{RigidShape, Solid};
use super::world::Bodies;

/// Rays end here, in metres: beyond the corner of the largest ground.
const REACH_M: f32 = 1e6;

/// What a ray from a point meets.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Sight {
    /// Nothing.
    Open,
    Blocked,
    /// The point itself lies in a body.
    Inside,
}

/// The ground and the fixed bodies as they were when it was made. A mesh is the convex parts that it is
/// for physics and grass. It shares nothing with the bodies it is made from, so that another thread may
/// have it.
pub struct Occluders {
    world: PhysicsWorld,
    frame: Frame,
    hash: u64,
}

impl std::fmt::Debug for Occluders {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Occluders({:016x})", self.hash)
    }
}

impl Occluders {
    /// The ground and the fixed bodies of a world.
    ///
    /// # Errors
    /// A ground that makes no collider.
    pub fn new(bodies: &Bodies) -> Result<Self, BodyError> {
        let grid = &bodies.ground;
        let frame = Frame::around(&[], grid.centre_m);
        let mut world = PhysicsWorld::default();
        for (place, mut collider) in ground(grid, 0.0)?.into_iter().chain(land(grid, 0.0)) {
            collider.set_translation(frame.place_to_rapier(place));
            world.insert_collider(collider, None);
        }
        let mut hash = Hash64::default();
        take_in_ground(&mut hash, grid);
        let fixed =
            (bodies.actors.values()).filter(|actor| matches!(actor.control, Control::Fixed));
        for piece in fixed.flat_map(|actor| &actor.pieces) {
            let Some(shape) = bodies.library.shapes().get(piece.shape as usize) else {
                continue;
            };
            // A part that rapier finds flat hides nothing.
            let Some(shared) = shared_shape(shape) else {
                continue;
            };
            let collider = ColliderBuilder::new(shared).position(frame.pose_to_rapier(piece.to));
            world.insert_collider(collider.build(), None);
            take_in_pose(&mut hash, &piece.to);
            take_in_shape(&mut hash, shape);
        }
        // A step of no time is how rapier takes in changes without moving anything.
        world.integration_parameters.dt = 0.0;
        world.step();
        Ok(Self {
            world,
            frame,
            hash: hash.value(),
        })
    }

    /// A hash of everything that rays can meet.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// What a ray from a place along a unit vector meets. The ground has no inside.
    pub fn sight(&self, from_m: [f64; 3], direction: [f64; 3]) -> Sight {
        let from = self.frame.place_to_rapier(Vec3::of(from_m));
        let ray = Ray::new(from, to_rapier(Vec3::of(direction)));
        let met = (self.world).cast_ray(&ray, REACH_M, true, QueryFilter::default());
        match met {
            None => Sight::Open,
            Some((_, 0.0)) => Sight::Inside,
            Some(_) => Sight::Blocked,
        }
    }
}

fn take_in_ground(hash: &mut Hash64, grid: &HeightGrid) {
    hash.word(u64::from(grid.columns) << 32 | u64::from(grid.rows));
    hash.word(u64::from(grid.spacing_m.to_bits()));
    grid.centre_m.iter().for_each(|c| hash.word(c.to_bits()));
    for height in &grid.heights_m {
        hash.word(u64::from(height.to_bits()));
    }
}

fn take_in_pose(hash: &mut Hash64, pose: &Pose<f64>) {
    take_in(hash, &pose.turn.to_array());
    take_in(hash, &pose.place.to_f64());
}

fn take_in(hash: &mut Hash64, numbers: &[f64]) {
    hash.word(numbers.len() as u64);
    numbers.iter().for_each(|x| hash.word(x.to_bits()));
}

fn take_in_shape(hash: &mut Hash64, shape: &RigidShape) {
    hash.word(shape.parts.len() as u64);
    for part in &shape.parts {
        take_in_pose(hash, &part.pose);
        match &part.solid {
            Solid::Ball { radius } => take_in(hash, &[1.0, *radius]),
            Solid::Box { half } => take_in(hash, &[2.0, half[0], half[1], half[2]]),
            Solid::Capsule { radius, half } => take_in(hash, &[3.0, *radius, *half]),
            Solid::Cylinder { radius, half } => take_in(hash, &[4.0, *radius, *half]),
            Solid::Convex { vertices, .. } => take_in(hash, vertices.as_flattened()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::terrain::height_grid;

    fn occluders(bodies: &str) -> Occluders {
        let scene: Scene = ron::from_str(&format!("(bodies: [{bodies}])")).expect("a scene");
        let ground = height_grid(&scene.terrain, &Default::default()).expect("flat");
        let bodies = Bodies::new(&scene, &Default::default(), &ground).expect("plain bodies");
        Occluders::new(&bodies).expect("a ground")
    }

    const BOX: &str =
        "(name: \"a\", shape: Box(size_m: (2, 2, 2)), position_m: (3, 1, 0), motion: Fixed)";
    const BALL: &str = "(name: \"b\", shape: Ball(radius_m: 0.5), position_m: (-3, 0.5, 0))";

    #[test]
    fn rays_meet_the_ground_and_what_is_fixed_alone() {
        let all = occluders(&format!("{BOX}, {BALL}"));
        let from = [0.0, 0.5, 0.0];
        assert_eq!(all.sight(from, [1.0, 0.0, 0.0]), Sight::Blocked);
        assert_eq!(all.sight(from, [-1.0, 0.0, 0.0]), Sight::Open);
        assert_eq!(all.sight(from, [0.0, -1.0, 0.0]), Sight::Blocked);
        assert_eq!(all.sight(from, [0.0, 1.0, 0.0]), Sight::Open);
        assert_eq!(all.sight([3.0, 1.0, 0.0], [0.0, 1.0, 0.0]), Sight::Inside);
    }

    #[test]
    fn the_hash_follows_what_is_fixed() {
        let one = occluders(BOX).hash();
        assert_eq!(occluders(&format!("{BOX}, {BALL}")).hash(), one);
        let moved = BOX.replace("(3, 1, 0)", "(3, 1, 0.001)");
        let larger = BOX.replace("(2, 2, 2)", "(2, 2, 2.001)");
        for other in ["", BALL, &moved, &larger] {
            assert_ne!(occluders(other).hash(), one, "{other}");
        }
    }
}
