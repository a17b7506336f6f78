//! What touched billboards do: one invocation each, as many as the collide pass listed.
//! Shader: `shaders/billboard/relax.wgsl`; twin: `src/sim/billboard/relax.rs`.

use super::{Around, bind_responding, responding};
use crate::gpu::billboards::BillboardBuffers;
use crate::gpu::grass_buffers::RELAX_GROUPS;
use crate::gpu::passes::relax::count_groups;
use crate::gpu::passes::{Groups, Kernel, Recording};
use crate::gpu::turns::Turns;
use crate::gpu::wgsl::Constant;
use crate::gpu::{Gpu, GpuError};

/// The pass that pushes touched billboards out and restores their shape.
#[derive(Clone, Debug)]
pub struct RelaxBillboards {
    count_groups: Kernel,
    relax: Kernel,
}

impl RelaxBillboards {
    /// # Errors
    /// The shader's.
    pub fn new(gpu: &Gpu, constants: &[Constant], workgroup: u32) -> Result<Self, GpuError> {
        let (path, name) = ("billboard/relax.wgsl", "relax_billboards");
        Ok(Self {
            count_groups: count_groups(gpu, workgroup)?,
            relax: responding(gpu, path, name, constants)?,
        })
    }

    /// Responds every billboard on the list, in as many turns as it takes.
    pub fn record(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        boards: &BillboardBuffers,
        around: Around<'_>,
        turns: Turns,
    ) {
        let listed = [(4, &boards.touched.raw), (7, &boards.groups.raw)];
        let counted = self.count_groups.bind(gpu, &listed);
        self.count_groups
            .record(into, &counted, Groups::Direct([1, 1, 1]));
        let bound = bind_responding(gpu, &self.relax, boards, around);
        let groups = Groups::Indirect(&boards.groups, RELAX_GROUPS);
        (around.turns).record(gpu, into, &boards.touched, turns, |into| {
            self.relax.record(into, &bound, groups);
        });
    }
}
