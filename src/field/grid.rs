//! How the ground is divided: height samples, seeding cells, anchors, tiles.
//!
//! All of them nest. A square between four height samples is halved until a *seeding cell* is
//! small enough; a cell holds two seeding triangles. Four by four cells share an *anchor*, the
//! origin of the coordinates in which collision is computed. A *tile* is 1, 2 or 4 cells wide and
//! so lies in one anchor: neither roots nor coordinates depend on the tile size.

use crate::base::Real;
use crate::base::widened;
use crate::scene::{Grass, Solver};
use crate::terrain::HeightGrid;

/// Cells along the side of an anchor square.
pub const ANCHOR_CELLS: u32 = 4;
/// Most plants one tile may hold: a slab's index and a drawing's instance count stay small.
pub const MAX_PLANTS_PER_TILE: u64 = crate::scene::limits::PLANTS_PER_TILE;
/// Most halvings of the sample spacing.
const MAX_HALVINGS: u32 = 12;

/// Rank of a tile, row by row from the field's corner.
pub type TileId = u32;

/// The division of one ground.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldGrid {
    /// Halvings of the sample spacing down to a seeding cell.
    pub halvings: u32,
    /// Side of a seeding cell, in metres: the spacing over 2^halvings, exactly.
    pub cell_m: f32,
    /// Seeding cells along x and z.
    pub cells: [u32; 2],
    /// Cells along the side of a tile: 1, 2 or 4.
    pub tile_cells: u32,
    /// Tiles along x and z; the last ones may reach over the edge, where nothing grows.
    pub tiles: [u32; 2],
    /// Plants every seeding triangle has.
    pub sure_plants: u32,
    /// Chance of one more, as a fraction of 2³²: rounding by a hash keeps the mean density.
    pub one_more: u32,
}

/// Which plant of the field a place of a tile stands for, whatever the tile's size.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct SeedPlace {
    /// Seeding cell.
    pub cell: [u32; 2],
    /// Which of the cell's two triangles.
    pub half: u32,
    /// Number of the plant on its triangle.
    pub index: u32,
}

/// Why a ground cannot be divided.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    #[error(
        "solver.seeding_cell_m is {wished} m, but the ground's {spacing} m spacing may be halved \
         at most {MAX_HALVINGS} times: use a longer cell"
    )]
    CellTooSmall { wished: f32, spacing: f32 },
    #[error(
        "the ground has {cells} seeding cells of {cell_m} m, more than the {limit} whose \
         triangles can be numbered: use longer cells or a smaller ground"
    )]
    TooManyCells { cells: u64, cell_m: f32, limit: u64 },
    #[error(
        "a tile of {tile_m} m would hold {plants} plants, more than {MAX_PLANTS_PER_TILE}: lower \
         grass.density_per_m2 or solver.tile_m"
    )]
    TileTooFull { tile_m: f32, plants: u64 },
}

/// Origin of collision coordinates, and where it lies in the height samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// Anchor counts along x and z.
    pub index: [u32; 2],
    /// Square of height samples in which the origin lies.
    pub square: [u32; 2],
    /// Fraction of that square at which it lies, along x and z; exact.
    pub in_square: [f32; 2],
    /// Height of the origin: a whole number of metres, so that taking it away loses nothing.
    pub base_y: f32,
}

impl FieldGrid {
    pub fn new(ground: &HeightGrid, grass: &Grass, solver: &Solver) -> Result<Self, GridError> {
        let mut halvings = 0;
        let mut cell_m = ground.spacing_m;
        while cell_m > solver.seeding_cell_m * 1.000_001 {
            cell_m *= 0.5;
            halvings += 1;
            if halvings > MAX_HALVINGS {
                return Err(GridError::CellTooSmall {
                    wished: solver.seeding_cell_m,
                    spacing: ground.spacing_m,
                });
            }
        }
        let cells_wide = ground.squares().map(|n| u64::from(n) << halvings);
        let count = cells_wide[0].saturating_mul(cells_wide[1]);
        // A triangle id has one bit more than a cell's rank; plant u32::MAX is kept for rounding.
        let limit = 1 << 31;
        if count > limit {
            return Err(GridError::TooManyCells {
                cells: count,
                cell_m,
                limit,
            });
        }
        let cells = cells_wide.map(|n| n as u32);
        let tile_cells = [4, 2, 1]
            .into_iter()
            .find(|&n| cell_m * n as f32 <= solver.tile_m * 1.000_001)
            .unwrap_or(1);
        let bare = Self {
            halvings,
            cell_m,
            cells,
            tile_cells,
            tiles: cells.map(|n| n.div_ceil(tile_cells)),
            sure_plants: 0,
            one_more: 0,
        };
        let grows = !grass.species.is_empty();
        let grid = bare.with_density(if grows { grass.density_per_m2 } else { 0.0 });
        let plants = u64::from(grid.triangles_per_tile()) * u64::from(grid.plants_per_triangle());
        if plants > MAX_PLANTS_PER_TILE {
            return Err(GridError::TileTooFull {
                tile_m: grid.tile_m(),
                plants,
            });
        }
        Ok(grid)
    }

