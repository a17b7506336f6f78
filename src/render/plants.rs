//! Plants of every form: the second of the two stages of P15 section 3.5. Each form has a file and
//! a shader of its own, and is drawn indirectly from the ranges that `sort_plants.rs` makes.

use wgpu::{BufferUsages, ShaderStages};

use crate::field::plant::MAX_SPECIES;
use crate::field::{Field, TileId, WindNow};
use crate::gpu::field_data::FieldBuffers;
use crate::gpu::passes::Recording;
use crate::gpu::{Buffer, Gpu, GpuError, PassTimer};
use crate::gpu_struct;
use crate::scene::Form;

use super::active_billboards::BillboardNodes;
use super::blade_tiles::{BladeDetail, DrawnTile, Size, drawn_tiles, most_on_triangle};
use super::camera::View;
use super::canopy::Canopy;
use super::ground_look::GroundTexture;
use super::pipeline::{Drawing, READ_STORAGE, SAMPLER, TEXTURE, UNIFORM, bind_group, group_layout};
use super::plant_form::{BUCKETS, DETAILS, FORM_BLADE, FORMS, FormDrawing, form_index};
use super::plant_list::{self, ListedPlant};
use super::seed_triangles::SeededTriangles;
use super::sort_plants::{DrawArgs, PlantSort, SeededClusters, SortInput};
use super::view_group::ViewGroups;

/// Details whose plants have shadows: those of plants that are nearer than twice
/// [`BladeDetail::full_m`], at the end of which shadows have faded.
const SHADOW_DETAILS: u32 = 2;

/// Where plants hide more of the ground's sky than this, they hide the ground and the shadows on it, and
/// cost a third of a frame for nothing to be seen.
const CLOSED_COVER: f32 = 0.6;

gpu_struct! {
    pub(super) struct Bucket {
        stride: u32,
        steps: u32,
        coarser: u32,
        spare: u32,
    }
}

gpu_struct! {
    pub(super) struct FormUniform {
        petal_rgb: [f32; 3],
        petals: f32,
        centre_rgb: [f32; 3],
        head_m: f32,
    }
}

gpu_struct! {
    pub(super) struct PlantLook {
        map_m: [f32; 2],
        cover: f32,
        reach_m: f32,
        samples: u32,
        spare_a: u32,
        spare_b: [u32; 2],
        buckets: [Bucket; BUCKETS as usize],
        forms: [FormUniform; MAX_SPECIES],
    }
}

/// What grows, and what of it is awake.
#[derive(Clone, Copy, Debug)]
pub struct BladesInput<'a> {
    pub field: &'a Field,
    pub wind: &'a WindNow,
    /// Active tiles with their slabs, in the order of their ids.
    pub active: &'a [(TileId, u32)],
    /// Nodes of the active tiles' plants in their anchors, as
    /// [`GpuGrass::drawn`](crate::gpu::GpuGrass::drawn) or [`ActiveNodes`](super::ActiveNodes)
    /// lays them out: a row per node, root first.
    pub active_nodes: &'a Buffer<[f32; 4]>,
    /// The same of billboards; `None` draws all of them as quads in the wind.
    pub billboards: Option<BillboardNodes<'a>>,
    pub detail: BladeDetail,
}

/// Counts of a frame, for panels and benches: upper bounds, since the device leaves out what is
/// bare or out of sight, and tells nobody.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct BladeCounts {
    pub tiles: u64,
    pub blades: u64,
    pub triangles: u64,
}

impl BladeCounts {
    fn add(&mut self, drawn: &DrawnTile, segments: u32) {
        let form = &FORMS[FORM_BLADE as usize];
        let [_, steps] = form.steps(drawn.detail, segments);
        let blades = u64::from(drawn.most_places);
        self.tiles += 1;
        self.blades += blades;
        self.triangles += blades * u64::from(form.triangles((form.vertices)(steps)));
    }
}

/// Plants of one form that a frame drew, as the device counted them.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct DrawnPlants {
    /// Name of the form's shader.
    pub form: &'static str,
    pub plants: u64,
    pub triangles: u64,
}

/// What belongs to one field.
#[derive(Debug)]
struct PlantScene {
    buffers: FieldBuffers,
    colour: GroundTexture,
    cover: f32,
    /// Form of each kind.
    kinds: Vec<Form>,
    group: Option<(wgpu::Buffer, wgpu::BindGroup)>,
}

/// Draws the plants.
#[derive(Debug)]
pub(super) struct PlantsLayer {
    /// One per form, for the plants and for their shadows on the ground.
    pipelines: Vec<wgpu::RenderPipeline>,
    shadows: Vec<wgpu::RenderPipeline>,
    has_shadows: bool,
    layout: wgpu::BindGroupLayout,
    look: Buffer<PlantLook>,
    sort: PlantSort,
    scene: Option<PlantScene>,
    /// Forms and details that this frame may hold.
    used: Vec<u32>,
    pub(super) counts: BladeCounts,
    samples: u32,
}

