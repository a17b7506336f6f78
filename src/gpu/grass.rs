//! The grass of the `gpu` engine: state in slabs on the device, passes as compute shaders.
//!
//! Three lifetimes: [`GrassKernels`] (compiled passes) live as long as the process, [`GpuGrass`]
//! as long as a scene, and the lists and numbers in its buffers for one tick. The methods that a
//! tick calls have the names of those of [`sim::cpu::Grass`](crate::sim::cpu::Grass); they record,
//! and [`GpuGrass::submit`] hands the tick to the device. Nothing is read back unless asked for.

use super::billboards::GpuBillboards;
use super::cubes::Cubes;
use super::field_data::TileRecord;
use super::grass_buffers::{
    COLLIDE_GROUPS, CUT_SHORT_BYTE, GrassBuffers, RECOVER_GROUPS, TOUCHED_HEADER, slab_limit,
};
use super::late_count::LateCount;
use super::passes::billboard::Around;
use super::passes::collide::CollidePass;
use super::passes::depth_cube::DepthCubePass;
use super::passes::recover::RecoverPass;
use super::passes::relax::RelaxPass;
use super::passes::{Recording, WORKGROUP};
use super::tick_data::{ContactRecord, TickUniform};
use super::turns::{PassTurns, TurnsPass};
use super::{Buffer, FieldBuffers, Gpu, GpuError, PassTimer};
use crate::scene::Method;
use crate::scene::method::Collide;
use crate::sim::Meadow;
use crate::sim::slab::slab_bytes;

/// Dispatches of a tick that are timed: those of a scene with hundreds of sweeps in a sub-step.
const MOST_TIMED: usize = 256;

/// Every pass, compiled.
#[derive(Clone, Debug)]
pub struct GrassKernels {
    field: wgpu::BindGroupLayout,
    depth_cube: DepthCubePass,
    collide: CollidePass,
    relax: RelaxPass,
    recover: RecoverPass,
    turns: TurnsPass,
    workgroup: u32,
}

impl GrassKernels {
    /// # Errors
    /// A shader that the driver refuses.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::with_workgroup(gpu, WORKGROUP)
    }

    /// With workgroups of another size, 1 to 256, which changes no result.
    ///
    /// # Errors
    /// A shader that the driver refuses.
    pub fn with_workgroup(gpu: &Gpu, workgroup: u32) -> Result<Self, GpuError> {
        Ok(Self {
            field: FieldBuffers::layout(gpu),
            depth_cube: DepthCubePass::new(gpu, workgroup)?,
            collide: CollidePass::new(gpu, workgroup)?,
            relax: RelaxPass::new(gpu, workgroup)?,
            recover: RecoverPass::new(gpu, workgroup)?,
            turns: TurnsPass::new(gpu)?,
            workgroup,
        })
    }
}

/// True for the formulas that the kernels have: the default ones, with cubes or closed forms for
/// every body, and any cut of time.
pub fn knows_method(method: &Method) -> bool {
    unknown_settings(method).is_empty()
}

/// What the kernels do not have of a method, as keys and values of `solver.method`.
fn unknown_settings(method: &Method) -> Vec<String> {
    let &Method {
        collide,
        sampling,
        cube_per,
        push,
        springs,
        recovery,
        sweep_share: _,
        grass_steps: _,
    } = method;
    let known = Method::default();
    let voxels_or_exact = matches!(collide, Collide::Voxels | Collide::Exact);
    let settings = [
        (voxels_or_exact, format!("collide: {collide:?}")),
        (
            sampling != known.sampling,
            format!("sampling: {sampling:?}"),
        ),
        (
            cube_per != known.cube_per,
            format!("cube_per: {cube_per:?}"),
        ),
        (push != known.push, format!("push: {push:?}")),
        (springs != known.springs, format!("springs: {springs:?}")),
        (
            recovery != known.recovery,
            format!("recovery: {recovery:?}"),
        ),
    ];
    let unknown = settings.into_iter().filter(|(unknown, _)| *unknown);
    // Scenes write the names of variants, which are single words, in small letters.
    unknown.map(|(_, setting)| setting.to_lowercase()).collect()
}

