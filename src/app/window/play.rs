//! The scene on the stage: choosing, pausing, stepping, and what a person does to its bodies.

use crate::base::Vec3;
use crate::field::TileState;
use crate::gpu::{Gpu, GpuError};
use crate::render::{PictureTarget, View};
use crate::run::EngineChoice;
use crate::run::stage::{Stage, StageError};
use crate::scene::limits::{ENGINE_FORCE, STEER};
use crate::scene::{Action, Body, Collider, Mass, Motion, Shape};

use super::scenes::SceneList;
use crate::app::Failure;

/// One frame of a step by hand, in seconds.
const STEP_S: f64 = 1.0 / 60.0;
/// How far a pointer reaches, in metres.
const REACH_M: f64 = 1000.0;
/// A dropped ball: its radius, and how high over the pointed place its middle starts, in metres.
const BALL_RADIUS_M: f32 = 0.25;
const DROP_HEIGHT_M: f64 = 1.2;
/// Acceleration that a held arrow gives a vehicle, in metres per second squared.
const DRIVE_M_PER_S2: f64 = 3.5;
/// Deceleration of a vehicle that nobody drives any more.
const COAST_M_PER_S2: f64 = 0.5;
const STEER_DEG: f32 = 20.0;

/// What is played, and how.
pub struct Play {
    pub scenes: SceneList,
    pub stage: Stage,
    engine: EngineChoice,
    pub paused: bool,
    pub overlay: bool,
    /// The body that was clicked last.
    pub selected: Option<String>,
    /// Arrows as last sent to the vehicle.
    arrows: [i8; 2],
    /// Milliseconds per pass of the last displayed frame, for engines without a device's clock.
    frame_ms: Vec<(&'static str, f64)>,
    /// Whether the scene's plants are known to be wrong, and that was told.
    told_wrong: bool,
}

/// Tiles by state.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct TileCounts {
    pub resting: u32,
    pub colliding: u32,
    pub recovering: u32,
}

impl Play {
    /// Puts the list's current scene on a stage for pictures of this size.
    ///
    /// # Errors
    /// A scene that cannot be read or laid out; what the device refuses.
    pub fn new(
        gpu: &Gpu,
        scenes: SceneList,
        engine: EngineChoice,
        size: [u32; 2],
    ) -> Result<Self, Failure> {
        let loaded = scenes.load()?;
        let stage = Stage::new(gpu, &loaded, engine, PictureTarget::FORMAT, size)?;
        Ok(Self {
            scenes,
            stage,
            engine,
            paused: false,
            overlay: false,
            selected: None,
            arrows: [0; 2],
            frame_ms: Vec::new(),
            told_wrong: false,
        })
    }

    /// Shows the states of tiles, those at rest included or not; what is shown already is taken away.
    pub fn toggle_overlay(&mut self, resting: bool) {
        self.overlay = !self.overlay || self.stage.resting_boxes != resting;
        self.stage.resting_boxes = resting;
    }

    /// Puts the list's current scene on the stage, read anew.
    ///
    /// # Errors
    /// As for [`Play::new`]; then the old scene goes on.
    pub fn restart(&mut self, gpu: &Gpu) -> Result<(), Failure> {
        let loaded = self.scenes.load()?;
        self.stage.set_scene(gpu, &loaded, self.engine)?;
        self.selected = None;
        self.arrows = [0; 2];
        self.told_wrong = false;
        Ok(())
    }

    /// What the device tells late of the sub-steps so far, once per scene.
    pub fn news_of_device(&mut self) -> Option<GpuError> {
        if self.told_wrong {
            return None;
        }
        let error = self.stage.engine().check_late().err();
        self.told_wrong = error.is_some();
        error
    }

    /// Goes to another line of the menu.
    ///
    /// # Errors
    /// As for [`Play::new`]; then the old scene goes on and stays marked.
    pub fn choose(&mut self, gpu: &Gpu, line: usize) -> Result<(), Failure> {
        let before = std::mem::replace(&mut self.scenes.current, line);
        let chosen = self.restart(gpu);
        if chosen.is_err() {
            self.scenes.current = before;
        }
        chosen
    }

    /// Simulates what a displayed frame of `frame_s` adds, unless paused.
    ///
    /// # Errors
    /// An event of the script that cannot happen; what the device refuses.
    pub fn advance(&mut self, frame_s: f64) -> Result<(), StageError> {
        if self.paused {
            return Ok(());
        }
        let before = self.stage.engine().pass_ms();
        let outcome = self.stage.advance(frame_s);
        let after = self.stage.engine().pass_ms();
        self.frame_ms = (after.iter().zip(&before))
            .map(|(&(pass, end), (_, start))| (pass, end - start))
            .collect();
        // A script that cannot go on would fail at every frame.
        self.paused |= outcome.is_err();
        outcome.map(|_| ())
    }

    /// Simulates one frame and pauses.
    ///
    /// # Errors
    /// As for [`Play::advance`].
    pub fn step(&mut self) -> Result<(), StageError> {
        self.paused = false;
        let outcome = self.advance(STEP_S);
        self.paused = true;
        outcome
    }

    /// Milliseconds per pass: medians from the device's clock, and the last frame's by the
    /// processor's for what the processor does.
    pub fn pass_ms(&self) -> Vec<(&'static str, f64)> {
        let mut passes = self.frame_ms.clone();
        passes.extend(self.stage.pass_ms());
        passes
    }

