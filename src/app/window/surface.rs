//! The window's surface, and what becomes of a frame that it does not give.

use std::sync::Arc;

use winit::dpi::PhysicalSize;
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use crate::gpu::{Gpu, GpuError};

/// One of the two formats that every surface has; picture and panels come to it already encoded.
pub const SURFACE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Bgra8Unorm;

/// A surface with the window it belongs to.
pub struct WindowSurface {
    instance: wgpu::Instance,
    surface: wgpu::Surface<'static>,
    window: Arc<Window>,
    /// As last configured; `None` while the window has no area.
    size: Option<[u32; 2]>,
}

/// What the surface gives for a frame.
pub enum Acquired {
    Frame(wgpu::SurfaceTexture),
    /// Nothing this time, for a reason that passes: hidden, too slow, just resized.
    Nothing,
}

impl WindowSurface {
    /// Makes the surface of a window and opens the device that can show pictures in it.
    ///
    /// # Errors
    /// No adapter or device for this window.
    pub fn open(display: OwnedDisplayHandle, window: Arc<Window>) -> Result<(Self, Gpu), GpuError> {
        if wgpu::Instance::enabled_backend_features().is_empty() {
            return Err(GpuError::NoAdapter {
                reason: "this build has no graphics backend for the platform".into(),
            });
        }
        let descriptor = wgpu::InstanceDescriptor::new_with_display_handle(Box::new(display));
        let instance = wgpu::Instance::new(descriptor.with_env());
        // Without a driver there is no backend that could make one.
        let surface = create_surface(&instance, &window).map_err(no_adapter_for_window)?;
        let gpu = Gpu::for_surface(&instance, &surface).map_err(no_adapter_for_window)?;
        let surface = Self {
            instance,
            surface,
            window,
            size: None,
        };
        Ok((surface, gpu))
    }

    /// Takes the window's size. One without area is remembered as such and never configured.
    ///
    /// # Errors
    /// A size or format the driver refuses.
    pub fn resize(&mut self, gpu: &Gpu, size: PhysicalSize<u32>) -> Result<(), GpuError> {
        let limit = gpu.device.limits().max_texture_dimension_2d;
        let has_area = size.width > 0 && size.height > 0;
        self.size = has_area.then(|| [size.width.min(limit), size.height.min(limit)]);
        self.configure(gpu)
    }

    /// Width and height in pixels; `None` while there is nothing to draw on.
    pub fn size(&self) -> Option<[u32; 2]> {
        self.size
    }

    /// A texture to draw the next frame into.
    ///
    /// # Errors
    /// A surface that cannot be made again after it was lost; an invalid one.
    pub fn acquire(&mut self, gpu: &Gpu) -> Result<Acquired, GpuError> {
        if self.size.is_none() {
            return Ok(Acquired::Nothing);
        }
        match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(texture)
            | wgpu::CurrentSurfaceTexture::Suboptimal(texture) => Ok(Acquired::Frame(texture)),
            wgpu::CurrentSurfaceTexture::Timeout | wgpu::CurrentSurfaceTexture::Occluded => {
                Ok(Acquired::Nothing)
            }
            wgpu::CurrentSurfaceTexture::Outdated => {
                self.resize(gpu, self.window.inner_size())?;
                Ok(Acquired::Nothing)
            }
            wgpu::CurrentSurfaceTexture::Lost => {
                self.surface = create_surface(&self.instance, &self.window)?;
                self.configure(gpu)?;
                Ok(Acquired::Nothing)
            }
            wgpu::CurrentSurfaceTexture::Validation => {
                gpu.check()?;
                Ok(Acquired::Nothing)
            }
        }
    }

    fn configure(&self, gpu: &Gpu) -> Result<(), GpuError> {
        let Some([width, height]) = self.size else {
            return Ok(());
        };
        gpu.guarded("the window's surface", || {
            let configuration = wgpu::SurfaceConfiguration {
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
                format: SURFACE_FORMAT,
                color_space: wgpu::SurfaceColorSpace::Auto,
                width,
                height,
                present_mode: wgpu::PresentMode::AutoVsync,
                desired_maximum_frame_latency: 2,
                alpha_mode: wgpu::CompositeAlphaMode::Auto,
                view_formats: Vec::new(),
            };
            self.surface.configure(&gpu.device, &configuration);
        })
    }
}

fn create_surface(
    instance: &wgpu::Instance,
    window: &Arc<Window>,
) -> Result<wgpu::Surface<'static>, GpuError> {
    instance
        .create_surface(Arc::clone(window))
        .map_err(|error| GpuError::Rejected {
            what: "the window's surface".into(),
            reason: error.to_string(),
        })
}

/// Tells what else can be done where no adapter draws in the window.
fn no_adapter_for_window(error: GpuError) -> GpuError {
    let (GpuError::NoAdapter { reason } | GpuError::Rejected { reason, .. }) = error else {
        return error;
    };
    let text = "for the window; without one, `sward run SCENE` simulates on the cpu";
    GpuError::NoAdapter {
        reason: format!("{text}: {reason}"),
    }
}
