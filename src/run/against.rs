//! A run beside the reference engine: the same scene, tick by tick, and how far the poses differ.

use std::collections::{BTreeMap, BTreeSet};

use crate::base::statistics::quantile;
use crate::field::TileId;
use crate::gpu::{GpuError, TickError};
use crate::scene::Scene;
use crate::scene::assets::Assets;
use crate::sim::measure::Standing;
use crate::sim::{Meadow, MeadowError};

use super::engine::Engine;

/// A plant by its tile and number.
type PlantId = (TileId, u32);
type Plants = BTreeMap<PlantId, Standing<f64>>;

/// A plant leans if its tip is this far from the vertical over its root.
const LEANS_DEG: f64 = 30.0;
/// A plant stands on another side of a body if its tip is this far from the reference's, over the
/// plant's length: errors of a method are millimetres, the way around a body is a good part of a
/// blade.
const OTHER_SIDE: f64 = 0.25;

/// The reference beside a run, and what differed so far.
pub struct Against {
    meadow: Meadow,
    engine: Engine,
    /// Plants that ever were on another side.
    flipped: BTreeSet<PlantId>,
    touched: BTreeSet<PlantId>,
    /// Mean squared distance of the nodes of a plant at a frame, for plants on the same side.
    squares_m2: Vec<f64>,
    /// Plants that lean in both, and in either, summed over frames.
    lean_both: u64,
    lean_either: u64,
}

/// What a comparison came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Difference {
    /// Over touched plants on the same side of the bodies, all frames.
    pub pose_rms_m: f64,
    pub pose_p95_m: f64,
    /// Overlap of the plants that lean more than 30°; `None` where none ever leaned.
    pub imprint_iou: Option<f64>,
    /// Plants that ever were on another side of a body than in the reference.
    pub side_flips: u64,
    pub touched_plants: u64,
    /// World x and z of their roots.
    pub flipped_roots_m: Vec<[f64; 2]>,
}

impl Against {
    /// Lays the scene out once more for the reference engine.
    ///
    /// # Errors
    ///
    /// As for [`Meadow::new`].
    pub fn new(scene: Scene, assets: &Assets) -> Result<Self, MeadowError> {
        let mut meadow = Meadow::new(scene, assets)?;
        Ok(Self {
            engine: Engine::reference(&mut meadow),
            meadow,
            flipped: BTreeSet::new(),
            touched: BTreeSet::new(),
            squares_m2: Vec::new(),
            lean_both: 0,
            lean_either: 0,
        })
    }

    /// Advances the reference to the time of a meadow: by one sub-step where both have the same.
    ///
    /// # Errors
    ///
    /// The script's.
    pub fn catch_up(&mut self, time_s: f64) -> Result<(), TickError> {
        // A thousandth of a sub-step forgives the rounding of two ways to count time.
        let step_s = self.meadow.scene.solver.substep_s;
        while self.meadow.time_s() + 0.999 * step_s < time_s {
            self.engine.tick(&mut self.meadow)?;
        }
        Ok(())
    }

    /// Compares both at the end of a frame.
    ///
    /// # Errors
    ///
    /// The engine's.
    pub fn frame(&mut self, meadow: &Meadow, engine: &mut Engine) -> Result<(), GpuError> {
        let active = |meadow: &Meadow| -> BTreeSet<TileId> {
            meadow.work.tiles.iter().map(|tile| tile.tile).collect()
        };
        for tile in &active(meadow) | &active(&self.meadow) {
            let ours = plants_of(meadow, engine, tile)?;
            let theirs = plants_of(&self.meadow, &mut self.engine, tile)?;
            self.compare(&ours, &theirs);
        }
        Ok(())
    }

    fn compare(&mut self, ours: &Plants, theirs: &Plants) {
        for (&id, truth) in theirs {
            let Some(plant) = ours.get(&id) else {
                continue;
            };
            if plant.touched_at == 0 && truth.touched_at == 0 {
                continue;
            }
            self.touched.insert(id);
            let leans = [plant, truth].map(|p| p.lean_rad() > LEANS_DEG.to_radians());
            self.lean_both += u64::from(leans == [true, true]);
            self.lean_either += u64::from(leans != [false, false]);
            let Some(distances) = distances_m(plant, truth) else {
                continue;
            };
            let tip_m = distances.last().copied().unwrap_or(0.0);
            if tip_m > OTHER_SIDE * f64::from(truth.plant.height_m) {
                self.flipped.insert(id);
            } else {
                let sum: f64 = distances.iter().map(|d| d * d).sum();
                self.squares_m2.push(sum / distances.len() as f64);
            }
        }
    }

    /// What differed over all frames.
    pub fn finish(&self) -> Difference {
        let mean = self.squares_m2.iter().sum::<f64>() / self.squares_m2.len().max(1) as f64;
        let roots: Vec<f64> = self.squares_m2.iter().map(|s| s.sqrt()).collect();
        let overlap = || self.lean_both as f64 / self.lean_either as f64;
        Difference {
            pose_rms_m: mean.sqrt(),
            pose_p95_m: quantile(&roots, 0.95).unwrap_or(0.0),
            imprint_iou: (self.lean_either > 0).then(overlap),
            side_flips: self.flipped.len() as u64,
            touched_plants: self.touched.len() as u64,
            flipped_roots_m: self
                .flipped
                .iter()
                .filter_map(|&id| self.root_m(id))
                .collect(),
        }
    }

    fn root_m(&self, (tile, place): PlantId) -> Option<[f64; 2]> {
        let field = &self.meadow.field;
        let anchor = field.grid.anchor_of(tile, &field.ground);
        let origin = field.grid.anchor_in_world(&anchor, &field.ground);
        let [x, _, z] = field.plant(&anchor, tile, place)?.root_in_anchor;
        Some([origin[0] + f64::from(x), origin[2] + f64::from(z)])
    }
}

/// Distances of the nodes of a plant in both runs; `None` where they have not as many.
fn distances_m(plant: &Standing<f64>, truth: &Standing<f64>) -> Option<Vec<f64>> {
    let same = plant.nodes.len() == truth.nodes.len();
    let pairs = plant.nodes.iter().zip(&truth.nodes).skip(1);
    same.then(|| pairs.map(|(a, b)| (*a - *b).length()).collect())
}

/// Plants of a tile, awake or not.
fn plants_of(meadow: &Meadow, engine: &mut Engine, tile: TileId) -> Result<Plants, GpuError> {
    let plants = engine.of_tile(meadow, tile)?.into_iter();
    Ok(plants.map(|plant| ((tile, plant.place), plant)).collect())
}
