//! Textures of four bytes a texel.

use super::{Gpu, GpuError};

/// A texture of `width` by `height` texels in a format of four bytes each, filled with `rgba8`, row by
/// row; zeros where there is none.
///
/// # Errors
/// The driver's, as when memory is short.
pub(super) fn rgba8_texture(
    gpu: &Gpu,
    label: &'static str,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    rgba8: Option<&[u8]>,
) -> Result<wgpu::Texture, GpuError> {
    let size = wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    let texture = gpu.guarded(label, || {
        gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        })
    })?;
    if let Some(rgba8) = rgba8 {
        gpu.queue.write_texture(
            texture.as_image_copy(),
            rgba8,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(width * 4),
                rows_per_image: None,
            },
            size,
        );
    }
    Ok(texture)
}
