//! How large a scene's ground and field become: counted before anything is allocated.
//!
//! The rules here are the ones the terrain and the field follow, so that the numbers in an error
//! are the numbers that would have been allocated.

use super::limits::{HEIGHT_SAMPLES, PLANTS_PER_TILE, SEEDING_TRIANGLES, TILES};
use super::{Grass, Ground, Solver};

/// Most halvings of the height samples' spacing.
const MOST_HALVINGS: u32 = 12;
/// Sides a few roundings apart count as equal.
const ROUNDING: f32 = 1.000_001;

/// Counts that follow from ground, grass and solver settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldSize {
    /// Height samples along x and z.
    pub samples: [u64; 2],
    /// Extent along x and z, in metres.
    pub size_m: [f64; 2],
    pub seeding_cell_m: f32,
    /// Two for every seeding cell.
    pub seeding_triangles: u64,
    /// Seeding cells along a tile's side: 1, 2 or 4.
    pub tile_cells: u32,
    pub tiles: u64,
    /// The mean number of plants, rounded up.
    pub plants: u64,
    /// The most plants a tile can hold.
    pub plants_per_tile: u64,
}

/// A count that is over its limit, or settings that do not fit each other.
#[derive(Clone, Debug, PartialEq)]
pub struct OverBudget {
    /// The key to change.
    pub key: &'static str,
    pub what: String,
}

/// Spacings along a side: a size that is no whole number of them is rounded up.
pub fn squares_along(size_m: f32, spacing_m: f32) -> u64 {
    let exact = f64::from(size_m) / f64::from(spacing_m);
    // A whole number of spacings stays one although f32 rounds both: 2⁻²³ off, twice.
    (exact * (1.0 - 3e-7)).ceil().max(1.0) as u64
}

/// Seeding cells along a height sample's spacing: the power of two, up to 2^12, that makes a cell
/// no longer than wished; `None` if none does.
pub fn cells_per_square(spacing_m: f32, wished_cell_m: f32) -> Option<u32> {
    let longest = wished_cell_m * ROUNDING;
    (0..=MOST_HALVINGS)
        .map(|halvings| 1_u32 << halvings)
        .find(|&cells| spacing_m / cells as f32 <= longest)
}

/// Seeding cells along a tile's side: the largest of 1, 2 and 4 that makes a tile no longer than
/// wished, or 1; `None` if 8 would still be no longer.
pub fn tile_cells(wished_tile_m: f32, cell_m: f32) -> Option<u32> {
    match wished_tile_m * ROUNDING / cell_m {
        ratio if ratio < 2.0 => Some(1),
        ratio if ratio < 4.0 => Some(2),
        ratio if ratio < 8.0 => Some(4),
        _ => None,
    }
}

/// Height samples along x and z that a flat or rolling ground has; `None` for a height map, whose
/// file says so.
pub fn ground_samples(ground: &Ground) -> Option<[u64; 2]> {
    match ground {
        Ground::Flat { size_m, spacing_m }
        | Ground::Rolling {
            size_m, spacing_m, ..
        } => Some(size_m.map(|s| squares_along(s, *spacing_m) + 1)),
        Ground::HeightMap { .. } => None,
    }
}

/// Distance of a ground's height samples, in metres.
pub fn spacing_m(ground: &Ground) -> f32 {
    match ground {
        Ground::Flat { spacing_m, .. }
        | Ground::Rolling { spacing_m, .. }
        | Ground::HeightMap { spacing_m, .. } => *spacing_m,
    }
}

/// What to write where a ground of so many seeding cells has too many tiles.
fn wider_tiles(cells: [u64; 2], cell_m: f32) -> String {
    let fits = |side: &u64| {
        let [x, z] = cells.map(|n| n.div_ceil(*side));
        x.checked_mul(z).is_some_and(|tiles| tiles <= TILES)
    };
    match [2, 4].into_iter().find(fits) {
        Some(side) => format!("write a tile_m of {} m", side as f32 * cell_m),
        None => {
            format!("make the ground smaller, or the seeding cells of {cell_m} m and tile_m larger")
        }
    }
}