    pub fn tile_counts(&self) -> TileCounts {
        let meadow = self.stage.meadow();
        let mut counts = TileCounts::default();
        for (_, tile) in meadow.tiles.iter() {
            match tile.state {
                TileState::Colliding => counts.colliding += 1,
                TileState::Recovering => counts.recovering += 1,
            }
        }
        let awake = counts.colliding + counts.recovering;
        counts.resting = meadow.field.grid.tile_count() - awake;
        counts
    }

    /// Selects the body that a ray meets first, or none.
    pub fn select(&mut self, view: &View, direction: Vec3<f64>) {
        let bodies = &self.stage.meadow().bodies;
        let hit = bodies.ray(view.eye_in_world.to_f64(), direction.to_f64(), REACH_M);
        self.selected = hit.and_then(|hit| hit.body.map(str::to_owned));
    }

    /// Drops a ball over the place that a ray meets first. Gives its name, or `None` where the
    /// ray meets nothing.
    ///
    /// # Errors
    /// A ball that the bodies refuse.
    pub fn drop_ball(
        &mut self,
        view: &View,
        direction: Vec3<f64>,
    ) -> Result<Option<String>, StageError> {
        let bodies = &self.stage.meadow().bodies;
        let from = view.eye_in_world.to_f64();
        let Some(hit) = bodies.ray(from, direction.to_f64(), REACH_M) else {
            return Ok(None);
        };
        let [x, y, z] = hit.point_m;
        let mut number = 1;
        let name = loop {
            let name = format!("dropped ball {number}");
            if bodies.id_of(&name).is_none() {
                break name;
            }
            number += 1;
        };
        let ball = ball(name.clone(), [x, y + DROP_HEIGHT_M, z]);
        self.stage.act(&Action::Spawn(Box::new(ball)))?;
        Ok(Some(name))
    }

    /// Drives the vehicle as the arrows say: right and ahead, each −1…1. Acts on changes only, so
    /// that a scene's own script goes on until a key is pressed.
    ///
    /// # Errors
    /// None is known: there is a vehicle, and the values are in their limits.
    pub fn drive(&mut self, arrows: [i8; 2]) -> Result<(), StageError> {
        if arrows == self.arrows {
            return Ok(());
        }
        self.arrows = arrows;
        let mut bodies = self.stage.meadow().bodies.info();
        let Some(vehicle) = bodies.find(|body| body.is_vehicle) else {
            return Ok(());
        };
        let [right, ahead] = arrows.map(f32::from);
        let force_n = |m_per_s2: f64| {
            let newtons = vehicle.mass_kg * m_per_s2;
            newtons.clamp(0.0, ENGINE_FORCE.max) as f32
        };
        let action = Action::Drive {
            body: vehicle.name.to_owned(),
            engine_n: ahead * force_n(DRIVE_M_PER_S2),
            // Positive steers to the left.
            steer_deg: -right * STEER_DEG.min(STEER.max as f32),
            brake_n: if ahead == 0.0 {
                force_n(COAST_M_PER_S2)
            } else {
                0.0
            },
        };
        drop(bodies);
        self.stage.act(&action)
    }

    /// Middle and radius of a ball around the selected body, else around the first that moves.
    pub fn body_ball(&self) -> Option<(Vec3<f64>, f64)> {
        let bodies = &self.stage.meadow().bodies;
        let selected = self.selected.as_deref().and_then(|n| bodies.info_of(n));
        let body = selected
            .or_else(|| bodies.info().find(|body| body.awake))
            .or_else(|| bodies.info().next())?;
        let shape = bodies.shapes().get(body.shape as usize)?;
        Some((body.pose.place, 1.5 * shape.bounding_radius_m))
    }

    /// Middle and radius of a ball around all bodies; of the field where there is none.
    pub fn whole_ball(&self) -> (Vec3<f64>, f64) {
        let meadow = self.stage.meadow();
        let places: Vec<Vec3<f64>> = meadow.bodies.info().map(|body| body.pose.place).collect();
        let ground = &meadow.field.ground;
        let Some(&first) = places.first() else {
            let [width, depth] = ground.size_m();
            let [x, z] = ground.centre_m;
            let middle = Vec3::new(x, ground.height_in_world(x, z), z);
            return (middle, 0.4 * width.min(depth));
        };
        let low = places.iter().fold(first, |a, b| extreme(a, *b, f64::min));
        let high = places.iter().fold(first, |a, b| extreme(a, *b, f64::max));
        ((low + high) * 0.5, 0.5 * (high - low).length() + 1.0)
    }
}

fn extreme(a: Vec3<f64>, b: Vec3<f64>, of: fn(f64, f64) -> f64) -> Vec3<f64> {
    Vec3::new(of(a.x, b.x), of(a.y, b.y), of(a.z, b.z))
}

fn ball(name: String, position_m: [f64; 3]) -> Body {
    Body {
        name,
        shape: Shape::Ball {
            radius_m: BALL_RADIUS_M,
        },
        position_m,
        above_ground: false,
        rotation_deg: [0.0; 3],
        motion: Motion::Free,
        mass: Mass::default(),
        friction: 0.6,
        restitution: 0.2,
        // Rolls out within a few metres, as in grass.
        damping: [0.3, 0.8],
        collider: Collider::Auto,
        rgb: [0.75, 0.28, 0.04],
        coat: None,
    }
}
