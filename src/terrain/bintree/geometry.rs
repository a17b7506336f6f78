//! Points, diamonds and triangles of a forest of right-isosceles bintrees.
//!
//! The forest covers the height samples with squares of `root_side` samples spacing (a power of
//! two), counted from the field's corner; the last ones may reach over the far edges. A root square
//! is two triangles. A triangle is split at the middle of its longest side, its *base*, together
//! with the triangle on the other side of that base: the two are a *diamond*, named by the point
//! that splits it. A diamond may be split once its halves exist, that is once the diamonds at
//! their right angles are split. The set of split points therefore is the whole mesh, and the mesh
//! has no cracks if every split point's parents are split.
//!
//! Squares are cut along (0, 0)-(1, 1) where column and row add to an even number and across where
//! they do not, at every second level: the last of them are the cuts of [`HeightGrid`].
//!
//! [`HeightGrid`]: crate::terrain::HeightGrid

/// A place in the lattice of height samples: columns and rows from the field's corner.
pub type Point = [i32; 2];

/// A right-isosceles triangle: right angle, then the ends of its base, counter-clockwise seen
/// from above.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Triangle {
    pub apex: Point,
    pub base: [Point; 2],
}

impl Triangle {
    /// The point at which it is split, or `None` for a triangle between neighbouring samples.
    pub fn split_point(&self) -> Option<Point> {
        let [[x0, z0], [x1, z1]] = self.base;
        let (x, z) = (x0 + x1, z0 + z1);
        ((x | z) & 1 == 0).then_some([x / 2, z / 2])
    }

    /// The two triangles left and right of the line from the right angle to `middle` of the base.
    pub fn halves(&self, middle: Point) -> [Self; 2] {
        let [first, second] = self.base;
        let half = |base| Self { apex: middle, base };
        [half([self.apex, first]), half([second, self.apex])]
    }

    pub fn corners(&self) -> [Point; 3] {
        [self.apex, self.base[0], self.base[1]]
    }

    /// Smallest and largest column and row.
    pub fn bounds(&self) -> [Point; 2] {
        let [a, b, c] = self.corners();
        let low = [0, 1].map(|i| a[i].min(b[i]).min(c[i]));
        let high = [0, 1].map(|i| a[i].max(b[i]).max(c[i]));
        [low, high]
    }
}

/// Two triangles with a common base.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Diamond {
    pub centre: Point,
    /// Corners, counter-clockwise from above.
    corners: [Point; 4],
    /// First of the two corners, two apart, that are right angles.
    apex: usize,
    /// Whether its halves' halves can be split again.
    pub has_children: bool,
}

impl Diamond {
    /// The diamond that a point splits; `None` for a corner of a root square, which splits none.
    pub fn at(centre: Point, root_side: i32) -> Option<Self> {
        let [x, z] = centre;
        let half = (x | z) & (x | z).wrapping_neg();
        if half == 0 || half >= root_side {
            return None;
        }
        let at = |dx: i32, dz: i32| [x + dx * half, z + dz * half];
        let (is_odd_x, is_odd_z) = (x & half != 0, z & half != 0);
        if is_odd_x && is_odd_z {
            let square = (x - half) / (2 * half) + (z - half) / (2 * half);
            Some(Self {
                centre,
                corners: [at(-1, -1), at(-1, 1), at(1, 1), at(1, -1)],
                apex: usize::from(square & 1 == 0),
                has_children: true,
            })
        } else {
            Some(Self {
                centre,
                corners: [at(-1, 0), at(0, 1), at(1, 0), at(0, -1)],
                apex: usize::from(is_odd_x),
                has_children: half > 1,
            })
        }
    }

    /// Its two triangles; one of them may lie outside the forest.
    pub fn triangles(&self) -> [Triangle; 2] {
        [self.apex, self.apex + 2].map(|k| Triangle {
            apex: self.corners[k],
            base: [self.corners[(k + 1) % 4], self.corners[(k + 3) % 4]],
        })
    }

    /// The points that must be split before this one: the right angles.
    pub fn parents(&self) -> [Point; 2] {
        [self.corners[self.apex], self.corners[self.apex + 2]]
    }

    /// The points that split its four quarters; empty where samples lie no closer.
    pub fn children(&self) -> impl Iterator<Item = Point> + use<> {
        let corners = self.corners;
        let count = if self.has_children { 4 } else { 0 };
        (0..count).map(move |k| {
            let ([ax, az], [bx, bz]) = (corners[k], corners[(k + 1) % 4]);
            [(ax + bx) / 2, (az + bz) / 2]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cross(t: &Triangle) -> i32 {
        let ([ax, az], [bx, bz], [cx, cz]) = (t.apex, t.base[0], t.base[1]);
        (bx - ax) * (cz - az) - (bz - az) * (cx - ax)
    }

    #[test]
    fn a_diamonds_triangles_are_its_parents_halves() {
        let side = 8;
        for x in 1..16 {
            for z in 1..16 {
                let Some(diamond) = Diamond::at([x, z], side) else {
                    assert!(x % side == 0 && z % side == 0);
                    continue;
                };
                for (triangle, parent) in diamond.triangles().iter().zip(diamond.parents()) {
                    assert_eq!(triangle.split_point(), Some([x, z]));
                    // y is up, x to the right and z towards the viewer: negative is
                    // counter-clockwise from above.
                    assert!(cross(triangle) < 0, "{triangle:?}");
                    let Some(above) = Diamond::at(parent, side) else {
                        continue;
                    };
                    let from_above = above
                        .triangles()
                        .iter()
                        .any(|t| t.halves(parent).contains(triangle));
                    assert!(from_above, "{triangle:?} is no half of {above:?}");
                    assert!(above.children().any(|child| child == [x, z]));
                }
            }
        }
    }

    #[test]
    fn the_smallest_triangles_have_the_cut_of_the_height_grid() {
        for x in 1..8 {
            for z in 1..8 {
                let Some(diamond) = Diamond::at([x, z], 8).filter(|d| !d.has_children) else {
                    continue;
                };
                for leaf in diamond.triangles().iter().flat_map(|t| t.halves([x, z])) {
                    assert_eq!(leaf.split_point(), None);
                    let [[i, j], [i1, j1]] = leaf.bounds();
                    assert_eq!((i1 - i, j1 - j), (1, 1));
                    let [a, b] = leaf.base;
                    let is_main = (b[0] - a[0]) == (b[1] - a[1]);
                    assert_eq!(is_main, (i + j) % 2 == 0, "square {i} {j}");
                }
            }
        }
    }
}