    /// The same division of the ground with another mean number of plants per square metre.
    pub fn with_density(&self, density_per_m2: f32) -> Self {
        let cell_m = f64::from(self.cell_m);
        let mean = f64::from(density_per_m2) * 0.5 * cell_m * cell_m;
        Self {
            sure_plants: mean.floor() as u32,
            one_more: ((mean - mean.floor()) * 4_294_967_296.0) as u32,
            ..self.clone()
        }
    }

    /// Side of a tile, in metres.
    pub fn tile_m(&self) -> f32 {
        self.cell_m * self.tile_cells as f32
    }

    pub fn tile_count(&self) -> u32 {
        self.tiles[0] * self.tiles[1]
    }

    pub fn triangles_per_tile(&self) -> u32 {
        2 * self.tile_cells * self.tile_cells
    }

    /// Most plants of a seeding triangle: n_max of P15 eq. 1.
    pub fn plants_per_triangle(&self) -> u32 {
        self.sure_plants + u32::from(self.one_more > 0)
    }

    /// Most plants of a tile, and the places of a slab.
    pub fn plants_per_tile(&self) -> u32 {
        self.triangles_per_tile() * self.plants_per_triangle()
    }

    /// The seed at a place of a tile's order, which takes one plant of every triangle in turn, so
    /// that any prefix of it covers the tile evenly. The cell may lie beyond the field's edge.
    pub fn seed_place(&self, tile: TileId, place: u32) -> SeedPlace {
        let triangles = self.triangles_per_tile();
        let (index, within) = (place / triangles, place % triangles);
        let in_tile = [
            (within >> 1) % self.tile_cells,
            (within >> 1) / self.tile_cells,
        ];
        let first = self.first_cell(tile);
        SeedPlace {
            cell: [first[0] + in_tile[0], first[1] + in_tile[1]],
            half: within & 1,
            index,
        }
    }

    /// The id of the triangle a seed lies on.
    pub fn triangle(&self, seed: &SeedPlace) -> u32 {
        ((seed.cell[1] * self.cells[0] + seed.cell[0]) << 1) | seed.half
    }

    pub fn tile_at(&self, column: u32, row: u32) -> TileId {
        row * self.tiles[0] + column
    }

    /// Column and row of a tile.
    pub fn tile_place(&self, tile: TileId) -> [u32; 2] {
        [tile % self.tiles[0], tile / self.tiles[0]]
    }

    /// First seeding cell of a tile.
    pub fn first_cell(&self, tile: TileId) -> [u32; 2] {
        self.tile_place(tile).map(|n| n * self.tile_cells)
    }

    /// The anchor a tile lies in.
    pub fn anchor_of(&self, tile: TileId, ground: &HeightGrid) -> Anchor {
        let index = self.first_cell(tile).map(|n| n / ANCHOR_CELLS);
        let first = index.map(|n| n * ANCHOR_CELLS);
        let square = first.map(|n| n >> self.halvings);
        let share = 1.0 / (1u32 << self.halvings) as f32;
        let in_square = [0, 1].map(|a| (first[a] - (square[a] << self.halvings)) as f32 * share);
        Anchor {
            index,
            square,
            in_square,
            base_y: ground.sample(square[0], square[1]).floor(),
        }
    }

    /// World place of an anchor's origin.
    pub fn anchor_in_world(&self, anchor: &Anchor, ground: &HeightGrid) -> [f64; 3] {
        let side = f64::from(ANCHOR_CELLS) * f64::from(self.cell_m);
        let corner = ground.corner_in_world();
        [
            corner[0] + f64::from(anchor.index[0]) * side,
            f64::from(anchor.base_y),
            corner[1] + f64::from(anchor.index[1]) * side,
        ]
    }

    /// World bounds of a tile's ground along x and z: smallest and largest.
    pub fn tile_bounds(&self, tile: TileId, ground: &HeightGrid) -> [[f64; 2]; 2] {
        let side = f64::from(self.tile_m());
        let corner = ground.corner_in_world();
        let [column, row] = self.tile_place(tile).map(f64::from);
        let low = [corner[0] + column * side, corner[1] + row * side];
        [low, [low[0] + side, low[1] + side]]
    }

