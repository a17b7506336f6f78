//! From scene light to display colours. Shader: `shaders/tonemap.wgsl`.

use wgpu::{BufferUsages, ShaderStages};

use crate::gpu::{Buffer, Gpu, GpuError};
use crate::gpu_struct;

use super::pipeline::{DepthUse, Drawing, UNIFORM, bind_group, group_layout};
use super::targets::Targets;

/// How bright and how colourful a picture comes out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    /// Factor on the scene's light.
    pub exposure: f32,
    /// Exponent of the encoded tone: above 1 darker shadows.
    pub contrast: f32,
    /// Distance from grey: 1 as the curve gives it.
    pub saturation: f32,
}

impl Default for Exposure {
    fn default() -> Self {
        Self {
            exposure: 0.80,
            contrast: 1.22,
            saturation: 1.0,
        }
    }
}

gpu_struct! {
    pub(super) struct Tonemap {
        exposure: f32,
        contrast: f32,
        saturation: f32,
        encode_srgb: u32,
    }
}

/// The last step of a picture.
#[derive(Debug)]
pub(super) struct TonemapLayer {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    settings: Buffer<Tonemap>,
    encodes: bool,
}

impl TonemapLayer {
    /// Shows pictures in targets of this format.
    pub(super) fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Result<Self, GpuError> {
        let layout = group_layout(
            gpu,
            "tonemap",
            &[
                (ShaderStages::FRAGMENT, UNIFORM),
                (
                    ShaderStages::FRAGMENT,
                    wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: false },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                ),
            ],
        );
        let pipeline = Drawing {
            shader: "tonemap.wgsl",
            vertex: "tonemap_vertex",
            fragment: "tonemap_fragment",
            groups: [Some(&layout), None, None, None],
            format,
            depth: DepthUse::None,
            ..Drawing::default()
        }
        .pipeline(gpu)?;
        Ok(Self {
            pipeline,
            layout,
            settings: Buffer::new(gpu, "tonemap", 1, BufferUsages::UNIFORM)?,
            encodes: !format.is_srgb(),
        })
    }

    /// The light of `targets` as a binding; made once per picture size.
    pub(super) fn bind(&self, gpu: &Gpu, targets: &Targets) -> wgpu::BindGroup {
        bind_group(
            gpu,
            "tonemap",
            &self.layout,
            &[
                self.settings.binding(),
                wgpu::BindingResource::TextureView(&targets.resolved),
            ],
        )
    }

    pub(super) fn write(&self, gpu: &Gpu, exposure: Exposure) -> Result<(), GpuError> {
        let settings = Tonemap {
            exposure: exposure.exposure,
            contrast: exposure.contrast,
            saturation: exposure.saturation,
            encode_srgb: u32::from(self.encodes),
        };
        self.settings.write(gpu, 0, &[settings])
    }

    pub(super) fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        light: &wgpu::BindGroup,
        shown: &wgpu::TextureView,
        times: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("tonemap"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: shown,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: None,
            timestamp_writes: times,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, light, &[]);
        pass.draw(0..3, 0..1);
    }
}
