//! The nodes of active tiles' billboards as they are drawn, once per displayed frame.
//! Shader: `shaders/billboard/recover.wgsl`; twin: `src/sim/billboard/recover.rs`.

use crate::gpu::billboards::BillboardBuffers;
use crate::gpu::grass_buffers::{GrassBuffers, RECOVER_GROUPS};
use crate::gpu::passes::{Access, Groups, Kernel, Recording};
use crate::gpu::wgsl::{self, Constant};
use crate::gpu::{Gpu, GpuError};

/// The pass that writes drawn nodes.
#[derive(Clone, Debug)]
pub struct RecoverBillboards {
    recover: Kernel,
}

impl RecoverBillboards {
    /// # Errors
    /// The shader's.
    pub fn new(gpu: &Gpu, constants: &[Constant]) -> Result<Self, GpuError> {
        let bindings = [
            (0, Access::Uniform),
            (1, Access::Read),
            (3, Access::Write),
            (7, Access::Write),
            (8, Access::Uniform),
        ];
        let (path, name) = ("billboard/recover.wgsl", "recover_billboards");
        let library = wgsl::PASSES;
        Ok(Self {
            recover: Kernel::with_constants(gpu, library, path, name, &bindings, constants)?,
        })
    }

    /// Writes the nodes of every active tile's billboards.
    pub fn record(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        boards: &BillboardBuffers,
        grass: &GrassBuffers,
    ) {
        let bound = self.recover.bind(
            gpu,
            &[
                (0, &grass.tick.raw),
                (1, &grass.tiles.raw),
                (3, &boards.pool.raw),
                (7, &boards.drawn.raw),
                (8, &boards.numbers.raw),
            ],
        );
        let groups = Groups::Indirect(&boards.groups, RECOVER_GROUPS);
        self.recover.record(into, &bound, groups);
    }
}
