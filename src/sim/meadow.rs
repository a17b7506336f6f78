//! The simulated world without the grass's own state: script, bodies, wind, broad phase, slabs.
//!
//! Engines share it: whatever is decided here (which tiles are awake, which slab a tile has, which
//! parts may touch it, how many sweeps a body needs) is decided once, on the CPU.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::bodies::{Bodies, BodyError, Link};
use crate::field::grid::ANCHOR_CELLS;
use crate::field::tiles::Changes;
use crate::field::wind::FADE_S;
use crate::field::{ActiveTiles, Field, FieldError, Kinds, TileId, TileState, WindNow};
use crate::scene::assets::Assets;
use crate::scene::{Action, Event, Invalid, Likes, Scene, Solver, Wind, validate};
use crate::terrain::{ColourMap, CoverMap, HeightGrid, TerrainError};

use super::billboard::{GridError, Weave};
use super::fault::Planted;
use super::parts::{Parts, Tested, takes_whole_bodies};
use super::state_size::{StateSize, all_at_rest, has_bends, weave_of};
use super::work::{Mover, TileWork, Work};

/// Everything of a scene that moves or is decided per tick, but the grass's state.
pub struct Meadow {
    pub scene: Scene,
    pub field: Field,
    /// Nodes and springs of a touched billboard; `None` in a scene without billboards.
    pub weave: Option<Weave>,
    pub bodies: Bodies,
    pub parts: Parts,
    /// The true shape of every body, whatever the passes test.
    pub truth: Parts,
    pub tiles: ActiveTiles,
    /// What the passes have to do in the current sub-step.
    pub work: Work,
    /// Tiles that woke or came to rest in the current sub-step.
    pub changes: Changes,
    pub counters: Counters,
    /// A mistake planted by a test.
    pub planted: Planted,
    /// Sub-steps done.
    pub ticks: u32,
    /// Events in the order of their times.
    script: Vec<Event>,
    script_state: ScriptState,
    /// The bodies' ways through the current sub-step.
    links: Vec<Link>,
    movers: Vec<Mover>,
}

/// Limits reached and things counted since the start.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Counters {
    /// Bodies and sub-steps in which a body needed more sweeps than the solver allows.
    pub capped_sweeps: u64,
    /// Tiles that could not wake in a sub-step because every slab was in use.
    pub refused_tiles: u64,
    /// Largest number of plants and billboards in active tiles at once.
    pub plants_peak: u64,
    /// Largest number of bytes of grass state at once.
    pub state_bytes_peak: u64,
}

/// How far the script has come, and the wind it has set.
#[derive(Clone, Debug)]
pub struct ScriptState {
    /// Events that have happened.
    done: usize,
    wind: WindChange,
}

/// The wind of now and the one before it: a change fades out and in.
#[derive(Clone, Debug)]
struct WindChange {
    before: Wind,
    now: Wind,
    since_s: f64,
}

