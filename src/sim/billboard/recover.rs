//! Recover: where a billboard is now, from its quad in the wind and the offsets of its last contact.
//!
//! v = lengths(w(now) + t³ d₀), as for blades and by the same weight (see
//! [`sim::recover`](crate::sim::recover)); O09 section 5.5 does not preserve lengths and says so. Here
//! every column gets its lengths back along its own directions, then the springs pull rows and diagonals
//! together once and the columns are laid out again: columns are exact, and rows as long as a surface
//! allows that is on its way from one shape to another. Without an offset left it is the quad's own
//! grid, bit for bit; in the tick of a contact it is the pose that the contact left.

use crate::base::{Real, Vec3};
use crate::scene::method::Recovery;
use crate::sim::recover::{ASIDE, Fading, offset_left};

use super::grid::{SIDES, Side};
use super::lanes::Lanes;
use super::springs::{Pull, Rest, pass};
use super::{Quad, Weave};

/// Passes over the springs before the columns are laid out for good.
pub const PASSES: u32 = 1;

/// A billboard whose pose is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Fade<'a, R> {
    /// In the wind of now.
    pub quad: Quad<R>,
    /// Offsets of its movable nodes at the last contact, in metres.
    pub offsets: &'a [Vec3<R>],
    /// Ticks since then.
    pub age: u32,
}

/// Room for the poses of `L` billboards.
#[derive(Clone, Debug)]
pub struct Poses<R, const L: usize> {
    pub nodes: Lanes<R, L>,
    rest: Rest<R, L>,
}

impl<R: Real, const L: usize> Poses<R, L> {
    pub fn new(weave: &Weave) -> Self {
        Self {
            nodes: Lanes::new(weave.grid.nodes()),
            rest: Rest::default(),
        }
    }

    /// The nodes of up to `L` billboards, each in its lane.
    pub fn recover(&mut self, weave: &Weave, fades: &[Fade<R>], fading: &Fading<R>) {
        let mut lengths = false;
        let mut restored = [false; L];
        for (l, fade) in fades.iter().enumerate().take(L) {
            let left = offset_left(fade.age, fading.step_over_t);
            self.blend(weave, l, fade, share_of(left, fading.recovery));
            restored[l] = fade.age > 0 && left > R::ZERO && keeps_lengths(fading.recovery);
            lengths |= restored[l];
        }
        if !lengths {
            return;
        }
        let mut quads = [None; L];
        for (l, fade) in fades.iter().enumerate().take(L) {
            quads[l] = Some(fade.quad);
            for side in 0..SIDES {
                let length = fade.quad.rest_length(weave.grid, Side::ALL[side]);
                self.rest.set(side, l, length);
            }
        }
        let blended = self.nodes.clone();
        self.restore_lengths(weave, &blended, &quads);
        let half = R::of(0.5);
        let pull = Pull {
            shape: half,
            bend: R::ZERO,
        };
        for _ in 0..PASSES {
            pass(weave, &self.rest, pull, &mut self.nodes);
            let pulled = self.nodes.clone();
            self.restore_lengths(weave, &pulled, &quads);
        }
        // Those that need none have their own pose.
        for l in (0..fades.len().min(L)).filter(|&l| !restored[l]) {
            self.nodes.copy_lane(l, &blended);
        }
    }

    /// w + t³ d₀.
    fn blend(&mut self, weave: &Weave, l: usize, fade: &Fade<R>, share: R) {
        let grid = weave.grid;
        for node in 0..grid.nodes() {
            let mut place = fade.quad.node(grid, node);
            if node >= grid.columns && share > R::ZERO {
                place += fade.offsets[node - grid.columns] * share;
            }
            self.nodes.set(node, l, place);
        }
    }

    /// Gives the segments of every column their rest length, keeping the directions that they have in
    /// `blended`. One that was turned right over takes the side that the quad faces.
    fn restore_lengths(
        &mut self,
        weave: &Weave,
        blended: &Lanes<R, L>,
        quads: &[Option<Quad<R>>; L],
    ) {
        let columns = weave.grid.columns;
        let column_m = self.rest.length[Side::Column as usize];
        for node in columns..weave.grid.nodes() {
            let below = node - columns;
            let mut lost = [false; L];
            for l in 0..L {
                let x = blended.x[node][l] - blended.x[below][l];
                let y = blended.y[node][l] - blended.y[below][l];
                let z = blended.z[node][l] - blended.z[below][l];
                let square = x * x + y * y + z * z;
                let scale = column_m[l] / square.sqrt();
                self.nodes.x[node][l] = self.nodes.x[below][l] + x * scale;
                self.nodes.y[node][l] = self.nodes.y[below][l] + y * scale;
                self.nodes.z[node][l] = self.nodes.z[below][l] + z * scale;
                lost[l] = !(square > R::of(0.25) * column_m[l] * column_m[l]);
            }
            for (l, quad) in quads.iter().enumerate().filter(|&(l, _)| lost[l]) {
                if let Some(quad) = quad {
                    let segment = blended.get(node, l) - blended.get(below, l);
                    let end = self.nodes.get(below, l) + aside(quad, segment, column_m[l]);
                    self.nodes.set(node, l, end);
                }
            }
        }
    }
}

/// A short segment at its rest length, along its own line or, where that is the line of the quad's
/// columns, to the side that the quad faces.
fn aside<R: Real>(quad: &Quad<R>, segment: Vec3<R>, length: R) -> Vec3<R> {
    let small = R::of(ASIDE) * length;
    let mut segment = segment;
    if segment.cross(quad.lean).length_squared() < small * small {
        segment += quad.normal() * small;
    }
    segment.unit_or(quad.lean) * length
}

fn keeps_lengths(recovery: Recovery) -> bool {
    matches!(recovery, Recovery::Lengths | Recovery::Angles)
}

/// The share of the stored offset that is read.
fn share_of<R: Real>(left: R, recovery: Recovery) -> R {
    match recovery {
        Recovery::Literal if left > R::ZERO => R::ONE,
        _ => left,
    }
}