/// Passes dispatched since the start.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Dispatches {
    /// Depth cubes drawn.
    pub depth_cubes: u64,
    pub collide: u64,
    pub relax: u64,
    pub recover: u64,
}

/// State of a scene's grass on the device.
#[derive(Debug)]
pub struct GpuGrass {
    pub(super) gpu: Gpu,
    kernels: GrassKernels,
    pub field: FieldBuffers,
    pub(super) buffers: GrassBuffers,
    pub cubes: Cubes,
    /// `None` in a scene without billboards.
    pub billboards: Option<GpuBillboards>,
    /// Nodes as drawn, laid out like the state.
    drawn: Buffer<[f32; 4]>,
    pub(super) encoder: wgpu::CommandEncoder,
    /// Rows of a slab.
    pub(super) slab_rows: usize,
    /// Tiles of the current tick, and how many of them collide.
    active: u32,
    colliding: u32,
    /// Turns of the current tick's passes.
    turns: PassTurns,
    pub dispatches: Dispatches,
    pub timer: PassTimer,
    cut_short: LateCount,
}

impl GpuGrass {
    /// Prepares a meadow's grass. Lowers the meadow's slab limit to what the device can bind;
    /// tiles beyond it are refused and counted by the meadow.
    ///
    /// # Errors
    /// A ground, a blade table or billboards larger than the device can bind.
    pub fn new(gpu: &Gpu, kernels: &GrassKernels, meadow: &mut Meadow) -> Result<Self, GpuError> {
        let unknown = unknown_settings(&meadow.scene.solver.method);
        if !unknown.is_empty() {
            let asked = unknown.join(", ");
            return Err(GpuError::UnknownMethod { asked });
        }
        let billboards = GpuBillboards::new(gpu, meadow)?;
        let solver = &meadow.scene.solver;
        let bytes = slab_bytes(meadow.field.grid.plants_per_tile(), solver.segments);
        let (cube_resolution, skin_m) = (solver.cube_resolution, f64::from(solver.skin_m));
        meadow.tiles.slabs.lower_limit(slab_limit(gpu, bytes));
        let grass = Self {
            gpu: gpu.clone(),
            kernels: kernels.clone(),
            field: FieldBuffers::new(gpu, &kernels.field, &meadow.field)?,
            buffers: GrassBuffers::new(gpu)?,
            cubes: Cubes::new(gpu, cube_resolution, skin_m)?,
            billboards,
            drawn: Buffer::new(gpu, "drawn nodes", 0, wgpu::BufferUsages::STORAGE)?,
            encoder: new_encoder(gpu),
            slab_rows: bytes as usize / size_of::<[u32; 4]>(),
            active: 0,
            colliding: 0,
            turns: PassTurns::new(meadow),
            dispatches: Dispatches::default(),
            timer: PassTimer::new(gpu, MOST_TIMED),
            cut_short: LateCount::new(gpu),
        };
        grass.field.set_wind(gpu, &meadow.work.wind)?;
        Ok(grass)
    }

    /// Takes in the tick's tiles, and gives woken ones a wiped slab.
    ///
    /// # Errors
    /// The driver's, as when memory is short.
    pub fn assign_slabs(&mut self, meadow: &Meadow) -> Result<(), GpuError> {
        self.take_in(meadow)?;
        let slab = (self.slab_rows * size_of::<[u32; 4]>()) as u64;
        for &(_, woken) in &meadow.changes.woken {
            let first = u64::from(woken) * slab;
            let state = &self.buffers.state.raw;
            self.encoder.clear_buffer(state, first, Some(slab));
        }
        if let Some(billboards) = &self.billboards {
            billboards.assign_slabs(&mut self.encoder, meadow);
        }
        Ok(())
    }

