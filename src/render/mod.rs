//! Pictures of a meadow: one file per layer, drawn in the order of [`Renderer::draw`].
//!
//! Pipelines and targets live as long as the renderer, the ground and the shapes as long as a
//! scene, everything else for one frame. All positions go to the device relative to the eye.

mod active_billboards;
mod active_nodes;
mod billboard_runs;
mod billboard_surface;
mod billboards;
mod blade_tiles;
mod blades;
mod bodies;
mod camera;
mod canopy;
mod clump_picture;
mod clump_textures;
mod coat;
mod coat_place;
mod coat_scene;
mod colour_mips;
mod error;
mod flowers;
mod frame;
mod gravel;
mod ground_look;
mod ground_mesh;
mod leaves;
pub mod light;
mod meadow_view;
mod overlay;
mod picture;
mod pipeline;
mod plant_form;
mod plant_list;
mod plants;
mod seed_triangles;
mod shadow;
mod sky;
mod sort_plants;
mod targets;
mod terrain;
mod tonemap;
mod twigs;
mod view_group;

pub use active_billboards::{ActiveBillboards, BillboardNodes};
pub use active_nodes::ActiveNodes;
pub use billboards::BillboardCounts;
pub use blade_tiles::{BladeDetail, Count, Submission, Transition};
pub use bodies::BodyInstance;
pub use camera::{Frustum, View};
pub use coat::{CoatDetail, DrawnCoats};
pub use coat_place::PlacedPlant;
pub use error::RenderError;
pub use frame::{FrameInput, Renderer};
pub use ground_look::GroundLook;
pub use ground_mesh::TerrainDetail;
pub use meadow_view::{active_slabs, bodies_at, scene_view, tile_marks};
pub use overlay::{TileMark, TileTone};
pub use picture::{Animation, Picture, PictureTarget};
pub use plant_list::ListedPlant;
pub use plants::{BladeCounts, BladesInput, DrawnPlants};
pub use seed_triangles::SeededTriangles;
pub use sky::{Daylight, Sun};
pub use sort_plants::SeededClusters;
pub use tonemap::Exposure;

use crate::field::billboards::MAX_CLUMPS;
use crate::field::count::{BINS, COUNT_WORD, NEAR_M};
use crate::field::grid::ANCHOR_CELLS;
use crate::field::kinds::MAX_TASTES;
use crate::field::plant::MAX_SPECIES;
use crate::gpu::GpuStruct;
use crate::gpu::layout::StructLayout;
use crate::gpu::passes::{MOST_GROUPS, WORKGROUP};
use crate::gpu::wgsl::WgslFile;
use crate::wgsl_file;
use blade_tiles::WIDEN_POWER;
use blades::{TUFT_RADIUS_M, TUFT_TURNS};
use clump_textures::CLUMP_TINT_MOST;
use coat_place::{COAT_BUCKETS, COAT_DETAILS, COAT_VERTICES, NO_COAT_BUCKET};
use ground_look::{LOOK_BARE, LOOK_GRASS, LOOK_GRAVEL, LOOK_LITTER, TASTE_ROWS};
use plant_form::{BUCKET_VERTICES, BUCKETS, DETAILS, FORM_BLADE, FORM_COUNT};
use seed_triangles::{
    LIST_BIN_ENDS, LIST_BIN_TRIANGLES, LIST_CLUSTERS, LIST_GROUPS, LIST_JOBS, NO_BIN,
};
use sort_plants::{
    BARE_BUCKET, COUNT_BY_DISTANCE, COUNT_BY_PROJECTED_AREA, LEAST_GROWN, NO_BUCKET,
};
use terrain::{CHUNK_SAMPLES, LAND_RINGS_M};

