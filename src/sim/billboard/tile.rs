//! The billboards of a tile: their poses, and relax over the tile's slab.

use crate::base::{Real, Vec3};
use crate::field::{Anchor, WindNow};
use crate::sim::collide::MAX_MOVABLE;
use crate::sim::contact::{Moment, Touch};
use crate::sim::recover::{Fading, is_back};
use crate::sim::relax::{Bodies, Ground};
use crate::sim::slab::Slab;
use crate::terrain::HeightGrid;

use super::batch::{Batch, Lane};
use super::recover::{Fade, Poses};
use super::relax::{Outcome, Settings, respond};
use super::{Quad, Weave};
use crate::field::Billboard;

/// Billboards side by side: as many as the few of a tile fill, two vectors of four floats each.
pub const LANES: usize = 8;

/// What a tile's billboards meet in a sub-step.
#[derive(Clone, Copy, Debug)]
pub struct Tile<'a, R> {
    pub weave: &'a Weave,
    pub billboards: &'a [Billboard],
    pub anchor: &'a Anchor,
    pub ground: &'a HeightGrid,
    /// Nothing of the ground within reach of the tile is higher, in metres over the anchor's origin.
    pub ground_top_m: R,
    pub touches: &'a [Touch<'a, R>],
    pub wind: &'a WindNow,
    /// The wind at the start of the sub-step.
    pub wind_before: &'a WindNow,
    /// Tick at the end of the sub-step.
    pub now: u32,
    pub fading: Fading<R>,
}

/// A billboard to respond: its place in the tile, and the sweeps it needs, 0 if it is merely held.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Touched {
    pub place: u32,
    pub sweeps: u32,
}

/// What a sub-step did to the billboards of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Responded {
    /// Billboards that were pushed or held.
    pub touched: u64,
    /// Most rounds of one.
    pub rounds: u32,
    /// Largest strain that was left.
    pub strain: f64,
    pub reset: u64,
    pub replaced: u64,
    pub clamped: bool,
}

impl<'a, R: Real> Tile<'a, R> {
    pub(super) fn quad(&self, place: usize, wind: &WindNow) -> Quad<R> {
        Quad::in_wind(&self.billboards[place], self.anchor, wind)
    }

