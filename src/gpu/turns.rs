//! How many sweeps of a sub-step one dispatch runs; the rest are left to the next ones.
//!
//! A body that is fast, thin or let down from above takes hundreds of sweeps. Software drivers end
//! long loops without a word: llvmpipe stops all loops of an invocation once they have gone round
//! 65,535 times together. Hardware drivers take the device away from a dispatch that runs for
//! seconds. So collide and relax run in turns of as many sweeps as stay below that, counted with
//! the most rounds. Kernels that find their loops cut short all the same say so:
//! [`Counts::cut_short`](super::Counts::cut_short), which is read with the state, and late by a window. Shader: `shaders/turns.wgsl`.

use super::passes::{Access, Groups, Kernel, Recording};
use super::{Buffer, Gpu, GpuError};
use crate::sim::Meadow;
use crate::sim::billboard::Weave;
use crate::sim::billboard::relax::{FINENESS, Settings};
use crate::sim::fault::Fault;
use crate::sim::parts::Tested;
use crate::sim::relax::{LOOKS, SPRING_TRIES};
use crate::sim::work::Contact;

/// Most times that all loops of a dispatch together go round: less than half the driver's limit, since
/// the count leaves out what drivers add (blades of 16 segments were cut short below 60,000), and the
/// loops before and after the sweeps.
const MOST_LOOPS: u64 = 30_000;
/// Loops of a depth cube's test: six faces, and four texels for each; the check that ends a loop counts
/// as a round.
const CUBE_LOOPS: u64 = 7 + 6 * 5;
/// Loops of the test that a part does not take: lanes that are masked off go once around each.
const OTHER_LOOPS: u64 = 6;
/// Loops of the second look at a depth cube, where a way out ends; once around for a part without one.
const NEARER_LOOPS: u64 = 5;
/// Loops of the look at a body's other parts where it has none: its only part, the check that ends it, and
/// the test inside, which is masked off.
const LONE_LOOPS: u64 = 3;
/// Loops over the segments in a round of relax, besides those that meet bodies.
const LOOPS_OVER_SEGMENTS: u64 = 3;

/// Dispatches of one pass in a sub-step.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Turns {
    /// Sweeps of each, the last one excepted, which has what is left.
    pub sweeps: u32,
    pub count: u32,
}

/// Turns of the passes of a sub-step.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct PassTurns {
    pub collide: Turns,
    pub relax: Turns,
}

/// Turns of the billboards' passes of a sub-step; those of relax are of rounds instead of sweeps, since a
/// sweep of a fine grid by itself may be too long.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct BillboardTurns {
    pub collide: Turns,
    pub relax: Turns,
}

/// Neighbours of a node of a billboard that a pass over its springs asks about.
const EARLIER_LOOPS: u64 = 7;

impl PassTurns {
    /// Those of the meadow's current sub-step.
    pub fn new(meadow: &Meadow) -> Self {
        let solver = &meadow.scene.solver;
        let sweeps = most_sweeps(meadow);
        let per_test = loops_per_node(meadow, |contacts| {
            contacts
                .iter()
                .map(|contact| test_loops(meadow, contact))
                .sum()
        });
        let per_exit = loops_per_node(meadow, |contacts| exit_loops(meadow, contacts));
        let segments = u64::from(solver.segments);
        // The push, the springs' tries, and the rounds.
        let rounds = u64::from(solver.rounds[1] + SPRING_TRIES) + 2;
        if meadow.planted.is(Fault::OneTurn) {
            return Self {
                collide: Turns::new(sweeps, 1),
                relax: Turns::new(sweeps, 1),
            };
        }
        Self {
            collide: Turns::new(sweeps, segments * per_test),
            relax: Turns::new(sweeps, rounds * segments * (per_exit + LOOPS_OVER_SEGMENTS)),
        }
    }
}

impl BillboardTurns {
    /// Those of the meadow's current sub-step.
    pub fn new(meadow: &Meadow, weave: &Weave, settings: &Settings<f32>) -> Self {
        let sweeps = most_sweeps(meadow).saturating_mul(FINENESS);
        let per_test = loops_per_node(meadow, |contacts| {
            let tests = contacts.iter();
            tests.map(|contact| test_loops(meadow, contact)).sum()
        });
        let per_exit = loops_per_node(meadow, |contacts| exit_loops(meadow, contacts));
        let nodes = weave.grid.nodes() as u64;
        let passes = u64::from(settings.passes);
        // Measured three times, pulled, and pulled otherwise where that raised the energy.
        let springs = (passes + 3) * (EARLIER_LOOPS + 1) + passes * (2 * EARLIER_LOOPS + 1);
        // Of every sweep the push, and then its rounds.
        let rounds = sweeps.saturating_mul(settings.most_rounds + 1);
        Self {
            collide: Turns::new(sweeps, nodes * (per_test + 1)),
            relax: Turns::new(rounds, nodes * (per_exit + springs)),
        }
    }
}

