//! The base map's bytes on the device, for the choice of kinds in integers.

use super::{Gpu, GpuError};
use crate::field::Field;

/// The base map as stored; one texel where kinds do not look at it.
///
/// # Errors
/// A map larger than the device can hold.
pub(super) fn base_texels(gpu: &Gpu, field: &Field) -> Result<wgpu::TextureView, GpuError> {
    let map = field.seeds.kinds.as_ref().map(|kinds| &kinds.map);
    let (width, height) = map.map_or((1, 1), |map| (map.columns, map.rows));
    let limit = gpu.device.limits().max_texture_dimension_2d;
    if width.max(height) > limit {
        return Err(GpuError::TooLarge {
            what: "the base map's longer side, in texels".to_owned(),
            asked: width.max(height).into(),
            limit: limit.into(),
            limit_name: "max_texture_dimension_2d",
        });
    }
    let size = wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    let texture = gpu.guarded("the base map's texels", || {
        gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("base map's texels"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        })
    })?;
    if let Some(map) = map {
        gpu.queue.write_texture(
            texture.as_image_copy(),
            &map.rgba8,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(width * 4),
                rows_per_image: None,
            },
            size,
        );
    }
    Ok(texture.create_view(&Default::default()))
}
