//! One frame as a list.

use crate::bodies::{CoatedShape, RigidShape};
use crate::field::Field;
use crate::gpu::{FieldBuffers, Gpu, PassTimer};
use crate::terrain::bintree::MeshChange;

use super::billboards::{BillboardCounts, BillboardForm, BillboardsLayer};
use super::blade_tiles::Size;
use super::bodies::{BodiesLayer, BodyInstance};
use super::camera::View;
use super::coat::{CoatDetail, CoatLayer, DrawnCoats};
use super::coat_place::CoatFrame;
use super::coat_scene::CoatScene;
use super::error::RenderError;
use super::ground_look::{GroundLook, GroundTexture};
use super::ground_mesh::TerrainDetail;
use super::light::{LightTexels, check_layers};
use super::overlay::{OverlayLayer, TileMark};
use super::plant_list::ListedPlant;
use super::plants::{BladeCounts, BladesInput, DrawnPlants, PlantsLayer};
use super::seed_triangles::SeededTriangles;
use super::shadow::{ShadowFit, ShadowMap};
use super::sky::{SkyLayer, Sun};
use super::sort_plants::SeededClusters;
use super::targets::{Part, Targets, most_samples, picture_bytes};
use super::terrain::TerrainLayer;
use super::tonemap::{Exposure, TonemapLayer};
use super::view_group::{Frame, ViewGroups};

/// Draws pictures of a meadow, in one size at a time.
#[derive(Debug)]
pub struct Renderer {
    groups: ViewGroups,
    shadow: ShadowMap,
    bodies: BodiesLayer,
    plants: PlantsLayer,
    /// None until a scene has billboards.
    billboards: Option<BillboardsLayer>,
    /// None until a scene has coats.
    coats: Option<CoatLayer>,
    /// What the kernels of coats bind beside their own buffers, and rounds of Philox.
    field: Option<(FieldBuffers, u32)>,
    terrain: TerrainLayer,
    sky: SkyLayer,
    overlay: OverlayLayer,
    tonemap: TonemapLayer,
    targets: Targets,
    resolved_light: wgpu::BindGroup,
    samples: u32,
    /// How finely the ground of a large field is drawn from the next frame on.
    pub terrain_detail: TerrainDetail,
    /// How many plants of coats are drawn from the next frame on.
    pub coat_detail: CoatDetail,
}

/// Everything that may change from one frame to the next.
#[derive(Clone, Copy, Debug)]
pub struct FrameInput<'a> {
    pub view: &'a View,
    pub sun: Sun,
    pub exposure: Exposure,
    pub bodies: &'a [BodyInstance],
    /// The plants; `None` leaves them out.
    pub blades: Option<BladesInput<'a>>,
    /// Boxes of the tile-state overlay; empty to leave it out.
    pub marks: &'a [TileMark],
    /// Seconds since the start, for drifting clouds.
    pub time_s: f64,
}

impl Renderer {
    /// A renderer for targets of a format and size, with 4 samples per pixel where the device
    /// has them.
    ///
    /// # Errors
    /// A size the device cannot hold; the device's own errors.
    pub fn new(
        gpu: &Gpu,
        format: wgpu::TextureFormat,
        size: [u32; 2],
    ) -> Result<Self, RenderError> {
        let samples = most_samples(gpu);
        let shadow = ShadowMap::new(gpu)?;
        let groups = ViewGroups::new(gpu, &shadow.view)?;
        let targets = Targets::new(gpu, size, samples)?;
        let tonemap = TonemapLayer::new(gpu, format)?;
        Ok(Self {
            bodies: BodiesLayer::new(gpu, &groups, samples)?,
            plants: PlantsLayer::new(gpu, &groups, samples)?,
            billboards: None,
            coats: None,
            field: None,
            terrain: TerrainLayer::new(gpu, &groups, samples)?,
            sky: SkyLayer::new(gpu, &groups, samples)?,
            overlay: OverlayLayer::new(gpu, &groups, samples)?,
            resolved_light: tonemap.bind(gpu, &targets),
            tonemap,
            targets,
            groups,
            shadow,
            samples,
            terrain_detail: TerrainDetail::default(),
            coat_detail: CoatDetail::of_device(gpu),
        })
    }

    /// Takes a scene's ground, plants, body shapes and coats of them in place of the old ones.
    ///
    /// # Errors
    /// Bad colour maps, data larger than the device can bind.
    pub fn set_scene(
        &mut self,
        gpu: &Gpu,
        field: &Field,
        look: &GroundLook<'_>,
        shapes: &[RigidShape],
        coats: &[CoatedShape],
    ) -> Result<(), RenderError> {
        let colour = GroundTexture::new(gpu, look.map)?;
        let buffers = FieldBuffers::new(gpu, &FieldBuffers::layout(gpu), field)?;
        self.terrain
            .set_ground(gpu, field, &buffers, &colour, look.soil_rgb)?;
        self.field = Some((buffers.clone(), field.seeds.rounds));
        let (groups, samples) = (&self.groups, self.samples);
        self.billboards = BillboardsLayer::of(gpu, groups, samples, field, &buffers, &colour)?;
        self.plants.set_field(field, buffers, &colour);
        self.set_shapes(gpu, shapes, coats)
    }

