//! How much state the active tiles of a meadow have, in both layers.

use crate::field::{ActiveTiles, Field};
use crate::scene::Solver;
use crate::scene::method::Springs;

use super::billboard::{Grid, GridError, Weave};
use super::slab::slab_bytes;

/// Most bytes of grass state a meadow may use.
pub const STATE_BUDGET_BYTES: u64 = 1 << 30;

/// What the active tiles hold.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct StateSize {
    /// Plants and billboards.
    pub plants: u64,
    pub bytes: u64,
}

impl StateSize {
    pub fn of(field: &Field, solver: &Solver, weave: Option<&Weave>, tiles: &ActiveTiles) -> Self {
        let active = tiles.len() as u64;
        let plants = field.grid.plants_per_tile();
        let mut size = Self {
            plants: active * u64::from(plants),
            bytes: active * slab_bytes(plants, solver.segments),
        };
        if let Some(weave) = weave {
            for (tile, _) in tiles.iter() {
                let billboards = field.billboards_on(tile);
                size.plants += u64::from(billboards);
                size.bytes += slab_bytes(billboards, weave.grid.movable() as u32);
            }
        }
        size
    }
}

/// No tile awake, and as many slabs as the budget allows if every tile has the most billboards.
pub fn all_at_rest(field: &Field, solver: &Solver, weave: Option<&Weave>) -> ActiveTiles {
    let plants = slab_bytes(field.grid.plants_per_tile(), solver.segments);
    let most = field.billboards.as_ref().map_or(0, |b| b.most_in_tile());
    let nodes = weave.map_or(0, |weave| weave.grid.movable() as u32);
    let slab = (plants + slab_bytes(most, nodes)).max(1);
    let slab_limit = (STATE_BUDGET_BYTES / slab).min(u64::from(field.grid.tile_count()));
    ActiveTiles::new(slab_limit as u32)
}

/// Nodes and springs of a field's billboards, if it has some.
///
/// # Errors
///
/// A grid with too few or too many columns or rows.
pub fn weave_of(field: &Field, solver: &Solver) -> Result<Option<Weave>, GridError> {
    let woven = |nodes| Ok(Weave::new(Grid::new(nodes)?, has_bends(solver)));
    let billboards = field.billboards.as_ref();
    billboards.map(|field| woven(field.nodes)).transpose()
}

/// Whether billboards have bend springs, which the printed method has not.
pub fn has_bends(solver: &Solver) -> bool {
    solver.method.springs != Springs::Literal
}
