//! Twigs: three-sided sticks with a side branch. Shader: `shaders/twigs.wgsl`.

use super::plant_form::{FormDrawing, HALVING_STRIDES};

/// Sides of a stick.
const SIDES: u32 = 3;

pub(super) const FORM: FormDrawing = FormDrawing {
    shader: "twigs.wgsl",
    vertex: "twig_vertex",
    fragment: "twig_fragment",
    topology: wgpu::PrimitiveTopology::TriangleList,
    strides: HALVING_STRIDES,
    // The branch is one more segment.
    vertices: |steps| 6 * SIDES * (steps + 1),
};
