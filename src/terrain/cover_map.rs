//! How billboards grow at every place of the ground: the three maps of O09 section 4 as one picture.
//!
//! Texels, places and mixed values are integers, so that every engine places alike. The WGSL twin of
//! [`CoverMap::at`] is in `shaders/billboard_place.wgsl`.

use crate::scene::assets::{Assets, DirectionMap, GreyMap};
use crate::scene::{Billboards, Messiness};

use super::between_texels::BetweenTexels;
use super::{HeightGrid, TerrainError};

/// What stands for 0 along an axis of a direction. Bytes are kept doubled: none of them means 0 itself.
const LEVEL: u32 = 255;

/// Extent, direction and messiness over the whole ground.
#[derive(Clone, Debug, PartialEq)]
pub struct CoverMap {
    pub columns: u32,
    pub rows: u32,
    /// Side of a texel, in metres. The first texel's corner is the ground's corner.
    pub texel_m: f64,
    /// Two words a texel, row by row from the smallest z: extent in the lower half of the first,
    /// messiness in its upper half, both 0…65535; the direction along x, y and z in the second, 9 bits
    /// each from the lowest on, where 0 means −1, 255 means 0 and 510 means 1.
    pub texels: Vec<[u32; 2]>,
}

/// How billboards grow at a place.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Cover {
    /// Chance that one grows, in units of 2⁻¹⁶, 0…65536.
    pub extent: u32,
    /// In units of 2⁻¹⁶, 0…65536.
    pub messiness: u32,
    /// Along x, y and z, of any length, −65280…65280; y is above 0.
    pub direction: [i32; 3],
}

impl CoverMap {
    /// The maps that a scene names, brought to the size of the largest. One texel where it names none.
    ///
    /// # Errors
    /// A map that is not among the assets.
    pub fn of(
        billboards: &Billboards,
        ground: &HeightGrid,
        assets: &Assets,
    ) -> Result<Self, TerrainError> {
        let extent = billboards.extent.as_ref();
        let extent = extent.map(|file| grey(assets, file)).transpose()?;
        let messiness = match &billboards.messiness {
            Messiness::Even(_) => None,
            Messiness::Map(file) => Some(grey(assets, file)?),
        };
        let direction = billboards.direction.as_ref();
        let direction = direction.map(|file| {
            let map = assets.direction_maps.get(file);
            map.ok_or_else(|| TerrainError::MissingCoverMap { file: file.clone() })
        });
        let direction = direction.transpose()?;

        let greys = [extent, messiness].into_iter().flatten();
        let sizes = greys
            .map(|map| [map.columns, map.rows])
            .chain(direction.map(|map| [map.columns, map.rows]));
        // Of equals the last; they are alike.
        let size = sizes
            .max_by_key(|&[columns, rows]| u64::from(columns) * u64::from(rows))
            .unwrap_or([1, 1]);
        let even = match billboards.messiness {
            Messiness::Even(share) => (f64::from(share) * 65_535.0).round() as u32,
            Messiness::Map(_) => 0,
        };
        let extent = extent.map_or_else(|| filled(size, 65_535), |map| grey_of_size(map, size));
        let messy = messiness.map_or_else(|| filled(size, even), |map| grey_of_size(map, size));
        let ways = direction.map_or_else(
            || filled(size, packed([LEVEL, 2 * LEVEL, LEVEL])),
            |map| direction_of_size(map, size),
        );
        let shares = extent.iter().zip(&messy).map(|(e, m)| e | (m << 16));
        Ok(Self {
            columns: size[0],
            rows: size[1],
            texel_m: ground.size_m()[0] / f64::from(size[0]),
            texels: shares
                .zip(ways)
                .map(|(shares, way)| [shares, way])
                .collect(),
        })
    }

    /// How billboards grow at a place in units of 2⁻¹⁶ texel.
    pub fn at(&self, place: [u32; 2]) -> Cover {
        let between = BetweenTexels::at(place, [self.columns, self.rows]);
        let share = |shift: u32| {
            let mixed = between.mix(|texel| (self.texels[texel][0] >> shift) & 0xffff) >> 16;
            // White is all: 65535 becomes 65536.
            mixed + (mixed >> 15)
        };
        let along = |shift: u32| {
            let mixed = between.mix(|texel| (self.texels[texel][1] >> shift) & 0x1ff) >> 8;
            mixed as i32 - (LEVEL << 8) as i32
        };
        Cover {
            extent: share(0),
            messiness: share(16),
            direction: [along(0), along(9), along(18)],
        }
    }