impl Turns {
    /// Turns for `sweeps` sweeps that take `loops` loops each.
    fn new(sweeps: u32, loops: u64) -> Self {
        let sweeps = sweeps.max(1);
        let at_once = (MOST_LOOPS / loops.max(1)).clamp(1, u64::from(sweeps)) as u32;
        Self {
            sweeps: at_once,
            count: sweeps.div_ceil(at_once),
        }
    }
}

fn most_sweeps(meadow: &Meadow) -> u32 {
    let contacts = meadow.work.contacts.iter();
    contacts.map(|contact| contact.sweeps).max().unwrap_or(0)
}

/// Loops that a node takes for all parts near its tile, where they are most.
fn loops_per_node(meadow: &Meadow, of_tile: impl Fn(&[Contact]) -> u64) -> u64 {
    let tiles = meadow.work.tiles.iter();
    let loops = tiles.map(|tile| of_tile(meadow.work.contacts_of(tile)));
    loops.max().unwrap_or(0)
}

/// Loops that tell whether a node is in a part.
fn test_loops(meadow: &Meadow, contact: &Contact) -> u64 {
    match contact.tested {
        Tested::Cube => CUBE_LOOPS + OTHER_LOOPS,
        _ => features(meadow, contact) + 1 + OTHER_LOOPS,
    }
}

fn features(meadow: &Meadow, contact: &Contact) -> u64 {
    let part = &meadow.parts.parts[contact.part as usize];
    u64::from(part.grown.feature_count())
}

/// Loops that look for a node's way out of the parts near a tile: the end of each way out of a closed
/// form is looked for in the body's other parts, and all parts but one are asked again where that one
/// has turned a segment.
fn exit_loops(meadow: &Meadow, contacts: &[Contact]) -> u64 {
    let of_part = |(number, contact): (usize, &Contact)| {
        let first = number - contact.part_in_body as usize;
        let body = &contacts[first..first + contact.parts_of_body as usize];
        let others: u64 = body.iter().map(|other| 2 + features(meadow, other)).sum();
        let covered = match contact.tested {
            Tested::Cube => 0,
            _ if body.len() == 1 => features(meadow, contact) * LONE_LOOPS,
            _ => features(meadow, contact) * (1 + others),
        };
        test_loops(meadow, contact) + NEARER_LOOPS + covered
    };
    let looks = if contacts.len() > 1 { LOOKS } else { 1 };
    let once: u64 = contacts.iter().enumerate().map(of_part).sum();
    once * looks as u64
}

/// The kernel that goes on to the next turn.
#[derive(Clone, Debug)]
pub struct TurnsPass {
    next_turn: Kernel,
}

impl TurnsPass {
    /// # Errors
    /// The shader's.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let bindings = [(4, Access::Write)];
        Ok(Self {
            next_turn: Kernel::new(gpu, "turns.wgsl", "next_turn", &bindings, 1)?,
        })
    }

    /// Records a pass once per turn.
    pub fn record(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        touched: &Buffer<u32>,
        turns: Turns,
        mut pass: impl FnMut(&mut Recording<'_>),
    ) {
        into.encoder.clear_buffer(&touched.raw, 8, Some(4));
        pass(into);
        if turns.count == 1 {
            return;
        }
        let bound = self.next_turn.bind(gpu, &[(4, &touched.raw)]);
        for _ in 1..turns.count {
            self.next_turn
                .record(into, &bound, Groups::Direct([1, 1, 1]));
            pass(into);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_cover_every_sweep_and_stay_below_the_limit() {
        for (sweeps, loops) in [(0, 0), (1, 10), (1024, 616), (1024, 30_000), (7, 90_000)] {
            let turns = Turns::new(sweeps, loops);
            let covered = u64::from(turns.sweeps) * u64::from(turns.count);
            assert!(covered >= u64::from(sweeps.max(1)), "{turns:?}");
            assert!(covered - u64::from(turns.sweeps) < u64::from(sweeps.max(1)));
            let at_once = u64::from(turns.sweeps) * loops;
            assert!(at_once <= MOST_LOOPS || turns.sweeps == 1, "{turns:?}");
        }
    }
}
