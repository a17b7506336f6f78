//! Bind groups that layers share: 1, the view and the light; 2, the shadow map and the light volumes, or
//! a texel in their place. Group 0 is the field's, for layers that draw plants; group 3 is a layer's own.

use wgpu::{BindGroup, BindGroupLayout, BindingType, BufferUsages, ShaderStages};

use crate::gpu::{Buffer, Gpu, GpuError};
use crate::gpu_struct;

use super::blade_tiles::BladeDetail;
use super::camera::View;
use super::error::RenderError;
use super::light::{LightTexels, LightTextures};
use super::pipeline::{UNIFORM, bind_group, group_layout};
use super::shadow::ShadowFit;
use super::sky::Daylight;

gpu_struct! {
    /// Twin of `Frame` in `shaders/shared/frame.wgsl`, where the units are.
    pub(super) struct Frame {
        clip_from_eye: [[f32; 4]; 4],
        eye_from_clip: [[f32; 4]; 4],
        shadow_from_eye: [[f32; 4]; 4],
        sun_direction: [f32; 3],
        time_s: f32,
        sun_rgb: [f32; 3],
        air_per_m: f32,
        zenith_rgb: [f32; 3],
        pixel_rad: f32,
        horizon_rgb: [f32; 3],
        shadow_texel_m: f32,
        bounce_rgb: [f32; 3],
        blade_reach_m: f32,
        eye_in_sky: [f32; 2],
        blade_full_m: f32,
        pad_a: f32,
        viewport_px: [f32; 2],
        pad_b: [f32; 2],
        judge_from_eye: [f32; 3],
        pad_c: f32,
    }
}

/// Light lost to the air, per metre: two thirds are lost after 8 km, as on a clear summer day with some
/// haze, so that a field of kilometres is seen from a kilometre above.
const AIR_PER_M: f32 = 1.0 / 8000.0;
/// Drift of the high clouds, in their pattern's units per second.
const CLOUDS_PER_S: f64 = 0.0015;

impl Frame {
    pub(super) fn new(
        view: &View,
        size: [u32; 2],
        light: &Daylight,
        shadow: &ShadowFit,
        blades: Option<BladeDetail>,
        time_s: f64,
    ) -> Self {
        let clip_from_eye = view.clip_from_eye(size[0] as f32 / size[1] as f32);
        Self {
            clip_from_eye: clip_from_eye.to_cols_array_2d(),
            eye_from_clip: clip_from_eye.inverse().to_cols_array_2d(),
            shadow_from_eye: shadow.shadow_from_eye(view).to_cols_array_2d(),
            sun_direction: light.sun_direction.to_f32(),
            time_s: time_s as f32,
            sun_rgb: light.sun_rgb,
            air_per_m: AIR_PER_M,
            zenith_rgb: light.zenith_rgb,
            pixel_rad: view.pixel_rad(size[1]),
            horizon_rgb: light.horizon_rgb,
            shadow_texel_m: shadow.texel_m(),
            bounce_rgb: light.bounce_rgb,
            blade_reach_m: blades.map_or(0.0, |detail| detail.reach_m),
            eye_in_sky: [(time_s * CLOUDS_PER_S) as f32, 0.0],
            blade_full_m: blades.map_or(0.0, |detail| detail.full_m),
            pad_a: 0.0,
            viewport_px: size.map(|n| n as f32),
            pad_b: [0.0; 2],
            judge_from_eye: (blades.and_then(|detail| detail.judged_from))
                .map_or([0.0; 3], |place| view.from_eye(place)),
            pad_c: 0.0,
        }
    }
}

/// The shared groups and their layouts.
#[derive(Debug)]
pub(super) struct ViewGroups {
    /// An empty group 0 for layers without plants. Leaving it out would be the same in WebGPU,
    /// but wgpu 30 on Vulkan loses the later groups when a pipeline without a group 0 follows
    /// one that has it.
    no_field_layout: BindGroupLayout,
    no_field_group: BindGroup,
    frame_layout: BindGroupLayout,
    shadow_layout: BindGroupLayout,
    frame_group: BindGroup,
    shadow_group: BindGroup,
    shadow_map: wgpu::TextureView,
    shadow_sampler: wgpu::Sampler,
    light: LightTextures,
    frame: Buffer<Frame>,
}

