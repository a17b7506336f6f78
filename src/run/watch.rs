//! What is gathered over a run: the metrics of every frame, folded together.

use std::collections::BTreeMap;

use crate::base::most;
use crate::base::statistics::quantile;
use crate::gpu::GpuError;
use crate::sim::Meadow;
use crate::sim::measure::{Depth, Snapshot};

use super::engine::Engine;
use super::jitter::Jitter;
use super::release::Release;

/// Metrics of a run so far.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    depths_m: Vec<f64>,
    pushed_nodes: u64,
    pub worst: Depth,
    pub pinched: u64,
    /// Most plants at the end of a frame whose root lay inside a body.
    pub buried: u64,
    pub over_push_m: f64,
    /// Largest depth of a node of a plant that no body pushed or held, in metres.
    pub missed_m: f64,
    /// Largest depth of the middle of a segment whose ends are outside, in metres.
    pub max_middle_m: f64,
    pub max_strain: f64,
    pub max_offset_m: f64,
    pub not_finite: u64,
    /// Last time at which a tile was active, in seconds; `None` if none ever was.
    pub last_active_s: Option<f64>,
    /// Per body that was ever there: how many of its parts were tested by cube and how many by
    /// closed form.
    pub colliders: BTreeMap<String, (u32, u32)>,
    /// The last frame alone.
    pub last: Snapshot,
    pub release: Release,
    pub jitter: Jitter,
}

impl Watch {
    /// Takes in the state at the end of a frame.
    ///
    /// # Errors
    ///
    /// The engine's.
    pub fn frame(&mut self, meadow: &Meadow, engine: &mut Engine) -> Result<(), GpuError> {
        if !meadow.tiles.is_empty() {
            self.last_active_s = Some(meadow.time_s());
        }
        let bodies = meadow.colliders().into_iter();
        self.colliders
            .extend(bodies.map(|(body, cube, analytic)| (body, (cube, analytic))));
        let snapshot = engine.snapshot(meadow)?;
        self.fold(&snapshot);
        self.last = snapshot;
        self.jitter.frame(meadow, engine)?;
        self.release.frame(meadow, engine)
    }

    fn fold(&mut self, frame: &Snapshot) {
        self.depths_m.extend(&frame.depths_m);
        self.pushed_nodes += frame.pushed_nodes;
        self.missed_m = most(self.missed_m, frame.missed_m);
        if frame.worst.depth_m / frame.worst.limit_m > self.worst.depth_m / self.worst.limit_m {
            self.worst = frame.worst;
        }
        self.pinched += frame.pinched;
        self.buried = self.buried.max(frame.buried);
        self.over_push_m = self.over_push_m.max(frame.over_push_m);
        let deepest = frame.middle_depths_m.iter().copied().fold(0.0, f64::max);
        self.max_middle_m = self.max_middle_m.max(deepest);
        self.max_strain = self.max_strain.max(frame.max_strain);
        self.max_offset_m = self.max_offset_m.max(frame.max_offset_m);
        self.not_finite += frame.not_finite;
    }

    /// Largest depth inside a true shape, in metres.
    pub fn max_penetration_m(&self) -> f64 {
        self.depths_m.iter().copied().fold(0.0, f64::max)
    }

    /// The depth that 99.9% of the pushed nodes do not exceed, in metres; nodes outside count
    /// as 0. Nodes of plants that were missed count with their depth, so that it is never too small.
    pub fn p999_penetration_m(&self) -> f64 {
        let nodes = self.pushed_nodes as f64;
        let inside = self.depths_m.len() as f64;
        if inside <= 1e-3 * nodes {
            return 0.0;
        }
        // The quantile among all nodes, of which only the ones inside are kept.
        quantile(&self.depths_m, 1.0 - 1e-3 * nodes / inside).unwrap_or(0.0)
    }

    /// Root mean square depth over all nodes of plants pushed or held, in metres.
    pub fn rms_penetration_m(&self) -> f64 {
        // The sum of nothing is −0, which would be printed.
        let squares = self.depths_m.iter().fold(0.0, |sum, d| sum + d * d);
        (squares / (self.pushed_nodes.max(1)) as f64).sqrt()
    }
}