    /// Smallest and largest ground height under a tile, in metres.
    pub fn tile_heights(&self, tile: TileId, ground: &HeightGrid) -> [f32; 2] {
        let first = self.first_cell(tile);
        let low = first.map(|n| n >> self.halvings);
        let high = first.map(|n| ((n + self.tile_cells - 1) >> self.halvings) + 1);
        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
        for row in low[1]..=high[1] {
            for column in low[0]..=high[0] {
                let h = ground.sample(column, row);
                range = widened(range, [h, h]);
            }
        }
        range
    }
}

/// The plane of the ground's triangle under a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundPlane<R> {
    /// Height of the ground there over the anchor's origin, in metres.
    pub height: R,
    /// How steeply it rises along x and z, in metres per metre.
    pub slope: [R; 2],
}

/// Height of the ground over an anchor's origin, at a place in the anchor's coordinates. Places
/// beyond the edge take the edge's height.
pub fn ground_in_anchor<R: Real>(ground: &HeightGrid, anchor: &Anchor, x: R, z: R) -> R {
    ground_plane_in_anchor(ground, anchor, x, z).height
}

/// As [`ground_in_anchor`], with the slope.
pub fn ground_plane_in_anchor<R: Real>(
    ground: &HeightGrid,
    anchor: &Anchor,
    x: R,
    z: R,
) -> GroundPlane<R> {
    let per_metre = R::of_f32(1.0 / ground.spacing_m);
    let squares = ground.squares();
    let locate = |p: R, axis: usize| {
        let at = p * per_metre + R::of_f32(anchor.in_square[axis]);
        let whole = at.floor();
        let square = anchor.square[axis] as i64 + whole.to_f64() as i64;
        if square < 0 {
            (0, R::ZERO)
        } else if square >= i64::from(squares[axis]) {
            (squares[axis] - 1, R::ONE)
        } else {
            (square as u32, at - whole)
        }
    };
    let (i, u) = locate(x, 0);
    let (j, v) = locate(z, 1);
    let [height, along_x, along_z] = ground.plane_in_square(i, j, u, v, anchor.base_y);
    GroundPlane {
        height,
        slope: [along_x * per_metre, along_z * per_metre],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(tile_m: f32, spacing: f32) -> (HeightGrid, FieldGrid) {
        let mut ground = HeightGrid::flat(9, 7, spacing);
        for (k, h) in ground.heights_m.iter_mut().enumerate() {
            *h = 3.0 + ((k * 31) % 17) as f32 * 0.2;
        }
        let solver = Solver {
            tile_m,
            ..Solver::default()
        };
        let grid = FieldGrid::new(&ground, &Grass::default(), &solver).expect("a valid grid");
        (ground, grid)
    }

    #[test]
    fn cells_nest_in_samples_and_tiles_in_anchors() {
        for (tile_m, cells) in [(0.5, 1), (1.0, 2), (2.0, 4)] {
            let (_, grid) = grid(tile_m, 1.0);
            assert_eq!((grid.cell_m, grid.halvings), (0.5, 1));
            assert_eq!((grid.tile_cells, grid.tile_m()), (cells, tile_m));
            assert_eq!(grid.plants_per_triangle(), 32);
        }
        assert_eq!(grid(1.0, 5.0).1.cell_m, 0.3125);
    }

    #[test]
    fn heights_in_an_anchor_are_the_worlds() {
        for spacing in [1.0, 5.0] {
            let (ground, grid) = grid(1.0, spacing);
            for tile in 0..grid.tile_count() {
                let anchor = grid.anchor_of(tile, &ground);
                let origin = grid.anchor_in_world(&anchor, &ground);
                for (x, z) in [(0.1, 0.2), (0.7, 0.9), (1.3, 1.9)] {
                    let local: f64 = ground_in_anchor(&ground, &anchor, x, z);
                    let world = ground.height_in_world(origin[0] + x, origin[2] + z);
                    assert!((local + origin[1] - world).abs() < 1e-6, "tile {tile}");
                    let single: f32 = ground_in_anchor(&ground, &anchor, x as f32, z as f32);
                    // Slopes up to 3.4 per spacing times places rounded to 2^-23 m: below 2e-6 m.
                    assert!((f64::from(single) - local).abs() < 2e-6);
                }
            }
        }
    }

    #[test]
    fn too_much_is_refused_with_numbers() {
        let ground = HeightGrid::flat(3, 3, 4096.0);
        let solver = Solver {
            seeding_cell_m: 0.5,
            ..Solver::default()
        };
        let refused = FieldGrid::new(&ground, &Grass::default(), &solver);
        assert!(matches!(refused, Err(GridError::CellTooSmall { .. })));
        let dense = Grass {
            density_per_m2: 1e6,
            ..Grass::default()
        };
        let refused = FieldGrid::new(&HeightGrid::flat(3, 3, 1.0), &dense, &Solver::default());
        assert!(refused.is_err_and(|e| e.to_string().contains("1000000 plants")));
    }
}
