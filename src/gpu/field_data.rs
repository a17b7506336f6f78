//! The field as the shaders see it: constants of a scene, the wind of an instant, one record per
//! tile. Twins: `shaders/shared/field.wgsl`, `wind.wgsl`, `tile.wgsl`.
//!
//! The buffers of [`FieldBuffers`] are bind group 0 of the simulation's passes and of every
//! renderer that draws plants. They live as long as the scene.

use wgpu::BufferUsages;

use super::base_texels::base_texels;
use super::{Buffer, Gpu, GpuError};
use crate::field::blade_table::Spacing;
use crate::field::kinds::{MAX_TASTES, Taste};
use crate::field::plant::{MAX_SPECIES, SpeciesNumbers};
use crate::field::pose::{MAX_SEGMENTS, wind_share};
use crate::field::wind::{WAVES, Wave};
use crate::field::{Anchor, Field, TileId, WindNow};
use crate::gpu_struct;
use crate::sim::work::TileWork;

/// Knee of a blade table whose axes are even.
pub const NO_KNEE: f32 = -1.0;
/// Slab of a tile that has none.
pub const NO_SLAB: u32 = u32::MAX;
/// State of a tile that is in no list of active ones.
pub const TILE_RESTING: u32 = 0;
pub const TILE_COLLIDING: u32 = 1;
pub const TILE_RECOVERING: u32 = 2;

gpu_struct! {
    /// A kind of plant; pairs are the smallest value and the span above it.
    pub struct SpeciesUniform {
        pub height_m: [f32; 2],
        pub width_m: [f32; 2],
        pub stiffness: [f32; 2],
        pub lean: [f32; 2],
        pub tint_rgb: [f32; 3],
        pub flexibility: f32,
        pub share_below: u32,
        pub dwindle: f32,
        pub responds: u32,
        pub spare_a: u32,
        pub towards: [f32; 2],
        pub spare_b: [u32; 2],
    }
}

gpu_struct! {
    /// A liking for a colour of the ground.
    pub struct TasteUniform {
        pub hsv: [u32; 3],
        pub exponent: u32,
        pub weights: [u32; 3],
        pub share_log: i32,
        pub threshold_log: i32,
        pub spare_a: u32,
        pub spare_b: [u32; 2],
    }
}

gpu_struct! {
    /// What a meadow's plants are made of.
    pub struct FieldUniform {
        pub cells: [u32; 2],
        pub squares: [u32; 2],
        pub columns: u32,
        pub tile_cells: u32,
        pub sure_plants: u32,
        pub one_more: u32,
        pub plants_per_tile: u32,
        pub key: u32,
        pub rounds: u32,
        pub species_count: u32,
        pub segments: u32,
        pub stiffness_entries: u32,
        pub lean_entries: u32,
        pub cell_m: f32,
        pub squares_per_m: f32,
        pub segment_share: f32,
        pub reach_m: f32,
        pub stiffness_knee: f32,
        pub map_texels: [u32; 2],
        pub map_step: u32,
        pub taste_count: u32,
        pub cluster: u32,
        pub spare_a: u32,
        pub spare_b: [u32; 2],
        pub wind_shares: [[f32; 4]; MAX_SEGMENTS / 4],
        pub species: [SpeciesUniform; MAX_SPECIES],
        pub tastes: [TasteUniform; MAX_TASTES],
    }
}

gpu_struct! {
    /// One sine of a gust.
    pub struct WaveUniform {
        pub per_anchor: [u32; 2],
        pub per_metre: [f32; 2],
        pub phase: u32,
        pub share: f32,
        pub spare: [u32; 2],
    }
}

gpu_struct! {
    /// The wind at one instant.
    pub struct WindUniform {
        pub direction: [f32; 2],
        pub strength: f32,
        pub gust: f32,
        pub flutter: f32,
        pub flutter_phase: u32,
        pub spare: [u32; 2],
        pub waves: [WaveUniform; WAVES],
    }
}

gpu_struct! {
    /// One tile, resting or active.
    pub struct TileRecord {
        pub tile: u32,
        pub slab: u32,
        pub anchor: [u32; 2],
        pub square: [u32; 2],
        pub in_square: [f32; 2],
        pub first_cell: [u32; 2],
        pub base_y: f32,
        pub state: u32,
        pub first_contact: u32,
        pub end_contact: u32,
        pub anchor_on_map: [u32; 2],
    }
}

