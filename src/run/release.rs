//! How fast a plant rises again: one that was let go is followed until it is back, and its pose
//! alone tells how much of its offset is left.

use crate::gpu::GpuError;
use crate::sim::Meadow;
use crate::sim::measure::Standing;
use crate::sim::weight::offset_weight;

use super::compare::{PlantId, touched_plants};
use super::engine::Engine;

/// Shares of the offset whose times are told.
const SHARES: [f64; 3] = [0.5, 0.1, 0.01];
/// A tip is worth following from this offset on, in metres.
const WORTH_M: f64 = 0.05;

/// Follows the first plant that is let go with a fair offset and not touched again.
///
/// What it was held at is read from the state in the frame of the contact: the wind pose and the
/// offset stored by then. From there on only its pose counts.
#[derive(Clone, Debug, Default)]
pub struct Release {
    followed: Option<Followed>,
    /// The plants that were touched in the last frame, as they were held.
    held: Vec<(PlantId, Standing<f64>)>,
    /// Ticks at the last frame.
    last_tick: u32,
}

#[derive(Clone, Debug)]
struct Followed {
    id: PlantId,
    /// As it stood at its last contact.
    held: Standing<f64>,
    weight: Passed,
    tip: Passed,
}

/// Seconds after release at which a half, a tenth and a hundredth were left.
pub type Passed = [Option<f64>; 3];

impl Release {
    /// Takes in the state at the end of a frame.
    ///
    /// # Errors
    ///
    /// The engine's.
    pub fn frame(&mut self, meadow: &Meadow, engine: &mut Engine) -> Result<(), GpuError> {
        if meadow.ticks == self.last_tick {
            // A plant that is held is not let go between two sub-steps.
            return Ok(());
        }
        match &mut self.followed {
            Some(followed) if followed.is_back() => {}
            Some(followed) => {
                if followed.is_touched_again(meadow, engine)? {
                    self.followed = None;
                }
            }
            None => self.look_for_one(meadow, engine)?,
        }
        self.last_tick = meadow.ticks;
        Ok(())
    }

    /// When the weight of the offset had fallen, measured from the pose of the plant.
    pub fn weight_s(&self) -> Passed {
        self.followed.as_ref().map_or([None; 3], |f| f.weight)
    }

    /// When the tip's distance from its wind pose had fallen, which goes faster where a bent blade
    /// keeps its length.
    pub fn tip_s(&self) -> Passed {
        self.followed.as_ref().map_or([None; 3], |f| f.tip)
    }

    /// Follows a plant that was touched in the last frame and not since.
    fn look_for_one(&mut self, meadow: &Meadow, engine: &mut Engine) -> Result<(), GpuError> {
        let plants = touched_plants(meadow, engine)?;
        for (id, held) in self.held.drain(..) {
            let now = plants.get(&id);
            if let Some(now) = now.filter(|now| now.touched_at == held.touched_at) {
                let mut followed = Followed::new(id, held);
                followed.take_in(meadow, now);
                self.followed = Some(followed);
                return Ok(());
            }
        }
        let touched = plants
            .into_iter()
            .filter(|(_, p)| p.touched_at > self.last_tick);
        let held = touched.map(|(id, plant)| (id, as_held(plant)));
        self.held = held.filter(|(_, plant)| tip_m(plant) > WORTH_M).collect();
        Ok(())
    }
}

impl Followed {
    fn new(id: PlantId, held: Standing<f64>) -> Self {
        Self {
            id,
            held,
            weight: [None; 3],
            tip: [None; 3],
        }
    }

    fn is_back(&self) -> bool {
        self.weight[2].is_some() && self.tip[2].is_some()
    }

    /// Notes what is left now, unless something has touched the plant.
    fn is_touched_again(&mut self, meadow: &Meadow, engine: &mut Engine) -> Result<bool, GpuError> {
        let (tile, place) = self.id;
        let plants = engine.of_tile(meadow, tile)?;
        let Some(now) = plants.iter().find(|plant| plant.place == place) else {
            return Ok(true);
        };
        // A tile that came to rest has given its ticks of contact back.
        let touched = now.touched_at > self.held.touched_at;
        if !touched {
            self.take_in(meadow, now);
        }
        Ok(touched)
    }