impl ViewGroups {
    pub(super) fn new(gpu: &Gpu, shadow_map: &wgpu::TextureView) -> Result<Self, GpuError> {
        let both = ShaderStages::VERTEX_FRAGMENT;
        let no_field_layout = group_layout(gpu, "no field", &[]);
        let frame_layout = group_layout(gpu, "view", &[(both, UNIFORM)]);
        let shadow = BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let comparison = BindingType::Sampler(wgpu::SamplerBindingType::Comparison);
        let mut bindings = vec![(both, shadow), (both, comparison)];
        bindings.extend(LightTextures::bindings());
        let shadow_layout = group_layout(gpu, "shadow map and light", &bindings);
        let frame = Buffer::new(gpu, "view", 1, BufferUsages::UNIFORM)?;
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow map"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        let frame_group = bind_group(gpu, "view", &frame_layout, &[frame.binding()]);
        let light = LightTextures::none(gpu)?;
        Ok(Self {
            no_field_group: bind_group(gpu, "no field", &no_field_layout, &[]),
            no_field_layout,
            frame_layout,
            frame_group,
            shadow_group: shadow_group(gpu, &shadow_layout, shadow_map, &sampler, &light),
            shadow_layout,
            shadow_map: shadow_map.clone(),
            shadow_sampler: sampler,
            light,
            frame,
        })
    }

    /// Takes light volumes in place of the old ones; `None` lets them go.
    ///
    /// # Errors
    /// Volumes that the device cannot hold.
    pub(super) fn set_light(
        &mut self,
        gpu: &Gpu,
        texels: Option<&LightTexels>,
    ) -> Result<(), RenderError> {
        self.light = match texels {
            Some(texels) => LightTextures::new(gpu, texels)?,
            None => LightTextures::none(gpu)?,
        };
        let (layout, map) = (&self.shadow_layout, &self.shadow_map);
        self.shadow_group = shadow_group(gpu, layout, map, &self.shadow_sampler, &self.light);
        Ok(())
    }

    /// Bytes of the light volumes on the device; a texel of each kind where the scene has none.
    pub(super) fn light_bytes(&self) -> u64 {
        self.light.bytes()
    }

    /// Groups of a layer without data of its own.
    pub(super) fn view_only(&self) -> [Option<&BindGroupLayout>; 4] {
        [
            Some(&self.no_field_layout),
            Some(&self.frame_layout),
            None,
            None,
        ]
    }

    /// Groups of a layer on which no shadow falls.
    pub(super) fn unlit<'a>(
        &'a self,
        layer: &'a BindGroupLayout,
    ) -> [Option<&'a BindGroupLayout>; 4] {
        let [field, view, shadow, _] = self.view_only();
        [field, view, shadow, Some(layer)]
    }

    /// Groups of a layer that receives shadows.
    pub(super) fn lit<'a>(
        &'a self,
        layer: &'a BindGroupLayout,
    ) -> [Option<&'a BindGroupLayout>; 4] {
        let [field, view, _, layer] = self.unlit(layer);
        [field, view, Some(&self.shadow_layout), layer]
    }

    /// Binds the view; group 0 stays empty.
    pub(super) fn bind_unlit(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(0, &self.no_field_group, &[]);
        pass.set_bind_group(1, &self.frame_group, &[]);
    }

    /// Binds the view, the shadow map and the light volumes; group 0 stays empty.
    pub(super) fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.bind_unlit(pass);
        pass.set_bind_group(2, &self.shadow_group, &[]);
    }

    pub(super) fn write(&self, gpu: &Gpu, view: &View, frame: Frame) -> Result<(), GpuError> {
        self.light.write(gpu, view)?;
        self.frame.write(gpu, 0, &[frame])
    }
}

fn shadow_group(
    gpu: &Gpu,
    layout: &BindGroupLayout,
    shadow_map: &wgpu::TextureView,
    sampler: &wgpu::Sampler,
    light: &LightTextures,
) -> BindGroup {
    let mut resources = vec![
        wgpu::BindingResource::TextureView(shadow_map),
        wgpu::BindingResource::Sampler(sampler),
    ];
    resources.extend(light.resources());
    bind_group(gpu, "shadow map and light", layout, &resources)
}
