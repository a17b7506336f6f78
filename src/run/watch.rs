//! What is gathered over a run: the metrics of every frame, folded together.

use crate::base::statistics::quantile;
use crate::sim::Meadow;
use crate::sim::measure::{Depth, Snapshot};

use super::engine::Engine;

/// Metrics of a run so far.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    depths_m: Vec<f64>,
    pushed_nodes: u64,
    pub worst: Depth,
    pub pinched: u64,
    pub over_push_m: f64,
    pub max_strain: f64,
    pub max_offset_m: f64,
    pub not_finite: u64,
    /// Last time at which a tile was active, in seconds; `None` if none ever was.
    pub last_active_s: Option<f64>,
    recovery: Option<Recovery>,
}

/// The tip of one released plant, followed until it is back.
#[derive(Clone, Copy, Debug)]
struct Recovery {
    place_m: [f64; 2],
    released_at: u32,
    tip_m: f64,
    /// Times after release at which a half, a tenth and a hundredth of the tip's offset were left.
    passed_s: [Option<f64>; 3],
}

/// Shares of the offset whose times are told.
const SHARES: [f64; 3] = [0.5, 0.1, 0.01];
/// Offsets of the tip worth following, in metres.
const WORTH_M: f64 = 0.05;
/// Two roots closer than this are one plant, in metres.
const SAME_ROOT_M: f64 = 1e-6;

impl Watch {
    /// Takes in the state at the end of a frame.
    pub fn frame(&mut self, meadow: &Meadow, engine: &mut Engine) {
        if !meadow.tiles.is_empty() {
            self.last_active_s = Some(meadow.time_s());
        }
        let snapshot = engine.snapshot(meadow);
        self.fold(&snapshot);
        self.follow_release(meadow, engine);
    }

    fn fold(&mut self, frame: &Snapshot) {
        self.depths_m.extend(&frame.depths_m);
        self.pushed_nodes += frame.pushed_nodes;
        if frame.worst.depth_m / frame.worst.limit_m > self.worst.depth_m / self.worst.limit_m {
            self.worst = frame.worst;
        }
        self.pinched += frame.pinched;
        self.over_push_m = self.over_push_m.max(frame.over_push_m);
        self.max_strain = self.max_strain.max(frame.max_strain);
        self.max_offset_m = self.max_offset_m.max(frame.max_offset_m);
        self.not_finite += frame.not_finite;
    }

    /// Follows the first plant seen released with a fair offset of its tip.
    fn follow_release(&mut self, meadow: &Meadow, engine: &mut Engine) {
        let now = meadow.ticks;
        let tip = |plant: &crate::sim::measure::Standing<f32>| {
            let (a, b) = (plant.nodes.last(), plant.wind.last());
            a.zip(b).map_or(0.0, |(a, b)| f64::from((*a - *b).length()))
        };
        if let Some(recovery) = &mut self.recovery {
            if recovery.passed_s[2].is_some() {
                return;
            }
            let plants = engine.near(meadow, recovery.place_m, SAME_ROOT_M);
            let Some(plant) = plants.first() else {
                return;
            };
            if plant.touched_at > recovery.released_at {
                // Touched again: the following starts over with some other plant.
                self.recovery = None;
                return;
            }
            let left = tip(plant) / recovery.tip_m;
            let since = f64::from(now - recovery.released_at) * meadow.scene.solver.substep_s;
            for (passed, share) in recovery.passed_s.iter_mut().zip(SHARES) {
                if passed.is_none() && left <= share {
                    *passed = Some(since);
                }
            }
            return;
        }
        let Some(place_m) = meadow.work.tiles.iter().find_map(|tile| {
            let recovering = tile.contacts.is_empty();
            let [low, high] = meadow
                .field
                .grid
                .tile_bounds(tile.tile, &meadow.field.ground);
            recovering.then(|| [0, 1].map(|a| 0.5 * (low[a] + high[a])))
        }) else {
            return;
        };
        let half = 0.5 * f64::from(meadow.field.grid.tile_m());
        let plants = engine.near(meadow, place_m, half);
        let released = plants.iter().find(|plant| {
            // Within a frame of the release the tip still is where the contact left it.
            plant.touched_at > 0 && plant.touched_at < now && tip(plant) > WORTH_M
        });
        self.recovery = released.map(|plant| Recovery {
            place_m: plant.root_in_world(),
            released_at: plant.touched_at,
            tip_m: tip_at_release(plant, now, meadow),
            passed_s: [None; 3],
        });
    }

    /// Times after release at which a half, a tenth and a hundredth of the followed tip's offset
    /// were left, in seconds.
    pub fn recovery_s(&self) -> [Option<f64>; 3] {
        self.recovery.map_or([None; 3], |r| r.passed_s)
    }

    /// Largest depth inside a true shape, in metres.
    pub fn max_penetration_m(&self) -> f64 {
        self.depths_m.iter().copied().fold(0.0, f64::max)
    }

    /// The depth that 99.9% of the pushed nodes do not exceed, in metres; nodes outside count
    /// as 0.
    pub fn p999_penetration_m(&self) -> f64 {
        let nodes = self.pushed_nodes as f64;
        let inside = self.depths_m.len() as f64;
        if inside <= 1e-3 * nodes {
            return 0.0;
        }
        // The quantile among all nodes, of which only the ones inside are kept.
        quantile(&self.depths_m, 1.0 - 1e-3 * nodes / inside).unwrap_or(0.0)
    }

    /// Root mean square depth over all pushed nodes, in metres.
    pub fn rms_penetration_m(&self) -> f64 {
        let squares: f64 = self.depths_m.iter().map(|d| d * d).sum();
        (squares / (self.pushed_nodes.max(1)) as f64).sqrt()
    }
}

/// The tip's offset at release, from what is left of it now.
fn tip_at_release(plant: &crate::sim::measure::Standing<f32>, now: u32, meadow: &Meadow) -> f64 {
    let (Some(a), Some(b)) = (plant.nodes.last(), plant.wind.last()) else {
        return 0.0;
    };
    let left = crate::sim::recover::offset_left(now - plant.touched_at, meadow.step_over_t());
    f64::from((*a - *b).length()) / left.max(1e-3)
}