    /// Takes new body shapes and coats alone, for a body that is added while the scene runs.
    ///
    /// # Errors
    /// Data larger than the device can bind.
    pub fn set_shapes(
        &mut self,
        gpu: &Gpu,
        shapes: &[RigidShape],
        coats: &[CoatedShape],
    ) -> Result<(), RenderError> {
        self.bodies.set_shapes(gpu, shapes)?;
        let Some((field, rounds)) = self.field.as_ref().filter(|_| !coats.is_empty()) else {
            self.coats = None;
            return Ok(());
        };
        let scene = CoatScene::new(gpu, *rounds, shapes, coats)?;
        let field = field.clone();
        match &mut self.coats {
            Some(layer) => layer.set_scene(scene, field),
            None => {
                let (groups, samples) = (&self.groups, self.samples);
                self.coats = Some(CoatLayer::new(gpu, groups, samples, scene, field)?);
            }
        }
        Ok(())
    }

    /// Lights the next frames from volumes; `None` as if nothing hid the sky. A scene that is set later
    /// keeps them until it gets its own.
    ///
    /// # Errors
    /// Volumes that the device cannot hold.
    pub fn set_light(
        &mut self,
        gpu: &Gpu,
        texels: Option<&LightTexels>,
    ) -> Result<(), RenderError> {
        self.groups.set_light(gpu, texels)
    }

    /// Refuses so many slices of light volumes before anything is traced for them.
    ///
    /// # Errors
    /// More slices than the device's textures have layers for.
    pub fn check_light(&self, gpu: &Gpu, slices: u32) -> Result<(), RenderError> {
        check_layers(slices, gpu.device.limits().max_texture_array_layers)
    }

    /// Bytes of light volumes on the device. Where there is none, a texel of each kind for the bindings, 29
    /// bytes: shaders look none of them up.
    pub fn light_bytes(&self) -> u64 {
        self.groups.light_bytes()
    }

    /// Makes targets for another picture size; the same size costs nothing.
    ///
    /// # Errors
    /// A size the device cannot hold; the old one stays.
    pub fn resize(&mut self, gpu: &Gpu, size: [u32; 2]) -> Result<(), RenderError> {
        if size != self.targets.size {
            self.targets = Targets::new(gpu, size, self.samples)?;
            self.resolved_light = self.tonemap.bind(gpu, &self.targets);
        }
        Ok(())
    }

    /// What the last frame drew of the plants.
    pub fn blade_counts(&self) -> BladeCounts {
        self.plants.counts
    }

    /// What the last frame drew of the billboards; `None` where the scene has none, and so no pipelines
    /// and buffers for them.
    pub fn billboard_counts(&self) -> Option<BillboardCounts> {
        self.billboards.as_ref().map(|layer| layer.counts)
    }

    /// What the last frame drew of every form of plant, counted and read back from the device: for
    /// tests and benches, since it waits.
    ///
    /// # Errors
    /// The device's.
    pub fn drawn_plants(&self, gpu: &Gpu) -> Result<Vec<DrawnPlants>, RenderError> {
        Ok(self.plants.read_counts(gpu)?)
    }

    /// Every plant that the last frame drew, read back from the device: for tests, since it waits.
    ///
    /// # Errors
    /// The device's.
    pub fn listed_plants(&self, gpu: &Gpu) -> Result<Vec<ListedPlant>, RenderError> {
        Ok(self.plants.read_list(gpu)?)
    }

    /// What the last frame drew of the coats, read back from the device: for tests and benches, since it
    /// waits. `None` where the scene has none, and so no kernels and buffers for them.
    ///
    /// # Errors
    /// The device's.
    pub fn drawn_coats(&self, gpu: &Gpu) -> Result<Option<DrawnCoats>, RenderError> {
        let read = self.coats.as_ref().map(|coats| coats.read(gpu));
        Ok(read.transpose()?)
    }

    /// What the last frame's ground mesh is; `None` for a small field, which is drawn in full.
    pub fn ground_mesh(&self) -> Option<MeshChange> {
        self.terrain.mesh_change()
    }

