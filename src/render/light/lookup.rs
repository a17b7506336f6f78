//! The light at a place between cells, as shaders find it. Twin: `sky_light_at` and `sky_light` in
//! `shaders/shared/volume_light.wgsl`.

use super::half::of_half_bits;
use super::irradiance::{CellLight, LightTexels};
use crate::base::Vec3;

impl CellLight {
    /// Light of the sky on a white surface with this normal, linear RGB: its irradiance over π. Without what
    /// the ground throws up.
    pub fn on(&self, normal: Vec3<f32>) -> [f32; 3] {
        self.irradiance
            .map(|[x, y, z, mean]| (mean + Vec3::new(x, y, z).dot(normal)).max(0.0))
    }
}

/// Two neighbours along an axis, and the share of the second.
type Between = (usize, usize, f32);

impl LightTexels {
    /// The light at a place of the world: mixed between columns within the two closest slices, and then
    /// between those. Beyond the volume's sides and top it is that at them.
    pub fn at(&self, place_m: [f64; 3]) -> CellLight {
        let [x, height, z] = place_m;
        let [corner_x, corner_z] = self.corner_in_world;
        let [wide, deep] = self.columns.map(|n| n as usize);
        let across = between((x - corner_x) / self.cell_m[0], wide);
        let along = between((z - corner_z) / self.cell_m[1], deep);
        let floor = mixed(across, along, |column, row| {
            [self.ground_m[row * wide + column]]
        })[0];
        let slices = self.slices as usize;
        let (low, high, share) = between((height - f64::from(floor)) / self.slice_m, slices);
        let [below, above] = [low, high].map(|slice| {
            mixed(across, along, |column, row| {
                self.cell((slice * deep + row) * wide + column)
            })
        });
        let all: [f32; 13] = std::array::from_fn(|n| below[n] + share * (above[n] - below[n]));
        CellLight {
            openness: all[12],
            irradiance: std::array::from_fn(|colour| {
                std::array::from_fn(|part| all[4 * colour + part])
            }),
        }
    }

    /// What is stored of a cell: four numbers per colour, and the openness.
    fn cell(&self, cell: usize) -> [f32; 13] {
        let all = self.openness.len();
        std::array::from_fn(|n| match n {
            12 => f32::from(self.openness[cell]) / 255.0,
            _ => of_half_bits(self.irradiance[n / 4 * all + cell][n % 4]),
        })
    }
}

/// Where a place, in steps from the first of `count`, lies between two of them.
fn between(place: f64, count: usize) -> Between {
    let place = place.clamp(0.0, (count - 1) as f64);
    let low = (place as usize).min(count.saturating_sub(2));
    (low, (low + 1).min(count - 1), (place - low as f64) as f32)
}

/// The mix of four columns.
fn mixed<const N: usize>(
    (left, right, across): Between,
    (near, far, along): Between,
    at: impl Fn(usize, usize) -> [f32; N],
) -> [f32; N] {
    let [a, b, c, d] = [
        at(left, near),
        at(right, near),
        at(left, far),
        at(right, far),
    ];
    std::array::from_fn(|n| {
        let (first, second) = (a[n] + across * (b[n] - a[n]), c[n] + across * (d[n] - c[n]));
        first + along * (second - first)
    })
}
