//! From a scene's description of the ground to its height samples.

use thiserror::Error;

use crate::scene::assets::{Assets, HeightMap};
use crate::scene::{Ground, Terrain};

use super::HeightGrid;
use super::noise::octaves;

/// Most height samples of a ground: 64 MiB of them.
pub const MOST_SAMPLES: u64 = crate::scene::limits::HEIGHT_SAMPLES;
/// Octaves beyond this many are finer than f32 heights can hold.
const MOST_OCTAVES: u32 = 24;

/// A ground that cannot be built.
#[derive(Debug, Error, PartialEq)]
pub enum TerrainError {
    #[error("terrain: `{key}` is {value}; it must be more than 0 and finite")]
    NotPositive { key: &'static str, value: f32 },
    #[error("terrain: `{key}` is {value}; it must be finite")]
    NotFinite { key: &'static str, value: f32 },
    #[error("terrain: {count} octaves; give 1 to {MOST_OCTAVES}")]
    Octaves { count: u32 },
    #[error(
        "terrain: {columns} x {rows} height samples are more than {MOST_SAMPLES}; make `size_m` \
         smaller or `spacing_m` larger"
    )]
    TooManySamples { columns: f64, rows: f64 },
    #[error("terrain: height map `{file}` is not among the loaded assets")]
    MissingHeightMap { file: String },
    #[error("billboards: map `{file}` is not among the loaded assets")]
    MissingCoverMap { file: String },
    #[error("terrain: base map `{file}` is not among the loaded assets")]
    MissingBaseMap { file: String },
    #[error(
        "terrain: height map `{file}` has {columns} columns, {rows} rows and {samples} samples; \
         it needs two each way and their product"
    )]
    BadHeightMap {
        file: String,
        columns: u32,
        rows: u32,
        samples: usize,
    },
}

/// The height samples of a scene's ground.
///
/// # Errors
/// If a size is not more than 0 and finite, the samples are more than [`MOST_SAMPLES`] (checked
/// before anything is allocated), or the height map is missing or too small.
pub fn height_grid(terrain: &Terrain, assets: &Assets) -> Result<HeightGrid, TerrainError> {
    Ok(HeightGrid {
        centre_m: terrain.centre_m,
        ..about_the_origin(terrain, assets)?
    })
}

fn about_the_origin(terrain: &Terrain, assets: &Assets) -> Result<HeightGrid, TerrainError> {
    match &terrain.ground {
        Ground::Flat { size_m, spacing_m } => {
            let [columns, rows] = sample_counts(*size_m, *spacing_m)?;
            Ok(HeightGrid::flat(columns, rows, *spacing_m))
        }
        Ground::Rolling {
            size_m,
            spacing_m,
            amplitude_m,
            wavelength_m,
            octaves,
            seed,
        } => {
            let counts = sample_counts(*size_m, *spacing_m)?;
            let wave = Wave {
                amplitude_m: finite("amplitude_m", *amplitude_m)?,
                wavelength_m: positive("wavelength_m", *wavelength_m)?,
                octaves: *octaves,
                seed: *seed,
            };
            if !(1..=MOST_OCTAVES).contains(octaves) {
                return Err(TerrainError::Octaves { count: *octaves });
            }
            Ok(rolling(counts, *spacing_m, &wave))
        }
        Ground::HeightMap {
            file,
            spacing_m,
            height_m,
        } => {
            let map = assets
                .height_maps
                .get(file)
                .ok_or_else(|| TerrainError::MissingHeightMap { file: file.clone() })?;
            positive("spacing_m", *spacing_m)?;
            mapped(file, map, *spacing_m, finite("height_m", *height_m)?)
        }
    }
}

struct Wave {
    amplitude_m: f64,
    wavelength_m: f64,
    octaves: u32,
    seed: u32,
}

fn rolling([columns, rows]: [u32; 2], spacing_m: f32, wave: &Wave) -> HeightGrid {
    let mut grid = HeightGrid::flat(columns, rows, spacing_m);
    let [corner_x, corner_z] = grid.corner_in_world();
    let spacing = f64::from(spacing_m);
    for row in 0..rows {
        let z = corner_z + spacing * f64::from(row);
        for column in 0..columns {
            let x = corner_x + spacing * f64::from(column);
            let (u, v) = (x / wave.wavelength_m, z / wave.wavelength_m);
            let height = wave.amplitude_m * octaves(u, v, wave.octaves, wave.seed);
            grid.heights_m[row as usize * columns as usize + column as usize] = height as f32;
        }
    }
    grid
}

