//! The textures a picture is built up in.

use crate::gpu::Gpu;

use super::LIGHT_FORMAT;
use super::error::RenderError;
use super::pipeline::DEPTH_FORMAT;

/// Colour and depth of one picture size.
#[derive(Debug)]
pub(super) struct Targets {
    pub(super) size: [u32; 2],
    /// Light per sample; the same as `resolved` without multisampling.
    light: wgpu::TextureView,
    depth: wgpu::TextureView,
    /// Light per pixel.
    pub(super) resolved: wgpu::TextureView,
    samples: u32,
}

/// Which of a picture's passes one is: they are parted so that layers can be timed alone.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Part {
    Only,
    First,
    Middle,
    Last,
}

impl Part {
    fn load<V>(self, empty: V) -> wgpu::LoadOp<V> {
        match self {
            Self::Only | Self::First => wgpu::LoadOp::Clear(empty),
            Self::Middle | Self::Last => wgpu::LoadOp::Load,
        }
    }
}

/// Samples per pixel: 4 where the light format can have them, else 1.
pub(super) fn most_samples(gpu: &Gpu) -> u32 {
    let flags = LIGHT_FORMAT
        .guaranteed_format_features(gpu.device.features())
        .flags;
    let needed = wgpu::TextureFormatFeatureFlags::MULTISAMPLE_X4
        | wgpu::TextureFormatFeatureFlags::MULTISAMPLE_RESOLVE;
    if flags.contains(needed) { 4 } else { 1 }
}

/// Bytes of a picture's textures: light and depth per sample, resolved light, the shown picture and its
/// copy for reading.
pub(super) fn picture_bytes([width, height]: [u32; 2], samples: u32) -> u64 {
    let per_pixel = u64::from(samples) * (8 + 4) + 8 + 4 + 4;
    u64::from(width) * u64::from(height) * per_pixel
}

/// Refuses a picture that the device cannot hold, before anything is allocated.
///
/// # Errors
/// `PictureSize` or `PictureBytes`.
pub(super) fn check_size(gpu: &Gpu, size: [u32; 2], samples: u32) -> Result<(), RenderError> {
    let [width, height] = size;
    let limits = gpu.device.limits();
    let limit = limits.max_texture_dimension_2d;
    if size.iter().any(|&side| side == 0 || side > limit) {
        return Err(RenderError::PictureSize {
            width,
            height,
            limit,
        });
    }
    let asked = picture_bytes(size, samples);
    if asked > limits.max_buffer_size {
        return Err(RenderError::PictureBytes {
            width,
            height,
            asked,
            limit: limits.max_buffer_size,
        });
    }
    Ok(())
}

impl Targets {
    pub(super) fn new(gpu: &Gpu, size: [u32; 2], samples: u32) -> Result<Self, RenderError> {
        check_size(gpu, size, samples)?;
        let texture = |label, format, sample_count, usage| {
            gpu.device
                .create_texture(&wgpu::TextureDescriptor {
                    label: Some(label),
                    size: wgpu::Extent3d {
                        width: size[0],
                        height: size[1],
                        depth_or_array_layers: 1,
                    },
                    mip_level_count: 1,
                    sample_count,
                    dimension: wgpu::TextureDimension::D2,
                    format,
                    usage,
                    view_formats: &[],
                })
                .create_view(&Default::default())
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let read = attachment | wgpu::TextureUsages::TEXTURE_BINDING;
        Ok(gpu.guarded("the picture's targets", || {
            let resolved = texture("light", LIGHT_FORMAT, 1, read);
            Self {
                size,
                light: if samples > 1 {
                    texture("light per sample", LIGHT_FORMAT, samples, attachment)
                } else {
                    resolved.clone()
                },
                depth: texture("depth", DEPTH_FORMAT, samples, attachment),
                resolved,
                samples,
            }
        })?)
    }

    /// Starts a pass that layers draw into. Depth starts at 0, infinitely far away.
    pub(super) fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        part: Part,
        times: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'e> {
        let multisampled = self.samples > 1;
        let is_last = matches!(part, Part::Only | Part::Last);
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.light,
                depth_slice: None,
                resolve_target: (multisampled && is_last).then_some(&self.resolved),
                ops: wgpu::Operations {
                    load: part.load(wgpu::Color::BLACK),
                    store: if multisampled && is_last {
                        wgpu::StoreOp::Discard
                    } else {
                        wgpu::StoreOp::Store
                    },
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: part.load(0.0),
                    store: if is_last {
                        wgpu::StoreOp::Discard
                    } else {
                        wgpu::StoreOp::Store
                    },
                }),
                stencil_ops: None,
            }),
            timestamp_writes: times,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }
}
