//! Where a seed lies on a picture of the whole ground, in integers.
//!
//! WGSL twin: `shaders/shared/on_map.wgsl`.

use super::grid::{ANCHOR_CELLS, Anchor, FieldGrid};

/// How seeding cells lie on a picture that covers the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnMap {
    /// Side of a texel, in metres.
    texel_m: f64,
    /// Texels along the side of a seeding cell, in units of 2⁻¹⁸.
    pub step: u32,
}

impl OnMap {
    pub fn new(grid: &FieldGrid, texel_m: f64) -> Self {
        let texels_per_cell = f64::from(grid.cell_m) / texel_m;
        Self {
            texel_m,
            // Saturates for more than 16,384 texels in a cell: more than a map has on a side.
            step: (texels_per_cell * 262_144.0).round() as u32,
        }
    }

    /// Place of an anchor's origin on the map, in units of 2⁻¹⁶ texel.
    pub fn anchor(&self, grid: &FieldGrid, anchor: &Anchor) -> [u32; 2] {
        anchor.index.map(|n| self.nth_anchor(grid, n))
    }

    /// The same along one axis, by the anchor's number there.
    pub fn nth_anchor(&self, grid: &FieldGrid, number: u32) -> u32 {
        let side_m = f64::from(ANCHOR_CELLS) * f64::from(grid.cell_m);
        let texels = side_m / self.texel_m;
        (f64::from(number) * texels * 65_536.0).round() as u32
    }

    /// Place on the map of a place in a cell, both in units of 2⁻²⁴ cell.
    pub fn place(&self, anchor_on_map: [u32; 2], cell: [u32; 2], in_cell: [u32; 2]) -> [u32; 2] {
        [0, 1].map(|a| {
            let in_anchor = ((cell[a] % ANCHOR_CELLS) << 24) + in_cell[a];
            // The far end of the last cell would carry.
            let in_anchor = in_anchor.min((ANCHOR_CELLS << 24) - 1) << 6;
            let texels = (u64::from(in_anchor) * u64::from(self.step)) >> 32;
            anchor_on_map[a] + texels as u32
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Grass, Solver};
    use crate::terrain::HeightGrid;

    /// A place is where the map's picture has it: cells and anchors fall on their texels.
    #[test]
    fn places_are_those_of_the_ground() {
        let ground = HeightGrid::flat(17, 3, 1.0);
        let grid = FieldGrid::new(&ground, &Grass::default(), &Solver::default()).expect("a grid");
        let on_map = OnMap::new(&grid, 2.0);
        for tile in 0..grid.tile_count() {
            let anchor = grid.anchor_of(tile, &ground);
            let origin = on_map.anchor(&grid, &anchor);
            let cell = grid.first_cell(tile);
            for in_cell in [[0, 0], [1 << 23, 1 << 22], [1 << 24, (1 << 24) - 1]] {
                let place = on_map.place(origin, cell, in_cell);
                for a in 0..2 {
                    let cells = f64::from(cell[a]) + f64::from(in_cell[a]) / 16_777_216.0;
                    let want = cells * f64::from(grid.cell_m) / 2.0;
                    // Cut off once, the anchor rounded once, the step rounded to 2⁻¹⁸ over four cells.
                    let off = f64::from(place[a]) / 65_536.0 - want;
                    assert!(off.abs() < 2.0 / 65_536.0, "{cell:?} {in_cell:?}: {off}");
                }
            }
        }
    }
}
