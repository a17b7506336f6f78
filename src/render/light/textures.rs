//! Light volumes on the device: 2D texture arrays, one slice a layer. Shader:
//! `shaders/shared/volume_light.wgsl`.

use wgpu::{BindingType, BufferUsages, ShaderStages, TextureFormat};

use crate::base::Vec3;
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::gpu_struct;
use crate::render::camera::View;
use crate::render::error::RenderError;
use crate::render::pipeline::{SAMPLER, UNIFORM};

use super::irradiance::LightTexels;

/// Colours, and so layers of the irradiance for each slice.
const COLOURS: u32 = 3;

gpu_struct! {
    /// Twin of `LightVolume` in the shader.
    pub(in crate::render) struct LightVolume {
        corner_from_eye: [f32; 3],
        slices: u32,
        cells_per_m: [f32; 2],
        slices_per_m: f32,
        spare: f32,
    }
}

/// The volumes of a scene that has some; of one that has none, a texel of each kind for the bindings.
#[derive(Debug)]
pub struct LightTextures {
    uniform: Buffer<LightVolume>,
    openness: wgpu::TextureView,
    irradiance: wgpu::TextureView,
    heights: wgpu::TextureView,
    sampler: wgpu::Sampler,
    /// The uniform of an eye at the origin.
    base: LightVolume,
    corner_in_world: [f64; 2],
    bytes: u64,
}

impl LightTextures {
    /// A texel of each: nothing is looked up in them.
    ///
    /// # Errors
    /// A device that is short of memory.
    pub fn none(gpu: &Gpu) -> Result<Self, GpuError> {
        let texels = LightTexels {
            columns: [1, 1],
            slices: 1,
            cell_m: [1.0; 2],
            slice_m: 1.0,
            corner_in_world: [0.0; 2],
            ground_m: vec![0.0],
            openness: vec![0],
            irradiance: vec![[0; 4]; COLOURS as usize],
        };
        let mut none = Self::upload(gpu, &texels)?;
        none.base.slices = 0;
        none.uniform.write(gpu, 0, &[none.base])?;
        Ok(none)
    }

    /// # Errors
    /// More slices than the device's textures have layers for; a device that is short of memory.
    pub fn new(gpu: &Gpu, texels: &LightTexels) -> Result<Self, RenderError> {
        check_layers(texels.slices, gpu.device.limits().max_texture_array_layers)?;
        Ok(Self::upload(gpu, texels)?)
    }

    fn upload(gpu: &Gpu, texels: &LightTexels) -> Result<Self, GpuError> {
        let [columns, rows] = texels.columns;
        let of = |label, format, layers, bytes: &[u8]| {
            layered(gpu, label, format, [columns, rows, layers], bytes)
        };
        let slices = texels.slices;
        let openness = of("openness", TextureFormat::R8Unorm, slices, &texels.openness)?;
        let irradiance = of(
            "irradiance",
            TextureFormat::Rgba16Float,
            COLOURS * slices,
            bytemuck::cast_slice(&texels.irradiance),
        )?;
        let heights = of(
            "heights of light columns",
            TextureFormat::R32Float,
            1,
            bytemuck::cast_slice(&texels.ground_m),
        )?;
        let view = |texture: &wgpu::Texture, dimension| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(dimension),
                ..Default::default()
            })
        };
        let array = wgpu::TextureViewDimension::D2Array;
        Ok(Self {
            uniform: Buffer::new(gpu, "light volume", 1, BufferUsages::UNIFORM)?,
            openness: view(&openness, array),
            irradiance: view(&irradiance, array),
            heights: view(&heights, wgpu::TextureViewDimension::D2),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("light volume"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            base: LightVolume {
                corner_from_eye: [0.0; 3],
                slices,
                cells_per_m: texels.cell_m.map(|metres| (1.0 / metres) as f32),
                slices_per_m: (1.0 / texels.slice_m) as f32,
                spare: 0.0,
            },
            corner_in_world: texels.corner_in_world,
            bytes: texels.bytes(),
        })
    }

    /// Bytes of the textures on the device.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Writes where the volume is from this frame's eye; nothing where there is none.
    ///
    /// # Errors
    /// The device's.
    pub fn write(&self, gpu: &Gpu, view: &View) -> Result<(), GpuError> {
        if self.base.slices == 0 {
            return Ok(());
        }
        let [x, z] = self.corner_in_world;
        let volume = LightVolume {
            corner_from_eye: view.from_eye(Vec3::new(x, 0.0, z)),
            ..self.base
        };
        self.uniform.write(gpu, 0, &[volume])
    }

    /// What a bind group layout says of [`LightTextures::resources`].
    pub fn bindings() -> [(ShaderStages, BindingType); 5] {
        let texture = |view_dimension, filterable| BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable },
            view_dimension,
            multisampled: false,
        };
        let array = texture(wgpu::TextureViewDimension::D2Array, true);
        // 32-bit floats cannot be mixed in hardware everywhere.
        let heights = texture(wgpu::TextureViewDimension::D2, false);
        [UNIFORM, array, array, heights, SAMPLER]
            .map(|binding| (ShaderStages::VERTEX_FRAGMENT, binding))
    }

    /// The volumes for a bind group, in the order of the shader's bindings from 2 on.
    pub fn resources(&self) -> [wgpu::BindingResource<'_>; 5] {
        [
            self.uniform.binding(),
            wgpu::BindingResource::TextureView(&self.openness),
            wgpu::BindingResource::TextureView(&self.irradiance),
            wgpu::BindingResource::TextureView(&self.heights),
            wgpu::BindingResource::Sampler(&self.sampler),
        ]
    }
}

/// # Errors
/// More slices than a device's textures have layers for; `limit` is its `max_texture_array_layers`.
pub(in crate::render) fn check_layers(slices: u32, limit: u32) -> Result<(), RenderError> {
    let layers = COLOURS * slices;
    if layers <= limit {
        return Ok(());
    }
    Err(RenderError::LightLayers {
        slices,
        layers,
        limit,
        most: limit / COLOURS,
    })
}

/// A texture of so many columns, rows and layers.
fn layered(
    gpu: &Gpu,
    label: &'static str,
    format: TextureFormat,
    [width, height, layers]: [u32; 3],
    bytes: &[u8],
) -> Result<wgpu::Texture, GpuError> {
    let size = wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: layers,
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
    let texels = width * height * layers;
    gpu.queue.write_texture(
        texture.as_image_copy(),
        bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(width * (bytes.len() as u32 / texels)),
            rows_per_image: Some(height),
        },
        size,
    );
    Ok(texture)
}