impl From<&SpeciesNumbers> for SpeciesUniform {
    fn from(kind: &SpeciesNumbers) -> Self {
        Self {
            height_m: kind.height_m,
            width_m: kind.width_m,
            stiffness: kind.stiffness,
            lean: kind.lean,
            tint_rgb: kind.tint_rgb,
            flexibility: kind.flexibility,
            share_below: kind.share_below,
            dwindle: kind.dwindle,
            responds: kind.responds.into(),
            spare_a: 0,
            towards: kind.towards,
            spare_b: [0; 2],
        }
    }
}

impl From<&Taste> for TasteUniform {
    fn from(taste: &Taste) -> Self {
        Self {
            hsv: taste.hsv,
            exponent: taste.exponent,
            weights: taste.weights,
            share_log: taste.share_log,
            threshold_log: taste.threshold_log,
            spare_a: 0,
            spare_b: [0; 2],
        }
    }
}

impl FieldUniform {
    /// The numbers of a field. Kinds beyond [`MAX_SPECIES`] are refused when a scene is loaded.
    pub fn new(field: &Field) -> Self {
        let (grid, seeds, table) = (&field.grid, &field.seeds, &field.table);
        let mut species = [SpeciesUniform::from(&SpeciesNumbers::default()); MAX_SPECIES];
        for (place, kind) in species.iter_mut().zip(&seeds.species) {
            *place = kind.into();
        }
        let mut tastes = [TasteUniform::from(&Taste::default()); MAX_TASTES];
        let kinds = seeds.kinds.as_ref();
        for (place, taste) in tastes.iter_mut().zip(kinds.iter().flat_map(|k| &k.tastes)) {
            *place = taste.into();
        }
        let segments = table.segments as usize;
        let mut wind_shares = [[0.0; 4]; MAX_SEGMENTS / 4];
        for j in 0..segments {
            wind_shares[j / 4][j % 4] = wind_share(j, segments);
        }
        Self {
            cells: grid.cells,
            squares: field.ground.squares(),
            columns: field.ground.columns,
            tile_cells: grid.tile_cells,
            sure_plants: grid.sure_plants,
            one_more: grid.one_more,
            plants_per_tile: grid.plants_per_tile(),
            key: seeds.key,
            rounds: seeds.rounds,
            species_count: seeds.species.len() as u32,
            segments: table.segments,
            stiffness_entries: table.log2_k.entries,
            lean_entries: table.lean_rad.entries,
            cell_m: grid.cell_m,
            squares_per_m: 1.0 / field.ground.spacing_m,
            segment_share: (1.0 / f64::from(table.segments)) as f32,
            reach_m: field.reach_m,
            stiffness_knee: match table.log2_k.spacing {
                Spacing::Knee(knee) => knee,
                Spacing::Even | Spacing::FourthPower => NO_KNEE,
            },
            map_texels: kinds.map_or([1; 2], |k| [k.map.columns, k.map.rows]),
            map_step: kinds.map_or(0, |k| k.on_map.step),
            taste_count: kinds.map_or(0, |k| k.tastes.len() as u32),
            cluster: seeds.cluster,
            spare_a: 0,
            spare_b: [0; 2],
            wind_shares,
            species,
            tastes,
        }
    }
}

impl From<&Wave> for WaveUniform {
    fn from(wave: &Wave) -> Self {
        Self {
            per_anchor: wave.per_anchor,
            per_metre: wave.per_metre,
            phase: wave.phase,
            share: wave.share,
            spare: [0; 2],
        }
    }
}

impl From<&WindNow> for WindUniform {
    fn from(wind: &WindNow) -> Self {
        Self {
            direction: wind.direction,
            strength: wind.strength,
            gust: wind.gust,
            flutter: wind.flutter,
            flutter_phase: wind.flutter_phase,
            spare: [0; 2],
            waves: wind.waves.each_ref().map(WaveUniform::from),
        }
    }
}