    /// The part of the ground that billboards cover: the mean of the extent, 0…1.
    pub fn mean_extent(&self) -> f64 {
        let sum: f64 = self.texels.iter().map(|t| f64::from(t[0] & 0xffff)).sum();
        sum / (65_535.0 * self.texels.len() as f64)
    }
}

fn grey<'a>(assets: &'a Assets, file: &str) -> Result<&'a GreyMap, TerrainError> {
    let missing = || TerrainError::MissingCoverMap { file: file.into() };
    assets.grey_maps.get(file).ok_or_else(missing)
}

fn filled(size: [u32; 2], value: u32) -> Vec<u32> {
    vec![value; size[0] as usize * size[1] as usize]
}

fn packed([x, y, z]: [u32; 3]) -> u32 {
    x | (y << 9) | (z << 18)
}

fn grey_of_size(map: &GreyMap, size: [u32; 2]) -> Vec<u32> {
    of_size([map.columns, map.rows], size, |between| {
        rounded(between.mix(|texel| map.samples[texel].into()))
    })
}

/// Directions that rise stay so when they are mixed.
fn direction_of_size(map: &DirectionMap, size: [u32; 2]) -> Vec<u32> {
    of_size([map.columns, map.rows], size, |between| {
        packed([0, 1, 2].map(|a| rounded(between.mix(|texel| 2 * u32::from(map.texels[texel][a])))))
    })
}

/// From units of 2⁻¹⁶.
fn rounded(mixed: u32) -> u32 {
    (mixed + (1 << 15)) >> 16
}

/// A picture's values at the middles of the texels of another size; of the same size they are its own.
fn of_size(from: [u32; 2], to: [u32; 2], value: impl Fn(BetweenTexels) -> u32) -> Vec<u32> {
    let middle = |n: u32, a: usize| {
        let (from, to) = (u64::from(from[a]), u64::from(to[a]));
        // At most the side of a map in units of 2⁻¹⁶, which fits.
        ((((2 * u64::from(n) + 1) * from) << 15) / to) as u32
    };
    let rows = 0..to[1];
    rows.flat_map(|row| (0..to[0]).map(move |column| [column, row]))
        .map(|[column, row]| value(BetweenTexels::at([middle(column, 0), middle(row, 1)], from)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey_map(columns: u32, rows: u32, samples: &[u16]) -> GreyMap {
        GreyMap {
            columns,
            rows,
            samples: samples.to_vec(),
        }
    }

    #[test]
    fn without_maps_clumps_grow_upright_everywhere() {
        let billboards = Billboards {
            messiness: Messiness::Even(0.5),
            ..Billboards::default()
        };
        let ground = HeightGrid::flat(9, 5, 2.0);
        let map = CoverMap::of(&billboards, &ground, &Assets::default()).expect("no map needed");
        for place in [[0, 0], [1 << 15, 1 << 16], [u32::MAX, 77]] {
            let cover = map.at(place);
            assert_eq!((cover.extent, cover.messiness), (65_536, 32_769));
            assert_eq!(cover.direction, [0, 65_280, 0]);
        }
    }

    #[test]
    fn maps_are_brought_to_the_largest_size() {
        let mut assets = Assets::default();
        let small = grey_map(2, 2, &[0, 60_000, 0, 60_000]);
        let large = grey_map(
            4,
            4,
            &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16],
        );
        assets.grey_maps.insert("small".into(), small);
        assets.grey_maps.insert("large".into(), large.clone());
        let billboards = Billboards {
            extent: Some("small".into()),
            messiness: Messiness::Map("large".into()),
            resample: true,
            ..Billboards::default()
        };
        let ground = HeightGrid::flat(9, 9, 1.0);
        let map = CoverMap::of(&billboards, &ground, &assets).expect("both are there");
        assert_eq!((map.columns, map.rows, map.texel_m), (4, 4, 2.0));
        let extents: Vec<u32> = map.texels.iter().map(|t| t[0] & 0xffff).collect();
        // Middles at ¼, ¾, 5/4 and 7/4 of the small map's texels.
        assert_eq!(extents[..4], [0, 15_000, 45_000, 60_000]);
        let messy: Vec<u16> = map.texels.iter().map(|t| (t[0] >> 16) as u16).collect();
        assert_eq!(messy, large.samples);
        assert_eq!(map.mean_extent(), 30_000.0 / 65_535.0);
        assets.grey_maps.clear();
        let missing = CoverMap::of(&billboards, &ground, &assets);
        assert!(missing.is_err_and(|e| e.to_string().contains("`small`")));
    }
}
