//! Height samples on a square grid, and the triangles between them.
//!
//! Each square between four samples is cut into two right-isosceles triangles. The cut of square
//! (i, j) runs from its (0, 0) to its (1, 1) corner where i + j is even, and across where it is
//! odd: the pattern of a right-isosceles bintree at every even level, so that halved squares
//! nest in it and a seeding triangle never straddles an edge.

use crate::base::{Real, least, most, widened};

/// A rectangle of height samples. Place 0, 0 of the *field* is the corner with the smallest x and
/// z.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightGrid {
    /// Samples along x and z, at least 2 each.
    pub columns: u32,
    pub rows: u32,
    /// Distance of neighbouring samples, in metres.
    pub spacing_m: f32,
    /// World x and z of the rectangle's centre.
    pub centre_m: [f64; 2],
    /// Heights in metres, `rows` runs of `columns`.
    pub heights_m: Vec<f32>,
}

impl HeightGrid {
    pub fn flat(columns: u32, rows: u32, spacing_m: f32) -> Self {
        Self {
            columns,
            rows,
            spacing_m,
            centre_m: [0.0; 2],
            heights_m: vec![0.0; columns as usize * rows as usize],
        }
    }

    /// Squares along x and z.
    pub fn squares(&self) -> [u32; 2] {
        [self.columns - 1, self.rows - 1]
    }

    /// Extent along x and z, in metres.
    pub fn size_m(&self) -> [f64; 2] {
        self.squares()
            .map(|n| f64::from(n) * f64::from(self.spacing_m))
    }

    /// World place of the field's corner, x and z.
    pub fn corner_in_world(&self) -> [f64; 2] {
        let size_m = self.size_m();
        [0, 1].map(|a| self.centre_m[a] - 0.5 * size_m[a])
    }

    /// The sample at a column and row, which the edges repeat.
    pub fn sample(&self, column: u32, row: u32) -> f32 {
        let i = column.min(self.columns - 1) as usize;
        let j = row.min(self.rows - 1) as usize;
        self.heights_m[j * self.columns as usize + i]
    }

    /// Height above `base` inside square (`i`, `j`) at the fractions `u`, `v` in 0…1 along x and z,
    /// and by how much the triangle there rises across the square along x and z.
    pub fn plane_in_square<R: Real>(&self, i: u32, j: u32, u: R, v: R, base: f32) -> [R; 3] {
        let at = |di, dj| R::of_f32(self.sample(i + di, j + dj)) - R::of_f32(base);
        let (h00, h10, h01, h11) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
        let is_even = (i + j) & 1 == 0;
        if !is_even && u + v > R::ONE {
            let height = h11 + (R::ONE - u) * (h01 - h11) + (R::ONE - v) * (h10 - h11);
            return [height, h11 - h01, h11 - h10];
        }
        let (along_x, along_z) = match (is_even, u >= v) {
            (true, true) => (h10 - h00, h11 - h10),
            (true, false) => (h11 - h01, h01 - h00),
            (false, _) => (h10 - h00, h01 - h00),
        };
        [h00 + u * along_x + v * along_z, along_x, along_z]
    }

    /// Height at a world place; places beyond the edge take the edge's.
    pub fn height_in_world(&self, x: f64, z: f64) -> f64 {
        let (i, u, j, v) = self.locate(x, z);
        self.plane_in_square(i, j, u, v, 0.0)[0]
    }

    /// Unit normal of the triangle under a world place.
    pub fn normal_in_world(&self, x: f64, z: f64) -> [f64; 3] {
        let (i, u, j, v) = self.locate(x, z);
        let [_, rise_x, rise_z] = self.plane_in_square(i, j, u, v, 0.0);
        let s = f64::from(self.spacing_m);
        let length = (rise_x * rise_x + s * s + rise_z * rise_z).sqrt();
        [-rise_x / length, s / length, -rise_z / length]
    }

    /// True where a world place lies over the ground.
    pub fn contains(&self, x: f64, z: f64) -> bool {
        let ([w, d], [cx, cz]) = (self.size_m(), self.centre_m);
        (x - cx).abs() <= 0.5 * w && (z - cz).abs() <= 0.5 * d
    }

    /// Smallest and largest height, in metres.
    pub fn range_m(&self) -> [f32; 2] {
        self.heights_m
            .iter()
            .fold([f32::INFINITY, f32::NEG_INFINITY], |range, &h| {
                widened(range, [h, h])
            })
    }

