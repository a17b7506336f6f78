//! The ground as right-isosceles triangle bintrees: P15 section 3.1, on ROAM (Duchaineau et al.
//! 1997).
//!
//! [`Bintree`] lives as long as a terrain: where triangles lie and how far the ground may be off
//! them. [`Mesh`] is what of it is drawn, changed from frame to frame. The seeding traversal
//! ([`Bintree::seed`]) goes down to one fixed level on the full ground and does not depend on the
//! mesh.

mod drawn;
mod geometry;
mod hidden;
mod lattice;
mod mesh;
mod seeding;
mod sight;
mod urgency;
mod viewpoint;
mod wedgies;

#[cfg(test)]
mod seeding_tests;
#[cfg(test)]
mod tests;

use std::sync::Arc;

pub use drawn::DrawnMesh;
pub use geometry::Point;
pub use mesh::{Mesh, MeshChange, MeshError};
pub use seeding::{SeedCounts, SeedTriangle, Seeding};
pub use urgency::{HELD_ERROR_M, MeshDetail};
pub use viewpoint::Viewpoint;

use super::HeightGrid;
use geometry::Diamond;
use lattice::Lattice;
use wedgies::Wedgies;

/// The bintrees over one terrain, with their bounds of error.
#[derive(Clone, Debug)]
pub struct Bintree {
    lattice: Lattice,
    wedgies: Wedgies,
}

impl Bintree {
    /// Takes time and memory in proportion to the samples.
    pub fn new(ground: Arc<HeightGrid>) -> Self {
        let lattice = Lattice::new(ground);
        let wedgies = Wedgies::new(&lattice);
        Self { lattice, wedgies }
    }

    pub fn ground(&self) -> &HeightGrid {
        &self.lattice.ground
    }

    /// Bytes of the bounds; the heights themselves are not counted.
    pub fn bytes(&self) -> usize {
        self.wedgies.bytes()
    }

    /// Triangles of the ground at full resolution.
    pub fn finest_triangles(&self) -> usize {
        let [columns, rows] = self.lattice.squares;
        2 * columns as usize * rows as usize
    }

    /// The diamond that a point of the lattice splits.
    fn diamond(&self, point: Point) -> Option<Diamond> {
        if !self.lattice.holds(point) {
            return None;
        }
        Diamond::at(point, self.lattice.root_side)
    }
}
