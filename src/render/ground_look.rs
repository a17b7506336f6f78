//! The colours of the ground, as a texture that the ground and the plants on it share, and what
//! the ground of each kind looks like.

use crate::field::Field;
use crate::field::kinds::MAX_TASTES;
use crate::gpu::Gpu;
use crate::scene::Form;
use crate::terrain::ColourMap;

use super::colour_mips::{linear_texels, srgb_texture};
use super::error::RenderError;

/// How the ground looks.
#[derive(Clone, Copy, Debug)]
pub struct GroundLook<'a> {
    pub map: &'a ColourMap,
    /// Colour of bare earth, linear RGB.
    pub soil_rgb: [f32; 3],
}

/// The map on the device.
#[derive(Clone, Debug)]
pub(super) struct GroundTexture {
    pub(super) view: wgpu::TextureView,
    pub(super) sampler: wgpu::Sampler,
    /// Extent of the map along x and z.
    pub(super) size_m: [f32; 2],
    /// Mean colour, linear RGB.
    pub(super) mean_rgb: [f32; 3],
}

impl GroundTexture {
    /// Uploads the map.
    ///
    /// # Errors
    /// A size the device cannot hold, or bytes that do not fit the size.
    pub(super) fn new(gpu: &Gpu, map: &ColourMap) -> Result<Self, RenderError> {
        let (width, height) = (map.columns, map.rows);
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if width == 0 || height == 0 || width > limit || height > limit {
            return Err(RenderError::BadInput {
                what: "the base-colour map's size",
                found: format!("{width} x {height} texels; the device's limit is {limit}"),
                wanted: "give each side 1 texel to the limit",
            });
        }
        if map.rgba8.len() as u64 != u64::from(width) * u64::from(height) * 4 {
            return Err(RenderError::BadInput {
                what: "the base-colour map",
                found: format!("{} bytes for {width} x {height} texels", map.rgba8.len()),
                wanted: "give four bytes per texel",
            });
        }
        let texture = srgb_texture(gpu, "the base-colour map", [width, height], &map.rgba8)?;
        // Mirrored, so that the land beyond the edge goes on in the field's colours.
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("base colour"),
            address_mode_u: wgpu::AddressMode::MirrorRepeat,
            address_mode_v: wgpu::AddressMode::MirrorRepeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        Ok(Self {
            view: texture.create_view(&Default::default()),
            sampler,
            size_m: [width, height].map(|n| (f64::from(n) * map.texel_m) as f32),
            mean_rgb: mean_rgb(&map.rgba8),
        })
    }
}

/// What the ground of a kind looks like, as the shader knows it.
pub(super) const LOOK_GRASS: u32 = 0;
pub(super) const LOOK_GRAVEL: u32 = 1;
pub(super) const LOOK_LITTER: u32 = 2;
pub(super) const LOOK_BARE: u32 = 3;
/// Rows of four that hold a number for every kind and bare ground.
pub(super) const TASTE_ROWS: u32 = (MAX_TASTES as u32).div_ceil(4);

/// The looks of a field's kinds and bare grounds.
pub(super) fn looks(field: &Field) -> [[u32; 4]; TASTE_ROWS as usize] {
    let mut looks = [[LOOK_BARE; 4]; TASTE_ROWS as usize];
    for (n, kind) in field.seeds.species.iter().enumerate() {
        looks[n / 4][n % 4] = match kind.form {
            Form::Blade | Form::Flower { .. } => LOOK_GRASS,
            Form::Leaf | Form::Twig => LOOK_LITTER,
            Form::Gravel => LOOK_GRAVEL,
        };
    }
    looks
}

/// Mean of sRGB-encoded texels, as linear light.
fn mean_rgb(rgba8: &[u8]) -> [f32; 3] {
    let mut sum = [0.0_f64; 3];
    let texels = linear_texels(rgba8);
    for texel in &texels {
        for (total, &light) in sum.iter_mut().zip(texel) {
            *total += f64::from(light);
        }
    }
    sum.map(|total| (total / texels.len().max(1) as f64) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_is_of_light_not_of_bytes() {
        let [r, g, b] = mean_rgb(&[255, 0, 188, 255, 0, 0, 188, 255]);
        assert!((r - 0.5).abs() < 1e-6 && g == 0.0);
        // sRGB 188 is 0.503 of full light, to half a byte's step of 0.0024.
        assert!((b - 0.503).abs() < 0.0024, "{b}");
    }
}
