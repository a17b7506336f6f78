//! Which tiles a box in the world may touch: an octree over the tiles, without stored nodes.
//!
//! O09 section 5.1 tests bodies against an octree's nodes. A meadow is one sheet of tiles: of the
//! eight children of a node at most four hold any, so a node is a square of tiles with its own
//! range of heights, kept in a pyramid of minima and maxima. A query visits the tiles it
//! reports and their ancestors only; its cost does not grow with the meadow.

use crate::base::{least, most, widened};
use crate::terrain::HeightGrid;

use super::grid::{FieldGrid, TileId};

/// Tiles along the side of the smallest stored node; below it heights come from the samples.
const LEAF_TILES: u32 = 4;

/// The pyramid of height ranges over the tiles of one ground.
#[derive(Clone, Debug)]
pub struct Octree {
    /// From the leaves up to the root: nodes along x and z, and their ranges in metres.
    levels: Vec<Level>,
}

#[derive(Clone, Debug)]
struct Level {
    nodes: [u32; 2],
    ranges: Vec<[f32; 2]>,
}

/// A box in the world, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Bounds {
    /// Grown by `margin` metres on every side.
    pub fn grown(self, margin: f64) -> Self {
        Self {
            low: self.low.map(|x| x - margin),
            high: self.high.map(|x| x + margin),
        }
    }

    /// The smallest box around both. By [`Real`]'s comparisons: with `f64::max` the optimiser of
    /// rustc 1.95 left corners of turned boxes out, in some builds and not in others.
    pub fn union(self, other: Self) -> Self {
        Self {
            low: [0, 1, 2].map(|a| least(self.low[a], other.low[a])),
            high: [0, 1, 2].map(|a| most(self.high[a], other.high[a])),
        }
    }
}

/// Where a query's box lies in the grid of tiles.
struct Query {
    /// First and last tile along x and z.
    first: [i64; 2],
    last: [i64; 2],
    heights: [f32; 2],
}

impl Octree {
    pub fn new(grid: &FieldGrid, ground: &HeightGrid) -> Self {
        let nodes = grid.tiles.map(|n| n.div_ceil(LEAF_TILES));
        let mut ranges = Vec::with_capacity(nodes[0] as usize * nodes[1] as usize);
        for row in 0..nodes[1] {
            for column in 0..nodes[0] {
                ranges.push(leaf_range(grid, ground, [column, row]));
            }
        }
        let mut levels = vec![Level { nodes, ranges }];
        while let Some(below) = levels.last().filter(|l| l.nodes != [1, 1]) {
            let above = parent_level(below);
            levels.push(above);
        }
        Self { levels }
    }

    /// Calls `found` with every tile whose ground, with plants `reach_m` long on it, may touch the
    /// box; in no particular order, each once.
    pub fn query(
        &self,
        grid: &FieldGrid,
        ground: &HeightGrid,
        bounds: &Bounds,
        reach_m: f64,
        mut found: impl FnMut(TileId),
    ) {
        let corner = ground.corner_in_world();
        let side = f64::from(grid.tile_m());
        let reached = bounds.grown(reach_m);
        let tile = |p: f64, axis: usize| ((p - corner[axis]) / side).floor() as i64;
        let query = Query {
            first: [tile(reached.low[0], 0), tile(reached.low[2], 1)],
            last: [tile(reached.high[0], 0), tile(reached.high[2], 1)],
            heights: [reached.low[1] as f32, reached.high[1] as f32],
        };
        let top = self.levels.len() - 1;
        self.visit(grid, ground, &query, top, [0, 0], &mut found);
    }