/// Why a meadow cannot be made or run.
#[derive(Debug, thiserror::Error)]
pub enum MeadowError {
    #[error(transparent)]
    Scene(#[from] Invalid),
    #[error(transparent)]
    Terrain(#[from] TerrainError),
    #[error(transparent)]
    Field(#[from] FieldError),
    #[error(transparent)]
    Grid(#[from] GridError),
    #[error(transparent)]
    Body(#[from] BodyError),
    #[error("there is no kind of plant {kind}: the scene has {known}, counted from 0")]
    NoSuchKind { kind: usize, known: usize },
    #[error(
        "plants of the kind '{name}' have no `likes`: give `likes` to every kind in the scene first"
    )]
    LikesNoGround { name: String },
}

/// The tiles whose plants a mover may touch, and the movers near any tile: those that would reach
/// a plant there as a ball.
fn near_movers<'a>(
    field: &Field,
    parts: &Parts,
    movers: &'a [Mover],
) -> (BTreeSet<TileId>, BTreeMap<TileId, Vec<&'a Mover>>) {
    let mut touched = BTreeSet::new();
    let mut near: BTreeMap<TileId, Vec<&Mover>> = BTreeMap::new();
    if field.is_empty() {
        return (touched, near);
    }
    for mover in movers {
        field.near(&mover.bounds, |tile| {
            touched.insert(tile);
        });
        field.near(&mover.ball_bounds(parts), |tile| {
            near.entry(tile).or_default().push(mover);
        });
    }
    (touched, near)
}

fn lay_out(ground: HeightGrid, scene: &Scene, assets: &Assets) -> Result<Field, MeadowError> {
    let field = if scene.grass.grows_by_colour() {
        let map = Arc::new(ColourMap::of(&scene.terrain, &ground, assets)?);
        Field::on_map(ground, map, &scene.grass, &scene.solver)?
    } else {
        Field::new(ground, &scene.grass, &scene.solver)?
    };
    let Some(billboards) = &scene.billboards else {
        return Ok(field);
    };
    let map = CoverMap::of(billboards, &field.ground, assets)?;
    Ok(field.with_billboards(billboards, map)?)
}

impl Meadow {
    /// Lays out a scene.
    ///
    /// # Errors
    ///
    /// A value outside its range, whoever made the scene; a ground, a field or a body that cannot be made, each with its limit.
    pub fn new(scene: Scene, assets: &Assets) -> Result<Self, MeadowError> {
        validate(&scene)?;
        let ground = crate::terrain::height_grid(&scene.terrain, assets)?;
        let bodies = Bodies::new(&scene, assets, &ground)?;
        let field = lay_out(ground, &scene, assets)?;
        let weave = weave_of(&field, &scene.solver)?;
        let tiles = all_at_rest(&field, &scene.solver, weave.as_ref());
        let mut script = scene.script.clone();
        script.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        let wind = WindChange {
            before: scene.wind.clone(),
            now: scene.wind.clone(),
            since_s: f64::NEG_INFINITY,
        };
        let mut meadow = Self {
            field,
            weave,
            bodies,
            parts: Parts::default(),
            truth: Parts::default(),
            tiles,
            work: Work::default(),
            changes: Changes::default(),
            counters: Counters::default(),
            planted: Planted::default(),
            ticks: 0,
            script,
            script_state: ScriptState { done: 0, wind },
            links: Vec::new(),
            movers: Vec::new(),
            scene,
        };
        meadow.work.wind = meadow.wind_at(0.0);
        Ok(meadow)
    }

    /// Gives a kind of plant, by its place in the scene's list, another ground to like, and puts all tiles
    /// to rest: the engine has to begin anew with resting grass. Roots stay where they are.
    ///
    /// # Errors
    ///
    /// A kind that the scene lacks or that likes no ground; a value outside its range. Then nothing has
    /// changed.
    pub fn set_likes(&mut self, kind: usize, likes: Likes) -> Result<(), MeadowError> {
        let mut scene = self.scene.clone();
        let known = scene.grass.species.len();
        let Some(species) = scene.grass.species.get_mut(kind) else {
            return Err(MeadowError::NoSuchKind { kind, known });
        };
        let (Some(kinds), Some(_)) = (&self.field.seeds.kinds, &species.likes) else {
            let name = species.name.clone();
            return Err(MeadowError::LikesNoGround { name });
        };
        species.likes = Some(likes);
        validate(&scene)?;
        let map = Arc::clone(&kinds.map);
        self.field.seeds.kinds = Kinds::new(&scene.grass, &self.field.grid, map);
        self.tiles = all_at_rest(&self.field, &scene.solver, self.weave.as_ref());
        self.work.tiles.clear();
        self.work.contacts.clear();
        self.changes = Changes::default();
        self.scene = scene;
        Ok(())
    }

    /// Simulated time so far, in seconds.
    pub fn time_s(&self) -> f64 {
        f64::from(self.ticks) * self.scene.solver.substep_s
    }

    /// Ticks from the last contact to the wind pose.
    pub fn recovery_ticks(&self) -> u32 {
        (self.scene.solver.recovery_s / self.scene.solver.substep_s).ceil() as u32
    }

    /// Δt/T of the recovery.
    pub fn step_over_t(&self) -> f64 {
        self.scene.solver.substep_s / self.scene.solver.recovery_s
    }

    /// Lets the events happen that are due at the start of this sub-step.
    ///
    /// # Errors
    ///
    /// An event the bodies refuse.
    pub fn script(&mut self) -> Result<(), MeadowError> {
        if self.part_of_body_step() > 0 {
            return Ok(());
        }
        // Half a nanosecond forgives the rounding of ticks · Δt.
        let now = self.time_s() + 5e-10;
        while self
            .script
            .get(self.script_state.done)
            .is_some_and(|e| e.at_s <= now)
        {
            let action = self.script[self.script_state.done].action.clone();
            self.script_state.done += 1;
            self.act(&action)?;
        }
        Ok(())
    }

    /// Lets one action happen now.
    ///
    /// # Errors
    ///
    /// An action the bodies refuse.
    pub fn act(&mut self, action: &Action) -> Result<(), MeadowError> {
        let now = self.time_s();
        if let Action::SetWind(wind) = action {
            let current = &mut self.script_state.wind;
            *current = WindChange {
                before: std::mem::replace(&mut current.now, wind.clone()),
                now: wind.clone(),
                since_s: now,
            };
        } else {
            self.bodies.apply(action, now)?;
        }
        Ok(())
    }

    /// Which sub-step of the grass, from 0, the next one is within a step of the bodies.
    fn part_of_body_step(&self) -> u32 {
        self.ticks % self.scene.solver.method.grass_steps
    }

    pub(super) fn script_state(&self) -> ScriptState {
        self.script_state.clone()
    }

    pub(super) fn set_script_state(&mut self, state: ScriptState) {
        self.script_state = state;
    }

    /// Moves the bodies by one sub-step.
    pub fn move_bodies(&mut self) {
        let (part, parts) = (
            self.part_of_body_step(),
            self.scene.solver.method.grass_steps,
        );
        if part == 0 {
            let dt = self.scene.solver.substep_s * f64::from(parts);
            self.bodies.step(self.time_s(), dt);
        }
        let links = self.bodies.links().iter();
        self.links = links.map(|link| link.piece(part, parts)).collect();
        let skin_m = f64::from(self.scene.solver.skin_m);
        let whole = takes_whole_bodies(&self.scene.solver.method);
        self.parts.extend(self.bodies.shapes(), skin_m, whole);
        self.truth.extend(self.bodies.shapes(), 0.0, true);
    }

    /// Finds the tiles that bodies may touch and lists the work of this sub-step.
    pub fn broad_phase(&mut self) {
        self.ticks += 1;
        let solver = &self.scene.solver;
        let shapes = self.bodies.shapes();
        self.movers = self
            .links
            .iter()
            .zip(0..)
            .map(|(link, number)| {
                let shape = &shapes[link.shape as usize];
                Mover::new(link, number, shape, solver, self.field.farthest_m())
            })
            .collect();
        let (touched, near) = near_movers(&self.field, &self.parts, &self.movers);
        let tiles: Vec<TileId> = touched.into_iter().collect();
        let recovery_ticks = self.recovery_ticks();
        self.changes = self.tiles.update(&tiles, self.ticks, recovery_ticks);
        let mut work = Work {
            now: self.ticks,
            wind: self.wind_at(f64::from(self.ticks) * solver.substep_s),
            wind_before: self.work.wind,
            tiles: std::mem::take(&mut self.work.tiles),
            contacts: std::mem::take(&mut self.work.contacts),
        };
        work.tiles.clear();
        work.contacts.clear();
        for (tile, active) in self.tiles.iter() {
            let anchor = self.field.grid.anchor_of(tile, &self.field.ground);
            let movers = match active.state {
                TileState::Colliding => near.get(&tile).map_or(&[][..], Vec::as_slice),
                TileState::Recovering => &[],
            };
            let contacts = work.add_contacts(
                &self.field,
                &self.parts,
                solver,
                &anchor,
                movers,
                self.planted,
            );
            work.tiles.push(TileWork {
                tile,
                slab: active.slab,
                anchor,
                contacts,
            });
        }
        self.work = work;
        for contact in &self.work.contacts {
            self.parts.want(contact.part as usize, contact.tested);
        }
        self.count();
    }

    fn count(&mut self) {
        let capped = self.movers.iter().filter(|mover| mover.capped).count() as u64;
        let state = self.state_size();
        let counters = &mut self.counters;
        counters.capped_sweeps += if self.field.is_empty() { 0 } else { capped };
        counters.refused_tiles = self.tiles.slabs.refused;
        counters.plants_peak = counters.plants_peak.max(state.plants);
        counters.state_bytes_peak = counters.state_bytes_peak.max(state.bytes);
    }

    /// Bytes of grass state in use now.
    pub fn state_bytes(&self) -> u64 {
        self.state_size().bytes
    }

    fn state_size(&self) -> StateSize {
        StateSize::of(
            &self.field,
            &self.scene.solver,
            self.weave.as_ref(),
            &self.tiles,
        )
    }

    /// Takes other settings, before the first sub-step; a reference's may go beyond what a scene may ask
    /// for.
    pub fn set_solver(&mut self, solver: Solver) {
        self.scene.solver = solver;
        if let Some(weave) = &mut self.weave {
            *weave = Weave::new(weave.grid, has_bends(&self.scene.solver));
        }
    }

    /// The wind at a time; the change from one wind to the next fades out and in.
    pub fn wind_at(&self, time_s: f64) -> WindNow {
        let anchor_m = f64::from(ANCHOR_CELLS) * f64::from(self.field.grid.cell_m);
        let wind = &self.script_state.wind;
        let faded = ((time_s - wind.since_s) / FADE_S).min(1.0);
        if faded < 0.5 {
            WindNow::at(&wind.before, time_s, anchor_m, 1.0 - 2.0 * faded)
        } else {
            WindNow::at(&wind.now, time_s, anchor_m, 2.0 * faded - 1.0)
        }
    }

    /// What each body resolved to, by name: how many of its parts are tested by cube and how many
    /// by closed form.
    pub fn colliders(&self) -> Vec<(String, u32, u32)> {
        let solver = &self.scene.solver;
        let mut found: BTreeMap<String, (u32, u32)> = BTreeMap::new();
        for link in self.bodies.links() {
            let Some(info) = self.bodies.info().find(|info| info.id == link.body) else {
                continue;
            };
            let entry = found.entry(info.name.to_owned()).or_default();
            for part in self.parts.of_shape(link.shape) {
                if self.parts.tested(part, link.collider, solver) == Tested::Cube {
                    entry.0 += 1;
                } else {
                    entry.1 += 1;
                }
            }
        }
        found
            .into_iter()
            .map(|(name, (cubes, analytic))| (name, cubes, analytic))
            .collect()
    }
}