fn mapped(
    file: &str,
    map: &HeightMap,
    spacing_m: f32,
    height_m: f64,
) -> Result<HeightGrid, TerrainError> {
    let count = u64::from(map.columns) * u64::from(map.rows);
    if map.columns < 2 || map.rows < 2 || count != map.samples.len() as u64 {
        return Err(TerrainError::BadHeightMap {
            file: file.to_owned(),
            columns: map.columns,
            rows: map.rows,
            samples: map.samples.len(),
        });
    }
    within_budget(f64::from(map.columns), f64::from(map.rows))?;
    let height = |&sample: &u16| (f64::from(sample) / f64::from(u16::MAX) * height_m) as f32;
    Ok(HeightGrid {
        columns: map.columns,
        rows: map.rows,
        spacing_m,
        centre_m: [0.0; 2],
        heights_m: map.samples.iter().map(height).collect(),
    })
}

/// Samples along x and z for an extent, rounded up to whole spacings.
fn sample_counts(size_m: [f32; 2], spacing_m: f32) -> Result<[u32; 2], TerrainError> {
    let spacing = positive("spacing_m", spacing_m)?;
    let mut counts = [0.0; 2];
    for (count, size) in counts.iter_mut().zip(size_m) {
        // A whole number of spacings stays one although f32 rounds both: 2⁻²³ off, twice.
        let spacings = (positive("size_m", size)? / spacing * (1.0 - 3e-7)).ceil();
        *count = spacings.max(1.0) + 1.0;
    }
    within_budget(counts[0], counts[1])?;
    Ok(counts.map(|count| count as u32))
}

fn within_budget(columns: f64, rows: f64) -> Result<(), TerrainError> {
    if columns * rows > MOST_SAMPLES as f64 {
        return Err(TerrainError::TooManySamples { columns, rows });
    }
    Ok(())
}

fn positive(key: &'static str, value: f32) -> Result<f64, TerrainError> {
    if value > 0.0 && value.is_finite() {
        Ok(f64::from(value))
    } else {
        Err(TerrainError::NotPositive { key, value })
    }
}

fn finite(key: &'static str, value: f32) -> Result<f64, TerrainError> {
    if value.is_finite() {
        Ok(f64::from(value))
    } else {
        Err(TerrainError::NotFinite { key, value })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn built(ground: Ground) -> Result<HeightGrid, TerrainError> {
        let mut assets = Assets::default();
        assets.height_maps.insert(
            "map.png".into(),
            HeightMap {
                columns: 3,
                rows: 2,
                samples: vec![0, 65_535, 13_107, 0, 0, 6_553],
            },
        );
        let terrain = Terrain {
            ground,
            ..Terrain::default()
        };
        height_grid(&terrain, &assets)
    }

    fn rolling_ground(spacing_m: f32) -> Ground {
        Ground::Rolling {
            size_m: [24.0, 16.0],
            spacing_m,
            amplitude_m: 0.5,
            wavelength_m: 9.0,
            octaves: 3,
            seed: 4,
        }
    }

    #[test]
    fn extents_are_rounded_up_to_whole_spacings() {
        let samples = |size_m, spacing_m| {
            let grid = built(Ground::Flat { size_m, spacing_m }).expect("a sound ground");
            [grid.columns, grid.rows]
        };
        assert_eq!(samples([16.0, 8.0], 1.0), [17, 9]);
        assert_eq!(samples([0.3, 0.7], 0.1), [4, 8]);
        assert_eq!(samples([1.05, 0.01], 0.5), [4, 2]);
    }

    #[test]
    fn rolling_ground_is_a_function_of_the_place() {
        let coarse = built(rolling_ground(1.0)).expect("a sound ground");
        let fine = built(rolling_ground(0.5)).expect("a sound ground");
        for row in 0..coarse.rows {
            for column in 0..coarse.columns {
                let both = [coarse.sample(column, row), fine.sample(2 * column, 2 * row)];
                assert_eq!(both[0], both[1]);
            }
        }
        let [low, high] = coarse.range_m();
        // Three octaves reach at most 1 + 1/2 + 1/4 amplitudes.
        assert!(
            low >= -0.875 && high <= 0.875 && high - low > 0.5,
            "{low} {high}"
        );
    }

    #[test]
    fn a_height_map_keeps_its_rows() {
        let grid = built(Ground::HeightMap {
            file: "map.png".into(),
            spacing_m: 5.0,
            height_m: 40.0,
        })
        .expect("a sound map");
        assert_eq!([grid.columns, grid.rows], [3, 2]);
        assert_eq!(grid.heights_m[..3], [0.0, 40.0, 8.0]);
        assert_eq!(grid.size_m(), [10.0, 5.0]);
    }

    #[test]
    fn impossible_grounds_are_refused() {
        let flat = |size_m, spacing_m| built(Ground::Flat { size_m, spacing_m });
        assert!(matches!(
            flat([1e6, 1e6], 0.01),
            Err(TerrainError::TooManySamples { .. })
        ));
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(flat([bad, 1.0], 1.0).is_err());
            assert!(flat([1.0, 1.0], bad).is_err());
        }
        let missing = built(Ground::HeightMap {
            file: "other.png".into(),
            spacing_m: 1.0,
            height_m: 1.0,
        });
        assert!(missing.is_err_and(|e| e.to_string().contains("other.png")));
    }
}
