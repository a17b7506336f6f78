//! Collide on the device: which plants a body touches. A workgroup is a run of one colliding tile's
//! plants; tiles that do not collide are not dispatched.
//! Shader: `shaders/collide.wgsl`; twin: `src/sim/collide.rs`.

use super::{Access, Groups, Kernel, Recording};
use crate::gpu::cubes::CubeBuffers;
use crate::gpu::grass_buffers::{COLLIDE_GROUPS, GrassBuffers};
use crate::gpu::turns::{Turns, TurnsPass};
use crate::gpu::{Gpu, GpuError};

/// The pass that lists touched plants.
#[derive(Clone, Debug)]
pub struct CollidePass {
    collide: Kernel,
}

impl CollidePass {
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
        let collide = Kernel::new(gpu, "collide.wgsl", "collide", &bindings, workgroup)?;
        Ok(Self { collide })
    }

    /// Empties the list of touched plants and fills it anew, in as many turns as it takes.
    pub fn record(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        grass: &GrassBuffers,
        cubes: &CubeBuffers,
        turns: &TurnsPass,
        count: Turns,
    ) {
        into.encoder.clear_buffer(&grass.touched.raw, 0, Some(4));
        let bound = self.collide.bind(
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
        let groups = Groups::Indirect(&grass.groups, COLLIDE_GROUPS);
        turns.record(gpu, into, &grass.touched, count, |into| {
            self.collide.record(into, &bound, groups);
        });
    }
}
