//! The array of clump pictures: [`CLUMP_VARIANTS`] layers for every kind of a scene, with mip levels.
//!
//! Levels keep the coverage that four samples per pixel draw, each of which is on or off: a level's alpha
//! is scaled until the mean of its alphas, rounded to quarters, is that of the finest. Averages alone would
//! lose the thin blades, whose alphas fall below an eighth.

use rayon::prelude::*;

use crate::field::billboards::CLUMP_VARIANTS;
use crate::gpu::{Gpu, GpuError};
use crate::scene::ClumpKind;

use super::clump_picture::{CLUMP_SIDE, paint};
use super::error::RenderError;

/// The coarsest level has this side: below it four samples cannot tell coverages apart.
const COARSEST_SIDE: u32 = 4;
/// A colour of this factor is a full byte. Bytes are sRGB, so that factors near 1 keep fine steps.
pub(super) const CLUMP_TINT_MOST: f32 = 8.0;

/// One level of a picture: linear colour factors, multiplied by the coverage, and the coverage.
type Level = Vec<[f32; 4]>;

/// The pictures of a scene's clumps on the device.
#[derive(Debug)]
pub(super) struct ClumpTextures {
    pub(super) view: wgpu::TextureView,
    pub(super) sampler: wgpu::Sampler,
    pub(super) bytes: u64,
}

impl ClumpTextures {
    /// Paints and uploads the pictures.
    ///
    /// # Errors
    /// More layers than the device's textures may have; a device that is short of memory.
    pub(super) fn new(gpu: &Gpu, kinds: &[ClumpKind]) -> Result<Self, RenderError> {
        let layers = kinds.len() as u32 * CLUMP_VARIANTS;
        check_layers(layers, gpu.device.limits().max_texture_array_layers)?;
        let pictures = pictures(kinds)?;
        let texture = gpu.guarded("the pictures of clumps", || {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("clumps"),
                size: extent(CLUMP_SIDE, layers),
                mip_level_count: level_count(),
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8UnormSrgb,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            })
        })?;
        let mut bytes = 0;
        for (layer, levels) in (0..).zip(&pictures) {
            for (level, rgba8) in (0..).zip(levels) {
                upload(gpu, &texture, layer, level, rgba8);
                bytes += rgba8.len() as u64;
            }
        }
        Ok(Self {
            view: texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            }),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("clumps"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                // Pressed clumps and quads turned aside are seen at a slant, as ghosts without it.
                anisotropy_clamp: 4,
                ..Default::default()
            }),
            bytes,
        })
    }
}

fn extent(side: u32, layers: u32) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width: side,
        height: side,
        depth_or_array_layers: layers,
    }
}

fn upload(gpu: &Gpu, texture: &wgpu::Texture, layer: u32, level: u32, rgba8: &[u8]) {
    let side = CLUMP_SIDE >> level;
    gpu.queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            mip_level: level,
            origin: wgpu::Origin3d {
                x: 0,
                y: 0,
                z: layer,
            },
            ..texture.as_image_copy()
        },
        rgba8,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(side * 4),
            rows_per_image: None,
        },
        extent(side, 1),
    );
}

fn check_layers(layers: u32, limit: u32) -> Result<(), RenderError> {
    if layers <= limit {
        return Ok(());
    }
    Err(RenderError::ClumpLayers { layers, limit })
}

fn level_count() -> u32 {
    (CLUMP_SIDE / COARSEST_SIDE).ilog2() + 1
}

/// The bytes of every level of every layer.
fn pictures(kinds: &[ClumpKind]) -> Result<Vec<Vec<Vec<u8>>>, GpuError> {
    let layers = kinds.len() as u32 * CLUMP_VARIANTS;
    let of_layer = |layer: u32| {
        let number = layer / CLUMP_VARIANTS;
        let finest = paint(&kinds[number as usize], number, layer % CLUMP_VARIANTS);
        let finest = finest.map_err(|error| GpuError::Rejected {
            what: "a picture of a clump".to_owned(),
            reason: error.to_string(),
        })?;
        Ok(bytes_of(&levels_of(finest)))
    };
    (0..layers).into_par_iter().map(of_layer).collect()
}

/// All levels of a picture, the finest first.
fn levels_of(finest: Level) -> Vec<Level> {
    let wanted = drawn_coverage(&finest, 1.0);
    let mut averages = vec![finest];
    for level in 1..level_count() {
        let next = halved(&averages[level as usize - 1], CLUMP_SIDE >> level);
        averages.push(next);
    }
    let mut levels = averages;
    for level in levels.iter_mut().skip(1) {
        keep_coverage(level, wanted);
    }
    levels
}

/// Averages of squares of four texels; `side` is the result's.
fn halved(level: &Level, side: u32) -> Level {
    let side = side as usize;
    let texel = |at: usize| {
        let first = at / side * 2 * (2 * side) + at % side * 2;
        let four = [first, first + 1, first + 2 * side, first + 2 * side + 1];
        [0, 1, 2, 3].map(|c| four.iter().map(|&n| level[n][c]).sum::<f32>() * 0.25)
    };
    (0..side * side).map(texel).collect()
}

/// Mean coverage of a level as four samples draw it, its alphas scaled.
fn drawn_coverage(level: &Level, scale: f32) -> f64 {
    let drawn = |texel: &[f32; 4]| f64::from((4.0 * (texel[3] * scale).min(1.0)).round() * 0.25);
    level.iter().map(drawn).sum::<f64>() / level.len() as f64
}

/// Scales a level so that it draws the wanted coverage; colours follow, being multiplied by it.
fn keep_coverage(level: &mut Level, wanted: f64) {
    let (mut low, mut high) = (0.0, 16.0);
    // Halved to the rounding of a float.
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        if drawn_coverage(level, middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    for texel in level {
        let alpha = (texel[3] * high).min(1.0);
        let scale = alpha / texel[3].max(1e-9);
        *texel = [0, 1, 2, 3].map(|c| texel[c] * scale);
    }
}

/// Levels as sRGB bytes with colours that are not multiplied by the coverage. A texel without any takes
/// its colour from the finest coarser level that has some there, so that filtering darkens no edge.
fn bytes_of(levels: &[Level]) -> Vec<Vec<u8>> {
    let sides: Vec<usize> = (0..levels.len())
        .map(|n| CLUMP_SIDE as usize >> n)
        .collect();
    let one = |number: usize| {
        let side = sides[number];
        let texel = |at: usize| {
            let [x, y] = [at % side, at / side];
            let coarser = (number..levels.len()).map(|n| {
                let shift = n - number;
                levels[n][(y >> shift) * sides[n] + (x >> shift)]
            });
            let found = coarser.into_iter().find(|texel| texel[3] > 1e-4);
            let colour = found.map_or([1.0; 3], |[r, g, b, a]| [r / a, g / a, b / a]);
            let [r, g, b] = colour.map(|c| srgb_byte(c / CLUMP_TINT_MOST));
            [r, g, b, (levels[number][at][3] * 255.0).round() as u8]
        };
        (0..side * side).flat_map(texel).collect()
    };
    (0..levels.len()).map(one).collect()
}

/// IEC 61966-2-1.
fn srgb_byte(linear: f32) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 {
        linear * 12.92
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    (encoded * 255.0).round() as u8
}

#[cfg(test)]
mod tests;