    /// Notes what is left now.
    fn take_in(&mut self, meadow: &Meadow, now: &Standing<f64>) {
        let age = meadow.ticks - self.held.touched_at;
        let since_s = f64::from(age) * meadow.scene.solver.substep_s;
        let recovery = meadow.scene.solver.method.recovery;
        if let Some(left) = offset_weight((&self.held).into(), now.into(), recovery) {
            note(&mut self.weight, left, since_s);
        }
        note(&mut self.tip, tip_m(now) / tip_m(&self.held), since_s);
    }
}

/// The plant with the nodes that its last contact left, beside the wind pose of now.
fn as_held(mut plant: Standing<f64>) -> Standing<f64> {
    let pairs = plant.wind.iter().skip(1).zip(&plant.offsets);
    let held = pairs.map(|(&wind, &offset)| wind + offset);
    plant.nodes.splice(1.., held.collect::<Vec<_>>());
    plant
}

fn note(passed: &mut Passed, left: f64, since_s: f64) {
    for (passed, share) in passed.iter_mut().zip(SHARES) {
        if passed.is_none() && left <= share {
            *passed = Some(since_s);
        }
    }
}

fn tip_m(plant: &Standing<f64>) -> f64 {
    let tips = plant.nodes.last().zip(plant.wind.last());
    tips.map_or(0.0, |(now, wind)| (*now - *wind).length())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::methods::method;
    use crate::run::{Device, RunOptions, run_scene};
    use crate::scene::parse_scene;

    /// A ball holds plants down and is gone after a quarter of a second.
    const HELD: &str = r#"(
        duration_s: 2.2,
        terrain: (ground: Flat(size_m: (1, 1))),
        wind: (strength: 0.2, gust: 0.2),
        bodies: [(name: "ball", shape: Ball(radius_m: 0.2), position_m: (0.05, 0.15, -0.05),
                  motion: Fixed)],
        script: [(at_s: 0.25, action: Remove(body: "ball"))],
    )"#;

    fn measured(hz: f64, name: &str) -> Passed {
        let loaded = parse_scene("held", HELD, &[]).expect("a valid scene");
        let options = RunOptions {
            hz,
            method: method(name),
            ..RunOptions::default()
        };
        let outcome = run_scene(&loaded, &options, &Device::Processor, |_| {});
        outcome.expect("a run").watch.release.weight_s()
    }

    #[test]
    fn the_pose_of_a_released_plant_passes_its_marks_within_a_frame() {
        // T(1 − ∛share) for T = 2 s.
        let marks = [0.5_f64, 0.1, 0.01].map(|share| 2.0 * (1.0 - share.cbrt()));
        for name in ["default", "recovery-positions", "recovery-angles"] {
            for hz in [15.0, 60.0, 120.0, 240.0] {
                let found = measured(hz, name);
                // Nothing moves between two sub-steps.
                let frame_s = (1.0 / hz).max(1.0 / 120.0);
                for (found, mark) in found.iter().zip(marks) {
                    let late = found.map(|s| s - mark);
                    assert!(
                        late.is_some_and(|late| (0.0..=frame_s).contains(&late)),
                        "{name} at {hz} Hz: {found:?} for {mark}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_recovery_that_forgets_too_soon_is_seen_as_such() {
        let [half, tenth, hundredth] = measured(120.0, "recovery-literal");
        // √((2 ln2 / 3)·T·Δt) = 0.088 s where 0.413 s is meant.
        assert!(half.is_some_and(|s| s < 0.12), "{half:?}");
        assert!(
            tenth < Some(0.25) && hundredth < Some(0.4),
            "{tenth:?} {hundredth:?}"
        );
    }
}
