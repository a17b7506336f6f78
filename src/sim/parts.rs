//! The convex parts that the grass collides with, made once per rigid shape.

use crate::base::Pose;
use crate::bodies::{ConvexPart, RigidShape};
use crate::scene::Collider;

use super::depth_cube::DepthCube;
use super::solid::Solid;

/// What the passes know of one convex part.
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
    wants_cube: bool,
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
    /// Takes in the shapes that are new since the last call.
    pub fn extend(&mut self, shapes: &[RigidShape], skin_m: f64) {
        for shape in &shapes[self.half_thickness_m.len().min(shapes.len())..] {
            self.first.push(self.parts.len() as u32);
            self.half_thickness_m.push(shape.half_thickness_m);
            self.radius_m.push(shape.bounding_radius_m);
            self.parts
                .extend(shape.parts.iter().map(|part| new_part(part, skin_m)));
        }
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

    /// True where a part is tested with its depth cube: as the body says, or for `auto` where
    /// half its thickness is at least two texels.
    pub fn resolves_to_cube(&self, part: usize, collider: Collider, resolution: u32) -> bool {
        match collider {
            Collider::Cube => true,
            Collider::Analytic => false,
            Collider::Auto => {
                let part = &self.parts[part];
                thinnest(part) >= 2.0 * part.texel_m(resolution)
            }
        }
    }

    /// Asks for a part's depth cube.
    pub fn want_cube(&mut self, part: usize) {
        self.parts[part].wants_cube = true;
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

fn new_part(part: &ConvexPart, skin_m: f64) -> Part {
    let solid = Solid::<f64>::of_part(&part.solid);
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
        pose: part.pose,
        radius_m: corner.iter().map(|c| c * c).sum::<f64>().sqrt(),
        cube: None,
        wants_cube: false,
    }
}

/// Half the smallest extent of a part's bounds: an upper bound of its half thickness that is
/// exact for the closed forms.
fn thinnest(part: &Part) -> f64 {
    let [low, high] = part.solid.bounds();
    let size = high - low;
    0.5 * size.x.min(size.y).min(size.z)
}
