//! The sun, the sky's colours and the sky itself.
//!
//! A few analytic colours light everything: a sun dimmed and reddened by the air it crosses, a
//! zenith, a horizon, and light thrown up by the ground. No measured sky model is claimed; the
//! figures are chosen so that grass in the sun is near middle grey, and shade is lit by the sky.
//! Shader: `shaders/sky.wgsl`.

use crate::base::Vec3;
use crate::gpu::{Gpu, GpuError};

use super::pipeline::{DepthUse, Drawing};
use super::view_group::ViewGroups;

/// Where the sun stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Height over the horizon, in degrees, 2 to 90.
    pub elevation_deg: f32,
    /// Direction towards the sun, from +x towards +z, in degrees.
    pub azimuth_deg: f32,
}

impl Default for Sun {
    /// A clear late afternoon.
    fn default() -> Self {
        Self {
            elevation_deg: 34.0,
            azimuth_deg: 215.0,
        }
    }
}

/// The light of a moment, in units of a white surface's radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Daylight {
    /// Unit vector towards the sun.
    pub sun_direction: Vec3<f32>,
    pub sun_rgb: [f32; 3],
    pub zenith_rgb: [f32; 3],
    pub horizon_rgb: [f32; 3],
    pub bounce_rgb: [f32; 3],
}

impl Sun {
    /// Unit vector towards the sun.
    pub fn direction(self) -> Vec3<f32> {
        // Below 2° the shadow map would stretch without end.
        let elevation = self.elevation_deg.clamp(2.0, 90.0).to_radians();
        let azimuth = self.azimuth_deg.to_radians();
        Vec3::new(
            elevation.cos() * azimuth.cos(),
            elevation.sin(),
            elevation.cos() * azimuth.sin(),
        )
    }

    /// Colours of sun, sky and ground for this place of the sun.
    pub fn daylight(self) -> Daylight {
        let direction = self.direction();
        // Air crossed relative to the zenith, with the curvature's limit near 1/0.06.
        let air = 1.06 / (direction.y + 0.06);
        // Optical depth of clear summer air with some haze, from red to blue.
        let sun_rgb = [0.075, 0.125, 0.235].map(|depth: f32| 4.0 * (-depth * air).exp());
        // The sky dims with the sun and reddens along the horizon when it is low.
        let bright = 0.25 + 0.75 * direction.y.sqrt();
        let low = (-6.0 * direction.y).exp();
        let towards = |day: f32, evening: f32| bright * (day + (evening - day) * low);
        let zenith_rgb = [
            towards(0.13, 0.15),
            towards(0.36, 0.25),
            towards(1.02, 0.55),
        ];
        let horizon_rgb = [
            towards(0.86, 1.35),
            towards(1.14, 0.95),
            towards(1.55, 0.70),
        ];
        let ground_rgb = [0.09, 0.12, 0.05];
        let bounce_rgb = [0, 1, 2].map(|i| {
            ground_rgb[i] * (sun_rgb[i] * direction.y + 0.5 * (zenith_rgb[i] + horizon_rgb[i]))
        });
        Daylight {
            sun_direction: direction,
            sun_rgb,
            zenith_rgb,
            horizon_rgb,
            bounce_rgb,
        }
    }
}

impl Daylight {
    /// Radiance of the sky along a unit vector, without clouds and without the sun's disc. Twin:
    /// `clear_sky` in `shaders/shared/light.wgsl`.
    pub fn clear_sky(&self, direction: Vec3<f64>) -> [f64; 3] {
        let towards_sun = direction.dot(Vec3::of_f32(self.sun_direction.to_f32()));
        let haze = libm::exp(-7.0 * direction.y.max(0.0));
        let broad = libm::pow((0.5 + 0.5 * towards_sun).max(0.0), 6.0);
        let narrow = libm::pow(towards_sun.max(0.0), 90.0);
        let glow = 0.10 * broad * haze + 0.03 * broad + 0.35 * narrow;
        [0, 1, 2].map(|i| {
            let [zenith, horizon, sun] =
                [self.zenith_rgb, self.horizon_rgb, self.sun_rgb].map(|rgb| f64::from(rgb[i]));
            zenith + (horizon - zenith) * haze + sun * glow
        })
    }
}

/// Draws the sky where nothing else is.
#[derive(Debug)]
pub(super) struct SkyLayer {
    pipeline: wgpu::RenderPipeline,
}

impl SkyLayer {
    pub(super) fn new(gpu: &Gpu, groups: &ViewGroups, samples: u32) -> Result<Self, GpuError> {
        let pipeline = Drawing {
            shader: "sky.wgsl",
            vertex: "sky_vertex",
            fragment: "sky_fragment",
            groups: groups.view_only(),
            depth: DepthUse::TestOnly,
            samples,
            ..Drawing::default()
        }
        .pipeline(gpu)?;
        Ok(Self { pipeline })
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_is_warmer_and_dimmer_when_low() {
        let at = |elevation_deg| {
            Sun {
                elevation_deg,
                azimuth_deg: 30.0,
            }
            .daylight()
        };
        let (high, low) = (at(60.0), at(8.0));
        assert!((high.sun_direction.length() - 1.0).abs() < 1e-6);
        assert!(low.sun_rgb[0] < high.sun_rgb[0]);
        let warmth = |d: &Daylight| d.sun_rgb[0] / d.sun_rgb[2];
        assert!(warmth(&low) > warmth(&high));
        assert!(
            high.zenith_rgb[2] > high.zenith_rgb[0],
            "the zenith is blue"
        );
    }
}