    /// Height that the ground over a rectangle of the plan, and the squares around it, does not exceed, in
    /// metres; beyond the edge the ground goes on as it is there.
    pub fn highest_in_world(&self, low: [f64; 2], high: [f64; 2]) -> f32 {
        let mut highest = f32::NEG_INFINITY;
        self.each_around(low, high, |sample| highest = most(highest, sample));
        highest
    }

    /// Height that the ground over a rectangle of the plan, and the squares around it, nowhere falls below, in
    /// metres; beyond the edge the ground goes on as it is there.
    pub fn lowest_in_world(&self, low: [f64; 2], high: [f64; 2]) -> f32 {
        let mut lowest = f32::INFINITY;
        self.each_around(low, high, |sample| lowest = least(lowest, sample));
        lowest
    }

    /// Calls `each` with the samples of all squares that a rectangle of the plan touches.
    fn each_around(&self, low: [f64; 2], high: [f64; 2], mut each: impl FnMut(f32)) {
        let (i0, _, j0, _) = self.locate(low[0], low[1]);
        let (i1, _, j1, _) = self.locate(high[0], high[1]);
        for row in j0..=j1 + 1 {
            for column in i0..=i1 + 1 {
                each(self.sample(column, row));
            }
        }
    }

    fn locate(&self, x: f64, z: f64) -> (u32, f64, u32, f64) {
        let [cx, cz] = self.corner_in_world();
        let [nx, nz] = self.squares();
        let along = |p: f64, n: u32| {
            let at = (p / f64::from(self.spacing_m)).clamp(0.0, f64::from(n));
            let square = (at.floor() as u32).min(n - 1);
            (square, at - f64::from(square))
        };
        let (i, u) = along(x - cx, nx);
        let (j, v) = along(z - cz, nz);
        (i, u, j, v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bumpy() -> HeightGrid {
        let mut grid = HeightGrid::flat(5, 4, 2.0);
        for (k, h) in grid.heights_m.iter_mut().enumerate() {
            *h = ((k * 7919) % 13) as f32 * 0.1;
        }
        grid
    }

    #[test]
    fn the_surface_meets_its_samples_and_is_continuous() {
        let grid = bumpy();
        let [cx, cz] = grid.corner_in_world();
        for j in 0..grid.rows {
            for i in 0..grid.columns {
                let (x, z) = (cx + 2.0 * f64::from(i), cz + 2.0 * f64::from(j));
                let want = f64::from(grid.sample(i, j));
                assert!((grid.height_in_world(x, z) - want).abs() < 1e-9);
            }
        }
        // Steps of 1e-7 m on slopes below 1 may change the height by no more.
        for k in 0..500 {
            let x = cx + 0.016 * f64::from(k);
            let a = grid.height_in_world(x, -0.3 + 0.001 * f64::from(k));
            let b = grid.height_in_world(x + 1e-7, -0.3 + 0.001 * f64::from(k));
            assert!((a - b).abs() < 2e-7, "{x}");
        }
    }

    #[test]
    fn nothing_in_a_rectangle_is_higher_than_its_highest_or_lower_than_its_lowest() {
        let grid = bumpy();
        for k in 0..200 {
            let low = [-6.0 + 0.05 * f64::from(k), -4.0 + 0.03 * f64::from(k)];
            let high = [low[0] + 1.3, low[1] + 0.7];
            let highest = f64::from(grid.highest_in_world(low, high));
            let lowest = f64::from(grid.lowest_in_world(low, high));
            for part in 0..25 {
                let share = [part % 5, part / 5].map(|n| f64::from(n) / 4.0);
                let at = [0, 1].map(|a| low[a] + share[a] * (high[a] - low[a]));
                let height = grid.height_in_world(at[0], at[1]);
                assert!(height <= highest + 1e-6, "{at:?}");
                assert!(height >= lowest - 1e-6, "{at:?}");
            }
        }
    }

    #[test]
    fn normals_are_across_the_surface() {
        let grid = bumpy();
        for k in 0..300 {
            let (x, z) = (-3.9 + 0.026 * f64::from(k), -2.9 + 0.019 * f64::from(k));
            let n = grid.normal_in_world(x, z);
            let e = 1e-6;
            let dx = (grid.height_in_world(x + e, z) - grid.height_in_world(x, z)) / e;
            let dz = (grid.height_in_world(x, z + e) - grid.height_in_world(x, z)) / e;
            // A step may cross an edge of the surface once in a while; then the slopes differ.
            let off = (n[0] + n[1] * dx).abs().max((n[2] + n[1] * dz).abs());
            assert!(!(1e-5..=1e-3).contains(&off), "{k}: {off}");
        }
    }
}
