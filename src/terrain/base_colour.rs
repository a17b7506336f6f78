//! Colour of the ground: a base map, or patches of lush and dry grass, and bare soil on slopes.
//!
//! A plant takes the colour of the ground under it, so the patches are those of the meadow. They
//! come from value noise at 8 m and less, at places that noise has wound, so that no tile, grid
//! spacing or lattice shows through.

use rayon::prelude::*;

use crate::scene::Terrain;
use crate::scene::assets::{Assets, ColourPicture};

use super::noise::value_noise;
use super::{HeightGrid, TerrainError};

/// Finest texel of a colour map, in metres: the finest noise is five times as long.
const FINEST_TEXEL_M: f64 = 1.0 / 16.0;
/// Most texels along a side: 4 MiB of them.
pub const MOST_TEXELS: u32 = 1024;

/// The ground's colours as a picture over the whole terrain.
#[derive(Clone, Debug, PartialEq)]
pub struct ColourMap {
    pub columns: u32,
    pub rows: u32,
    /// Side of a texel, in metres. The first texel's corner is the ground's corner; the last
    /// column and row may reach beyond the ground.
    pub texel_m: f64,
    /// Four bytes a texel, row by row from the smallest z. Red, green and blue are encoded as
    /// sRGB (a texture format with `Srgb` in its name decodes them), alpha is 255.
    pub rgba8: Vec<u8>,
}

impl ColourMap {
    /// The colours of the whole ground: its base map's, or patches.
    ///
    /// # Errors
    /// A base map that is not among the assets.
    pub fn of(
        terrain: &Terrain,
        ground: &HeightGrid,
        assets: &Assets,
    ) -> Result<Self, TerrainError> {
        let Some(file) = &terrain.base_map else {
            return Ok(Self::of_patches(terrain, ground));
        };
        let picture = assets.base_maps.get(file);
        let picture = picture.ok_or_else(|| TerrainError::MissingBaseMap { file: file.clone() })?;
        Ok(Self::of_picture(picture, ground))
    }

    fn of_picture(picture: &ColourPicture, ground: &HeightGrid) -> Self {
        Self {
            columns: picture.columns,
            rows: picture.rows,
            // Texels are square: the rows fit too, to half a texel.
            texel_m: ground.size_m()[0] / f64::from(picture.columns),
            rgba8: picture.rgba8.clone(),
        }
    }

    /// Patches in the terrain's three colours. A texel is 1/16 m, or larger where the ground is
    /// longer than 64 m: then 1,024 texels span its longer side.
    pub fn of_patches(terrain: &Terrain, ground: &HeightGrid) -> Self {
        let size_m = ground.size_m();
        let longest_m = size_m[0].max(size_m[1]);
        let texel_m = FINEST_TEXEL_M.max(longest_m / f64::from(MOST_TEXELS));
        // A side of whole texels stays so although the division rounds.
        let texels = |length_m: f64| ((length_m / texel_m - 1e-9).ceil().max(1.0)) as u32;
        let (columns, rows) = (texels(size_m[0]), texels(size_m[1]));
        let encode = srgb_table();
        let [corner_x, corner_z] = ground.corner_in_world();
        let mut rgba8 = vec![255; columns as usize * rows as usize * 4];
        let row_bytes = columns as usize * 4;
        rgba8
            .par_chunks_exact_mut(row_bytes)
            .enumerate()
            .for_each(|(row, texels)| {
                let z = corner_z + (row as f64 + 0.5) * texel_m;
                for (column, texel) in texels.chunks_exact_mut(4).enumerate() {
                    let x = corner_x + (column as f64 + 0.5) * texel_m;
                    let rgb = base_colour(terrain, ground, x, z);
                    for (byte, linear) in texel.iter_mut().zip(rgb) {
                        let step = linear.clamp(0.0, 1.0) * (encode.len() - 1) as f32;
                        *byte = encode[step.round() as usize];
                    }
                }
            });
        Self {
            columns,
            rows,
            texel_m,
            rgba8,
        }
    }
}

