//! The ground that is flown over and what grows on it.

use std::sync::Arc;

use crate::field::{Field, WindNow};
use crate::gpu::Gpu;
use crate::render::GroundLook;
use crate::run::bench::still_field::{DrawBenchError, StillField};
use crate::run::bench::terrain::hills;
use crate::scene::assets::{Assets, HeightMap};
use crate::scene::{Grass, Ground, Likes, Solver, Species, Terrain};
use crate::terrain::{ColourMap, HeightGrid, TerrainError, height_grid};

/// Side of a seeding cell, in metres. Its triangles have 50 plants: enough for clusters of 16.
const CELL_M: f32 = 0.625;
/// Linear colour of bare soil, which takes the place of dry patches.
const SOIL_RGB: [f32; 3] = [0.2, 0.15, 0.08];

/// A height map in place of the hills.
#[derive(Clone, Debug)]
pub struct FlownMap {
    /// Its name in results.
    pub name: String,
    pub map: HeightMap,
    /// Distance of its texels, and height of white above black, in metres.
    pub spacing_m: f32,
    pub height_m: f32,
}

/// A ground with its colours, which say what grows where.
pub(super) struct FlownGround {
    pub grid: HeightGrid,
    map: Arc<ColourMap>,
    soil_rgb: [f32; 3],
}

impl FlownGround {
    /// Square hills of a side, or the height map.
    ///
    /// # Errors
    ///
    /// A height map that is too small or too large.
    pub fn new(side_m: f32, flown: Option<&FlownMap>) -> Result<Self, TerrainError> {
        let mut assets = Assets::default();
        let coloured = Terrain {
            dry_rgb: SOIL_RGB,
            ..hills(side_m)
        };
        let terrain = match flown {
            None => coloured,
            Some(flown) => {
                let file = flown.name.clone();
                assets.height_maps.insert(file.clone(), flown.map.clone());
                Terrain {
                    ground: Ground::HeightMap {
                        file,
                        spacing_m: flown.spacing_m,
                        height_m: flown.height_m,
                    },
                    ..coloured
                }
            }
        };
        let grid = height_grid(&terrain, &assets)?;
        Ok(Self {
            map: Arc::new(ColourMap::of_patches(&terrain, &grid)),
            soil_rgb: terrain.soil_rgb,
            grid,
        })
    }

    /// The field whose seeds lie in clusters of a size.
    ///
    /// # Errors
    ///
    /// A field that cannot be laid out or that the device cannot hold.
    pub fn field(
        &self,
        gpu: &Gpu,
        cluster: u32,
        picture: [u32; 2],
    ) -> Result<StillField, DrawBenchError> {
        let map = Arc::clone(&self.map);
        let grass = grass(cluster);
        let solver = Solver {
            seeding_cell_m: CELL_M,
            tile_m: 2.0 * CELL_M,
            ..Solver::default()
        };
        let field = Field::on_map(self.grid.clone(), map, &grass, &solver)?;
        let look = GroundLook {
            map: &self.map,
            soil_rgb: self.soil_rgb,
        };
        StillField::of(gpu, field, &look, WindNow::default(), picture)
    }
}

/// Two grasses and bare soil. Their references are the lush patches' colour, that between, and
/// [`SOIL_RGB`], in sRGB.
fn grass(cluster: u32) -> Grass {
    let likes = |hsv| Likes {
        hsv,
        weights: [2.0, 0.5, 0.25],
        ..Likes::default()
    };
    Grass {
        cluster,
        species: vec![
            Species {
                name: "lush grass".into(),
                likes: Some(likes([88.0, 0.5, 0.47])),
                ..Species::default()
            },
            Species {
                name: "dry fescue".into(),
                likes: Some(likes([67.0, 0.38, 0.45])),
                height_m: [0.14, 0.28],
                width_m: [0.003, 0.005],
                ..Species::default()
            },
        ],
        bare: vec![likes([39.0, 0.36, 0.49])],
        ..Grass::default()
    }
}
