//! The two volumes of O09 section 6.1: ambient occlusion, and irradiance from it and the sky.
//!
//! The paper leaves open what a cell stores. Here the ambient occlusion of a cell is the share of the
//! upper half of the sphere that it sees. Its irradiance is a function of the normal, kept for each
//! colour as a mean and a vector: with L the sky's radiance where it is seen, and 0 where it is hidden,
//!
//! ```text
//! E(n) / π ≈ mean + lean · n,   mean = ∫ L dω / 4π,   lean = ∫ L ω dω / 2π
//! ```
//!
//! These are the first two bands of E's spherical harmonics. The mean over all normals is exact, so is
//! the difference E(n) − E(−n), the two sides of a leaf; the sum of both sides is flat. It is exact at
//! every normal under a uniform half sphere. At its worst, one small light of irradiance E₀, it gives
//! 0.75 E₀ for E₀ to its front and −0.25 E₀ for 0 to its back; less than 0 is taken as 0.
//!
//! Deviations: what hides the sky is black, as with Pharr and Green (PG04), whom the paper follows;
//! light from below is the ground's, dimmed by the ambient occlusion where it is looked up. The plants
//! themselves hide nothing here: they dim each other by their height (`light_between` in
//! `shaders/shared/plant_light.wgsl`), finer than any cell. Of the sky the clear part without clouds and
//! without the sun's disc counts; the sun is a light of its own with a shadow map.

use rayon::prelude::*;

use super::half::half_bits;
use super::visibility::Visibility;
use crate::base::Vec3;
use crate::render::sky::Daylight;

/// What a cell knows of the light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellLight {
    /// Share of the upper half of the sphere that it sees, 0 to 1.
    pub openness: f32,
    /// For each colour: `lean` along x, y and z, and `mean`.
    pub irradiance: [[f32; 4]; 3],
}

/// The volumes, as the device gets them.
#[derive(Clone, Debug, PartialEq)]
pub struct LightTexels {
    pub columns: [u32; 2],
    pub slices: u32,
    pub cell_m: [f64; 2],
    pub slice_m: f64,
    pub corner_in_world: [f64; 2],
    pub ground_m: Vec<f32>,
    /// A byte per cell: 255 is open.
    pub openness: Vec<u8>,
    /// Four half floats per colour and cell: all slices of red, of green, of blue.
    pub irradiance: Vec<[u16; 4]>,
}

/// The light of every cell under a sky: its radiance along a unit vector, linear RGB. A cell in a body has
/// the mean of its neighbours, from the body's surface inwards, since it is mixed with those outside.
pub fn cell_lights(
    visibility: &Visibility,
    sky: impl Fn(Vec3<f64>) -> [f64; 3] + Sync,
) -> Vec<CellLight> {
    let radiances: Vec<[f64; 3]> = visibility.directions.iter().map(|&d| sky(d)).collect();
    let cells = visibility.grid.cells();
    let mut lights: Vec<CellLight> = (0..cells)
        .into_par_iter()
        .map(|cell| cell_light(visibility, &radiances, cell))
        .collect();
    let inside = (0..cells).filter(|&cell| visibility.is_inside(cell));
    fill_inside(visibility, &mut lights, inside.collect());
    lights
}

fn cell_light(visibility: &Visibility, radiances: &[[f64; 3]], cell: usize) -> CellLight {
    let mut sums = [[0.0_f64; 4]; 3];
    let mut seen = 0;
    for n in visibility.seen_from(cell) {
        let [x, y, z] = visibility.directions[n].to_f64();
        seen += 1;
        for (sum, radiance) in sums.iter_mut().zip(radiances[n]) {
            for (part, along) in sum.iter_mut().zip([x, y, z, 0.5]) {
                *part += radiance * along;
            }
        }
    }
    // Each direction stands for 2π over their number, and `lean` is the sum over 2π; half of it `mean`.
    let count = visibility.directions.len() as f64;
    CellLight {
        openness: (f64::from(seen) / count) as f32,
        irradiance: sums.map(|sum| sum.map(|part| (part / count) as f32)),
    }
}

/// Goes from the surface of bodies inwards: each round fills the cells beside those that have light.
fn fill_inside(visibility: &Visibility, lights: &mut [CellLight], mut dark: Vec<usize>) {
    let mut is_dark = vec![false; lights.len()];
    dark.iter().for_each(|&cell| is_dark[cell] = true);
    loop {
        let filled: Vec<(usize, CellLight)> = dark
            .iter()
            .filter_map(|&cell| {
                let beside = visibility.grid.neighbours(cell);
                let lit: Vec<CellLight> =
                    beside.filter(|&n| !is_dark[n]).map(|n| lights[n]).collect();
                Some((cell, mean_of(&lit)?))
            })
            .collect();
        if filled.is_empty() {
            return;
        }
        for (cell, light) in filled {
            lights[cell] = light;
            is_dark[cell] = false;
        }
        dark.retain(|&cell| is_dark[cell]);
    }
}

/// `None` of none.
fn mean_of(lights: &[CellLight]) -> Option<CellLight> {
    let share = 1.0 / lights.len() as f32;
    let first = CellLight::default();
    (!lights.is_empty()).then(|| {
        lights.iter().fold(first, |mut sum, light| {
            sum.openness += share * light.openness;
            let all = sum.irradiance.as_flattened_mut().iter_mut();
            for (part, own) in all.zip(light.irradiance.as_flattened()) {
                *part += share * own;
            }
            sum
        })
    })
}

impl LightTexels {
    /// The volumes under the sky of a moment.
    pub fn new(visibility: &Visibility, light: &Daylight) -> Self {
        Self::of_lights(
            visibility,
            &cell_lights(visibility, |direction| light.clear_sky(direction)),
        )
    }

    /// The volumes of cells with this light.
    pub fn of_lights(visibility: &Visibility, lights: &[CellLight]) -> Self {
        let grid = &visibility.grid;
        let of_colour = |colour: usize| {
            (lights.iter()).map(move |light| light.irradiance[colour].map(half_bits))
        };
        Self {
            columns: grid.columns,
            slices: grid.slices,
            cell_m: grid.cell_m,
            slice_m: grid.slice_m,
            corner_in_world: grid.corner_in_world,
            ground_m: grid.ground_m.clone(),
            openness: (lights.iter())
                .map(|light| (light.openness * 255.0).round() as u8)
                .collect(),
            irradiance: (0..3).flat_map(of_colour).collect(),
        }
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        (self.openness.len() + 8 * self.irradiance.len() + 4 * self.ground_m.len()) as u64
    }
}
