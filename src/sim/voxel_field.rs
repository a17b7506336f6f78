//! Voxel field: the signed distance to a solid on a regular grid, read trilinearly.
//!
//! What many engines use in place of depth cubes: N³ samples for a solid where a depth cube has
//! 6 N², and no silhouette. It is here to be compared with them, in the cpu engine alone.
//!
//! Limits: distances between samples are linear, so edges are rounded by up to half a cell.

use crate::base::{Real, Vec3, vec3};

use super::solid::{Exit, Solid};

/// Signed distances about a solid, positive inside.
#[derive(Clone, Debug)]
pub struct VoxelField {
    low: Vec3<f32>,
    /// Sides of a cell.
    cell: Vec3<f32>,
    /// Samples along an edge.
    side: u32,
    /// `side`³ depths, x fastest, then y.
    depths: Vec<f32>,
}

impl VoxelField {
    /// Samples `solid` on `cells` cells along each edge of its bounds, and one cell around them.
    pub fn draw(solid: &Solid<f32>, cells: u32) -> Self {
        let [low, high] = solid.bounds();
        let size = high - low;
        let inner = cells.max(1) as f32;
        let cell = vec3(size.x / inner, size.y / inner, size.z / inner);
        let low = low - cell;
        let side = cells.max(1) + 3;
        let mut depths = Vec::with_capacity((side * side * side) as usize);
        for z in 0..side {
            for y in 0..side {
                for x in 0..side {
                    let at = vec3(x as f32 * cell.x, y as f32 * cell.y, z as f32 * cell.z);
                    let p = low + at;
                    let depth = solid.depth(p);
                    depths.push(if depth > 0.0 { depth } else { -solid.gap(p) });
                }
            }
        }
        Self {
            low,
            cell,
            side,
            depths,
        }
    }

    /// Longest side of a cell, in metres.
    pub fn cell_m(&self) -> f32 {
        self.cell.x.max(self.cell.y).max(self.cell.z)
    }

    /// Depth at a point and its gradient; `None` outside the grid.
    fn read<R: Real>(&self, p: Vec3<R>) -> Option<(R, Vec3<R>)> {
        let place = |x: R, low: f32, cell: f32| (x - R::of_f32(low)) / R::of_f32(cell);
        let s = [
            place(p.x, self.low.x, self.cell.x),
            place(p.y, self.low.y, self.cell.y),
            place(p.z, self.low.z, self.cell.z),
        ];
        let last = R::of(f64::from(self.side - 1));
        if s.iter().any(|&s| !(s >= R::ZERO && s < last)) {
            return None;
        }
        let first = s.map(|s| s.floor().to_f64() as usize);
        let part = s.map(|s| s - s.floor());
        let side = self.side as usize;
        let mut depth = R::ZERO;
        let mut slope = [R::ZERO; 3];
        for corner in 0..8 {
            let up = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight = |a: usize| {
                if up[a] == 1 {
                    part[a]
                } else {
                    R::ONE - part[a]
                }
            };
            let at = ((first[2] + up[2]) * side + first[1] + up[1]) * side + first[0] + up[0];
            let value = R::of_f32(self.depths[at]);
            depth += value * (weight(0) * weight(1) * weight(2));
            for (a, slope) in slope.iter_mut().enumerate() {
                let across = weight((a + 1) % 3) * weight((a + 2) % 3);
                let sign = if up[a] == 1 { R::ONE } else { -R::ONE };
                *slope += value * across * sign;
            }
        }
        let cell = self.cell;
        let slope = vec3(
            slope[0] / R::of_f32(cell.x),
            slope[1] / R::of_f32(cell.y),
            slope[2] / R::of_f32(cell.z),
        );
        Some((depth, slope))
    }

    /// True where a point is deeper than `depth_m`.
    pub fn is_deeper<R: Real>(&self, p: Vec3<R>, depth_m: R) -> bool {
        self.read(p).is_some_and(|(depth, _)| depth > depth_m)
    }

    /// The way out along the steepest descent of the depth.
    pub fn exit<R: Real>(&self, p: Vec3<R>) -> Option<Exit<R>> {
        let (depth, slope) = self.read(p)?;
        (depth > R::ZERO).then(|| Exit {
            depth,
            normal: (-slope).unit_or(Vec3::UP),
            face: 0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_known_to_the_square_of_a_cell() {
        let ball = Solid::<f32>::Ball { radius: 0.3 };
        for cells in [16, 32] {
            let field = VoxelField::draw(&ball, cells);
            for k in 0..500_u32 {
                let word = |salt| crate::base::philox::philox2x32([k, salt], 9, 7)[0];
                let at = |salt| 0.5 * (crate::base::philox::unit(word(salt)) - 0.5);
                let p = vec3(at(1), at(2), at(3));
                let r = p.length();
                // Linear between samples: h²/8 of the second derivative, 1/r in two directions
                // across the ray, each at most over the diagonal of a cell's face.
                let error = field.cell_m().powi(2) / (4.0 * r.max(field.cell_m())) * 2.0;
                let Some((depth, _)) = field.read(p) else {
                    panic!("{p:?} is within the grid");
                };
                assert!((depth - (0.3 - r)).abs() <= error, "{cells} {p:?} {depth}");
            }
        }
    }
}