/// Counts what a field of these settings holds; each of them must have passed its own range.
///
/// # Errors
/// The first count over its limit, with both numbers.
pub fn field_size(
    ground: &Ground,
    samples: [u64; 2],
    grass: &Grass,
    solver: &Solver,
) -> Result<FieldSize, OverBudget> {
    let over = |key, count: String, what: &str, limit: u64, hint: &str| OverBudget {
        key,
        what: format!("makes {count} {what}, more than the limit of {limit}; {hint}"),
    };
    let text = |count: Option<u64>| count.map_or("more than 2^64".to_owned(), |c| c.to_string());
    let within = |count: Option<u64>, limit| count.filter(|&c| c <= limit);
    let product = |a: u64, b: u64| a.checked_mul(b);

    let sampled = product(samples[0], samples[1]);
    within(sampled, HEIGHT_SAMPLES).ok_or_else(|| {
        let hint = "make the ground smaller or its spacing_m larger";
        over(
            "terrain.ground",
            text(sampled),
            "height samples",
            HEIGHT_SAMPLES,
            hint,
        )
    })?;

    let spacing = spacing_m(ground);
    let wished = solver.seeding_cell_m;
    let per_square = cells_per_square(spacing, wished).ok_or_else(|| OverBudget {
        key: "solver.seeding_cell_m",
        what: format!(
            "is {wished} m, but the ground's spacing_m of {spacing} m can be halved {MOST_HALVINGS} \
             times at most; write at least {} m",
            spacing / (1 << MOST_HALVINGS) as f32
        ),
    })?;
    // A division by a power of two is exact.
    let cell_m = spacing / per_square as f32;
    let cells = samples.map(|n| n.saturating_sub(1).saturating_mul(per_square.into()));
    let triangles = product(cells[0], cells[1]).and_then(|c| product(c, 2));
    let triangles = within(triangles, SEEDING_TRIANGLES).ok_or_else(|| {
        let hint = "make the ground smaller or seeding_cell_m larger";
        let count = text(triangles);
        over(
            "terrain.ground",
            count,
            "seeding triangles",
            SEEDING_TRIANGLES,
            hint,
        )
    })?;

    let tile_cells = tile_cells(solver.tile_m, cell_m).ok_or_else(|| OverBudget {
        key: "solver.tile_m",
        what: format!(
            "is {} m, but a tile is 1, 2 or 4 seeding cells of {cell_m} m; write {} m, or make the \
             ground's spacing_m of {spacing} m larger",
            solver.tile_m,
            4.0 * cell_m
        ),
    })?;
    let [x, z] = cells.map(|n| n.div_ceil(tile_cells.into()));
    let tiles = product(x, z);
    let tiles = within(tiles, TILES).ok_or_else(|| {
        let hint = wider_tiles(cells, cell_m);
        over("terrain.ground", text(tiles), "tiles", TILES, &hint)
    })?;

    let grows = !grass.species.is_empty();
    let density = if grows {
        f64::from(grass.density_per_m2)
    } else {
        0.0
    };
    let per_triangle = 0.5 * density * f64::from(cell_m).powi(2);
    // A triangle rounds its number of plants up or down by chance.
    let most = per_triangle.ceil() as u64;
    let per_tile = product(most, 2 * u64::from(tile_cells * tile_cells));
    let per_tile = within(per_tile, PLANTS_PER_TILE).ok_or_else(|| {
        let hint = "lower density_per_m2 or solver.tile_m";
        let count = text(per_tile);
        over(
            "grass.density_per_m2",
            count,
            "plants in a tile",
            PLANTS_PER_TILE,
            hint,
        )
    })?;
    // Below 2³² · 2¹⁶, so the float holds it to the last plant in a million.
    let plants = (per_triangle * triangles as f64).ceil() as u64;
    Ok(FieldSize {
        samples,
        size_m: samples.map(|n| n.saturating_sub(1) as f64 * f64::from(spacing)),
        seeding_cell_m: cell_m,
        seeding_triangles: triangles,
        tile_cells,
        tiles,
        plants,
        plants_per_tile: per_tile,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(size_m: [f32; 2], spacing_m: f32) -> Ground {
        Ground::Flat { size_m, spacing_m }
    }

    fn size_of(ground: &Ground, grass: &Grass, solver: &Solver) -> Result<FieldSize, OverBudget> {
        let samples = ground_samples(ground).expect("no height map");
        field_size(ground, samples, grass, solver)
    }

    #[test]
    fn a_million_blades_on_4096_tiles() {
        let size = size_of(
            &flat([64.0, 64.0], 1.0),
            &Grass::default(),
            &Solver::default(),
        );
        let size = size.expect("within budget");
        assert_eq!(size.samples, [65, 65]);
        assert_eq!(size.seeding_triangles, 128 * 128 * 2);
        assert_eq!((size.tiles, size.plants), (4096, 1_048_576));
        assert_eq!(size.plants_per_tile, 256);
    }

    #[test]
    fn decimals_do_not_add_a_square() {
        for (size, spacing, squares) in [
            (24.0, 0.1, 240),
            (7.0, 0.7, 10),
            (24.0, 0.3, 80),
            (0.5, 1.0, 1),
            (2.1, 1.0, 3),
        ] {
            assert_eq!(squares_along(size, spacing), squares, "{size} / {spacing}");
        }
    }

    #[test]
    fn cells_and_tiles() {
        for (spacing, cells) in [
            (5.0, Some(16)),
            (0.5, Some(1)),
            (0.2, Some(1)),
            (2049.0, None),
        ] {
            assert_eq!(cells_per_square(spacing, 0.5), cells, "{spacing}");
        }
        assert_eq!(cells_per_square(0.7 * 4.0, 0.7), Some(4));
        let wishes = [(0.1, 1), (0.5, 1), (1.0, 2), (1.9, 2), (2.0, 4), (3.9, 4)];
        for (wish, cells) in wishes {
            assert_eq!(tile_cells(wish, 0.5), Some(cells), "{wish}");
        }
        assert_eq!(tile_cells(4.0, 0.5), None);
    }

    #[test]
    fn each_limit_is_named_with_its_numbers() {
        let grass = Grass::default();
        let solver = Solver::default();
        let what = |ground: &Ground, grass: &Grass, solver: &Solver| {
            let over = size_of(ground, grass, solver).expect_err("over budget");
            format!("{}: {}", over.key, over.what)
        };
        let text = what(&flat([100_000.0, 100_000.0], 1.0), &grass, &solver);
        assert!(
            text.contains("10000200001 height samples") && text.contains("16777216"),
            "{text}"
        );
        let fine = Solver {
            seeding_cell_m: 0.05,
            tile_m: 0.2,
            ..Solver::default()
        };
        let text = what(&flat([8000.0, 8000.0], 10.0), &grass, &fine);
        assert!(
            text.contains("seeding triangles") && text.contains("4294967296"),
            "{text}"
        );
        let text = what(&flat([8000.0, 8000.0], 2.0), &grass, &solver);
        assert!(
            text.contains("64000000 tiles, more than the limit of 16777216; write a tile_m of 2 m"),
            "{text}"
        );
        let text = what(&flat([9000.0, 9000.0], 3.0), &grass, &solver);
        assert!(
            text.contains("make the ground smaller, or the seeding cells"),
            "{text}"
        );
        let dense = Grass {
            density_per_m2: 10_000.0,
            ..Grass::default()
        };
        let wide = Solver {
            seeding_cell_m: 2.0,
            tile_m: 8.0,
            ..Solver::default()
        };
        let text = what(&flat([100.0, 100.0], 2.0), &dense, &wide);
        assert!(
            text.contains("640000 plants in a tile") && text.contains("65536"),
            "{text}"
        );
        let many = Grass {
            density_per_m2: 2000.0,
            ..Grass::default()
        };
        let size = size_of(&flat([3000.0, 3000.0], 1.0), &many, &solver);
        assert_eq!(size.map(|size| size.plants), Ok(18_000_000_000));
        let text = what(&flat([8.0, 8.0], 0.1), &grass, &solver);
        assert!(text.starts_with("solver.tile_m: is 1 m"), "{text}");
    }

    #[test]
    fn no_species_no_plants() {
        let bare = Grass {
            species: Vec::new(),
            ..Grass::default()
        };
        let size = size_of(&flat([64.0, 64.0], 1.0), &bare, &Solver::default());
        assert_eq!(size.map(|s| (s.plants, s.plants_per_tile)), Ok((0, 0)));
    }
}
