//! egui in the window: its events, its pass, its triangles.

use std::time::Duration;

use winit::event::WindowEvent;
use winit::window::Window;

use crate::gpu::Gpu;
use crate::render::PictureTarget;

/// Size of the small text, in points: egui's own 9 is hard to read over a meadow.
const SMALL_POINTS: f32 = 10.5;

/// egui with its state between frames.
pub struct Ui {
    context: egui::Context,
    winit: egui_winit::State,
    renderer: egui_wgpu::Renderer,
    /// The part of the window that no panel covers, in points, as of the last pass.
    picture_rect: egui::Rect,
}

/// A finished pass, to be painted.
pub struct Painting {
    triangles: Vec<egui::ClippedPrimitive>,
    textures: egui::TexturesDelta,
    pixels_per_point: f32,
    /// Time after which egui wants another pass even if nothing happens.
    pub repaint_after: Duration,
}

impl Ui {
    pub fn new(gpu: &Gpu, window: &Window) -> Self {
        let context = egui::Context::default();
        context.set_theme(egui::Theme::Dark);
        context.all_styles_mut(|style| {
            let small = egui::FontId::proportional(SMALL_POINTS);
            style.text_styles.insert(egui::TextStyle::Small, small);
        });
        let winit = egui_winit::State::new(
            context.clone(),
            egui::ViewportId::ROOT,
            window,
            None,
            None,
            Some(gpu.device.limits().max_texture_dimension_2d as usize),
        );
        Self {
            renderer: egui_wgpu::Renderer::new(
                &gpu.device,
                PictureTarget::FORMAT,
                egui_wgpu::RendererOptions::default(),
            ),
            context,
            winit,
            picture_rect: egui::Rect::EVERYTHING,
        }
    }

    /// Gives egui an event. Keys stay out: no panel has a text field, and Tab has its own meaning.
    pub fn event(&mut self, window: &Window, event: &WindowEvent) {
        if !matches!(event, WindowEvent::KeyboardInput { .. }) {
            let _ = self.winit.on_window_event(window, event);
        }
    }

    /// Whether a place in the window, in pixels, belongs to a panel.
    pub fn is_panel_at(&self, [x, y]: [f64; 2]) -> bool {
        let scale = self.context.pixels_per_point();
        let place = egui::pos2(x as f32, y as f32) / scale;
        match self.context.layer_id_at(place) {
            Some(layer) if layer.order != egui::Order::Background => true,
            _ => !self.picture_rect.contains(place),
        }
    }

    /// Builds a frame's panels.
    pub fn pass(&mut self, window: &Window, mut panels: impl FnMut(&mut egui::Ui)) -> Painting {
        let input = self.winit.take_egui_input(window);
        let mut rest = egui::Rect::EVERYTHING;
        let output = self.context.run_ui(input, |ui| {
            panels(ui);
            rest = ui.available_rect_before_wrap();
        });
        self.picture_rect = rest;
        self.winit
            .handle_platform_output(window, output.platform_output);
        let repaint_after = output
            .viewport_output
            .get(&egui::ViewportId::ROOT)
            .map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        Painting {
            triangles: self
                .context
                .tessellate(output.shapes, output.pixels_per_point),
            textures: output.textures_delta,
            pixels_per_point: output.pixels_per_point,
            repaint_after,
        }
    }

    /// Paints a pass over what `target`, of [`PictureTarget::FORMAT`], shows already.
    pub fn paint(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        size_in_pixels: [u32; 2],
        mut painting: Painting,
    ) {
        let (device, queue) = (&gpu.device, &gpu.queue);
        for (id, changes) in painting.textures.set.drain() {
            for change in changes {
                self.renderer.update_texture(device, queue, id, &change);
            }
        }
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels,
            pixels_per_point: painting.pixels_per_point,
        };
        // Only paint callbacks give command buffers of their own, and there are none.
        let _ = self
            .renderer
            .update_buffers(device, queue, encoder, &painting.triangles, &screen);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("panels"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Load,
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        let mut pass = pass.forget_lifetime();
        self.renderer
            .render(&mut pass, &painting.triangles, &screen);
        drop(pass);
        for id in painting.textures.free.drain() {
            self.renderer.free_texture(&id);
        }
    }
}
