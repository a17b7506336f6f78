//! Boxes around tiles, coloured by state as in figure 8 of O09. Shader: `shaders/overlay.wgsl`.

use wgpu::{BufferUsages, ShaderStages};

use crate::base::Vec3;
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::gpu_struct;

use super::camera::View;
use super::pipeline::{DepthUse, Drawing, READ_STORAGE, bind_group, group_layout};
use super::view_group::ViewGroups;

/// What a box says.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum TileTone {
    /// Nothing is simulated: its plants are their seeds.
    Resting,
    /// A body may be touching the tile's plants.
    Colliding,
    /// The tile's plants are returning to the wind pose.
    Recovering,
    /// Marked by the user.
    Selected,
}

impl TileTone {
    /// Colour for legends, in display sRGB.
    pub fn srgb(self) -> [u8; 3] {
        match self {
            Self::Resting => [70, 120, 205],
            Self::Colliding => [226, 62, 46],
            Self::Recovering => [76, 200, 92],
            Self::Selected => [245, 205, 70],
        }
    }

    /// Width of the edges, in pixels, and opacity of the sides: resting tiles are many, and their
    /// grass is to be seen.
    fn edge_and_fill(self) -> (f32, f32) {
        match self {
            Self::Resting => (0.8, 0.0),
            _ => (EDGE_PX, FILL),
        }
    }

    /// The same colour as light in the scene, bright enough to stand out in the sun.
    fn light(self) -> [f32; 3] {
        self.srgb()
            .map(|byte| 2.2 * (f32::from(byte) / 255.0).powf(2.2))
    }
}

/// A tile's box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileMark {
    pub low_in_world: [f64; 3],
    pub high_in_world: [f64; 3],
    pub tone: TileTone,
}

gpu_struct! {
    pub(super) struct OverlayBox {
        low_from_eye: [f32; 3],
        edge_px: f32,
        high_from_eye: [f32; 3],
        fill: f32,
        rgb: [f32; 3],
        pad: f32,
    }
}

/// Width of a box's edges, in pixels.
const EDGE_PX: f32 = 1.6;
/// Opacity of a box's sides.
const FILL: f32 = 0.10;

/// Draws the boxes.
#[derive(Debug)]
pub(super) struct OverlayLayer {
    edges: wgpu::RenderPipeline,
    sides: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    boxes: Buffer<OverlayBox>,
    group: wgpu::BindGroup,
    count: u32,
}

impl OverlayLayer {
    pub(super) fn new(gpu: &Gpu, groups: &ViewGroups, samples: u32) -> Result<Self, GpuError> {
        let layout = group_layout(gpu, "overlay", &[(ShaderStages::VERTEX, READ_STORAGE)]);
        let edges = Drawing {
            shader: "overlay.wgsl",
            vertex: "edge_vertex",
            fragment: "overlay_fragment",
            groups: groups.unlit(&layout),
            depth: DepthUse::TestOnly,
            samples,
            blend: Some(wgpu::BlendState::ALPHA_BLENDING),
            ..Drawing::default()
        };
        let sides = Drawing {
            vertex: "side_vertex",
            ..edges
        };
        let (edges, sides) = (edges.pipeline(gpu)?, sides.pipeline(gpu)?);
        let boxes = Buffer::new(gpu, "overlay boxes", 16, BufferUsages::STORAGE)?;
        let group = bind_group(gpu, "overlay", &layout, &[boxes.binding()]);
        Ok(Self {
            edges,
            sides,
            layout,
            boxes,
            group,
            count: 0,
        })
    }

    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        view: &View,
        marks: &[TileMark],
    ) -> Result<(), GpuError> {
        let boxes: Vec<OverlayBox> = marks
            .iter()
            .map(|mark| {
                let (edge_px, fill) = mark.tone.edge_and_fill();
                OverlayBox {
                    low_from_eye: view.from_eye(Vec3::of(mark.low_in_world)),
                    edge_px,
                    high_from_eye: view.from_eye(Vec3::of(mark.high_in_world)),
                    fill,
                    rgb: mark.tone.light(),
                    pad: 0.0,
                }
            })
            .collect();
        self.count = boxes.len() as u32;
        if self.boxes.write_or_grow(gpu, &boxes)? {
            self.group = bind_group(gpu, "overlay", &self.layout, &[self.boxes.binding()]);
        }
        Ok(())
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.count == 0 {
            return;
        }
        pass.set_bind_group(3, &self.group, &[]);
        pass.set_pipeline(&self.sides);
        pass.draw(0..5 * 6, 0..self.count);
        pass.set_pipeline(&self.edges);
        pass.draw(0..12 * 6, 0..self.count);
    }
}
