//! What the cases share: a small meadow with its engine, and what must hold of it at all times.

use std::collections::BTreeMap;

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::field::TileId;
use sward::run::{Device, Engine};
use sward::scene::{Collider, LoadedScene, Method, Scene, parse_scene};
use sward::sim::Meadow;
use sward::sim::fault::{Fault, Planted};
use sward::sim::measure::{GrassState, Standing};
use sward::sim::slab::Slab;

/// No wind at all.
pub const CALM: &str = "wind: (strength: 0, gust: 0, flutter: 0)";
/// Sub-steps of a displayed frame at 60 Hz.
pub const FRAME_TICKS: u32 = 2;
/// Sub-steps of a second.
pub const SECOND_TICKS: u32 = 120;
/// No vertex is farther from its root than this, in lengths of its blade.
const FARTHEST: f64 = 1.05;

/// What a trial runs with.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    pub device: &'a Device,
    pub collider: Collider,
    /// Made in every engine but the reference.
    pub mistake: Option<Mistake>,
}

/// What a naive method does, in place of the default.
#[derive(Clone, Copy)]
pub enum Mistake {
    /// Planted in the kernels of the cpu engine.
    Planted(Fault),
    /// A method of its own.
    Method(fn(&mut Method)),
}

impl Setting<'_> {
    /// The collider as a scene writes it.
    pub fn collider(&self) -> &'static str {
        match self.collider {
            Collider::Auto => "auto",
            Collider::Cube => "cube",
            Collider::Analytic => "analytic",
        }
    }

    /// A meadow from the text of a scene.
    pub fn rig(&self, text: &str) -> Result<Rig, Failed> {
        self.rig_of(parse(text)?.scene)
    }

    /// A meadow from a scene without assets.
    pub fn rig_of(&self, mut scene: Scene) -> Result<Rig, Failed> {
        if let Some(Mistake::Method(change)) = self.mistake {
            change(&mut scene.solver.method);
        }
        let mut rig = Rig::of_scene(self.device, scene)?;
        if let Some(Mistake::Planted(fault)) = self.mistake {
            rig.meadow.planted = Planted::plant(fault);
        }
        Ok(rig)
    }
}

/// Reads the text of a scene.
pub fn parse(text: &str) -> Result<LoadedScene, Failed> {
    Ok(parse_scene("hard case", text, &[])?)
}

pub fn ensure(holds: bool, says: impl FnOnce() -> String) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(says().into()) }
}

/// Slabs made by hand.
#[derive(Clone, Debug, Default)]
pub struct Handmade {
    pub slabs: Vec<Option<Slab<f32>>>,
}

impl GrassState<f32> for Handmade {
    fn slab(&self, slab: u32) -> Option<&Slab<f32>> {
        self.slabs.get(slab as usize)?.as_ref()
    }
}

/// A meadow with its engine, and the worst that was seen of it.
pub struct Rig {
    pub meadow: Meadow,
    pub engine: Engine,
    pub seen: Seen,
}

/// The worst over all looks at a meadow.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    /// Depth in a true shape over what the collider promises, and in metres.
    pub depth_over_limit: f64,
    pub depth_m: f64,
    pub strain: f64,
    /// Distance of a vertex from its root, in lengths of its blade.
    pub reach: f64,
    pub offset_m: f64,
    /// Nodes of plants pushed in the sub-steps that were looked at.
    pub pushed_nodes: u64,
}

/// A plant by its tile and its rank among the tile's plants.
pub type PlantKey = (TileId, usize);

impl Rig {
    pub fn new(device: &Device, loaded: LoadedScene) -> Result<Self, Failed> {
        let mut meadow = Meadow::new(loaded.scene, &loaded.assets)?;
        let engine = device.engine(&mut meadow)?;
        Ok(Self {
            meadow,
            engine,
            seen: Seen::default(),
        })
    }

    pub fn of_scene(device: &Device, scene: Scene) -> Result<Self, Failed> {
        let mut loaded = parse("()")?;
        loaded.scene = scene;
        Self::new(device, loaded)
    }

    pub fn tick(&mut self) -> Result<(), Failed> {
        Ok(self.engine.tick(&mut self.meadow)?)
    }

    pub fn ticks(&mut self, count: u32) -> Result<(), Failed> {
        (0..count).try_for_each(|_| self.tick())
    }

    /// Runs to a tick and looks at the meadow after every `every` of them.
    pub fn run_to(&mut self, tick: u32, every: u32) -> Result<(), Failed> {
        while self.meadow.ticks < tick {
            self.tick()?;
            if self.meadow.ticks.is_multiple_of(every) {
                self.look()?;
            }
        }
        Ok(())
    }

    /// A copy of the grass's state.
    pub fn state(&self) -> Result<Handmade, Failed> {
        let meadow = &self.meadow;
        Ok(match &self.engine {
            Engine::Cpu(grass) => Handmade::of(meadow, grass),
            Engine::Gpu(engine) => Handmade::of(meadow, &engine.grass.read_state(meadow)?),
            Engine::Reference(_) => return Err("the reference engine is in f64".into()),
        })
    }