impl TileRecord {
    /// A tile that rests.
    pub fn resting(field: &Field, tile: TileId) -> Self {
        let anchor = field.grid.anchor_of(tile, &field.ground);
        Self::at(field, tile, &anchor)
    }

    /// An active tile with its run of contacts.
    pub fn active(field: &Field, work: &TileWork) -> Self {
        let state = if work.contacts.is_empty() {
            TILE_RECOVERING
        } else {
            TILE_COLLIDING
        };
        Self {
            slab: work.slab,
            state,
            first_contact: work.contacts.start,
            end_contact: work.contacts.end,
            ..Self::at(field, work.tile, &work.anchor)
        }
    }

    fn at(field: &Field, tile: TileId, anchor: &Anchor) -> Self {
        let grid = &field.grid;
        let kinds = field.seeds.kinds.as_ref();
        Self {
            tile,
            slab: NO_SLAB,
            anchor: anchor.index,
            square: anchor.square,
            in_square: anchor.in_square,
            first_cell: grid.first_cell(tile),
            base_y: anchor.base_y,
            state: TILE_RESTING,
            first_contact: 0,
            end_contact: 0,
            anchor_on_map: kinds.map_or([0; 2], |kinds| kinds.on_map.anchor(grid, anchor)),
        }
    }
}

/// Bind group 0: the field, its height samples, its blade table, the wind, the base map's bytes.
#[derive(Clone, Debug)]
pub struct FieldBuffers {
    pub uniform: Buffer<FieldUniform>,
    pub heights_m: Buffer<f32>,
    pub blade_directions: Buffer<[f32; 2]>,
    pub wind: Buffer<WindUniform>,
    /// The base map as stored, for scores in integers; one texel where kinds do not look at it.
    pub base_texels: wgpu::TextureView,
    pub bind_group: wgpu::BindGroup,
}

impl FieldBuffers {
    /// The layout of bind group 0; the same for every pipeline that imports `shared/field.wgsl`.
    pub fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
        let of_type = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::all(),
            ty,
            count: None,
        };
        let entry = |binding, ty| {
            let buffer = wgpu::BindingType::Buffer {
                ty,
                has_dynamic_offset: false,
                min_binding_size: None,
            };
            of_type(binding, buffer)
        };
        let texels = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Uint,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let uniform = wgpu::BufferBindingType::Uniform;
        let storage = wgpu::BufferBindingType::Storage { read_only: true };
        gpu.device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("field"),
                entries: &[
                    entry(0, uniform),
                    entry(1, storage),
                    entry(2, storage),
                    entry(3, uniform),
                    of_type(4, texels),
                ],
            })
    }

    /// # Errors
    /// A ground, a table or a base map larger than the device can bind.
    pub fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, field: &Field) -> Result<Self, GpuError> {
        let uniform = Buffer::with(
            gpu,
            "field",
            &[FieldUniform::new(field)],
            BufferUsages::UNIFORM,
        )?;
        let heights_m = Buffer::with(
            gpu,
            "height samples",
            &field.ground.heights_m,
            BufferUsages::STORAGE,
        )?;
        let blade_directions = Buffer::with(
            gpu,
            "blade table",
            &field.table.directions,
            BufferUsages::STORAGE,
        )?;
        let wind = Buffer::new(gpu, "wind", 1, BufferUsages::UNIFORM)?;
        let base_texels = base_texels(gpu, field)?;
        let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("field"),
            layout,
            entries: &[
                entry(0, uniform.binding()),
                entry(1, heights_m.binding()),
                entry(2, blade_directions.binding()),
                entry(3, wind.binding()),
                entry(4, wgpu::BindingResource::TextureView(&base_texels)),
            ],
        });
        Ok(Self {
            uniform,
            heights_m,
            blade_directions,
            wind,
            base_texels,
            bind_group,
        })
    }

    /// Sets the wind for everything submitted from now on.
    ///
    /// # Errors
    /// The driver's.
    pub fn set_wind(&self, gpu: &Gpu, wind: &WindNow) -> Result<(), GpuError> {
        self.wind.write(gpu, 0, &[wind.into()])
    }
}

fn entry(binding: u32, resource: wgpu::BindingResource<'_>) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource }
}