    fn visit(
        &self,
        grid: &FieldGrid,
        ground: &HeightGrid,
        query: &Query,
        level: usize,
        node: [u32; 2],
        found: &mut impl FnMut(TileId),
    ) {
        let Level { nodes, ranges } = &self.levels[level];
        if node[0] >= nodes[0] || node[1] >= nodes[1] {
            return;
        }
        let tiles_wide = LEAF_TILES << level;
        let outside = (0..2).any(|a| {
            let first = i64::from(node[a]) * i64::from(tiles_wide);
            first > query.last[a] || first + i64::from(tiles_wide) <= query.first[a]
        });
        if outside || !query.meets(ranges[(node[1] * nodes[0] + node[0]) as usize]) {
            return;
        }
        if level > 0 {
            for child in 0..4 {
                let child = [2 * node[0] + (child & 1), 2 * node[1] + (child >> 1)];
                self.visit(grid, ground, query, level - 1, child, found);
            }
            return;
        }
        for place in 0..LEAF_TILES * LEAF_TILES {
            let column = node[0] * LEAF_TILES + place % LEAF_TILES;
            let row = node[1] * LEAF_TILES + place / LEAF_TILES;
            if column < grid.tiles[0] && row < grid.tiles[1] && query.holds([column, row]) {
                let tile = grid.tile_at(column, row);
                if query.meets(grid.tile_heights(tile, ground)) {
                    found(tile);
                }
            }
        }
    }
}

impl Query {
    fn meets(&self, range: [f32; 2]) -> bool {
        range[0] <= self.heights[1] && range[1] >= self.heights[0]
    }

    fn holds(&self, place: [u32; 2]) -> bool {
        (0..2).all(|a| {
            let p = i64::from(place[a]);
            p >= self.first[a] && p <= self.last[a]
        })
    }
}

fn leaf_range(grid: &FieldGrid, ground: &HeightGrid, node: [u32; 2]) -> [f32; 2] {
    let mut range = [f32::INFINITY, f32::NEG_INFINITY];
    for place in 0..LEAF_TILES * LEAF_TILES {
        let column = node[0] * LEAF_TILES + place % LEAF_TILES;
        let row = node[1] * LEAF_TILES + place / LEAF_TILES;
        if column < grid.tiles[0] && row < grid.tiles[1] {
            let [low, high] = grid.tile_heights(grid.tile_at(column, row), ground);
            range = widened(range, [low, high]);
        }
    }
    range
}

fn parent_level(below: &Level) -> Level {
    let nodes = below.nodes.map(|n| n.div_ceil(2));
    let mut ranges = vec![[f32::INFINITY, f32::NEG_INFINITY]; (nodes[0] * nodes[1]) as usize];
    for row in 0..below.nodes[1] {
        for column in 0..below.nodes[0] {
            let [low, high] = below.ranges[(row * below.nodes[0] + column) as usize];
            let range = &mut ranges[((row / 2) * nodes[0] + column / 2) as usize];
            *range = widened(*range, [low, high]);
        }
    }
    Level { nodes, ranges }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::philox::{philox2x32, unit};
    use crate::scene::{Grass, Solver};
    use std::collections::BTreeSet;

    #[test]
    fn a_query_finds_what_a_search_of_all_tiles_finds() {
        let mut ground = HeightGrid::flat(30, 21, 1.0);
        for (k, h) in ground.heights_m.iter_mut().enumerate() {
            *h = ((k % 30) as f32 * 0.3).sin() * 3.0;
        }
        let grid = FieldGrid::new(&ground, &Grass::default(), &Solver::default()).expect("grid");
        let octree = Octree::new(&grid, &ground);
        for k in 0..200 {
            let [a, b] = philox2x32([k, 0], 9, 7);
            let [c, d] = philox2x32([k, 1], 9, 7);
            let low = [
                f64::from(unit(a)) * 40.0 - 20.0,
                f64::from(unit(b)) * 8.0 - 4.0,
                f64::from(unit(c)) * 30.0 - 15.0,
            ];
            let bounds = Bounds {
                low,
                high: low.map(|x| x + f64::from(unit(d)) * 4.0),
            };
            let mut found = BTreeSet::new();
            octree.query(&grid, &ground, &bounds, 0.4, |tile| {
                assert!(found.insert(tile), "tile {tile} reported twice");
            });
            let wide = bounds.grown(0.4);
            let expected: BTreeSet<_> = (0..grid.tile_count())
                .filter(|&tile| {
                    let [[x0, z0], [x1, z1]] = grid.tile_bounds(tile, &ground);
                    let [y0, y1] = grid.tile_heights(tile, &ground).map(f64::from);
                    x0 <= wide.high[0]
                        && x1 > wide.low[0]
                        && z0 <= wide.high[2]
                        && z1 > wide.low[2]
                        && y0 <= wide.high[1]
                        && y1 >= wide.low[1]
                })
                .collect();
            assert_eq!(found, expected, "query {k}");
        }
    }
}
