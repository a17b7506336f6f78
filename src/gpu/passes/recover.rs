//! Recover on the device: the nodes of active tiles' plants as they are drawn, once per displayed
//! frame. Shader: `shaders/recover.wgsl`; twin: `src/sim/recover.rs`.

use super::{Access, Groups, Kernel, Recording};
use crate::gpu::grass_buffers::{GrassBuffers, RECOVER_GROUPS};
use crate::gpu::{Buffer, Gpu, GpuError};

/// The pass that writes drawn nodes.
#[derive(Clone, Debug)]
pub struct RecoverPass {
    recover: Kernel,
}

impl RecoverPass {
    /// # Errors
    /// The shader's.
    pub fn new(gpu: &Gpu, workgroup: u32) -> Result<Self, GpuError> {
        let bindings = [
            (0, Access::Uniform),
            (1, Access::Read),
            (3, Access::Read),
            (7, Access::Write),
        ];
        let recover = Kernel::new(gpu, "recover.wgsl", "recover", &bindings, workgroup)?;
        Ok(Self { recover })
    }

    /// Writes the nodes of every active tile into its slab of `drawn`.
    pub fn record(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        grass: &GrassBuffers,
        drawn: &Buffer<[f32; 4]>,
    ) {
        let bound = self.recover.bind(
            gpu,
            &[
                (0, &grass.tick.raw),
                (1, &grass.tiles.raw),
                (3, &grass.state.raw),
                (7, &drawn.raw),
            ],
        );
        let groups = Groups::Indirect(&grass.groups, RECOVER_GROUPS);
        self.recover.record(into, &bound, groups);
    }
}
