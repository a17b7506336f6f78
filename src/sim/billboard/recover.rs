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

use super::grid::Side;
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
    /// Nodes before their lengths are restored.
    blended: Lanes<R, L>,
    pulled: Lanes<R, L>,
}

impl<R: Real, const L: usize> Poses<R, L> {
    pub fn new(weave: &Weave) -> Self {
        let lanes = || Lanes::new(weave.grid.nodes());
        Self {
            nodes: lanes(),
            rest: Rest::default(),
            blended: lanes(),
            pulled: lanes(),
        }
    }

    /// The nodes of up to `L` billboards, each in its lane.
    pub fn recover<'f>(
        &mut self,
        weave: &Weave,
        fades: impl IntoIterator<Item = &'f Fade<'f, R>> + Clone,
        fading: &Fading<R>,
    ) {
        let mut lengths = false;
        let mut restored = [false; L];
        let each = || fades.clone().into_iter().enumerate().take(L);
        for (l, fade) in each() {
            let left = offset_left(fade.age, fading.step_over_t);
            self.blend(weave, l, fade, share_of(left, fading.recovery));
            restored[l] = fade.age > 0 && left > R::ZERO && keeps_lengths(fading.recovery);
            lengths |= restored[l];
        }
        if !lengths {
            return;
        }
        let mut quads = [None; L];
        for (l, fade) in each() {
            quads[l] = Some(fade.quad);
            let lengths = fade.quad.rest_lengths(weave.grid);
            for (side, length) in lengths.into_iter().enumerate() {
                self.rest.set(side, l, length);
            }
        }
        self.blended.copy_all(&self.nodes);
        let (rest, nodes) = (&self.rest, &mut self.nodes);
        restore_lengths(weave, rest, &self.blended, nodes, &quads);
        let half = R::of(0.5);
        let pull = Pull {
            shape: half,
            bend: R::ZERO,
        };
        for _ in 0..PASSES {
            pass(weave, rest, pull, nodes);
            self.pulled.copy_all(nodes);
            restore_lengths(weave, rest, &self.pulled, nodes, &quads);
        }
        // Those that need none have their own pose.
        for l in (0..L).filter(|&l| !restored[l]) {
            nodes.copy_lane(l, &self.blended);
        }
    }

    /// w + t³ d₀.
    fn blend(&mut self, weave: &Weave, l: usize, fade: &Fade<R>, share: R) {
        let grid = weave.grid;
        let nodes = &mut self.nodes;
        fade.quad.nodes(grid, |node, place| {
            let moved = if node >= grid.columns && share > R::ZERO {
                place + fade.offsets[node - grid.columns] * share
            } else {
                place
            };
            nodes.set(node, l, moved);
        });
    }
}

/// Gives the segments of every column their rest length, keeping the directions that they have in
/// `blended`. One that was turned right over takes the side that the quad faces.
fn restore_lengths<R: Real, const L: usize>(
    weave: &Weave,
    rest: &Rest<R, L>,
    blended: &Lanes<R, L>,
    nodes: &mut Lanes<R, L>,
    quads: &[Option<Quad<R>>; L],
) {
    let columns = weave.grid.columns;
    let column_m = &rest.length[Side::Column as usize];
    for node in columns..weave.grid.nodes() {
        let below = node - columns;
        let (ax, ay, az) = (&blended.x[below], &blended.y[below], &blended.z[below]);
        let (bx, by, bz) = (&blended.x[node], &blended.y[node], &blended.z[node]);
        let (fx, fy, fz) = (nodes.x[below], nodes.y[below], nodes.z[below]);
        let (tx, ty, tz) = (&mut nodes.x[node], &mut nodes.y[node], &mut nodes.z[node]);
        let mut over = [R::ZERO; L];
        for l in 0..L {
            let (x, y, z) = (bx[l] - ax[l], by[l] - ay[l], bz[l] - az[l]);
            let square = x * x + y * y + z * z;
            let scale = column_m[l] / square.sqrt();
            tx[l] = fx[l] + x * scale;
            ty[l] = fy[l] + y * scale;
            tz[l] = fz[l] + z * scale;
            over[l] = square - R::of(0.25) * column_m[l] * column_m[l];
        }
        for (l, quad) in quads.iter().enumerate() {
            let long = over[l] > R::ZERO;
            if let Some(quad) = quad.as_ref().filter(|_| !long) {
                let segment = blended.get(node, l) - blended.get(below, l);
                let end = nodes.get(below, l) + aside(quad, segment, column_m[l]);
                nodes.set(node, l, end);
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
