//! Depth cubes on the device: one job per part, one invocation per texel.
//! Shader: `shaders/depth_cube.wgsl`; twin: `src/sim/depth_cube.rs`.

use super::{Access, Groups, Kernel, Recording};
use crate::gpu::cubes::CubeBuffers;
use crate::gpu::{Gpu, GpuError};

/// The pass that draws depth cubes.
#[derive(Clone, Debug)]
pub struct DepthCubePass {
    draw: Kernel,
    workgroup: u32,
}

impl DepthCubePass {
    /// # Errors
    /// The shader's.
    pub fn new(gpu: &Gpu, workgroup: u32) -> Result<Self, GpuError> {
        let bindings = [
            (5, Access::Write),
            (6, Access::Read),
            (7, Access::Read),
            (8, Access::Read),
        ];
        let draw = Kernel::new(gpu, "depth_cube.wgsl", "draw_cube", &bindings, workgroup)?;
        Ok(Self { draw, workgroup })
    }

    /// Draws the first `jobs` cubes of the buffers' job list.
    pub fn record(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        buffers: &CubeBuffers,
        resolution: u32,
        jobs: u32,
    ) {
        let bound = self.draw.bind(
            gpu,
            &[
                (5, &buffers.texels.raw),
                (6, &buffers.planes.raw),
                (7, &buffers.parts.raw),
                (8, &buffers.jobs.raw),
            ],
        );
        let texels = 6 * resolution * resolution;
        let groups = [texels.div_ceil(self.workgroup), jobs, 1];
        self.draw.record(into, &bound, Groups::Direct(groups));
    }
}
