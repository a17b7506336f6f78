//! Blades of grass (P15 sections 2.3, 2.4). Shader: `shaders/blades.wgsl`.
//!
//! A plant is drawn as a tuft: the simulated blade, and companions that move with it. Near by every
//! one is drawn; `blade_tiles.rs` says how many farther off.

use super::plant_form::{FormDrawing, HALVING_STRIDES};

/// Companions stand at most this far from their plant's root, in metres.
pub(super) const TUFT_RADIUS_M: f32 = 0.045;
/// Range of a companion's turn about its plant's root, in turns.
pub(super) const TUFT_TURNS: f32 = 0.16;

pub(super) const FORM: FormDrawing = FormDrawing {
    shader: "blades.wgsl",
    vertex: "blade_vertex",
    fragment: "blade_fragment",
    topology: wgpu::PrimitiveTopology::TriangleStrip,
    // In place of P15 eq. 4: see `detail_of`.
    strides: HALVING_STRIDES,
    vertices: |steps| 2 * steps + 1,
};
