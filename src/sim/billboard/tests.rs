//! Laws of one billboard and of batches of them. Run with `--nocapture` for the figures.

use crate::base::philox::philox2x32;
use crate::base::{Pose, Real, Vec3, vec3};
use crate::bodies::{ConvexPart, DrawMesh, RigidShape, Solid as PartSolid};
use crate::field::{Anchor, Billboard, WindNow};
use crate::scene::method::Recovery;
use crate::scene::{Solver, Wind};
use crate::sim::billboard::relax::Settings;
use crate::sim::billboard::tile::{Responded, Tile, Touched};
use crate::sim::contact::Touch;
use crate::sim::depth_cube::DepthCube;
use crate::sim::fault::Planted;
use crate::sim::parts::{Part, Parts, Tested};
use crate::sim::recover::Fading;
use crate::sim::slab::Slab;
use crate::sim::solid::Solid;
use crate::sim::work::Contact;
use crate::terrain::HeightGrid;

use super::batch::Lane;
use super::recover::{Fade, Poses};
use super::springs::Pull;
use super::*;

mod contacts;
mod neighbours;
mod shapes;
mod speed;

const ANCHOR: Anchor = Anchor {
    index: [0, 0],
    square: [8, 8],
    in_square: [0.0; 2],
    base_y: 0.0,
};

fn ground() -> HeightGrid {
    HeightGrid::flat(17, 17, 1.0)
}

fn billboard(width_m: f32, height_m: f32) -> Billboard {
    Billboard {
        root_in_anchor: [0.0; 3],
        across: [1.0, 0.0],
        up: [0.0, 1.0, 0.0],
        height_m,
        width_m,
        flexibility: 1.0,
        flutter_turns: 0.0,
        texture: 0,
        kind: 0,
    }
}

fn weave(columns: u32, rows: u32) -> Weave {
    Weave::new(Grid::new([columns, rows]).expect("a grid"), true)
}

fn pull<R: Real>(rate_step: f64) -> Pull<R> {
    let twice_a = R::of(2.0 * crate::sim::springs::step::rational(rate_step));
    Pull {
        shape: twice_a,
        bend: twice_a,
    }
}

/// All nodes of a quad's grid.
fn grid_of<R: Real>(quad: &Quad<R>, grid: Grid) -> Vec<Vec3<R>> {
    let mut nodes = Vec::new();
    quad.nodes(grid, |_, place| nodes.push(place));
    nodes
}

/// A number within ±1 for each index and seed.
fn chance(index: usize, seed: u32) -> f64 {
    let [word, _] = philox2x32([index as u32, seed], 7, 10);
    (f64::from(word) / f64::from(u32::MAX) - 0.5) * 2.0
}

/// A batch of billboards with their movable nodes moved by up to `size_m`, and no body near.
fn shaken<'a, R: Real, const L: usize>(
    weave: &'a Weave,
    ground: &'a HeightGrid,
    billboards: &[Billboard],
    seed: u32,
    size_m: f64,
) -> Batch<'a, R, L> {
    let mut batch = Batch::new(weave);
    for (b, billboard) in billboards.iter().enumerate() {
        let quad = Quad::bent(billboard, [R::of(0.2), R::of(-0.1)]);
        let grid = weave.grid;
        let rest = grid_of(&quad, grid);
        let movable: Vec<Vec3<R>> = (grid.columns..grid.nodes())
            .map(|node| {
                let draw = |axis| size_m * chance(3 * (node + 100 * b) + axis, seed);
                rest[node] + Vec3::of([draw(0), draw(1), draw(2)])
            })
            .collect();
        let moment = crate::sim::contact::Moment {
            touches: &[],
            share: R::ONE,
            cover_m: R::ZERO,
        };
        let lane = Lane {
            quad,
            ground: crate::sim::relax::Ground {
                heights: ground,
                anchor: &ANCHOR,
            },
            ground_top_m: R::of(-1e3),
            bodies: crate::sim::relax::Bodies::at(moment, quad.root, billboard.reach_m()),
        };
        batch.add(lane, &movable, &vec![0; grid.movable()]);
    }
    batch
}

impl<R: Real, const L: usize> Batch<'_, R, L> {
    /// Passes of the default springs, one by one. Returns the energy before and after each.
    fn passes(&mut self, pull: Pull<R>, passes: u32) -> Vec<[R; L]> {
        let mut energies = vec![springs::measure(self.weave, &self.rest, pull, &self.nodes).energy];
        for _ in 0..passes {
            let before = energies[energies.len() - 1];
            let [start, spare] = &mut self.spare;
            let (rest, nodes) = (&self.rest, &mut self.nodes);
            springs::relax(self.weave, rest, pull, 1, &before, nodes, [start, spare]);
            energies.push(springs::measure(self.weave, &self.rest, pull, &self.nodes).energy);
        }
        energies
    }

    fn strain(&self, lane: usize) -> f64 {
        springs::measure(self.weave, &self.rest, pull(1.0), &self.nodes).strain[lane].to_f64()
    }
}
