//! How far a table of resting blades is from the solver.

use super::blade_shape::ShapeError;
use super::{Axis, BladeTable};
use crate::base::most;

/// Distances of nodes between a table and the solver, in blade lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TableErrors {
    pub max: f64,
    /// Root mean square over the nodes of plants, which are even in both axes.
    pub rms: f64,
}

impl BladeTable {
    /// The largest distance of a node between table and solver, in blade lengths, over nine
    /// points inside every cell of the table.
    ///
    /// # Errors
    ///
    /// The solver's.
    pub fn max_error(&self) -> Result<f64, ShapeError> {
        Ok(self.errors()?.max)
    }

    /// Distances of nodes between table and solver over nine points inside every cell.
    ///
    /// # Errors
    ///
    /// The solver's.
    pub fn errors(&self) -> Result<TableErrors, ShapeError> {
        let inside = |entry: u32, quarter: u32, axis: &Axis| {
            axis.fraction_at(f64::from(entry) + f64::from(quarter) * 0.25)
        };
        let share = |entry: u32, axis: &Axis| inside(entry + 1, 0, axis) - inside(entry, 0, axis);
        let mut max: f64 = 0.0;
        let mut mean_square = 0.0;
        for lean in 0..self.lean_rad.entries - 1 {
            for stiffness in 0..self.log2_k.entries - 1 {
                let plants = share(stiffness, &self.log2_k) * share(lean, &self.lean_rad);
                for quarters in 0..9 {
                    let (largest, square) = self.error_at(
                        inside(stiffness, 1 + quarters % 3, &self.log2_k),
                        inside(lean, 1 + quarters / 3, &self.lean_rad),
                    )?;
                    max = most(max, largest);
                    mean_square += plants * square / 9.0;
                }
            }
        }
        Ok(TableErrors {
            max,
            rms: mean_square.sqrt(),
        })
    }

    /// The largest distance of a node, and the mean of the squares.
    fn error_at(&self, stiffness: f64, lean: f64) -> Result<(f64, f64), ShapeError> {
        let shape = self.solve_at(stiffness, lean)?;
        let place = self.place(stiffness, lean);
        let mut at = [0.0, 0.0];
        let mut largest: f64 = 0.0;
        let mut squares = 0.0;
        for (segment, node) in shape.nodes.iter().skip(1).enumerate() {
            let [x, y] = self.direction(place, segment);
            let length = libm::hypot(x, y) * f64::from(self.segments);
            at = [at[0] + x / length, at[1] + y / length];
            let gap = libm::hypot(at[0] - node[0], at[1] - node[1]);
            largest = most(largest, gap);
            squares += gap * gap;
        }
        Ok((largest, squares / f64::from(self.segments)))
    }
}
