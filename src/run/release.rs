//! How fast a plant rises again: one that was let go is followed until it is back.

use crate::gpu::GpuError;
use crate::sim::Meadow;
use crate::sim::measure::Standing;
use crate::sim::recover::offset_left;

use super::engine::Engine;

/// Shares of the offset whose times are told.
const SHARES: [f64; 3] = [0.5, 0.1, 0.01];
/// A tip is worth following from this offset on, in metres.
const WORTH_M: f64 = 0.05;
/// A plant counts as just let go for this share of the recovery time (a half of the offset is left
/// after 0.21 of it): one that a body holds is not
/// touched in every sub-step.
const LATELY: f64 = 0.15;
/// Two roots closer than this are one plant, in metres.
const SAME_ROOT_M: f64 = 1e-6;

/// Follows the first plant that is let go with a fair offset and not touched again.
#[derive(Clone, Debug, Default)]
pub struct Release {
    followed: Option<Followed>,
    /// Ticks at the last frame.
    last_tick: u32,
}

#[derive(Clone, Copy, Debug)]
struct Followed {
    root_m: [f64; 2],
    released_at: u32,
    /// Offset of the tip at release.
    tip_m: f64,
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
        match &mut self.followed {
            Some(followed) if followed.is_back() => {}
            Some(followed) => {
                if followed.touched_again(meadow, engine)? {
                    self.followed = None;
                }
            }
            None => self.followed = self.just_released(meadow, engine)?,
        }
        self.last_tick = meadow.ticks;
        Ok(())
    }

    /// When the weight t³ of the stored offset had fallen: the law of the recovery itself.
    pub fn weight_s(&self) -> Passed {
        self.followed.map_or([None; 3], |f| f.weight)
    }

    /// When the tip's distance from its wind pose had fallen, which goes faster where a bent blade
    /// keeps its length.
    pub fn tip_s(&self) -> Passed {
        self.followed.map_or([None; 3], |f| f.tip)
    }

    /// A plant let go lately; one touched in this very sub-step is still held.
    fn just_released(
        &self,
        meadow: &Meadow,
        engine: &mut Engine,
    ) -> Result<Option<Followed>, GpuError> {
        let lately = (f64::from(meadow.recovery_ticks()) * LATELY) as u32;
        let first = meadow.ticks.saturating_sub(lately).min(self.last_tick);
        let just_now = first.max(1)..meadow.ticks;
        let field = &meadow.field;
        let half = 0.5 * f64::from(field.grid.tile_m());
        for tile in &meadow.work.tiles {
            let [low, high] = field.grid.tile_bounds(tile.tile, &field.ground);
            let middle_m = [0, 1].map(|a| 0.5 * (low[a] + high[a]));
            let mut plants = engine.near(meadow, middle_m, half)?.into_iter();
            let let_go = plants.find(|p| just_now.contains(&p.touched_at) && tip_m(p) > WORTH_M);
            if let Some(plant) = let_go {
                return Ok(Some(Followed {
                    root_m: plant.root_in_world(),
                    released_at: plant.touched_at,
                    tip_m: tip_m(&plant) / left(meadow, plant.touched_at).max(1e-3),
                    weight: [None; 3],
                    tip: [None; 3],
                }));
            }
        }
        Ok(None)
    }
}

impl Followed {
    fn is_back(&self) -> bool {
        self.weight[2].is_some() && self.tip[2].is_some()
    }

    /// Notes what is left now; true if something touched the plant.
    fn touched_again(&mut self, meadow: &Meadow, engine: &mut Engine) -> Result<bool, GpuError> {
        let plants = engine.near(meadow, self.root_m, SAME_ROOT_M)?;
        // A tile at rest has no plants to show: they stand in the wind pose.
        let (touched_at, tip) = plants
            .first()
            .map_or((self.released_at, 0.0), |p| (p.touched_at, tip_m(p)));
        let age = meadow.ticks - self.released_at;
        let since_s = f64::from(age) * meadow.scene.solver.substep_s;
        note(&mut self.weight, left(meadow, self.released_at), since_s);
        note(&mut self.tip, tip / self.tip_m, since_s);
        Ok(touched_at > self.released_at)
    }
}

fn note(passed: &mut Passed, left: f64, since_s: f64) {
    for (passed, share) in passed.iter_mut().zip(SHARES) {
        if passed.is_none() && left <= share {
            *passed = Some(since_s);
        }
    }
}

/// The weight of an offset stored at `touched_at`.
fn left(meadow: &Meadow, touched_at: u32) -> f64 {
    offset_left(meadow.ticks - touched_at, meadow.step_over_t())
}

fn tip_m(plant: &Standing<f64>) -> f64 {
    let tips = plant.nodes.last().zip(plant.wind.last());
    tips.map_or(0.0, |(now, wind)| (*now - *wind).length())
}
