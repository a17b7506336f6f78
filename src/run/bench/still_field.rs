//! A field at rest with its renderer, for benches of drawing.

use crate::field::{Field, FieldError, WindNow};
use crate::gpu::{Buffer, Gpu, GpuError, PassTimer};
use crate::render::{
    BladeDetail, BladesInput, Exposure, FrameInput, GroundLook, PictureTarget, RenderError,
    Renderer, Sun, View,
};
use crate::scene::{Grass, Solver, Terrain};
use crate::terrain::{ColourMap, HeightGrid, TerrainError};

/// Why a bench of drawing cannot run.
#[derive(Debug, thiserror::Error)]
pub enum DrawBenchError {
    #[error(transparent)]
    Terrain(#[from] TerrainError),
    #[error(transparent)]
    Field(#[from] FieldError),
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A field's plants, with no tile awake.
pub(super) struct StillField {
    pub field: Field,
    pub wind: WindNow,
    nodes: Buffer<[f32; 4]>,
    pub renderer: Renderer,
    pub timer: PassTimer,
}

impl StillField {
    /// The default grass on a ground. `picture` is the size of what is drawn, in pixels.
    pub fn new(
        gpu: &Gpu,
        terrain: &Terrain,
        ground: HeightGrid,
        wind: WindNow,
        picture: [u32; 2],
    ) -> Result<Self, DrawBenchError> {
        let map = ColourMap::of_patches(terrain, &ground);
        let field = Field::new(ground, &Grass::default(), &Solver::default())?;
        let look = GroundLook {
            map: &map,
            soil_rgb: terrain.soil_rgb,
        };
        Self::of(gpu, field, &look, wind, picture)
    }

    /// A field that is laid out, with the look of its ground.
    pub fn of(
        gpu: &Gpu,
        field: Field,
        look: &GroundLook<'_>,
        wind: WindNow,
        picture: [u32; 2],
    ) -> Result<Self, DrawBenchError> {
        let mut renderer = Renderer::new(gpu, PictureTarget::FORMAT, picture)?;
        renderer.set_scene(gpu, &field, look, &[], &[])?;
        Ok(Self {
            wind,
            nodes: Buffer::new(gpu, "no nodes", 1, wgpu::BufferUsages::STORAGE)?,
            timer: PassTimer::new(gpu, 16),
            field,
            renderer,
        })
    }

    /// The renderer and its timer, and a frame of the plants alone.
    pub fn frame<'a>(
        &'a mut self,
        view: &'a View,
        detail: BladeDetail,
    ) -> (&'a mut Renderer, &'a mut PassTimer, FrameInput<'a>) {
        let input = FrameInput {
            view,
            sun: Sun::default(),
            exposure: Exposure::default(),
            bodies: &[],
            blades: Some(BladesInput {
                field: &self.field,
                wind: &self.wind,
                active: &[],
                active_nodes: &self.nodes,
                billboards: None,
                detail,
            }),
            marks: &[],
            time_s: 0.0,
        };
        (&mut self.renderer, &mut self.timer, input)
    }
}
