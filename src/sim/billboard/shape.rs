//! The quad in the wind, and where the nodes of its grid are on it.
//!
//! O09 section 5: without a collision the two upper vertices of a quad follow the wind, here at a fixed
//! distance from the lower ones. A parallelogram is the same surface drawn from four vertices or from a
//! grid, so the change between quad and refined form shows nothing: that is why columns stay straight in
//! the wind. A column bowed by θ would leave the quad by up to hθ/8, 2 cm at a height of 0.5 m and 18°.
//!
//! The upper edge moves as far as the tip of a blade of the same flexibility, whose segments take
//! s(2 − s) of the bend, ⅔ on average.

use crate::base::{Real, Vec3, vec3};
use crate::field::billboards::WIND_SHARE;
use crate::field::{Anchor, WindNow};

use super::Grid;
use super::grid::{ALONG, SIDES, Side};
use crate::field::Billboard;

/// A billboard's quad at one instant, in its anchor's coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad<R> {
    /// Middle of the lower edge.
    pub root: Vec3<R>,
    /// Unit vectors along the lower edge, and from it to the upper one.
    pub across: Vec3<R>,
    pub lean: Vec3<R>,
    pub width_m: R,
    pub height_m: R,
}

impl<R: Real> Quad<R> {
    pub fn in_wind(billboard: &Billboard, anchor: &Anchor, wind: &WindNow) -> Self {
        let bend = wind.bend_at(
            anchor,
            billboard.root_in_anchor,
            billboard.flexibility,
            billboard.flutter_turns,
        );
        Self::bent(billboard, bend)
    }

    /// The quad whose top the wind bends by `bend` along x and z.
    pub fn bent(billboard: &Billboard, bend: [R; 2]) -> Self {
        let up: Vec3<R> = Vec3::of_f32(billboard.up);
        let [cos, sin] = billboard.across.map(R::of_f32);
        let share = R::of(WIND_SHARE);
        let lean = up + vec3(bend[0] * share, R::ZERO, bend[1] * share);
        Self {
            root: Vec3::of_f32(billboard.root_in_anchor),
            across: vec3(cos, R::ZERO, sin),
            lean: lean.unit_or(up),
            width_m: R::of_f32(billboard.width_m),
            height_m: R::of_f32(billboard.height_m),
        }
    }

    /// The place at shares of the width from the left and of the height.
    pub fn vertex(&self, right: R, up: R) -> Vec3<R> {
        self.root
            + self.across * ((right - R::of(0.5)) * self.width_m)
            + self.lean * (up * self.height_m)
    }

    /// What is drawn while nothing has touched it: lower left and right, upper left and right.
    pub fn vertices(&self) -> [Vec3<R>; 4] {
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
            .map(|[right, up]| self.vertex(R::of(right), R::of(up)))
    }

    /// Gives every node of the grid, row by row; those at the corners are the vertices, bit for bit.
    pub fn nodes(&self, grid: Grid, mut take: impl FnMut(usize, Vec3<R>)) {
        // n/n is 1 exactly. The sums are those of `vertex`, each made once.
        let share = |n: usize, of: usize| R::of(n as f64) / R::of((of - 1) as f64);
        let mut on_ground = [Vec3::ZERO; ALONG[1]];
        for (column, place) in on_ground.iter_mut().enumerate().take(grid.columns) {
            let right = share(column, grid.columns);
            *place = self.root + self.across * ((right - R::of(0.5)) * self.width_m);
        }
        for row in 0..grid.rows {
            let up = self.lean * (share(row, grid.rows) * self.height_m);
            for (column, &place) in on_ground.iter().enumerate().take(grid.columns) {
                take(row * grid.columns + column, place + up);
            }
        }
    }

    /// From a node to the next one of its row, and of its column.
    pub fn steps(&self, grid: Grid) -> [Vec3<R>; 2] {
        let part = |length: R, nodes: usize| length / R::of((nodes - 1) as f64);
        [
            self.across * part(self.width_m, grid.columns),
            self.lean * part(self.height_m, grid.rows),
        ]
    }

    /// Rest lengths of the springs by their sides, in metres.
    pub fn rest_lengths(&self, grid: Grid) -> [R; SIDES] {
        let [right, up] = self.steps(grid);
        Side::ALL.map(|side| {
            let [columns, rows] = side.steps().map(|n| R::of(f64::from(n)));
            (right * columns + up * rows).length()
        })
    }

    /// The side that the quad shows, a unit vector; some horizontal one for a quad without an area.
    pub fn normal(&self) -> Vec3<R> {
        let level = vec3(-self.across.z, R::ZERO, self.across.x);
        self.across.cross(self.lean).unit_or(level)
    }
}
