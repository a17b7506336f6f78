//! Stones of eight triangles. Shader: `shaders/gravel.wgsl`.

use super::plant_form::FormDrawing;

pub(super) const FORM: FormDrawing = FormDrawing {
    shader: "gravel.wgsl",
    vertex: "stone_vertex",
    fragment: "stone_fragment",
    topology: wgpu::PrimitiveTopology::TriangleList,
    strides: [u32::MAX; 4],
    vertices: |_| 24,
};