impl PlantsLayer {
    pub(super) fn new(gpu: &Gpu, groups: &ViewGroups, samples: u32) -> Result<Self, GpuError> {
        let (vertex, fragment) = (ShaderStages::VERTEX, ShaderStages::FRAGMENT);
        let layout = group_layout(
            gpu,
            "plants",
            &[
                (vertex | fragment, UNIFORM),
                (vertex, READ_STORAGE),
                (vertex, READ_STORAGE),
                (vertex, TEXTURE),
                (vertex, SAMPLER),
                (vertex, READ_STORAGE),
                (vertex, READ_STORAGE),
            ],
        );
        let field_layout = FieldBuffers::layout(gpu);
        let mut used = groups.lit(&layout);
        used[0] = Some(&field_layout);
        let pipeline = |form: &FormDrawing, vertex, fragment, topology| {
            Drawing {
                shader: form.shader,
                vertex,
                fragment,
                groups: used,
                topology,
                samples,
                alpha_to_coverage: samples > 1,
                ..Drawing::default()
            }
            .pipeline(gpu)
        };
        let pipelines =
            (FORMS.iter()).map(|form| pipeline(form, form.vertex, form.fragment, form.topology));
        let shadows = (FORMS.iter())
            .map(|form| pipeline(form, "shadow_vertex", "shadow_fragment", form.topology));
        Ok(Self {
            pipelines: pipelines.collect::<Result<_, _>>()?,
            shadows: shadows.collect::<Result<_, _>>()?,
            has_shadows: false,
            look: Buffer::new(gpu, "plant look", 1, BufferUsages::UNIFORM)?,
            sort: PlantSort::new(gpu)?,
            layout,
            scene: None,
            used: Vec::new(),
            counts: BladeCounts::default(),
            samples,
        })
    }

    /// Takes a field in place of the old one.
    pub(super) fn set_field(
        &mut self,
        field: &Field,
        buffers: FieldBuffers,
        colour: &GroundTexture,
    ) {
        self.clear();
        self.scene = (!field.is_bare()).then(|| PlantScene {
            buffers,
            colour: colour.clone(),
            cover: Canopy::of(field).cover,
            kinds: field.seeds.species.iter().map(|kind| kind.form).collect(),
            group: None,
        });
    }

    /// Leaves the plants out of the next frame.
    pub(super) fn clear(&mut self) {
        self.sort.clear();
        self.used.clear();
        self.counts = BladeCounts::default();
    }