/// Format in which light is added up before it is shown.
const LIGHT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// The shaders of this layer and what only they import.
pub const SHADERS: &[WgslFile] = &[
    wgsl_file!("shared/area_count.wgsl", NEAR_M),
    wgsl_file!("shared/ball_in_view.wgsl"),
    wgsl_file!("shared/billboard_surface.wgsl"),
    wgsl_file!("shared/coat.wgsl"),
    wgsl_file!("shared/count.wgsl", ANCHOR_CELLS, COUNT_WORD),
    wgsl_file!("shared/draw_args.wgsl"),
    wgsl_file!(
        "shared/drawn_plant.wgsl",
        BUCKET_VERTICES,
        BUCKETS,
        MAX_SPECIES
    ),
    wgsl_file!("shared/drawn_tile.wgsl"),
    wgsl_file!("shared/frame.wgsl"),
    wgsl_file!("shared/light.wgsl"),
    wgsl_file!("shared/noise.wgsl"),
    wgsl_file!("shared/plant_light.wgsl"),
    wgsl_file!("shared/canopy_light.wgsl"),
    wgsl_file!("shared/planar_shadow.wgsl"),
    wgsl_file!("shared/screen.wgsl"),
    wgsl_file!("shared/shadow.wgsl"),
    wgsl_file!("shared/volume_light.wgsl"),
    wgsl_file!("billboards.wgsl", ANCHOR_CELLS, CLUMP_TINT_MOST, MAX_CLUMPS),
    wgsl_file!("blades.wgsl", TUFT_RADIUS_M, TUFT_TURNS),
    wgsl_file!("bodies.wgsl"),
    wgsl_file!("coat.wgsl", COAT_VERTICES),
    wgsl_file!(
        "coat_place.wgsl",
        COAT_BUCKETS,
        COAT_DETAILS,
        COAT_VERTICES,
        COUNT_WORD,
        LEAST_GROWN,
        NO_COAT_BUCKET,
        WIDEN_POWER,
        WORKGROUP
    ),
    wgsl_file!("flowers.wgsl"),
    wgsl_file!("gravel.wgsl"),
    wgsl_file!("leaves.wgsl"),
    wgsl_file!("overlay.wgsl"),
    wgsl_file!("sky.wgsl"),
    wgsl_file!(
        "seed_triangles.wgsl",
        BINS,
        COUNT_BY_DISTANCE,
        COUNT_BY_PROJECTED_AREA,
        LIST_BIN_ENDS,
        LIST_BIN_TRIANGLES,
        LIST_GROUPS,
        LIST_JOBS,
        LIST_CLUSTERS,
        MOST_GROUPS,
        NO_BIN,
        WORKGROUP
    ),
    wgsl_file!("shared/sorting.wgsl", FORM_COUNT),
    wgsl_file!(
        "sort_plants.wgsl",
        ANCHOR_CELLS,
        BARE_BUCKET,
        BINS,
        BUCKET_VERTICES,
        BUCKETS,
        DETAILS,
        FORM_BLADE,
        LEAST_GROWN,
        LIST_BIN_ENDS,
        LIST_BIN_TRIANGLES,
        LIST_GROUPS,
        LIST_JOBS,
        LIST_CLUSTERS,
        NO_BUCKET,
        WIDEN_POWER,
        WORKGROUP
    ),
    wgsl_file!(
        "terrain.wgsl",
        CHUNK_SAMPLES,
        LAND_RINGS_M,
        LOOK_BARE,
        LOOK_GRASS,
        LOOK_GRAVEL,
        LOOK_LITTER,
        MAX_TASTES,
        TASTE_ROWS
    ),
    wgsl_file!("tonemap.wgsl"),
    wgsl_file!("twigs.wgsl"),
];

/// Layouts of the structs that the shaders of this layer read.
pub fn layouts() -> Vec<StructLayout> {
    vec![
        view_group::Frame::layout(),
        billboard_surface::SurfaceTap::layout(),
        billboards::BillboardLook::layout(),
        billboard_runs::BillboardTile::layout(),
        blade_tiles::DrawnTile::layout(),
        bodies::BodyRecord::layout(),
        coat_place::CoatBody::layout(),
        coat::CoatLook::layout(),
        coat_place::CoatView::layout(),
        coat_place::PlacedPlant::layout(),
        coat_scene::CoatTriangle::layout(),
        light::LightVolume::layout(),
        overlay::OverlayBox::layout(),
        plants::Bucket::layout(),
        plants::FormUniform::layout(),
        plants::PlantLook::layout(),
        sort_plants::ClusterRecord::layout(),
        sort_plants::CountUniform::layout(),
        sort_plants::DrawArgs::layout(),
        sort_plants::SortUniform::layout(),
        terrain::Ground::layout(),
        terrain::Chunk::layout(),
        tonemap::Tonemap::layout(),
    ]
}
