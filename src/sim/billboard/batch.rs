//! Billboards that are relaxed side by side.

use crate::base::{Real, Vec3};
use crate::sim::relax::{Bodies, Ground};
use crate::sim::springs::crumpled::{AtRest, CRUMPLED_SHARE, put_back};

use super::lanes::Lanes;
use super::springs::Rest;
use super::{Quad, Weave};

/// A billboard's surroundings.
#[derive(Clone, Debug)]
pub struct Lane<'a, R> {
    pub quad: Quad<R>,
    pub ground: Ground<'a>,
    /// Nothing of the ground within reach is higher, in metres over the anchor's origin.
    pub ground_top_m: R,
    pub bodies: Bodies<'a, R>,
}

/// Up to `L` billboards that need equally many sweeps, and room to relax them in. Made once and filled
/// again and again: nothing is allocated then but lists of bodies.
#[derive(Clone, Debug)]
pub struct Batch<'a, R, const L: usize> {
    pub weave: &'a Weave,
    pub lanes: Vec<Lane<'a, R>>,
    pub nodes: Lanes<R, L>,
    /// Per movable node: which body, part and face it was pushed out through.
    pub faces: Vec<[u32; L]>,
    pub rest: Rest<R, L>,
    /// Nodes of billboards that are done while others go on.
    pub(super) kept: Lanes<R, L>,
    pub(super) spare: [Lanes<R, L>; 2],
    /// Nodes of one billboard, where it is put in order by itself.
    line: [Vec<Vec3<R>>; 3],
}

impl<'a, R: Real, const L: usize> Batch<'a, R, L> {
    pub fn new(weave: &'a Weave) -> Self {
        let nodes = weave.grid.nodes();
        let lanes = || Lanes::new(nodes);
        Self {
            weave,
            lanes: Vec::with_capacity(L),
            nodes: lanes(),
            faces: vec![[0; L]; weave.grid.movable()],
            rest: Rest::default(),
            kept: lanes(),
            spare: [lanes(), lanes()],
            line: [const { Vec::new() }; 3],
        }
    }

    pub fn clear(&mut self) {
        self.lanes.clear();
    }

    pub fn is_full(&self) -> bool {
        self.lanes.len() == L
    }

    /// Adds a billboard by its movable nodes and their faces. The batch must not be full.
    pub fn add(&mut self, lane: Lane<'a, R>, movable: &[Vec3<R>], faces: &[u32]) {
        let (grid, l) = (self.weave.grid, self.lanes.len());
        let lengths = lane.quad.rest_lengths(grid);
        for (side, length) in lengths.into_iter().enumerate() {
            self.rest.set(side, l, length);
        }
        let nodes = &mut self.nodes;
        lane.quad.nodes(grid, |node, place| {
            if node < grid.columns {
                nodes.set(node, l, place);
            }
        });
        for (n, (&node, &face)) in movable.iter().zip(faces).enumerate() {
            self.nodes.set(grid.columns + n, l, node);
            self.faces[n][l] = face;
        }
        self.lanes.push(lane);
    }

    /// A movable node, counted from the first row above the ground.
    pub fn movable(&self, node: usize, lane: usize) -> Vec3<R> {
        self.nodes.get(self.weave.grid.columns + node, lane)
    }

    /// Which billboards have an edge without a direction or a row that runs against the one below it.
    fn look_lost(&self) -> [bool; L] {
        let (weave, nodes) = (self.weave, &self.nodes);
        let across = |a: usize, b: usize, l: usize| {
            [
                nodes.x[a][l] - nodes.x[b][l],
                nodes.y[a][l] - nodes.y[b][l],
                nodes.z[a][l] - nodes.z[b][l],
            ]
        };
        let dot = |u: [R; 3], v: [R; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        let mut least = [R::ZERO; L];
        let mut total = [R::ZERO; L];
        for spring in &weave.springs {
            let [a, b] = spring.ends;
            let rest = &self.rest.length[spring.side as usize];
            for l in 0..L {
                let edge = across(a, b, l);
                let length = dot(edge, edge).sqrt();
                total[l] += length;
                least[l] = R::min(least[l], length - R::of(CRUMPLED_SHARE) * rest[l]);
            }
        }
        let columns = weave.grid.columns;
        for left in (columns..nodes.len()).filter(|node| (node + 1) % columns > 0) {
            for l in 0..L {
                let here = across(left + 1, left, l);
                let below = across(left + 1 - columns, left - columns, l);
                least[l] = R::min(least[l], dot(here, below));
            }
        }
        let mut lost = [false; L];
        for l in 0..L {
            lost[l] = least[l] < R::ZERO || !total[l].is_finite();
        }
        lost
    }

    /// Puts back what is crumpled or inverted of the billboards asked for (see
    /// [`crumpled`](crate::sim::springs::crumpled)). Returns how many nodes of each were moved.
    pub(super) fn put_in_order(&mut self, asked: &[bool; L]) -> [u32; L] {
        let mut moved = [0; L];
        let lost = self.look_lost();
        let grid = self.weave.grid;
        for l in (0..self.lanes.len()).filter(|&l| asked[l] && lost[l]) {
            let [nodes, rest, before] = &mut self.line;
            nodes.clear();
            rest.clear();
            nodes.extend((0..grid.nodes()).map(|node| self.nodes.get(node, l)));
            self.lanes[l].quad.nodes(grid, |_, place| rest.push(place));
            let at_rest = AtRest {
                nodes: &rest[..],
                columns: grid.columns,
                pinned: grid.columns,
                earlier: &self.weave.earlier,
            };
            moved[l] = put_back(&at_rest, nodes, before);
            for (node, &place) in nodes.iter().enumerate().skip(grid.columns) {
                self.nodes.set(node, l, place);
            }
        }
        moved
    }
}