    /// Lists what this frame may draw.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        view: &View,
        picture: Size,
        input: &BladesInput<'_>,
    ) -> Result<(), GpuError> {
        self.clear();
        let Some(scene) = &mut self.scene else {
            return Ok(());
        };
        scene.buffers.set_wind(gpu, input.wind)?;
        let segments = input.field.table.segments;
        let look = plant_look(scene, input.detail.reach_m, segments, self.samples);
        self.look.write(gpu, 0, &[look])?;
        let forms: Vec<u32> = scene.kinds.iter().map(form_index).collect();
        let tiles = drawn_tiles(input, view, picture);
        for drawn in &tiles {
            self.counts.add(drawn, segments);
        }
        let used = |bucket: &u32| {
            let is_near = |tile: &DrawnTile| tile.detail == bucket % DETAILS;
            forms.contains(&(bucket / DETAILS)) && tiles.iter().any(is_near)
        };
        self.used = (0..BUCKETS).filter(used).collect();
        self.has_shadows = input.detail.shadows && scene.cover < CLOSED_COVER;
        let grown = self.sort.write(
            gpu,
            &SortInput {
                view,
                picture,
                detail: input.detail,
                most: most_on_triangle(input) as f32,
                triangles_per_tile: input.field.grid.triangles_per_tile(),
                plants_per_triangle: input.field.grid.plants_per_triangle(),
                cluster: input.field.seeds.cluster,
                forms: &forms,
                segments,
                tiles: &tiles,
            },
        )?;
        let known = scene.group.as_ref().map(|(nodes, _)| nodes);
        if grown || known != Some(&input.active_nodes.raw) {
            let group = bind_group(
                gpu,
                "plants",
                &self.layout,
                &[
                    self.look.binding(),
                    self.sort.tiles.binding(),
                    input.active_nodes.binding(),
                    wgpu::BindingResource::TextureView(&scene.colour.view),
                    wgpu::BindingResource::Sampler(&scene.colour.sampler),
                    self.sort.sorted.binding(),
                    self.sort.draws.binding(),
                ],
            );
            scene.group = Some((input.active_nodes.raw.clone(), group));
        }
        Ok(())
    }

    /// Records the first stage.
    pub(super) fn sort(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        timer: &mut PassTimer,
    ) {
        if let Some(scene) = &self.scene {
            let mut into = Recording {
                encoder,
                timer,
                field: &scene.buffers,
            };
            self.sort.record(gpu, &mut into);
        }
    }

    /// Records the second stage.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(scene) = &self.scene else {
            return;
        };
        let Some((_, group)) = &scene.group else {
            return;
        };
        pass.set_bind_group(0, &scene.buffers.bind_group, &[]);
        pass.set_bind_group(3, group, &[]);
        self.draw_buckets(pass, &self.pipelines, DETAILS);
        if self.has_shadows {
            self.draw_buckets(pass, &self.shadows, SHADOW_DETAILS);
        }
    }

    /// Draws the plants of the finest `details` with one pipeline per form.
    fn draw_buckets(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        pipelines: &[wgpu::RenderPipeline],
        details: u32,
    ) {
        for of_form in self.used.chunk_by(|a, b| a / DETAILS == b / DETAILS) {
            pass.set_pipeline(&pipelines[(of_form[0] / DETAILS) as usize]);
            for &bucket in of_form.iter().filter(|&bucket| bucket % DETAILS < details) {
                let offset = u64::from(bucket) * size_of::<DrawArgs>() as u64;
                pass.draw_indirect(&self.sort.draws.raw, offset);
            }
        }
    }

    /// Reads back what the last frame made of its triangles. Waits for the device.
    ///
    /// # Errors
    /// The device's.
    pub(super) fn read_triangles(&self, gpu: &Gpu) -> Result<SeededTriangles, GpuError> {
        self.sort.read_triangles(gpu)
    }

    /// Reads back what the last frame made of its clusters. Waits for the device.
    ///
    /// # Errors
    /// The device's.
    pub(super) fn read_clusters(&self, gpu: &Gpu) -> Result<SeededClusters, GpuError> {
        self.sort.read_clusters(gpu)
    }

    /// Reads back what the last frame drew, by form. Waits for the device: for tests and benches.
    ///
    /// # Errors
    /// The device's.
    pub(super) fn read_list(&self, gpu: &Gpu) -> Result<Vec<ListedPlant>, GpuError> {
        plant_list::read(gpu, &self.sort)
    }

    /// What the last frame drew of every form, counted by the device. Waits for it.
    ///
    /// # Errors
    /// The device's.
    pub(super) fn read_counts(&self, gpu: &Gpu) -> Result<Vec<DrawnPlants>, GpuError> {
        if self.sort.is_empty() {
            return Ok(Vec::new());
        }
        let draws = self.sort.draws.read(gpu, BUCKETS as usize)?;
        let by_form = draws.chunks_exact(DETAILS as usize).zip(&FORMS);
        Ok(by_form
            .map(|(draws, form)| DrawnPlants {
                form: form.shader,
                plants: draws.iter().map(|draw| u64::from(draw.instances)).sum(),
                triangles: draws
                    .iter()
                    .map(|draw| {
                        u64::from(draw.instances) * u64::from(form.triangles(draw.vertices))
                    })
                    .sum(),
            })
            .collect())
    }
}

fn plant_look(scene: &PlantScene, reach_m: f32, segments: u32, samples: u32) -> PlantLook {
    let mut buckets = [Bucket {
        stride: 1,
        steps: 1,
        coarser: 1,
        spare: 0,
    }; BUCKETS as usize];
    for (place, bucket) in buckets.iter_mut().zip(0..) {
        let form = &FORMS[(bucket / DETAILS) as usize];
        let detail = bucket % DETAILS;
        [place.stride, place.steps] = form.steps(detail, segments);
        [place.coarser, _] = form.steps((detail + 1).min(DETAILS - 1), segments);
    }
    let mut forms = [FormUniform {
        petal_rgb: [0.0; 3],
        petals: 1.0,
        centre_rgb: [0.0; 3],
        head_m: 0.0,
    }; MAX_SPECIES];
    for (place, form) in forms.iter_mut().zip(&scene.kinds) {
        if let Form::Flower {
            head_m,
            petals,
            petal_rgb,
            centre_rgb,
        } = *form
        {
            *place = FormUniform {
                petal_rgb,
                petals: petals as f32,
                centre_rgb,
                head_m,
            };
        }
    }
    PlantLook {
        map_m: scene.colour.size_m,
        cover: scene.cover,
        reach_m,
        samples,
        spare_a: 0,
        spare_b: [0; 2],
        buckets,
        forms,
    }
}
