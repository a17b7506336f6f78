//! Collide: which billboards of a tile a body touches in this sub-step (O09 section 5.2). Twin:
//! `shaders/billboard/collide.wgsl`.

use crate::base::{Real, Vec3};
use crate::sim::collide::{self, MAX_MOVABLE, Movable};
use crate::sim::relax::sweeps_for;
use crate::sim::slab::Slab;

use super::recover::Poses;
use super::relax::FINENESS;
use super::tile::{LANES, Tile, Touched};

impl<R: Real> Tile<'_, R> {
    /// Billboards that a body touches or holds: bounding spheres first, then nodes (O09 section 5.2).
    pub fn touched(&self, slab: &Slab<R>, poses: &mut Poses<R, LANES>, found: &mut Vec<Touched>) {
        found.clear();
        for place in 0..self.billboards.len() {
            let board = &self.billboards[place];
            let (root, reach) = (board.root(), board.reach_m());
            let sweeps = sweeps_for(self.touches, root, reach).saturating_mul(FINENESS);
            if sweeps > 0 {
                let place = place as u32;
                found.push(Touched { place, sweeps });
            }
        }
        let near = std::mem::take(found);
        for near in near.chunks(LANES) {
            let mut places = [0; LANES];
            for (place, near) in places.iter_mut().zip(near) {
                *place = near.place;
            }
            self.before(slab, &places[..near.len()], poses);
            let is_touched = near.iter().enumerate();
            found.extend(is_touched.filter_map(|(lane, near)| self.meets(slab, poses, lane, near)));
        }
    }

    /// Whether a billboard in reach of a body, with its nodes in a lane, is pushed or held by it.
    fn meets(
        &self,
        slab: &Slab<R>,
        poses: &Poses<R, LANES>,
        lane: usize,
        near: &Touched,
    ) -> Option<Touched> {
        let place = near.place as usize;
        let mut room = [Vec3::ZERO; MAX_MOVABLE];
        let nodes = &mut room[..self.weave.grid.movable()];
        self.movable(poses, lane, nodes);
        let before = self.was_touched(slab, place);
        let ground = self.ground();
        let pinned = |p: Vec3<R>| {
            before
                && p.y < self.ground_top_m + R::of(collide::PINNED_M)
                && p.y - ground.below(p).y <= R::of(collide::PINNED_M)
        };
        let board = &self.billboards[place];
        let (root, reach) = (board.root(), board.reach_m());
        let movable = Movable { root, nodes };
        if collide::touched(movable, self.touches, near.sweeps, reach, pinned) {
            return Some(*near);
        }
        let stays = before
            && (collide::held(movable, self.touches, reach) || {
                let mut alone: Poses<R, 1> = Poses::new(self.weave);
                alone.recover(self.weave, [&self.fade(slab, place)], &self.fading);
                for (n, node) in nodes.iter_mut().enumerate() {
                    *node = alone.nodes.get(self.weave.grid.columns + n, 0);
                }
                collide::in_the_way(Movable { root, nodes }, self.touches, reach)
            });
        stays.then_some(Touched { sweeps: 0, ..*near })
    }
}
