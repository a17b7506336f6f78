//! The billboards' passes on the device, compiled for the grid of a scene: one host file each, as for blades.

pub mod collide;
pub mod recover;
pub mod relax;

use super::{Access, Kernel};
use crate::gpu::billboards::BillboardBuffers;
use crate::gpu::cubes::CubeBuffers;
use crate::gpu::grass_buffers::GrassBuffers;
use crate::gpu::turns::TurnsPass;
use crate::gpu::wgsl::{self, Constant};
use crate::gpu::{Gpu, GpuError};
use crate::sim::billboard::Weave;

pub use collide::CollideBillboards;
pub use recover::RecoverBillboards;
pub use relax::RelaxBillboards;

/// What the passes read besides their own buffers.
#[derive(Clone, Copy, Debug)]
pub struct Around<'a> {
    /// Numbers, tiles and contacts of the sub-step.
    pub grass: &'a GrassBuffers,
    pub cubes: &'a CubeBuffers,
    pub turns: &'a TurnsPass,
}

/// The billboards' passes.
#[derive(Clone, Debug)]
pub struct BillboardPasses {
    pub collide: CollideBillboards,
    pub relax: RelaxBillboards,
    pub recover: RecoverBillboards,
}

impl BillboardPasses {
    /// # Errors
    /// The shaders'.
    pub fn new(gpu: &Gpu, weave: &Weave, workgroup: u32) -> Result<Self, GpuError> {
        let constant = |name, value: u32| Constant {
            name,
            value: value.into(),
        };
        let constants = [
            constant("WORKGROUP", workgroup),
            constant("BOARD_COLUMNS", weave.grid.columns as u32),
            constant("BOARD_ROWS", weave.grid.rows as u32),
            constant("BOARD_BENDS", u32::from(weave.has_bends())),
        ];
        Ok(Self {
            collide: CollideBillboards::new(gpu, &constants)?,
            relax: RelaxBillboards::new(gpu, &constants, workgroup)?,
            recover: RecoverBillboards::new(gpu, &constants)?,
        })
    }
}

/// A kernel that reads bodies and changes what is kept of billboards.
fn responding(
    gpu: &Gpu,
    path: &'static str,
    name: &'static str,
    constants: &[Constant],
) -> Result<Kernel, GpuError> {
    let bindings = [
        (0, Access::Uniform),
        (1, Access::Read),
        (2, Access::Read),
        (3, Access::Write),
        (4, Access::Write),
        (5, Access::Read),
        (6, Access::Read),
        (8, Access::Uniform),
    ];
    Kernel::with_constants(gpu, wgsl::PASSES, path, name, &bindings, constants)
}

fn bind_responding(
    gpu: &Gpu,
    kernel: &Kernel,
    boards: &BillboardBuffers,
    around: Around<'_>,
) -> wgpu::BindGroup {
    kernel.bind(
        gpu,
        &[
            (0, &around.grass.tick.raw),
            (1, &around.grass.tiles.raw),
            (2, &around.grass.contacts.raw),
            (3, &boards.pool.raw),
            (4, &boards.touched.raw),
            (5, &around.cubes.texels.raw),
            (6, &around.cubes.planes.raw),
            (8, &boards.numbers.raw),
        ],
    )
}
