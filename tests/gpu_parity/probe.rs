//! A kernel of the test's own, built from the shared shader files.

use libtest_mimic::Failed;
use sward::field::Field;
use sward::gpu::field_data::TileRecord;
use sward::gpu::wgsl::{self, WgslFile};
use sward::gpu::{Buffer, FieldBuffers, Gpu};
use wgpu::BufferUsages;

/// Rows of four words that a probe writes per invocation.
pub const ROWS: usize = 24;

/// Runs `text` (entry point `probe`) with the field in group 0, tile records in group 1's binding
/// 1 and `ROWS` rows per invocation in its binding 7; `groups` workgroups along x, one tile each
/// along y. Returns the rows.
pub fn run(
    gpu: &Gpu,
    text: &'static str,
    field: &Field,
    wind: &sward::field::WindNow,
    tiles: &[TileRecord],
    invocations: u32,
) -> Result<Vec<[u32; 4]>, Failed> {
    let file = WgslFile {
        path: "probe",
        text,
        constants: Vec::new,
    };
    let source = wgsl::assemble(&file, &[wgsl::SHARED])?;
    let group0 = FieldBuffers::layout(gpu);
    let field_buffers = FieldBuffers::new(gpu, &group0, field)?;
    field_buffers.set_wind(gpu, wind)?;
    let tile_buffer = Buffer::with(gpu, "tiles", tiles, BufferUsages::STORAGE)?;
    let count = tiles.len() * invocations as usize * ROWS;
    let out: Buffer<[u32; 4]> = Buffer::new(gpu, "probed", count, BufferUsages::STORAGE)?;
    let entry = |binding, read_only| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let group1 = gpu
        .device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("probe"),
            entries: &[entry(1, true), entry(7, false)],
        });
    let pipeline = gpu.compute_pipeline(&source, "probe", &[&group0, &group1])?;
    let bound = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("probe"),
        layout: &group1,
        entries: &[
            wgpu::BindGroupEntry {
                binding: 1,
                resource: tile_buffer.binding(),
            },
            wgpu::BindGroupEntry {
                binding: 7,
                resource: out.binding(),
            },
        ],
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &field_buffers.bind_group, &[]);
        pass.set_bind_group(1, &bound, &[]);
        pass.dispatch_workgroups(invocations, tiles.len() as u32, 1);
    }
    gpu.queue.submit([encoder.finish()]);
    Ok(out.read(gpu, count)?)
}
