//! A moment of a meadow and its grass, kept in memory: to go back to, and on from, as often as
//! wanted, with the same bits.
//!
//! The field, the scene, shapes and depth cubes are not copied; they never change or only grow.
//! Slabs are shared with the running grass until a contact writes to them, so that a checkpoint
//! costs what bodies and tile lists take, and later a copy of the slabs that collide on.

use std::sync::Arc;

use crate::base::Real;
use crate::bodies::BodiesState;
use crate::field::ActiveTiles;
use crate::field::tiles::Changes;

use super::cpu::{Grass, PassTimes};
use super::meadow::{Counters, Meadow, ScriptState};
use super::measure::GrassState;
use super::slab::Slab;
use super::state_hash::StateHash;
use super::work::Work;

/// A moment of a meadow and of the cpu engine's grass.
#[derive(Clone)]
pub struct Checkpoint<R: Real> {
    bodies: BodiesState,
    tiles: ActiveTiles,
    work: Work,
    changes: Changes,
    counters: Counters,
    ticks: u32,
    script: ScriptState,
    slabs: Vec<Option<Arc<Slab<R>>>>,
    billboard_slabs: Vec<Option<Arc<Slab<R>>>>,
    pushed: u64,
    rounds: u32,
    rounds_peak: u32,
    times: PassTimes,
    state_hash: StateHash,
}

impl<R: Real> Checkpoint<R> {
    /// Keeps the moment between two sub-steps.
    pub fn save(meadow: &Meadow, grass: &Grass<R>) -> Self {
        Self {
            bodies: meadow.bodies.save(),
            tiles: meadow.tiles.clone(),
            work: meadow.work.clone(),
            changes: meadow.changes.clone(),
            counters: meadow.counters,
            ticks: meadow.ticks,
            script: meadow.script_state(),
            slabs: grass.slabs().to_vec(),
            billboard_slabs: grass.billboards().slabs().to_vec(),
            pushed: grass.pushed,
            rounds: grass.rounds,
            rounds_peak: grass.rounds_peak,
            times: grass.times,
            state_hash: grass.state_hash,
        }
    }

    /// Goes back, or forth, to the moment. `meadow` and `grass` are those it was saved from.
    pub fn restore(&self, meadow: &mut Meadow, grass: &mut Grass<R>) {
        meadow.bodies.restore(&self.bodies);
        meadow.tiles = self.tiles.clone();
        meadow.work = self.work.clone();
        meadow.changes = self.changes.clone();
        meadow.counters = self.counters;
        meadow.ticks = self.ticks;
        meadow.set_script_state(self.script.clone());
        grass.set_slabs(self.slabs.clone());
        let billboards = grass.billboards_mut();
        billboards.set_slabs(self.billboard_slabs.clone());
        grass.pushed = self.pushed;
        grass.rounds = self.rounds;
        grass.rounds_peak = self.rounds_peak;
        grass.times = self.times;
        grass.state_hash = self.state_hash;
    }

    /// Sub-steps done at the moment.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// Bytes of slabs that nothing but this checkpoint holds.
    pub fn own_slab_bytes(&self) -> u64 {
        let slabs = self.slabs.iter().chain(&self.billboard_slabs);
        slabs
            .flatten()
            .filter(|slab| Arc::strong_count(slab) == 1)
            .map(|slab| slab.bytes())
            .sum()
    }
}

impl<R: Real> Grass<R> {
    /// Takes over the state of another engine, or one made by hand, in the meadow's active tiles, so
    /// that the next tick goes on from there. The twin of the gpu engine's `upload`.
    pub fn take_over(&mut self, meadow: &Meadow, state: &impl GrassState<R>) {
        let mut slabs = self.slabs().to_vec();
        slabs.resize_with(meadow.tiles.slabs.high_water() as usize, || None);
        for tile in &meadow.work.tiles {
            if let Some(slab) = state.slab(tile.slab) {
                slabs[tile.slab as usize] = Some(Arc::new(slab.clone()));
            }
        }
        self.set_slabs(slabs);
        let mut slabs = self.billboards().slabs().to_vec();
        slabs.resize_with(meadow.tiles.slabs.high_water() as usize, || None);
        for tile in &meadow.work.tiles {
            if let Some(slab) = state.billboards(tile.slab) {
                slabs[tile.slab as usize] = Some(Arc::new(slab.clone()));
            }
        }
        self.billboards_mut().set_slabs(slabs);
    }
}
