//! Flowers: a stem and a head of eight triangles with an alpha mask. Shader: `shaders/flowers.wgsl`.

use super::plant_form::{FormDrawing, HALVING_STRIDES};

/// Triangles of a head.
const HEAD_SECTORS: u32 = 8;

pub(super) const FORM: FormDrawing = FormDrawing {
    shader: "flowers.wgsl",
    vertex: "flower_vertex",
    fragment: "flower_fragment",
    topology: wgpu::PrimitiveTopology::TriangleList,
    strides: HALVING_STRIDES,
    vertices: |steps| 6 * steps + 3 * HEAD_SECTORS,
};