/// Colour of the ground at a world place, linear RGB.
pub fn base_colour(terrain: &Terrain, ground: &HeightGrid, x: f64, z: f64) -> [f32; 3] {
    let [cx, cz] = ground.centre_m;
    blend(terrain, x - cx, z - cz, steepness(ground, x, z))
}

/// Length of the ground's gradient over two spacings: the triangles' own slopes have edges that
/// soil would draw in.
fn steepness(ground: &HeightGrid, x: f64, z: f64) -> f64 {
    let reach = f64::from(ground.spacing_m);
    let height = |dx: f64, dz: f64| ground.height_in_world(x + dx, z + dz);
    let along_x = height(reach, 0.0) - height(-reach, 0.0);
    let along_z = height(0.0, reach) - height(0.0, -reach);
    (along_x * along_x + along_z * along_z).sqrt() / (2.0 * reach)
}

/// `steepness` is the tangent of the ground's slope.
fn blend(terrain: &Terrain, x: f64, z: f64, steepness: f64) -> [f32; 3] {
    // Winding the plane before looking up hides the lattice, which runs along the axes.
    let wind = |key| 1.2 * value_noise(x / 3.7, z / 3.7, key);
    let (wx, wz) = (x + wind(100), z + wind(101));
    // A turn by the 3-4-5 triangle's angle, so that no two scales share a direction.
    let (tx, tz) = (0.8 * wx - 0.6 * wz, 0.6 * wx + 0.8 * wz);
    let straight = |wavelength_m: f64, key| value_noise(wx / wavelength_m, wz / wavelength_m, key);
    let turned = |wavelength_m: f64, key| value_noise(tx / wavelength_m, tz / wavelength_m, key);

    // Unwound, or the finest noise is drawn out into streaks.
    let fine = value_noise(x / 0.23, z / 0.23, 102);
    let tufts = value_noise((0.8 * x - 0.6 * z) / 0.61, (0.6 * x + 0.8 * z) / 0.61, 103);
    let patches = 0.5 * turned(8.0, 104) + 0.4 * straight(3.1, 105) + 0.25 * turned(1.3, 106);
    let dry = smooth_step(-0.5, 0.7, patches + 0.16 * tufts + 0.12 * fine);
    // Bare from slopes of about 30° on, fully at 50°, with ragged edges; on level ground only the
    // rarest spots of the driest patches show some soil.
    let ragged = steepness + 0.12 * straight(1.7, 107) + 0.08 * tufts + 0.05 * fine;
    let steep = smooth_step(0.55, 1.1, ragged);
    let bald = smooth_step(0.5, 1.1, turned(2.3, 108) + 0.3 * tufts + 0.2 * fine);
    let soil = steep.max(0.6 * bald * dry);
    let light = 1.0 + 0.1 * fine + 0.06 * tufts;
    std::array::from_fn(|c| {
        let lush = f64::from(terrain.lush_rgb[c]);
        let grass = lush + dry * (f64::from(terrain.dry_rgb[c]) - lush);
        let mixed = grass + soil * (f64::from(terrain.soil_rgb[c]) - grass);
        (mixed * light) as f32
    })
}