    /// Draws the depth cubes that are wanted for the first time.
    ///
    /// # Errors
    /// More cubes than the device can bind.
    pub fn draw_depth_cubes(&mut self, meadow: &Meadow) -> Result<(), GpuError> {
        let mut recording = Recording {
            encoder: &mut self.encoder,
            timer: &mut self.timer,
            field: &self.field,
        };
        let pass = &self.kernels.depth_cube;
        let drawn = self
            .cubes
            .draw(&self.gpu, pass, &mut recording, &meadow.parts)?;
        self.dispatches.depth_cubes += u64::from(drawn);
        Ok(())
    }

    /// Lists the plants and billboards that a body touches. Nothing is dispatched where no tile collides.
    ///
    /// # Errors
    /// More contacts than the device can bind.
    pub fn collide(&mut self, meadow: &Meadow) -> Result<(), GpuError> {
        if self.colliding == 0 {
            return Ok(());
        }
        let contacts: Vec<ContactRecord> = meadow
            .work
            .contacts
            .iter()
            .map(|contact| ContactRecord::new(contact, self.cubes.solid(contact.part)))
            .collect();
        self.buffers.contacts.write_or_grow(&self.gpu, &contacts)?;
        let mut recording = Recording {
            encoder: &mut self.encoder,
            timer: &mut self.timer,
            field: &self.field,
        };
        self.kernels.collide.record(
            &self.gpu,
            &mut recording,
            &self.buffers,
            &self.cubes.buffers,
            &self.kernels.turns,
            self.turns.collide,
        );
        if let Some(billboards) = &self.billboards {
            let around = Around {
                grass: &self.buffers,
                cubes: &self.cubes.buffers,
                turns: &self.kernels.turns,
            };
            billboards.collide(&self.gpu, &mut recording, around);
        }
        self.dispatches.collide += u64::from(self.turns.collide.count);
        Ok(())
    }

    /// Pushes what is touched out, restores its shape and stores its offsets.
    pub fn relax(&mut self) {
        if self.colliding == 0 {
            return;
        }
        let mut recording = Recording {
            encoder: &mut self.encoder,
            timer: &mut self.timer,
            field: &self.field,
        };
        self.kernels.relax.record(
            &self.gpu,
            &mut recording,
            &self.buffers,
            &self.cubes.buffers,
            &self.kernels.turns,
            self.turns.relax,
        );
        if let Some(billboards) = &self.billboards {
            let around = Around {
                grass: &self.buffers,
                cubes: &self.cubes.buffers,
                turns: &self.kernels.turns,
            };
            billboards.relax(&self.gpu, &mut recording, around);
        }
        self.dispatches.relax += u64::from(self.turns.relax.count);
    }

    /// Hands what was recorded to the device.
    pub fn submit(&mut self) {
        let mut encoder = std::mem::replace(&mut self.encoder, new_encoder(&self.gpu));
        self.timer.finish_frame(&mut encoder);
        let (touched, byte) = (&self.buffers.touched.raw, CUT_SHORT_BYTE);
        self.cut_short.record(&mut encoder, touched, byte);
        if let Some(billboards) = &mut self.billboards {
            billboards.record_cut_short(&mut encoder);
        }
        self.gpu.queue.submit([encoder.finish()]);
        self.timer.collect(&self.gpu);
        self.cut_short.collect(&self.gpu);
        if let Some(billboards) = &mut self.billboards {
            billboards.cut_short.collect(&self.gpu);
        }
    }

    /// Whether the driver has ended loops of kernels early, as far as is known without waiting: for a
    /// window, which reads no state back.
    ///
    /// # Errors
    /// `CutShort`, from a frame or two later on.
    pub fn check_late(&self) -> Result<(), GpuError> {
        let of_boards = self.billboards.as_ref().map_or(0, |b| b.cut_short.value());
        self.check_cut_short(self.cut_short.value() + of_boards)
    }

