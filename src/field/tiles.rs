//! The life of a tile: resting, colliding, recovering (O09 section 5.1).
//!
//! A resting tile is in no list. One that a body's swept bounds may touch is colliding and has a
//! slab of state; when no body is near any more it recovers for the recovery time, then gives
//! the slab back. The work per tick follows the active tiles alone.

use std::collections::BTreeMap;

use super::grid::TileId;
use super::slabs::SlabPool;

/// What an active tile is doing. A tile that rests is not active.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum TileState {
    /// A body may be touching its plants in this tick.
    Colliding,
    /// Nothing is near; its plants return to the wind pose.
    Recovering,
}

/// An active tile.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct ActiveTile {
    pub slab: u32,
    pub state: TileState,
    /// Tick at which a body was near for the last time.
    pub last_near: u32,
}

/// Every active tile, in the order of their ids.
#[derive(Clone, Debug, Default)]
pub struct ActiveTiles {
    tiles: BTreeMap<TileId, ActiveTile>,
    pub slabs: SlabPool,
    /// Largest number of tiles active at once.
    pub peak: usize,
}

/// What changed in one tick.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    /// Tiles that woke, with the slab they got; its old content is to be wiped.
    pub woken: Vec<(TileId, u32)>,
    /// Tiles that rest again, with the slab they gave back.
    pub rested: Vec<(TileId, u32)>,
}

impl ActiveTiles {
    pub fn new(slab_limit: u32) -> Self {
        Self {
            slabs: SlabPool::new(slab_limit),
            ..Self::default()
        }
    }

    /// Marks the tiles in `near` (sorted, each once) as colliding at tick `now`, the other active
    /// ones as recovering, and lets those rest that have recovered for `recovery_ticks`.
    pub fn update(&mut self, near: &[TileId], now: u32, recovery_ticks: u32) -> Changes {
        let mut changes = Changes::default();
        let slabs = &mut self.slabs;
        self.tiles.retain(|&id, tile| {
            tile.state = TileState::Recovering;
            // One tick more than the recovery, so that the last one has been seen at zero offset.
            let keep = now.saturating_sub(tile.last_near) <= recovery_ticks
                || near.binary_search(&id).is_ok();
            if !keep {
                slabs.give_back(tile.slab);
                changes.rested.push((id, tile.slab));
            }
            keep
        });
        for &id in near {
            if let Some(tile) = self.tiles.get_mut(&id) {
                tile.state = TileState::Colliding;
                tile.last_near = now;
            } else if let Some(slab) = self.slabs.take() {
                changes.woken.push((id, slab));
                let tile = ActiveTile {
                    slab,
                    state: TileState::Colliding,
                    last_near: now,
                };
                self.tiles.insert(id, tile);
            }
        }
        self.peak = self.peak.max(self.tiles.len());
        changes
    }

    pub fn get(&self, tile: TileId) -> Option<&ActiveTile> {
        self.tiles.get(&tile)
    }

    pub fn iter(&self) -> impl Iterator<Item = (TileId, &ActiveTile)> {
        self.tiles.iter().map(|(&id, tile)| (id, tile))
    }

    pub fn len(&self) -> usize {
        self.tiles.len()
    }

    pub fn is_empty(&self) -> bool {
        self.tiles.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_wakes_recovers_and_rests() {
        let mut active = ActiveTiles::new(8);
        assert_eq!(active.update(&[3, 7], 10, 5).woken, [(3, 0), (7, 1)]);
        let changes = active.update(&[7], 11, 5);
        assert!(changes.woken.is_empty() && changes.rested.is_empty());
        assert_eq!(active.get(3).map(|t| t.state), Some(TileState::Recovering));
        for now in 12..=15 {
            assert!(active.update(&[7], now, 5).rested.is_empty(), "tick {now}");
        }
        assert_eq!(active.update(&[7], 16, 5).rested, [(3, 0)]);
        assert_eq!(
            (active.len(), active.peak, active.slabs.in_use()),
            (1, 2, 1)
        );
        assert_eq!(active.update(&[9], 17, 5).woken, [(9, 0)]);
    }

    #[test]
    fn a_full_pool_refuses_and_counts() {
        let mut active = ActiveTiles::new(1);
        active.update(&[1, 2], 0, 5);
        assert_eq!((active.len(), active.slabs.refused), (1, 1));
    }
}