/// 0 below `low`, 1 above `high`, smooth between.
fn smooth_step(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// sRGB bytes of 4,096 even steps of linear light: within one byte everywhere.
fn srgb_table() -> Vec<u8> {
    (0..4096)
        .map(|step| {
            let linear = f64::from(step) / 4095.0;
            // IEC 61966-2-1.
            let encoded = if linear <= 0.003_130_8 {
                12.92 * linear
            } else {
                1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
            };
            (encoded * 255.0).round() as u8
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terrain() -> Terrain {
        Terrain {
            lush_rgb: [0.0, 1.0, 0.0],
            dry_rgb: [1.0, 1.0, 0.0],
            soil_rgb: [0.0, 0.0, 1.0],
            ..Terrain::default()
        }
    }

    /// Shares of dry grass and of soil, read back from pure colours.
    fn shares(steepness: f64) -> Vec<[f64; 2]> {
        let mut shares = Vec::new();
        for k in 0..10_000 {
            let (x, z) = (0.37 * f64::from(k % 100), 0.37 * f64::from(k / 100));
            let [r, g, b] = blend(&terrain(), x, z, steepness).map(f64::from);
            shares.push([r / (r + g).max(1e-9), b / (b + g).max(1e-9)]);
        }
        shares
    }

    #[test]
    fn level_ground_has_lush_and_dry_patches_and_hardly_any_soil() {
        let all = shares(0.0);
        let share = |test: &dyn Fn(&[f64; 2]) -> bool| {
            all.iter().filter(|s| test(s)).count() as f64 / all.len() as f64
        };
        // r / (r + g) is 0 where lush and ½ where dry.
        let (lush, dry) = (share(&|s| s[0] < 0.1), share(&|s| s[0] > 0.4));
        let soil = share(&|s| s[1] > 0.3);
        assert!(lush > 0.15 && dry > 0.1, "{lush} {dry}");
        assert!(soil < 0.05, "{soil}");
    }

    #[test]
    fn steep_ground_is_bare() {
        // A slope of 56°.
        let bare = shares(1.5);
        assert!(bare.iter().all(|s| s[1] > 0.9));
    }

    #[test]
    fn the_map_covers_the_ground_within_its_limit() {
        let map = |columns, rows, spacing_m| {
            let ground = HeightGrid::flat(columns, rows, spacing_m);
            ColourMap::of_patches(&Terrain::default(), &ground)
        };
        let small = map(13, 7, 1.0);
        assert_eq!([small.columns, small.rows], [192, 96]);
        assert_eq!(small.rgba8.len(), 192 * 96 * 4);
        let large = map(404, 345, 5.0);
        assert_eq!([large.columns, large.rows], [1024, 875]);
        let reach = large.texel_m * f64::from(large.rows);
        assert!((344.0 * 5.0..345.0 * 5.0).contains(&reach));
    }

    #[test]
    fn a_base_map_is_taken_as_it_is() {
        let ground = HeightGrid::flat(9, 5, 2.0);
        let mut assets = Assets::default();
        let terrain = Terrain {
            base_map: Some("map.png".into()),
            ..Terrain::default()
        };
        assert!(
            ColourMap::of(&terrain, &ground, &assets)
                .is_err_and(|e| e.to_string().contains("map.png"))
        );
        let picture = ColourPicture {
            columns: 4,
            rows: 2,
            rgba8: (0..32).collect(),
        };
        assets.base_maps.insert("map.png".into(), picture.clone());
        let map = ColourMap::of(&terrain, &ground, &assets).expect("it is there");
        assert_eq!((map.columns, map.rows, map.texel_m), (4, 2, 4.0));
        assert_eq!(map.rgba8, picture.rgba8);
    }

    #[test]
    fn texels_hold_the_colour_of_their_middle_as_srgb() {
        let ground = HeightGrid::flat(5, 5, 1.0);
        let terrain = Terrain::default();
        let map = ColourMap::of_patches(&terrain, &ground);
        for (row, column) in [(0_u32, 0_u32), (10, 33), (63, 63)] {
            let at = |k: u32| -2.0 + (f64::from(k) + 0.5) * map.texel_m;
            let want = base_colour(&terrain, &ground, at(column), at(row));
            let first = ((row * map.columns + column) * 4) as usize;
            for (byte, linear) in map.rgba8[first..first + 3].iter().zip(want) {
                let encoded = f64::from(*byte) / 255.0;
                let back = ((encoded + 0.055) / 1.055).powf(2.4);
                // Half a byte at sRGB's steepest for linear values below 0.5: 0.0037.
                assert!((back - f64::from(linear)).abs() < 0.004, "{back} {linear}");
            }
        }
    }
}