    /// Writes the nodes of active tiles' plants as they stand after the last tick; once per
    /// displayed frame.
    ///
    /// # Errors
    /// The driver's, as when memory is short.
    pub fn recover(&mut self) -> Result<(), GpuError> {
        if self.active == 0 {
            return Ok(());
        }
        self.drawn.grow_to(&self.gpu, self.buffers.state.len())?;
        let mut recording = Recording {
            encoder: &mut self.encoder,
            timer: &mut self.timer,
            field: &self.field,
        };
        self.kernels
            .recover
            .record(&self.gpu, &mut recording, &self.buffers, &self.drawn);
        if let Some(billboards) = &mut self.billboards {
            billboards.recover(&self.gpu, &mut recording, &self.buffers)?;
        }
        self.dispatches.recover += 1;
        self.submit();
        Ok(())
    }

    /// Nodes of active tiles as drawn: a slab is `plants_per_tile · (segments + 1)` rows, per plant
    /// its root first, with w = 0 where nothing grows. Replaced when it grows, in `recover`.
    pub fn drawn(&self) -> &Buffer<[f32; 4]> {
        &self.drawn
    }

    /// Records of the active tiles, colliding ones first, and how many there are. Replaced when it
    /// grows, in `assign_slabs` and `upload`.
    pub fn tiles(&self) -> (&Buffer<TileRecord>, u32) {
        (&self.buffers.tiles, self.active)
    }

    /// Makes room for the meadow's slabs and sets the numbers, tiles and wind of its current tick.
    pub(super) fn take_in(&mut self, meadow: &Meadow) -> Result<(), GpuError> {
        let (gpu, buffers) = (&self.gpu, &mut self.buffers);
        let slabs = meadow.tiles.slabs.high_water() as usize;
        grow_doubling(gpu, &mut buffers.state, slabs, meadow, self.slab_rows)?;

        let grid = &meadow.field.grid;
        let all = || meadow.work.tiles.iter();
        let collides = |tile: &&crate::sim::work::TileWork| !tile.contacts.is_empty();
        let tiles: Vec<TileRecord> = all()
            .filter(collides)
            .chain(all().filter(|tile| !collides(tile)))
            .map(|tile| TileRecord::active(&meadow.field, tile))
            .collect();
        self.active = tiles.len() as u32;
        self.colliding = all().filter(collides).count() as u32;

        self.turns = PassTurns::new(meadow);
        let tick = TickUniform::new(meadow, self.colliding, self.turns);
        buffers.tick.write(gpu, 0, &[tick])?;
        buffers.tiles.write_or_grow(gpu, &tiles)?;
        self.field.set_wind(gpu, &meadow.work.wind)?;
        let plants = grid.plants_per_tile();
        let listed = TOUCHED_HEADER as usize + 2 * self.colliding as usize * plants as usize;
        buffers.touched.grow_to(gpu, listed)?;
        let groups = |tiles| [plants.div_ceil(self.kernels.workgroup), tiles, 1];
        let [collide, recover] = [groups(self.colliding), groups(self.active)];
        buffers
            .groups
            .write(gpu, COLLIDE_GROUPS as usize, &collide)?;
        buffers
            .groups
            .write(gpu, RECOVER_GROUPS as usize, &recover)?;
        match &mut self.billboards {
            Some(billboards) => billboards.take_in(gpu, meadow, [self.colliding, self.active]),
            None => Ok(()),
        }
    }
}

/// Makes room for `slabs` slabs, doubling up to the meadow's limit.
fn grow_doubling(
    gpu: &Gpu,
    state: &mut Buffer<[u32; 4]>,
    slabs: usize,
    meadow: &Meadow,
    slab_rows: usize,
) -> Result<(), GpuError> {
    if slabs * slab_rows > state.len() {
        let doubled = slabs
            .next_power_of_two()
            .min(meadow.tiles.slabs.limit() as usize);
        state.grow_to(gpu, doubled.max(slabs) * slab_rows)?;
    }
    Ok(())
}

fn new_encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("grass"),
        })
}