    /// The engine goes on from this state.
    pub fn take_over(&mut self, state: &Handmade) -> Result<(), Failed> {
        let meadow = &self.meadow;
        match &mut self.engine {
            Engine::Cpu(grass) => grass.take_over(meadow, state),
            Engine::Gpu(engine) => engine.grass.upload(meadow, state)?,
            Engine::Reference(_) => return Err("the reference engine is in f64".into()),
        }
        Ok(())
    }

    /// Every plant of the active tiles.
    pub fn plants(&mut self) -> Result<BTreeMap<PlantKey, Standing<f64>>, Failed> {
        let mut found = BTreeMap::new();
        for tile in &self.meadow.work.tiles {
            let plants = self.engine.standing(&self.meadow, tile)?;
            found.extend((plants.into_iter().enumerate()).map(|(n, p)| ((tile.tile, n), p)));
        }
        Ok(found)
    }

    /// Takes in how the meadow stands now.
    ///
    /// # Errors
    ///
    /// A value that is not finite, a vertex too far from its root, anything dropped.
    pub fn look(&mut self) -> Result<BTreeMap<PlantKey, Standing<f64>>, Failed> {
        let snapshot = self.engine.snapshot(&self.meadow)?;
        ensure(snapshot.not_finite == 0, || {
            format!("{} plants are not finite", snapshot.not_finite)
        })?;
        self.nothing_is_dropped()?;
        let seen = &mut self.seen;
        let worst = snapshot.worst;
        seen.depth_over_limit = seen.depth_over_limit.max(worst.depth_m / worst.limit_m);
        seen.depth_m = snapshot
            .depths_m
            .iter()
            .copied()
            .fold(seen.depth_m, f64::max);
        seen.strain = seen.strain.max(snapshot.max_strain);
        seen.pushed_nodes += snapshot.pushed_nodes;
        seen.offset_m = seen.offset_m.max(snapshot.max_offset_m);
        let plants = self.plants()?;
        for (key, plant) in &plants {
            let reach = reach(plant);
            ensure(reach <= FARTHEST, || {
                format!("plant {key:?} reaches {reach} L from its root, limit {FARTHEST} L")
            })?;
            self.seen.reach = self.seen.reach.max(reach);
        }
        Ok(plants)
    }

    fn nothing_is_dropped(&self) -> Result<(), Failed> {
        let counters = &self.meadow.counters;
        let gone = self.meadow.bodies.quarantined();
        ensure(
            counters.refused_tiles == 0 && counters.capped_sweeps == 0 && gone.is_empty(),
            || format!("something was dropped: {counters:?}, quarantined {gone:?}"),
        )
    }

    /// Fails where penetration was beyond what the collider promises (one texel for a cube, 1 mm
    /// for a closed form).
    pub fn nothing_is_inside(&self) -> Result<(), Failed> {
        ensure(self.seen.depth_over_limit <= 1.0, || {
            let Seen {
                depth_over_limit,
                depth_m,
                ..
            } = self.seen;
            format!("penetration {depth_m:.2e} m is {depth_over_limit:.2} of its limit")
        })
    }

    /// Bits of every plant of the active tiles, as a hash.
    pub fn bits(&mut self) -> Result<u64, Failed> {
        let mut hash = Fnv::new();
        for ((tile, rank), plant) in self.plants()? {
            hash.eat(tile);
            hash.eat(rank as u32);
            hash.eat(plant.touched_at);
            plant.nodes.iter().for_each(|&node| hash.point(node));
        }
        Ok(hash.0)
    }
}

impl Handmade {
    fn of(meadow: &Meadow, state: &impl GrassState<f32>) -> Self {
        let slabs = 0..meadow.tiles.slabs.high_water();
        Self {
            slabs: slabs.map(|slab| state.slab(slab).cloned()).collect(),
        }
    }
}

/// Largest distance of a vertex from the root, in lengths of the blade; infinite where a vertex
/// is not finite.
fn reach(plant: &Standing<f64>) -> f64 {
    let root = plant.nodes[0];
    let far = plant.nodes.iter().map(|&node| {
        let off = (node - root).length();
        if off.is_finite() { off } else { f64::INFINITY }
    });
    far.fold(0.0, f64::max) / f64::from(plant.plant.height_m)
}

/// Largest distance between the nodes of two poses of a plant, in metres.
pub fn apart(a: &[Vec3<f64>], b: &[Vec3<f64>]) -> f64 {
    let far = a.iter().zip(b).map(|(&a, &b)| (a - b).length());
    far.fold(0.0, f64::max)
}

/// True where every plant is in its wind pose, bit for bit.
pub fn all_in_wind_pose(plants: &BTreeMap<PlantKey, Standing<f64>>) -> bool {
    plants.values().all(|plant| plant.nodes == plant.wind)
}

/// Fowler, Noll and Vo's hash of words.
pub struct Fnv(pub u64);

impl Fnv {
    pub fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    pub fn eat(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    pub fn point(&mut self, point: Vec3<f64>) {
        point.to_f32().iter().for_each(|c| self.eat(c.to_bits()));
    }
}
