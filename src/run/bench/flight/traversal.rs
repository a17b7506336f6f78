//! What finding the tiles in view costs the processor over terrains of several sizes.

use serde::Serialize;

use crate::field::Field;
use crate::render::BladeDetail;
use crate::run::bench::terrain::TerrainBenchError;
use crate::run::bench::terrain::{Cost, hills, shortest_ms};
use crate::scene::assets::Assets;
use crate::scene::{Grass, Solver};
use crate::terrain::height_grid;

use super::{FLIGHT_S, FRAMES_PER_S, flight_view};

/// The traversal of one terrain.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Traversal {
    pub km2: f64,
    /// Milliseconds a frame, on one thread.
    pub ms: Cost,
    /// Most tiles of any frame.
    pub tiles: u64,
}

/// Flies over square hills of a side; every frame's traversal counts with the shortest of three.
///
/// # Errors
///
/// A terrain that cannot be laid out.
pub(super) fn traversal_over(side_m: f32, aspect: f32) -> Result<Traversal, TerrainBenchError> {
    let ground = height_grid(&hills(side_m), &Assets::default())?;
    let field = Field::new(ground, &Grass::default(), &Solver::default())?;
    let mut tiles = 0;
    let frames_ms: Vec<f64> = (0..FLIGHT_S * FRAMES_PER_S)
        .map(|frame| {
            let (ms, found) = traversal_ms(&field, frame, aspect, BladeDetail::default().reach_m);
            tiles = tiles.max(found);
            ms
        })
        .collect();
    Ok(Traversal {
        km2: f64::from(side_m) * f64::from(side_m) * 1e-6,
        ms: Cost::of(&frames_ms),
        tiles,
    })
}

/// Milliseconds of a frame's traversal, and the tiles that it finds.
pub(super) fn traversal_ms(field: &Field, frame: u32, aspect: f32, reach_m: f32) -> (f64, u64) {
    let view = flight_view(&field.ground, frame);
    let viewpoint = view.viewpoint(aspect, 1);
    let mut tiles = 0;
    let ms = shortest_ms(|| tiles = field.tiles_in_view(&viewpoint, reach_m).len());
    (ms, tiles as u64)
}
