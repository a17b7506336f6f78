//! Every unique shape, made once.

use rapier3d::prelude::SharedShape;

use crate::scene::{Coat, Shape};

use super::collider::shared_shape;
use super::error::ShapeError;
use super::shape::RigidShape;
use super::solids::{Meshes, rigid_shape};

/// A shape on which plants grow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatedShape {
    /// Index into the shape library.
    pub shape: u32,
    pub coat: Coat,
}

/// Shapes by index; entries are only ever appended.
pub(super) struct ShapeLibrary {
    meshes: Meshes,
    keys: Vec<Shape>,
    shapes: Vec<RigidShape>,
    colliders: Vec<SharedShape>,
    coated: Vec<CoatedShape>,
}

impl ShapeLibrary {
    pub fn new(meshes: Meshes) -> Self {
        Self {
            meshes,
            keys: Vec::new(),
            shapes: Vec::new(),
            colliders: Vec::new(),
            coated: Vec::new(),
        }
    }

    /// The index of a shape, made now if it is new.
    ///
    /// # Errors
    /// If the shape has no inside or its mesh was not loaded.
    pub fn index_of(&mut self, shape: &Shape) -> Result<u32, ShapeError> {
        if let Some(index) = self.keys.iter().position(|key| key == shape) {
            return Ok(index as u32);
        }
        let rigid = rigid_shape(shape, &self.meshes)?;
        let collider = shared_shape(&rigid).ok_or_else(|| flat(shape))?;
        self.keys.push(shape.clone());
        self.shapes.push(rigid);
        self.colliders.push(collider);
        Ok(self.keys.len() as u32 - 1)
    }

    /// The index of a coat on one of the shapes, new or not.
    pub fn index_of_coat(&mut self, coated: CoatedShape) -> u32 {
        let known = self.coated.iter().position(|other| *other == coated);
        let index = known.unwrap_or(self.coated.len());
        if known.is_none() {
            self.coated.push(coated);
        }
        index as u32
    }

    pub fn shapes(&self) -> &[RigidShape] {
        &self.shapes
    }

    pub fn coated(&self) -> &[CoatedShape] {
        &self.coated
    }

    /// The collider of an index that this library gave.
    pub fn collider(&self, index: u32) -> SharedShape {
        self.colliders[index as usize].clone()
    }
}

/// Only hulls can be too flat for rapier once they have a volume for us.
fn flat(shape: &Shape) -> ShapeError {
    match shape {
        Shape::Mesh { file, scale, .. } => ShapeError::FlatMesh {
            file: file.clone(),
            scale: *scale,
        },
        Shape::ConvexHull { points_m } => ShapeError::FlatHull {
            points: points_m.len(),
        },
        _ => ShapeError::FlatHull { points: 0 },
    }
}
