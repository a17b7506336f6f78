//! What the window shows, as a picture of our own: the scene, perhaps drawn smaller, the panels
//! over it, then a copy for the surface and, when asked for, for a file.

use crate::gpu::Gpu;
use crate::render::{Picture, PictureTarget, RenderError};

use super::surface::SURFACE_FORMAT;

/// Targets of one window size.
pub struct Canvas {
    /// The whole window.
    window: PictureTarget,
    size: [u32; 2],
    /// The scene, where it is drawn smaller than the window.
    scene: Option<PictureTarget>,
    scene_size: [u32; 2],
    enlarge: wgpu::util::TextureBlitter,
    present: wgpu::util::TextureBlitter,
}

impl Canvas {
    /// A canvas for a window of this size, whose scene is drawn at `scale` times its sides.
    ///
    /// # Errors
    /// A size the device cannot hold.
    pub fn new(gpu: &Gpu, size: [u32; 2], scale: f64) -> Result<Self, RenderError> {
        let scene_size = scaled(size, scale);
        Ok(Self {
            window: PictureTarget::new(gpu, size)?,
            size,
            scene: scene_target(gpu, size, scene_size)?,
            scene_size,
            enlarge: wgpu::util::TextureBlitterBuilder::new(&gpu.device, PictureTarget::FORMAT)
                .sample_type(wgpu::FilterMode::Linear)
                .build(),
            present: wgpu::util::TextureBlitter::new(&gpu.device, SURFACE_FORMAT),
        })
    }

    /// Makes targets for another size or scale; the same ones cost nothing.
    ///
    /// # Errors
    /// A size the device cannot hold; the old targets stay.
    pub fn resize(&mut self, gpu: &Gpu, size: [u32; 2], scale: f64) -> Result<(), RenderError> {
        let scene_size = scaled(size, scale);
        if size != self.size || scene_size != self.scene_size {
            let window = PictureTarget::new(gpu, size)?;
            self.scene = scene_target(gpu, size, scene_size)?;
            self.window = window;
            self.size = size;
            self.scene_size = scene_size;
        }
        Ok(())
    }

    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Width and height to draw the scene in.
    pub fn scene_size(&self) -> [u32; 2] {
        self.scene_size
    }

    /// Where the scene is drawn.
    pub fn scene_view(&self) -> &wgpu::TextureView {
        &self.scene.as_ref().unwrap_or(&self.window).view
    }

    /// Where the panels are painted, once [`Canvas::enlarge_scene`] has been recorded.
    pub fn window_view(&self) -> &wgpu::TextureView {
        &self.window.view
    }

    /// Brings a smaller scene to the window's size.
    pub fn enlarge_scene(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) {
        if let Some(scene) = &self.scene {
            self.enlarge
                .copy(&gpu.device, encoder, &scene.view, &self.window.view);
        }
    }

    /// Copies the window's picture to a texture of the surface.
    pub fn present(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, to: &wgpu::TextureView) {
        self.present
            .copy(&gpu.device, encoder, &self.window.view, to);
    }

    /// Reads back what was drawn last.
    ///
    /// # Errors
    /// The device's own.
    pub fn read(&self, gpu: &Gpu) -> Result<Picture, RenderError> {
        self.window.read(gpu)
    }
}

fn scaled(size: [u32; 2], scale: f64) -> [u32; 2] {
    size.map(|side| ((f64::from(side) * scale).round() as u32).max(1))
}

/// `None` where the scene is drawn straight into the window's picture.
fn scene_target(
    gpu: &Gpu,
    size: [u32; 2],
    scene_size: [u32; 2],
) -> Result<Option<PictureTarget>, RenderError> {
    if scene_size == size {
        return Ok(None);
    }
    PictureTarget::new(gpu, scene_size).map(Some)
}
