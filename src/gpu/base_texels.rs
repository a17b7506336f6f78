//! The base map's bytes on the device, for the choice of kinds in integers.

use super::texture::rgba8_texture;
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
    let texture = rgba8_texture(
        gpu,
        "the base map's texels",
        wgpu::TextureFormat::Rgba8Uint,
        [width, height],
        map.map(|map| &map.rgba8[..]),
    )?;
    Ok(texture.create_view(&Default::default()))
}
