//! One host file per compute pass: its bindings, its pipeline, how it is dispatched.
//!
//! Bind group 0 is the field ([`FieldBuffers`](super::FieldBuffers)); bind group 1 holds what one
//! pass works on. Kernels live as long as the process needs them.

pub mod billboard;
pub mod collide;
pub mod depth_cube;
pub mod recover;
pub mod relax;

use super::wgsl::{self, Constant, WgslFile};
use super::{Buffer, FieldBuffers, Gpu, GpuError, PassTimer};

/// Invocations of a workgroup: the plants of a tile, or the texels of a cube, that run together. Any
/// number gives the same results; this one fits the widths of all hardware.
pub const WORKGROUP: u32 = 64;
/// Most workgroups along one side of a dispatch (WebGPU's default limit).
pub const MOST_GROUPS: u32 = 65_535;

/// How a kernel uses a binding.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Access {
    Uniform,
    Read,
    Write,
}

/// One entry point of a pass with the layout of its bind group 1.
#[derive(Clone, Debug)]
pub struct Kernel {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    name: &'static str,
}

/// Workgroups of a dispatch.
#[derive(Clone, Copy, Debug)]
pub enum Groups<'a> {
    Direct([u32; 3]),
    /// Read from a buffer when the pass runs: three words from the given one on.
    Indirect(&'a Buffer<u32>, u32),
}

/// What passes of one tick or frame are recorded into.
#[derive(Debug)]
pub struct Recording<'a> {
    pub encoder: &'a mut wgpu::CommandEncoder,
    pub timer: &'a mut PassTimer,
    pub field: &'a FieldBuffers,
}

impl Kernel {
    /// Compiles entry point `name` of a pass's file for workgroups of a size.
    ///
    /// # Errors
    /// The shader's, with file and line.
    pub fn new(
        gpu: &Gpu,
        path: &'static str,
        name: &'static str,
        bindings: &[(u32, Access)],
        workgroup: u32,
    ) -> Result<Self, GpuError> {
        Self::of_library(gpu, wgsl::PASSES, path, name, bindings, workgroup)
    }

    /// The same, of a file of another library of shaders.
    ///
    /// # Errors
    /// The shader's, with file and line.
    pub fn of_library(
        gpu: &Gpu,
        library: &'static [WgslFile],
        path: &'static str,
        name: &'static str,
        bindings: &[(u32, Access)],
        workgroup: u32,
    ) -> Result<Self, GpuError> {
        let size = Constant {
            name: "WORKGROUP",
            value: workgroup.into(),
        };
        Self::with_constants(gpu, library, path, name, bindings, &[size])
    }

    /// The same with other values for constants.
    ///
    /// # Errors
    /// The shader's, with file and line.
    pub fn with_constants(
        gpu: &Gpu,
        library: &'static [WgslFile],
        path: &'static str,
        name: &'static str,
        bindings: &[(u32, Access)],
        constants: &[Constant],
    ) -> Result<Self, GpuError> {
        let entries: Vec<_> = bindings.iter().map(|&b| layout_entry(b)).collect();
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(name),
                entries: &entries,
            });
        let libraries = [library, wgsl::SHARED];
        let source = wgsl::assemble_with(pass_file(library, path)?, &libraries, constants)?;
        let field = FieldBuffers::layout(gpu);
        Ok(Self {
            pipeline: gpu.compute_pipeline(&source, name, &[&field, &layout])?,
            layout,
            name,
        })
    }

    /// Binds the buffers that the pass works on, in the order of the layout's bindings.
    pub fn bind(&self, gpu: &Gpu, bindings: &[(u32, &wgpu::Buffer)]) -> wgpu::BindGroup {
        let entries: Vec<_> = bindings
            .iter()
            .map(|&(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.name),
            layout: &self.layout,
            entries: &entries,
        })
    }

    /// Records the pass, timed under the kernel's name.
    pub fn record(&self, into: &mut Recording<'_>, bound: &wgpu::BindGroup, groups: Groups<'_>) {
        let mut pass = into
            .encoder
            .begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(self.name),
                timestamp_writes: into.timer.compute(self.name),
            });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &into.field.bind_group, &[]);
        pass.set_bind_group(1, bound, &[]);
        match groups {
            Groups::Direct([x, y, z]) => pass.dispatch_workgroups(x, y, z),
            Groups::Indirect(buffer, first) => {
                pass.dispatch_workgroups_indirect(&buffer.raw, u64::from(first) * 4);
            }
        }
    }
}

fn layout_entry((binding, access): (u32, Access)) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: match access {
                Access::Uniform => wgpu::BufferBindingType::Uniform,
                Access::Read => wgpu::BufferBindingType::Storage { read_only: true },
                Access::Write => wgpu::BufferBindingType::Storage { read_only: false },
            },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}

fn pass_file(
    library: &'static [WgslFile],
    path: &'static str,
) -> Result<&'static WgslFile, GpuError> {
    library
        .iter()
        .find(|file| file.path == path)
        .ok_or_else(|| GpuError::Rejected {
            what: format!("pass {path}"),
            reason: "its shader is not embedded".into(),
        })
}
