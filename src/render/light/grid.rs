//! Where the cells of light volumes are.

use crate::base::Hash64;
use crate::scene::LightVolumes;
use crate::terrain::HeightGrid;

/// Rays begin this far over the ground at the lowest, in metres, so that rounding does not put them
/// under it.
const LIFT_M: f64 = 0.01;

/// Cells in columns over the whole ground. A column begins at the height of the ground under it, so that
/// no cell lies under the ground and slices follow hills. Deviation from O09 section 6.1, whose volume is
/// a box: cells of a box are far apart where the ground is high, and those under the ground would darken
/// the grass above them.
#[derive(Clone, Debug, PartialEq)]
pub struct LightGrid {
    /// Columns along x and z, at least 2 each.
    pub columns: [u32; 2],
    /// Cells of a column, at least 2.
    pub slices: u32,
    /// Distance of columns along x and z, in metres.
    pub cell_m: [f64; 2],
    /// Distance of slices, in metres.
    pub slice_m: f64,
    /// World x and z of the first column.
    pub corner_in_world: [f64; 2],
    /// World height of the ground under each column, run by run along x.
    pub ground_m: Vec<f32>,
}

impl LightGrid {
    pub fn new(light: &LightVolumes, ground: &HeightGrid) -> Self {
        let size_m = ground.size_m();
        let columns = light.columns(size_m).map(|n| n as u32);
        let cell_m = [0, 1].map(|axis| size_m[axis] / f64::from(columns[axis] - 1));
        let corner = ground.corner_in_world();
        let mut ground_m = Vec::with_capacity(columns[0] as usize * columns[1] as usize);
        for row in 0..columns[1] {
            for column in 0..columns[0] {
                let x = corner[0] + f64::from(column) * cell_m[0];
                let z = corner[1] + f64::from(row) * cell_m[1];
                ground_m.push(ground.height_in_world(x, z) as f32);
            }
        }
        Self {
            columns,
            slices: light.slices,
            cell_m,
            slice_m: f64::from(light.height_m) / f64::from(light.slices - 1),
            corner_in_world: corner,
            ground_m,
        }
    }

    /// Cells of one slice.
    pub fn slice_cells(&self) -> usize {
        self.ground_m.len()
    }

    pub fn cells(&self) -> usize {
        self.slice_cells() * self.slices as usize
    }

    /// World place of a cell, counted along x, then z, then up.
    pub(super) fn place(&self, cell: usize) -> [f64; 3] {
        let (slice, in_slice) = (cell / self.slice_cells(), cell % self.slice_cells());
        let (column, row) = (
            in_slice % self.columns[0] as usize,
            in_slice / self.columns[0] as usize,
        );
        let over_m = (slice as f64 * self.slice_m).max(LIFT_M);
        [
            self.corner_in_world[0] + column as f64 * self.cell_m[0],
            f64::from(self.ground_m[in_slice]) + over_m,
            self.corner_in_world[1] + row as f64 * self.cell_m[1],
        ]
    }

    /// The cells beside a cell.
    pub(super) fn neighbours(&self, cell: usize) -> impl Iterator<Item = usize> {
        let sides = [self.columns[0], self.columns[1], self.slices].map(|n| n as usize);
        let steps = [1, sides[0], self.slice_cells()];
        (0..3).flat_map(move |axis| {
            let at = cell / steps[axis] % sides[axis];
            let before = (at > 0).then(|| cell - steps[axis]);
            let after = (at + 1 < sides[axis]).then(|| cell + steps[axis]);
            before.into_iter().chain(after)
        })
    }

    /// Takes in everything but the ground's heights.
    pub(super) fn hash_into(&self, hash: &mut Hash64) {
        for word in [self.columns[0], self.columns[1], self.slices] {
            hash.word(u64::from(word));
        }
        let numbers = self.cell_m.iter().chain(&self.corner_in_world);
        for number in numbers.chain([&self.slice_m]) {
            hash.word(number.to_bits());
        }
    }
}
