//! The parts that the grass collides with, made once per rigid shape: its convex parts, or the
//! whole body where a method wants that.

use crate::base::Pose;
use crate::bodies::RigidShape;
use crate::scene::method::{Collide, CubePer};
use crate::scene::{Collider, Method, Solver};

use super::depth_cube::DepthCube;
use super::solid::Solid;
use super::voxel_field::VoxelField;

/// What a part's vertices are tested against.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Tested {
    /// The closed form of its solid.
    Closed,
    Cube,
    Voxels,
}

/// What the passes know of one part.
#[derive(Clone, Debug)]
pub struct Part {
    /// The true solid, in the part's own space.
    pub solid: Solid<f64>,
    /// The solid grown by the skin: what the grass is kept out of.
    pub grown: Solid<f32>,
    /// `body_from_part`.
    pub pose: Pose<f64>,
    /// Radius of a ball about the part's origin that holds the grown part, in metres.
    pub radius_m: f64,
    /// Drawn when a body first needs it.
    pub cube: Option<DepthCube>,
    /// Sampled when a body first needs it.
    pub voxels: Option<VoxelField>,
    wants_cube: bool,
    wants_voxels: bool,
}

impl Part {
    /// Longest edge of a texel of this part's depth cube, in metres.
    pub fn texel_m(&self, resolution: u32) -> f64 {
        let [low, high] = self.grown.bounds();
        let size = high - low;
        f64::from(size.x.max(size.y).max(size.z) / resolution as f32)
    }
}

/// Every part of every shape, and which parts make up a shape.
#[derive(Clone, Debug, Default)]
pub struct Parts {
    pub parts: Vec<Part>,
    /// First part of each shape, and one past the last part of the last shape.
    first: Vec<u32>,
    half_thickness_m: Vec<f64>,
    radius_m: Vec<f64>,
}

impl Parts {
    /// Takes in the shapes that are new since the last call, part by part or each as a whole.
    pub fn extend(&mut self, shapes: &[RigidShape], skin_m: f64, whole: bool) {
        for shape in &shapes[self.half_thickness_m.len().min(shapes.len())..] {
            self.first.push(self.parts.len() as u32);
            self.half_thickness_m.push(shape.half_thickness_m);
            self.radius_m.push(shape.bounding_radius_m);
            if whole {
                let solid = Solid::of_body(shape);
                self.parts.push(new_part(solid, Pose::IDENTITY, skin_m));
            } else {
                let parts = shape.parts.iter();
                self.parts.extend(
                    parts.map(|part| new_part(Solid::of_part(&part.solid), part.pose, skin_m)),
                );
            }
        }
    }

    /// The only part of a shape that was taken in as a whole.
    pub fn whole(&self, shape: u32) -> Option<&Part> {
        self.parts.get(*self.first.get(shape as usize)? as usize)
    }

    /// Indices of the parts of a shape.
    pub fn of_shape(&self, shape: u32) -> std::ops::Range<usize> {
        let first = |n: usize| self.first.get(n).map_or(self.parts.len(), |&f| f as usize);
        first(shape as usize)..first(shape as usize + 1)
    }

    pub fn half_thickness_m(&self, shape: u32) -> f64 {
        self.half_thickness_m[shape as usize]
    }

    pub fn radius_m(&self, shape: u32) -> f64 {
        self.radius_m[shape as usize]
    }

    /// What a part is tested against: what the method or the body says; for `auto` its depth cube
    /// where half its thickness is at least two texels.
    pub fn tested(&self, part: usize, collider: Collider, solver: &Solver) -> Tested {
        match (solver.method.collide, collider) {
            (Collide::Voxels, _) => Tested::Voxels,
            (Collide::Exact | Collide::Analytic, _) => Tested::Closed,
            (Collide::Cube, _) | (Collide::AsBodies, Collider::Cube) => Tested::Cube,
            (Collide::AsBodies, Collider::Analytic) => Tested::Closed,
            (Collide::AsBodies, Collider::Auto) => {
                let part = &self.parts[part];
                if thinnest(part) >= 2.0 * part.texel_m(solver.cube_resolution) {
                    Tested::Cube
                } else {
                    Tested::Closed
                }
            }
        }
    }

    /// Asks for what a part's vertices are tested against.
    pub fn want(&mut self, part: usize, tested: Tested) {
        let part = &mut self.parts[part];
        match tested {
            Tested::Closed => {}
            Tested::Cube => part.wants_cube = true,
            Tested::Voxels => part.wants_voxels = true,
        }
    }

    /// Parts that a cube was asked for.
    pub fn wanted(&self) -> impl Iterator<Item = usize> {
        (0..self.parts.len()).filter(|&n| self.parts[n].wants_cube)
    }

    /// Parts that need a cube and have none yet.
    pub fn undrawn(&self) -> Vec<usize> {
        self.wanted()
            .filter(|&n| self.parts[n].cube.is_none())
            .collect()
    }

    /// Parts that need a voxel field and have none yet.
    pub fn unsampled(&self) -> Vec<usize> {
        (0..self.parts.len())
            .filter(|&n| self.parts[n].wants_voxels && self.parts[n].voxels.is_none())
            .collect()
    }

    /// Indices of the parts of the shape that a part belongs to.
    pub fn shape_of(&self, part: usize) -> std::ops::Range<usize> {
        let shape = self.first.partition_point(|&f| f as usize <= part) - 1;
        self.of_shape(shape as u32)
    }

    /// The other parts of the same shape.
    pub fn siblings(&self, part: usize) -> impl Iterator<Item = &Part> {
        self.shape_of(part)
            .filter(move |&n| n != part)
            .map(|n| &self.parts[n])
    }
}

/// True where a method takes bodies as a whole instead of part by part.
pub fn takes_whole_bodies(method: &Method) -> bool {
    method.collide == Collide::Exact || method.cube_per == CubePer::Body
}

fn new_part(solid: Solid<f64>, pose: Pose<f64>, skin_m: f64) -> Part {
    let grown: Solid<f32> = solid.grown_by(skin_m);
    let [low, high] = grown.bounds();
    let corner = [
        low.x.abs().max(high.x.abs()),
        low.y.abs().max(high.y.abs()),
        low.z.abs().max(high.z.abs()),
    ]
    .map(f64::from);
    Part {
        solid,
        grown,
        pose,
        radius_m: corner.iter().map(|c| c * c).sum::<f64>().sqrt(),
        cube: None,
        voxels: None,
        wants_cube: false,
        wants_voxels: false,
    }
}

/// Half the smallest extent of a part's bounds: an upper bound of its half thickness that is
/// exact for the closed forms.
fn thinnest(part: &Part) -> f64 {
    let [low, high] = part.solid.bounds();
    let size = high - low;
    0.5 * size.x.min(size.y).min(size.z)
}
