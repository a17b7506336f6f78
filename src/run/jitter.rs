//! Restlessness: how far plants move although nothing gives them a reason to.

use std::collections::BTreeMap;

use crate::base::{Pose, Vec3};
use crate::field::TileId;
use crate::gpu::GpuError;
use crate::sim::Meadow;

use super::engine::Engine;

/// Nodes of held plants and billboards by tile and order in it.
type Held = BTreeMap<(TileId, Layer, usize), Vec<Vec3<f64>>>;

#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
enum Layer {
    Plants,
    Billboards,
}

/// Follows the plants that a body holds, from frame to frame, while no wind blows and every body
/// stands still.
#[derive(Clone, Debug, Default)]
pub struct Jitter {
    /// Poses of all bodies at the end of the last frame.
    bodies: Vec<Pose<f64>>,
    /// Nodes of the held plants at the end of the last frame.
    held: Held,
    /// Tick since which nothing has moved.
    still_since: Option<u32>,
    largest_m: Option<f64>,
}

/// Time that plants have to settle after the last body stopped, in seconds.
const SETTLING_S: f64 = 1.0;

impl Jitter {
    /// Takes in the state at the end of a frame.
    ///
    /// # Errors
    ///
    /// The engine's.
    pub fn frame(&mut self, meadow: &Meadow, engine: &mut Engine) -> Result<(), GpuError> {
        let bodies: Vec<Pose<f64>> = meadow.bodies.links().iter().map(|link| link.to).collect();
        let still = !bodies.is_empty() && bodies == self.bodies && is_calm(meadow);
        self.bodies = bodies;
        if !still {
            self.held.clear();
            self.still_since = None;
            return Ok(());
        }
        let since = *self.still_since.get_or_insert(meadow.ticks);
        if f64::from(meadow.ticks - since) * meadow.scene.solver.substep_s < SETTLING_S {
            return Ok(());
        }
        let held = held_plants(meadow, engine)?;
        let seen_before = (held.iter()).filter_map(|(key, now)| Some((now, self.held.get(key)?)));
        let moved_m = seen_before
            .flat_map(|(now, before)| now.iter().zip(before))
            .map(|(now, before)| (*now - *before).length())
            .reduce(f64::max);
        self.largest_m = self.largest_m.into_iter().chain(moved_m).reduce(f64::max);
        self.held = held;
        Ok(())
    }

    /// Largest move of a node in one frame, in metres; `None` where no frame was still.
    pub fn largest_m(&self) -> Option<f64> {
        self.largest_m
    }
}

fn is_calm(meadow: &Meadow) -> bool {
    let wind = &meadow.work.wind;
    wind.strength == 0.0 && wind.gust == 0.0 && wind.flutter == 0.0
}

/// Nodes of the plants that were pushed in the last sub-step. One that was let go moves by right.
fn held_plants(meadow: &Meadow, engine: &mut Engine) -> Result<Held, GpuError> {
    let mut held = Held::new();
    let colliding = meadow.work.tiles.iter();
    for tile in colliding.filter(|tile| !tile.contacts.is_empty()) {
        for (order, plant) in engine.standing(meadow, tile)?.into_iter().enumerate() {
            if plant.touched_at == meadow.work.now {
                held.insert((tile.tile, Layer::Plants, order), plant.nodes);
            }
        }
        let billboards = engine.standing_billboards(meadow, tile)?.into_iter();
        for (order, billboard) in billboards.enumerate() {
            if billboard.touched_at == meadow.work.now {
                held.insert((tile.tile, Layer::Billboards, order), billboard.nodes);
            }
        }
    }
    Ok(held)
}

#[cfg(test)]
mod tests {
    use crate::run::{Device, RunOptions, run_scene};
    use crate::scene::parse_scene;

    /// Runs a box that lies fixed in the grass.
    fn jitter_m(wind: &str) -> Option<f64> {
        let text = format!(
            "(duration_s: 1.5, terrain: (ground: Flat(size_m: (2, 2))), wind: {wind}, bodies: [
                (name: \"box\", shape: Box(size_m: (0.3, 0.2, 0.3)), position_m: (0, 0.1, 0),
                 motion: Fixed)])"
        );
        let loaded = parse_scene("box", &text, &[]).expect("a sound scene");
        let options = RunOptions::default();
        let outcome = run_scene(&loaded, &options, &Device::Processor, |_| {}).expect("a run");
        outcome.watch.jitter.largest_m()
    }

    #[test]
    fn held_plants_keep_still_in_calm_air_and_wind_is_not_jitter() {
        let largest = jitter_m("(strength: 0, gust: 0, flutter: 0)").expect("still frames");
        // What the hard case `rest` asks for.
        assert!(largest <= 1e-5, "{largest} m");
        assert_eq!(jitter_m("(strength: 0.1)"), None);
    }
}