    /// Width and height of the pictures, in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.targets.size
    }

    /// Records and submits one frame into `shown`. Opaque layers come near to far, so that what is
    /// hidden is not shaded; the order does not show.
    ///
    /// # Errors
    /// Bad input, named; the device's own errors.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        input: &FrameInput<'_>,
        shown: &wgpu::TextureView,
        timer: &mut PassTimer,
    ) -> Result<(), RenderError> {
        self.write(gpu, input)?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());

        self.plants.sort(gpu, &mut encoder, timer);
        if let Some(coats) = &self.coats {
            coats.place(gpu, &mut encoder, timer);
        }
        let mut pass = self.shadow.begin(&mut encoder, timer.render("shadow"));
        self.groups.bind_unlit(&mut pass);
        self.bodies.draw_shadow(&mut pass);
        drop(pass);

        let mut is_begun = false;
        // First of all, since they hide the most.
        for form in [BillboardForm::Quad, BillboardForm::Refined] {
            let layer = self.billboards.as_ref();
            let Some(billboards) = layer.filter(|layer| layer.shows(form)) else {
                continue;
            };
            let part = if is_begun { Part::Middle } else { Part::First };
            let times = timer.render(form.pass());
            let mut pass = self.targets.begin(&mut encoder, part, times);
            self.groups.bind(&mut pass);
            billboards.draw(&mut pass, form);
            drop(pass);
            is_begun = true;
        }
        let part = if is_begun { Part::Last } else { Part::Only };
        let times = timer.render("scene");
        let mut pass = self.targets.begin(&mut encoder, part, times);
        self.groups.bind(&mut pass);
        self.bodies.draw(&mut pass);
        if let Some(coats) = &self.coats {
            coats.draw(&mut pass);
        }
        self.plants.draw(&mut pass);
        self.groups.bind(&mut pass);
        self.terrain.draw(&mut pass);
        self.groups.bind(&mut pass);
        self.sky.draw(&mut pass);
        self.overlay.draw(&mut pass);
        drop(pass);

        let times = timer.render("tonemap");
        self.tonemap
            .draw(&mut encoder, &self.resolved_light, shown, times);

        timer.finish_frame(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        timer.collect(gpu);
        Ok(gpu.check()?)
    }

    /// Writes a frame's data without drawing it, for [`Renderer::sort_plants`].
    ///
    /// # Errors
    /// Bad input, named; the device's own errors.
    pub fn prepare(&mut self, gpu: &Gpu, input: &FrameInput<'_>) -> Result<(), RenderError> {
        self.write(gpu, input)
    }

    /// Submits the first stage of drawing the prepared frame's plants alone, which finds and sorts
    /// them: for benches.
    ///
    /// # Errors
    /// The device's.
    pub fn sort_plants(&self, gpu: &Gpu, timer: &mut PassTimer) -> Result<(), RenderError> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.plants.sort(gpu, &mut encoder, timer);
        timer.finish_frame(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        timer.collect(gpu);
        Ok(gpu.check()?)
    }

    /// What the last frame's first stage made of the seeding triangles, read back from the device:
    /// for tests and benches, since it waits.
    ///
    /// # Errors
    /// The device's.
    pub fn seeded_triangles(&self, gpu: &Gpu) -> Result<SeededTriangles, RenderError> {
        Ok(self.plants.read_triangles(gpu)?)
    }

    /// What the last frame's first stage made of its clusters, read back from the device: for tests and
    /// benches, since it waits.
    ///
    /// # Errors
    /// The device's.
    pub fn seeded_clusters(&self, gpu: &Gpu) -> Result<SeededClusters, RenderError> {
        Ok(self.plants.read_clusters(gpu)?)
    }

    /// Bytes of the picture's textures on the device.
    pub fn picture_bytes(&self) -> u64 {
        picture_bytes(self.targets.size, self.samples)
    }

    /// Writes what the layers need for this frame.
    fn write(&mut self, gpu: &Gpu, input: &FrameInput<'_>) -> Result<(), RenderError> {
        let size = self.targets.size;
        let light = input.sun.daylight();
        let [columns, rows] = size;
        let picture = Size { columns, rows };
        let coat_frame = CoatFrame {
            view: input.view,
            picture,
            bodies: input.bodies,
            detail: self.coat_detail,
            density: input.blades.map_or(1.0, |blades| blades.detail.density),
        };
        if let Some(coats) = &mut self.coats {
            coats.write(gpu, &coat_frame)?;
        }
        let coats = self.coats.as_ref().map(|coats| (coats, &coat_frame));
        let casters = (self.bodies).write(gpu, input.view, input.bodies, coats)?;
        let fit = ShadowFit::new(&light, input.view, &casters);
        let detail = input.blades.map(|blades| blades.detail);
        let frame = Frame::new(input.view, size, &light, &fit, detail, input.time_s);
        self.groups.write(gpu, input.view, frame)?;
        let blades = input.blades.as_ref();
        self.terrain
            .write(gpu, input.view, size, self.terrain_detail, blades)?;
        if let Some(blades) = &input.blades {
            blades.detail.check()?;
            self.plants.write(gpu, input.view, picture, blades)?;
        } else {
            self.plants.clear();
        }
        match (&mut self.billboards, &input.blades) {
            (Some(layer), Some(blades)) => {
                let error_px = self.terrain_detail.error_px;
                layer.write(gpu, input.view, picture, error_px, blades)?;
            }
            (Some(layer), None) => layer.clear(),
            (None, _) => {}
        }
        self.overlay.write(gpu, input.view, input.marks)?;
        self.tonemap.write(gpu, input.exposure)?;
        Ok(())
    }
}
