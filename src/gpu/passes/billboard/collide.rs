//! Which billboards a body touches: a workgroup is a run of one colliding tile's billboards.
//! Shader: `shaders/billboard/collide.wgsl`; twin: `src/sim/billboard/collide.rs`.

use super::{Around, bind_responding, responding};
use crate::gpu::billboards::BillboardBuffers;
use crate::gpu::grass_buffers::COLLIDE_GROUPS;
use crate::gpu::passes::{Groups, Kernel, Recording};
use crate::gpu::turns::Turns;
use crate::gpu::wgsl::Constant;
use crate::gpu::{Gpu, GpuError};

/// The pass that lists touched billboards.
#[derive(Clone, Debug)]
pub struct CollideBillboards {
    collide: Kernel,
}

impl CollideBillboards {
    /// # Errors
    /// The shader's.
    pub fn new(gpu: &Gpu, constants: &[Constant]) -> Result<Self, GpuError> {
        let (path, name) = ("billboard/collide.wgsl", "collide_billboards");
        Ok(Self {
            collide: responding(gpu, path, name, constants)?,
        })
    }

    /// Empties the list of touched billboards and fills it anew, in as many turns as it takes.
    pub fn record(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        boards: &BillboardBuffers,
        around: Around<'_>,
        turns: Turns,
    ) {
        into.encoder.clear_buffer(&boards.touched.raw, 0, Some(4));
        let bound = bind_responding(gpu, &self.collide, boards, around);
        let groups = Groups::Indirect(&boards.groups, COLLIDE_GROUPS);
        (around.turns).record(gpu, into, &boards.touched, turns, |into| {
            self.collide.record(into, &bound, groups);
        });
    }
}
