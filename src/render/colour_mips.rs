//! Levels of a colour map for places that are far away: each has the mean light of the one before.

use crate::gpu::{Gpu, GpuError};

/// A texture of sRGB texels with all its levels.
///
/// # Errors
/// The driver's, as when memory is short.
pub(super) fn srgb_texture(
    gpu: &Gpu,
    label: &'static str,
    size: [u32; 2],
    rgba8: &[u8],
) -> Result<wgpu::Texture, GpuError> {
    let extent = |[width, height]: [u32; 2]| wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    let coarser = coarser_levels(size, rgba8);
    let texture = gpu.guarded(label, || {
        gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: extent(size),
            mip_level_count: 1 + coarser.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        })
    })?;
    let coarser = coarser.iter().map(|level| (level.size, &level.rgba8[..]));
    for (level, (size, rgba8)) in [(size, rgba8)].into_iter().chain(coarser).enumerate() {
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                mip_level: level as u32,
                ..texture.as_image_copy()
            },
            rgba8,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(size[0] * 4),
                rows_per_image: None,
            },
            extent(size),
        );
    }
    Ok(texture)
}

/// One level: columns, rows, and sRGB texels of four bytes, row by row.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(super) struct ColourLevel {
    pub(super) size: [u32; 2],
    pub(super) rgba8: Vec<u8>,
}

/// The levels after a map itself, down to a single texel. A side that is odd gives its last row or column
/// to the one before.
pub(super) fn coarser_levels(size: [u32; 2], rgba8: &[u8]) -> Vec<ColourLevel> {
    let mut levels: Vec<ColourLevel> = Vec::new();
    let mut last = (size, linear_texels(rgba8));
    while last.0 != [1, 1] {
        last = halved(last.0, &last.1);
        levels.push(ColourLevel {
            size: last.0,
            rgba8: last.1.iter().copied().flat_map(encoded_texel).collect(),
        });
    }
    levels
}

/// sRGB-encoded texels as linear light.
pub(super) fn linear_texels(rgba8: &[u8]) -> Vec<[f32; 3]> {
    let light: Vec<f32> = (0..=255).map(linear).collect();
    let texels = rgba8.chunks_exact(4);
    let of_texel = |texel: &[u8]| [0, 1, 2].map(|colour| light[usize::from(texel[colour])]);
    texels.map(of_texel).collect()
}

fn halved([columns, rows]: [u32; 2], texels: &[[f32; 3]]) -> ([u32; 2], Vec<[f32; 3]>) {
    let size = [columns, rows].map(|side| (side / 2).max(1));
    let mut means = Vec::with_capacity((size[0] * size[1]) as usize);
    for row in 0..size[1] {
        for column in 0..size[0] {
            let across = covered(column, size[0], columns);
            let down = covered(row, size[1], rows);
            let mut sum = [0.0_f32; 3];
            for y in down.clone() {
                for x in across.clone() {
                    let texel = texels[(y * columns + x) as usize];
                    sum = [0, 1, 2].map(|colour| sum[colour] + texel[colour]);
                }
            }
            let count = (across.len() * down.len()) as f32;
            means.push(sum.map(|total| total / count));
        }
    }
    (size, means)
}

/// Which of `all` finer texels one of `count` coarser ones stands for.
fn covered(coarse: u32, count: u32, all: u32) -> std::ops::Range<u32> {
    let first = 2 * coarse;
    first..if coarse + 1 == count { all } else { first + 2 }
}

/// Light of an sRGB byte (IEC 61966-2-1).
fn linear(byte: u8) -> f32 {
    let encoded = f64::from(byte) / 255.0;
    let light = if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    };
    light as f32
}

fn encoded_texel(light: [f32; 3]) -> [u8; 4] {
    let [r, g, b] = light.map(|light| {
        let encoded = if light <= 0.003_130_8 {
            12.92 * light
        } else {
            1.055 * light.powf(1.0 / 2.4) - 0.055
        };
        (encoded * 255.0 + 0.5) as u8
    });
    [r, g, b, 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Black and white in turns are half the light, which is byte 188, at every level.
    #[test]
    fn levels_keep_the_light() {
        let board: Vec<u8> = (0..7 * 4)
            .flat_map(|n| [[0, 0, 0, 255], [255; 4]][(n % 7 + n / 7) % 2])
            .collect();
        let levels = coarser_levels([7, 4], &board);
        let sizes: Vec<_> = levels.iter().map(|level| level.size).collect();
        assert_eq!(sizes, [[3, 2], [1, 1]]);
        for texel in levels.iter().flat_map(|level| level.rgba8.chunks_exact(4)) {
            assert_eq!(texel, [188, 188, 188, 255]);
        }
        assert!(coarser_levels([1, 1], &[9; 4]).is_empty());
        assert_eq!(coarser_levels([1, 5], &[9; 20])[1].size, [1, 1]);
    }

    #[test]
    fn bytes_come_back() {
        for byte in 0..=255 {
            assert_eq!(encoded_texel([linear(byte); 3]), [byte, byte, byte, 255]);
        }
    }
}
