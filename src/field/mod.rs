//! The meadow at rest: where plants stand, what shape they have, which tiles are awake.

pub mod billboards;
pub mod blade_shape;
pub mod blade_table;
pub mod clusters;
pub mod coat;
pub mod count;
pub mod grid;
pub mod horizon;
pub mod in_view;
pub mod kinds;
pub mod octree;
pub mod on_map;
pub mod plant;
pub mod pose;
pub mod slabs;
pub mod tiles;
pub mod wind;

pub use billboards::{Billboard, BillboardError, BillboardField};
pub use blade_table::BladeTable;
pub use grid::{Anchor, FieldGrid, TileId};
pub use horizon::Horizon;
pub use kinds::Kinds;
pub use octree::{Bounds, Octree};
pub use plant::{Plant, Seeds};
pub use pose::{MAX_NODES, MAX_SEGMENTS, Nodes, wind_pose};
pub use slabs::SlabPool;
pub use tiles::{ActiveTile, ActiveTiles, TileState};
pub use wind::WindNow;

use std::sync::Arc;

use crate::base::most;
use crate::scene::{Billboards, Grass, Solver};
use crate::terrain::bintree::Bintree;
use crate::terrain::{ColourMap, CoverMap, HeightGrid};

/// Everything about a meadow that does not change while it is simulated.
#[derive(Clone, Debug)]
pub struct Field {
    pub ground: Arc<HeightGrid>,
    pub bintree: Arc<Bintree>,
    pub grid: FieldGrid,
    pub seeds: Seeds,
    pub table: BladeTable,
    pub octree: Octree,
    /// The second layer, of a scene that has one.
    pub billboards: Option<Arc<BillboardField>>,
    /// Length of the longest blade, in metres: how far a plant can reach from its root.
    pub reach_m: f32,
}

/// Why a meadow cannot be laid out.
#[derive(Clone, Debug, thiserror::Error)]
pub enum FieldError {
    #[error(transparent)]
    Grid(#[from] grid::GridError),
    #[error(transparent)]
    Table(#[from] blade_table::TableError),
    #[error(transparent)]
    Billboards(#[from] BillboardError),
    #[error(
        "the kinds of plants have `likes`, so they need a base map: lay the field out with `on_map`"
    )]
    NoMap,
}

impl Field {
    /// A field whose kinds of plants grow everywhere alike.
    ///
    /// # Errors
    /// A ground that cannot be divided, blades without a shape, kinds that look at a base map.
    pub fn new(ground: HeightGrid, grass: &Grass, solver: &Solver) -> Result<Self, FieldError> {
        if grass.grows_by_colour() {
            return Err(FieldError::NoMap);
        }
        Self::laid_out(ground, grass, solver)
    }

    /// A field whose kinds of plants grow where the base map has the colours they like.
    ///
    /// # Errors
    /// A ground that cannot be divided, blades without a shape.
    pub fn on_map(
        ground: HeightGrid,
        map: Arc<ColourMap>,
        grass: &Grass,
        solver: &Solver,
    ) -> Result<Self, FieldError> {
        let mut field = Self::laid_out(ground, grass, solver)?;
        field.seeds.kinds = Kinds::new(grass, &field.grid, map);
        Ok(field)
    }

    /// The same field with billboards on it, as their maps say.
    ///
    /// # Errors
    /// More billboards than a tile or a field may hold.
    pub fn with_billboards(
        mut self,
        billboards: &Billboards,
        map: CoverMap,
    ) -> Result<Self, FieldError> {
        let rounds = self.seeds.rounds;
        let field = BillboardField::new(&self.ground, &self.grid, map, billboards, rounds)?;
        self.billboards = Some(Arc::new(field));
        Ok(self)
    }

    fn laid_out(ground: HeightGrid, grass: &Grass, solver: &Solver) -> Result<Self, FieldError> {
        let grid = FieldGrid::new(&ground, grass, solver)?;
        let table = BladeTable::new(grass, solver.segments, solver.root, solver.blade_table)?;
        let seeds = Seeds::new(grass, solver.philox, &table, &grid);
        let octree = Octree::new(&grid, &ground);
        let reach_m = grass
            .species
            .iter()
            .fold(0.0_f32, |reach, kind| most(reach, kind.height_m[1]));
        let ground = Arc::new(ground);
        Ok(Self {
            bintree: Arc::new(Bintree::new(Arc::clone(&ground))),
            ground,
            grid,
            seeds,
            table,
            octree,
            billboards: None,
            reach_m,
        })
    }

    /// The plant at a place of a tile's order, in its anchor's coordinates.
    pub fn plant(&self, anchor: &Anchor, tile: TileId, place: u32) -> Option<Plant> {
        self.seeds
            .plant(&self.grid, &self.ground, anchor, tile, place)
    }

    /// The same, if it is of a kind that bodies push aside.
    pub fn responding_plant(&self, anchor: &Anchor, tile: TileId, place: u32) -> Option<Plant> {
        let plant = self.plant(anchor, tile, place)?;
        self.seeds.species[plant.species as usize]
            .responds
            .then_some(plant)
    }

    /// Calls `found` with every tile that has a plant or a billboard which may touch a box in the world.
    pub fn near(&self, bounds: &Bounds, mut found: impl FnMut(TileId)) {
        let (grid, ground) = (&self.grid, &self.ground);
        self.octree
            .query(grid, ground, bounds, self.farthest_m(), |tile| {
                if !self.is_bare() || self.billboards_on(tile) > 0 {
                    found(tile);
                }
            });
    }

    /// How far anything of either layer can reach from its root, in metres.
    pub fn farthest_m(&self) -> f64 {
        let billboards_m = self.billboards.as_ref().map_or(0.0, |field| field.reach_m);
        f64::from(most(self.reach_m, billboards_m))
    }

    /// The billboards of a tile, in the order of its slab.
    pub fn billboards_in(&self, tile: TileId) -> &[Billboard] {
        let field = self.billboards.as_ref();
        field.map_or(&[], |field| field.in_tile(tile))
    }

    /// How many billboards stand on a tile.
    pub fn billboards_on(&self, tile: TileId) -> u32 {
        let field = self.billboards.as_ref();
        field.map_or(0, |field| field.range(tile).len() as u32)
    }

    /// Whether no plant of the first layer grows here.
    pub fn is_bare(&self) -> bool {
        self.seeds.species.is_empty() || self.grid.plants_per_triangle() == 0
    }

    /// Whether nothing of either layer grows here.
    pub fn is_empty(&self) -> bool {
        let billboards = self.billboards.as_ref();
        self.is_bare() && billboards.is_none_or(|field| field.all.is_empty())
    }
}
