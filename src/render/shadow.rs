//! The sun's shadow map of the bodies.
//!
//! One orthographic view along the sunlight, fitted around the bodies near the view. Only bodies
//! cast into it: the grass's own shade comes from its height (see `blades.rs`), and the ground's
//! from its slope. The map moves in whole texels, so that still shadows do not shimmer.

use glam::{Mat4, Vec3 as GlamVec3};

use crate::base::Vec3;
use crate::gpu::{Gpu, GpuError};

use super::camera::View;
use super::pipeline::DEPTH_FORMAT;
use super::sky::Daylight;

/// Texels along a side.
const SIDE: u32 = 2048;
/// Bodies farther from the eye than this cast no shadow: it would be thinner than a texel.
const REACH_M: f64 = 120.0;
/// Lower bound of the map's half width, so that a single ball does not get texels finer than a
/// blade of grass.
const LEAST_HALF_M: f64 = 2.0;

/// A ball around something that casts a shadow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Caster {
    pub(super) centre_in_world: Vec3<f64>,
    pub(super) radius_m: f64,
}

/// Where the map lies this frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShadowFit {
    /// Unit vectors of the map: right, up, and towards the sun.
    axes: [Vec3<f64>; 3],
    centre_in_world: Vec3<f64>,
    half_m: f64,
    /// Half the depth along the light.
    half_depth_m: f64,
}

impl ShadowFit {
    /// Fits the map around the casters near the eye; around the eye if there are none.
    pub(super) fn new(light: &Daylight, view: &View, casters: &[Caster]) -> Self {
        let to_sun = Vec3::of_f32(light.sun_direction.to_f32());
        let right = to_sun.cross(Vec3::UP).unit_or(Vec3::new(1.0, 0.0, 0.0));
        let axes = [right, to_sun.cross(right), to_sun];
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for caster in casters {
            let away = (caster.centre_in_world - view.eye_in_world).length();
            if away - caster.radius_m > REACH_M {
                continue;
            }
            for (axis, direction) in axes.iter().enumerate() {
                let at = caster.centre_in_world.dot(*direction);
                low[axis] = low[axis].min(at - caster.radius_m);
                high[axis] = high[axis].max(at + caster.radius_m);
            }
        }
        if low[0] > high[0] {
            low = axes.map(|axis| view.eye_in_world.dot(axis));
            high = low;
        }
        let half = [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]));
        // Steps of a fifth, so that the texel size does not change at every frame.
        let wished = half[0].max(half[1]).max(LEAST_HALF_M) * 1.02;
        let half_m = 1.2_f64.powf(wished.log(1.2).ceil());
        let texel = 2.0 * half_m / f64::from(SIDE);
        let snapped = |axis: usize| (0.5 * (high[axis] + low[axis]) / texel).round() * texel;
        let along = 0.5 * (high[2] + low[2]);
        Self {
            axes,
            centre_in_world: axes[0] * snapped(0) + axes[1] * snapped(1) + axes[2] * along,
            half_m,
            // Room behind the casters for the ground and blades their shadow falls on: points
            // beyond the map's end count as lit.
            half_depth_m: half[2] + 2.0 + 6.0 * half_m,
        }
    }

    pub(super) fn texel_m(&self) -> f32 {
        (2.0 * self.half_m / f64::from(SIDE)) as f32
    }

    /// Takes a point relative to the eye to the map: x and y in −1…1, depth from the sun in 0…1.
    pub(super) fn shadow_from_eye(&self, view: &View) -> Mat4 {
        let centre_from_eye = self.centre_in_world - view.eye_in_world;
        let row = |axis: Vec3<f64>, half: f64, shift: f64| {
            let scale = 1.0 / half;
            let offset = -centre_from_eye.dot(axis) * scale + shift;
            let [x, y, z] = (axis * scale).to_f32();
            glam::Vec4::new(x, y, z, offset as f32)
        };
        let depth = row(-self.axes[2], 2.0 * self.half_depth_m, 0.5);
        Mat4::from_cols(
            row(self.axes[0], self.half_m, 0.0),
            row(self.axes[1], self.half_m, 0.0),
            depth,
            GlamVec3::ZERO.extend(1.0),
        )
        .transpose()
    }
}

/// The map itself.
#[derive(Debug)]
pub(super) struct ShadowMap {
    pub(super) view: wgpu::TextureView,
}

impl ShadowMap {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let texture = gpu.guarded("the shadow map", || {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("shadow map"),
                size: wgpu::Extent3d {
                    width: SIDE,
                    height: SIDE,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: DEPTH_FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        })?;
        Ok(Self {
            view: texture.create_view(&Default::default()),
        })
    }

    /// Starts the pass that fills the map.
    pub(super) fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        times: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow"),
            color_attachments: &[],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: times,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::sky::Sun;
    use super::*;

    #[test]
    fn every_near_caster_lies_in_the_map_and_the_sun_side_is_nearer() {
        let light = Sun::default().daylight();
        let eye = Vec3::new(50_000.0, 2.0, 50_000.0);
        let view = View::look_at(eye, eye + Vec3::new(0.0, 0.0, -5.0), 45.0);
        let casters: Vec<Caster> = [(3.0, -4.0), (-6.0, -9.0), (0.0, 12.0)]
            .map(|(x, z)| Caster {
                centre_in_world: eye + Vec3::new(x, -1.5, z),
                radius_m: 0.4,
            })
            .to_vec();
        let fit = ShadowFit::new(&light, &view, &casters);
        let matrix = fit.shadow_from_eye(&view);
        let place =
            |p: Vec3<f64>| matrix.project_point3(GlamVec3::from((p - view.eye_in_world).to_f32()));
        let to_sun = Vec3::of_f32(light.sun_direction.to_f32());
        for caster in &casters {
            let rim = caster.centre_in_world + fit.axes[0] * caster.radius_m;
            let p = place(rim);
            assert!(
                p.x.abs() <= 1.0 && p.y.abs() <= 1.0 && p.z > 0.0 && p.z < 1.0,
                "{p}"
            );
            let nearer = place(caster.centre_in_world + to_sun * 0.2);
            assert!(nearer.z < place(caster.centre_in_world).z);
        }
    }

    #[test]
    fn without_casters_the_map_is_still_finite() {
        let light = Sun::default().daylight();
        let view = View::look_at(Vec3::new(0.0, 2.0, 0.0), Vec3::ZERO, 45.0);
        let fit = ShadowFit::new(&light, &view, &[]);
        assert!(fit.shadow_from_eye(&view).is_finite() && fit.texel_m() > 0.0);
    }
}
