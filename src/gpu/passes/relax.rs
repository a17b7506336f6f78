//! Relax on the device: one invocation per touched plant, as many as the collide pass listed; their
//! number never visits the CPU.
//! Shader: `shaders/relax.wgsl`; twin: `src/sim/relax.rs`.

use super::{Access, Groups, Kernel, Recording};
use crate::gpu::cubes::CubeBuffers;
use crate::gpu::grass_buffers::{GrassBuffers, RELAX_GROUPS};
use crate::gpu::turns::{Turns, TurnsPass};
use crate::gpu::{Gpu, GpuError};

/// The kernel that sets the size of a relax pass from the number of touched plants.
pub(super) fn count_groups(gpu: &Gpu, workgroup: u32) -> Result<Kernel, GpuError> {
    let bindings = [(4, Access::Write), (7, Access::Write)];
    Kernel::new(gpu, "relax.wgsl", "count_groups", &bindings, workgroup)
}

/// The pass that pushes touched plants out and restores their shape.
#[derive(Clone, Debug)]
pub struct RelaxPass {
    count_groups: Kernel,
    relax: Kernel,
}

impl RelaxPass {
    /// # Errors
    /// The shader's.
    pub fn new(gpu: &Gpu, workgroup: u32) -> Result<Self, GpuError> {
        let bindings = [
            (0, Access::Uniform),
            (1, Access::Read),
            (2, Access::Read),
            (3, Access::Write),
            (4, Access::Write),
            (5, Access::Read),
            (6, Access::Read),
        ];
        Ok(Self {
            count_groups: count_groups(gpu, workgroup)?,
            relax: Kernel::new(gpu, "relax.wgsl", "relax", &bindings, workgroup)?,
        })
    }

    /// Responds every plant in the list of touched ones, in as many turns as it takes.
    pub fn record(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        grass: &GrassBuffers,
        cubes: &CubeBuffers,
        turns: &TurnsPass,
        count: Turns,
    ) {
        let counted = self
            .count_groups
            .bind(gpu, &[(4, &grass.touched.raw), (7, &grass.groups.raw)]);
        self.count_groups
            .record(into, &counted, Groups::Direct([1, 1, 1]));
        let bound = self.relax.bind(
            gpu,
            &[
                (0, &grass.tick.raw),
                (1, &grass.tiles.raw),
                (2, &grass.contacts.raw),
                (3, &grass.state.raw),
                (4, &grass.touched.raw),
                (5, &cubes.texels.raw),
                (6, &cubes.planes.raw),
            ],
        );
        let groups = Groups::Indirect(&grass.groups, RELAX_GROUPS);
        turns.record(gpu, into, &grass.touched, count, |into| {
            self.relax.record(into, &bound, groups);
        });
    }
}
