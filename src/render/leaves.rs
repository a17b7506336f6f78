//! Broad leaves: two strips along the midrib, cut out by an alpha mask. Shader:
//! `shaders/leaves.wgsl`.

use super::plant_form::{FormDrawing, HALVING_STRIDES};

pub(super) const FORM: FormDrawing = FormDrawing {
    shader: "leaves.wgsl",
    vertex: "leaf_vertex",
    fragment: "leaf_fragment",
    topology: wgpu::PrimitiveTopology::TriangleList,
    strides: HALVING_STRIDES,
    vertices: |steps| 12 * steps,
};