    pub(super) fn offsets<'s>(&self, slab: &'s Slab<R>, place: usize) -> &'s [Vec3<R>] {
        let movable = self.weave.grid.movable();
        &slab.offsets[place * movable..][..movable]
    }

    /// Poses of all billboards one after the other, in batches: `take` gets the place, the lane and the
    /// nodes of each.
    pub fn poses(
        &self,
        slab: &Slab<R>,
        poses: &mut Poses<R, LANES>,
        mut take: impl FnMut(usize, usize, &Poses<R, LANES>),
    ) {
        let count = self.billboards.len();
        for first in (0..count).step_by(LANES) {
            let mut fades = [const { None }; LANES];
            for (place, fade) in (first..count).zip(&mut fades) {
                *fade = Some(self.fade(slab, place));
            }
            poses.recover(self.weave, fades.iter().flatten(), &self.fading);
            for (lane, place) in (first..count).take(LANES).enumerate() {
                take(place, lane, poses);
            }
        }
    }

    /// How a billboard fades at the end of the sub-step; one that was never touched has no offset left.
    pub(super) fn fade<'s>(&self, slab: &'s Slab<R>, place: usize) -> Fade<'s, R> {
        let touched_at = slab.touched_at[place];
        Fade {
            quad: self.quad(place, self.wind),
            offsets: self.offsets(slab, place),
            age: if touched_at == 0 {
                u32::MAX
            } else {
                self.now - touched_at
            },
        }
    }

    pub(super) fn was_touched(&self, slab: &Slab<R>, place: usize) -> bool {
        let touched_at = slab.touched_at[place];
        touched_at != 0 && self.now - touched_at == 1
    }

    /// Nodes that bodies meet in this sub-step, up to [`LANES`] billboards side by side: as each was left if
    /// it was touched in the sub-step before, wherever the wind has gone since, else in its pose of now.
    pub(super) fn before(&self, slab: &Slab<R>, places: &[u32], poses: &mut Poses<R, LANES>) {
        let grid = self.weave.grid;
        let mut fades = [const { None }; LANES];
        for (fade, &place) in fades.iter_mut().zip(places) {
            let place = place as usize;
            let now = self.fade(slab, place);
            // Nothing is restored of one that was touched: its pose is taken as it was left.
            let age = if self.was_touched(slab, place) {
                0
            } else {
                now.age
            };
            *fade = Some(Fade { age, ..now });
        }
        poses.recover(self.weave, fades.iter().flatten(), &self.fading);
        for (lane, &place) in places.iter().enumerate() {
            let place = place as usize;
            if self.was_touched(slab, place) {
                let offsets = self.offsets(slab, place);
                let quad = self.quad(place, self.wind_before);
                quad.nodes(grid, |node, rest| {
                    if node >= grid.columns {
                        poses
                            .nodes
                            .set(node, lane, rest + offsets[node - grid.columns]);
                    }
                });
            }
        }
    }

    /// The movable nodes of a lane, as a list.
    pub(super) fn movable(&self, poses: &Poses<R, LANES>, lane: usize, nodes: &mut [Vec3<R>]) {
        for (n, node) in nodes.iter_mut().enumerate() {
            *node = poses.nodes.get(self.weave.grid.columns + n, lane);
        }
    }

    pub(super) fn ground(&self) -> Ground<'a> {
        Ground {
            heights: self.ground,
            anchor: self.anchor,
        }
    }

    /// Pushes the touched billboards out, restores their shape and stores their offsets. `batch` and `poses`
    /// are used as room; those that need equally many sweeps share them.
    pub fn respond(
        &self,
        touched: &mut [Touched],
        slab: &mut Slab<R>,
        (batch, poses): (&mut Batch<'a, R, LANES>, &mut Poses<R, LANES>),
        settings: &Settings<R>,
    ) -> Responded {
        let mut done = Responded::default();
        touched.sort_by_key(|touched| (touched.sweeps, touched.place));
        let same_sweeps = touched.chunk_by(|a, b| a.sweeps == b.sweeps);
        for touched in same_sweeps.flat_map(|run| run.chunks(LANES)) {
            let mut places = [0; LANES];
            for (place, touched) in places.iter_mut().zip(touched) {
                *place = touched.place;
            }
            self.before(slab, &places[..touched.len()], poses);
            batch.clear();
            for (lane, touched) in touched.iter().enumerate() {
                self.take_in(touched.place as usize, slab, batch, (poses, lane), settings);
            }
            let outcomes = respond(batch, touched[0].sweeps, settings);
            for (lane, (touched, outcome)) in touched.iter().zip(outcomes).enumerate() {
                self.store(touched.place as usize, lane, slab, batch);
                done.add(&outcome);
            }
        }
        done
    }

    fn take_in(
        &self,
        place: usize,
        slab: &mut Slab<R>,
        batch: &mut Batch<'a, R, LANES>,
        (poses, lane): (&Poses<R, LANES>, usize),
        settings: &Settings<R>,
    ) {
        let mut room = [Vec3::ZERO; MAX_MOVABLE];
        let movable = self.weave.grid.movable();
        let nodes = &mut room[..movable];
        self.movable(poses, lane, nodes);
        let faces = &mut slab.faces[place * movable..][..movable];
        // What is back in the wind has no memory of faces, whenever its tile gave its slab back.
        let age = self.now - slab.touched_at[place];
        if is_back(age, self.fading.step_over_t.to_f32()) {
            faces.fill(0);
        }
        let board = &self.billboards[place];
        let quad = self.quad(place, self.wind);
        let moment = Moment {
            touches: self.touches,
            share: R::ZERO,
            cover_m: settings.cover_m,
        };
        let lane = Lane {
            quad,
            ground: self.ground(),
            ground_top_m: self.ground_top_m,
            bodies: Bodies::at(moment, quad.root, board.reach_m()),
        };
        batch.add(lane, nodes, faces);
    }

    fn store(&self, place: usize, lane: usize, slab: &mut Slab<R>, batch: &Batch<'a, R, LANES>) {
        let grid = self.weave.grid;
        let first = place * grid.movable();
        batch.lanes[lane].quad.nodes(grid, |node, rest| {
            if node >= grid.columns {
                let n = node - grid.columns;
                slab.offsets[first + n] = batch.nodes.get(node, lane) - rest;
                slab.faces[first + n] = batch.faces[n][lane];
            }
        });
        slab.touched_at[place] = self.now;
    }
}

impl Responded {
    fn add<R: Real>(&mut self, outcome: &Outcome<R>) {
        let Outcome {
            rounds,
            strain,
            reset,
            replaced,
            clamped,
        } = *outcome;
        self.touched += 1;
        self.rounds = self.rounds.max(rounds);
        self.strain = self.strain.max(strain.to_f64());
        self.reset += u64::from(reset);
        self.replaced += u64::from(replaced);
        self.clamped |= clamped;
    }
}
