//! How many plants of a seeding triangle are drawn: P15 eq. 1 and 2.
//!
//! The count is a number with a fraction; which plants it means is a prefix of the triangle's
//! sequence, so that plants never move when the count changes. A fraction is rounded by a hash of
//! the triangle, which keeps the mean. WGSL twin: `shaders/shared/count.wgsl`.
//!
//! Deviation of eq. 2: the vector runs from the observer, so the cosine is that of −n̂ and v, and
//! negative ones count as 0.
//!
//! Eq. 15: triangles may be given the counts of 32 bins instead of their own, see [`Bins`].

use crate::base::Vec3;
use crate::base::philox::{philox2x32, unit};

use super::plant::Seeds;

/// Distance of the near plane, in metres: a triangle with a corner before it has no projected area.
pub const NEAR_M: f32 = 0.03;
/// Second word of the hash that rounds a triangle's drawn count; plants have smaller ones.
pub const COUNT_WORD: u32 = u32::MAX - 1;

/// The view that a count is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CountView {
    pub right: Vec3<f32>,
    pub up: Vec3<f32>,
    pub forward: Vec3<f32>,
    /// Angle of a pixel in the middle of the picture, in radians.
    pub pixel_rad: f32,
}

/// Eq. 1: `per_px` plants for every pixel that the triangle covers, at most `most`. Corners are
/// relative to the eye.
pub fn by_projected_area(corners: [Vec3<f32>; 3], view: &CountView, per_px: f32, most: f32) -> f32 {
    let depths = corners.map(|p| p.dot(view.forward));
    if depths.iter().any(|&depth| depth < NEAR_M) {
        return most;
    }
    let [a, b, c] = [0, 1, 2].map(|i| {
        let px = 1.0 / (depths[i] * view.pixel_rad);
        [
            corners[i].dot(view.right) * px,
            corners[i].dot(view.up) * px,
        ]
    });
    let area_px = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
    (per_px * area_px).min(most)
}

/// Eq. 2: as many plants as eq. 1 gives a small triangle in the middle of the picture.
pub fn by_world_area(corners: [Vec3<f32>; 3], view: &CountView, per_px: f32, most: f32) -> f32 {
    let [a, b, c] = corners;
    let across = (b - a).cross(c - a);
    let upwards = if across.y < 0.0 {
        across * -1.0
    } else {
        across
    };
    let middle = (a + b + c) * (1.0 / 3.0);
    let away = middle.dot(middle).max(NEAR_M * NEAR_M);
    // Twice the area times the cosine, over the distance.
    let facing = (-upwards.dot(middle)).max(0.0) / away.sqrt();
    let area_px = 0.5 * facing / (away * view.pixel_rad * view.pixel_rad);
    (per_px * area_px).min(most)
}

/// What is added to a count before its fraction is cut off.
pub fn rounding(seeds: &Seeds, triangle: u32) -> f32 {
    unit(philox2x32([triangle, COUNT_WORD], seeds.key, seeds.rounds)[0])
}

/// How much of plant `index` of a triangle is drawn, 0 to 1: the last ones of the prefix are small,
/// so that none pops up. Above 0 for ⌊count + rounding⌋ plants.
pub fn shown(count: f32, rounding: f32, index: u32) -> f32 {
    shown_share(count + rounding, (0.2 * count).max(1.0), index)
}

/// The same of a count that is rounded already, over whose last `ramp` plants the shares fall.
pub fn shown_share(end: f32, ramp: f32, index: u32) -> f32 {
    ((end - (index as f32 + 1.0)) / ramp).clamp(0.0, 1.0)
}

/// Places of a triangle of this count: its plants are those of smaller indices, of which
/// [`shown`] tells how much. Never more than ⌈count⌉.
pub fn places(count: f32, rounding: f32) -> u32 {
    ((count + rounding).ceil() as u32).saturating_sub(1)
}

/// Clusters, whole or begun, of `cluster` seeds each that hold the first `places` of a triangle: first of
/// its plants, then of copies of them, their companions.
pub fn clusters_in(places: u32, plants_per_triangle: u32, cluster: u32) -> u32 {
    let per_triangle = plants_per_triangle.max(1);
    let [copies, rest] = [places / per_triangle, places % per_triangle];
    copies * per_triangle.div_ceil(cluster) + rest.div_ceil(cluster)
}

/// Bins of P15 section 3.2.
pub const BINS: usize = 32;

/// The counts that triangles are given where they are submitted by bins: P15 eq. 15 with
/// n_min = 1.
///
/// Deviation: a triangle of fewer plants than one keeps its count, which its hash rounds to one
/// plant or none; the first bin would give it one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bins {
    pub centres: [f32; BINS],
}

impl Bins {
    /// Bins up to the largest count of any triangle, at least 1.
    pub fn up_to(most: f32) -> Self {
        let most = f64::from(most.max(1.0));
        let centre = |i: usize| libm::pow(most, i as f64 / (BINS - 1) as f64) as f32;
        Self {
            centres: std::array::from_fn(centre),
        }
    }

    /// The bin whose centre is nearest to a count.
    pub fn nearest(&self, count: f32) -> usize {
        let is_past = |pair: &&[f32]| count > 0.5 * (pair[0] + pair[1]);
        self.centres.windows(2).take_while(is_past).count()
    }

    /// The count that a triangle of a bin gets in place of its own.
    pub fn binned(&self, count: f32) -> f32 {
        if count < 1.0 {
            count
        } else {
            self.centres[self.nearest(count)]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Field;
    use crate::scene::{Grass, Solver};
    use crate::terrain::HeightGrid;

    /// Looks along −z; a pixel is a thousandth wide.
    fn view() -> CountView {
        CountView {
            right: Vec3::new(1.0, 0.0, 0.0),
            up: Vec3::UP,
            forward: Vec3::new(0.0, 0.0, -1.0),
            pixel_rad: 1e-3,
        }
    }

    fn triangle(x: f32, y: f32, z: f32, side: f32) -> [Vec3<f32>; 3] {
        [(0.0, 0.0), (side, 0.0), (0.0, side)].map(|(dx, dz)| Vec3::new(x + dx, y, z + dz))
    }

    #[test]
    fn the_projected_area_is_that_of_the_picture() {
        // Upright, 2 m away, of 1 by 1 m: half of 500 by 500 pixels.
        let upright = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x, y, -2.0));
        let count = by_projected_area(upright, &view(), 0.01, 1e9);
        assert!((count - 1250.0).abs() < 0.01, "{count}");
        assert_eq!(by_projected_area(upright, &view(), 0.01, 900.0), 900.0);
        // A corner behind the near plane: the ceiling.
        let near = triangle(-0.5, -1.0, -0.6, 1.0);
        assert_eq!(by_projected_area(near, &view(), 1e-9, 77.0), 77.0);
    }

    #[test]
    fn both_areas_agree_in_the_middle_of_the_picture() {
        for away in [5.0, 20.0, 80.0] {
            let far = triangle(-0.02, -0.1 * away, -away, 0.04);
            let [projected, world] =
                [by_projected_area, by_world_area].map(|rule| rule(far, &view(), 1.0, 1e9));
            // The middle lies 5.7° below the axis: 1/cos³ of that is 1.5% more on the picture.
            assert!(
                (projected / world - 1.015).abs() < 0.01,
                "{projected} {world}"
            );
        }
        let below = triangle(0.0, 1.0, -5.0, 0.5);
        assert_eq!(by_world_area(below, &view(), 1.0, 9.0), 0.0);
    }

    /// Over many triangles the plants shown are as many as the count, to five standard deviations
    /// of a rounded fraction (at most ½ each), which is below the 2% that are asked for.
    #[test]
    fn rounding_keeps_the_mean_and_prefixes_stay() {
        let field = Field::new(
            HeightGrid::flat(9, 9, 1.0),
            &Grass::default(),
            &Solver::default(),
        );
        let seeds = field.expect("a field").seeds;
        let triangles = 4000;
        for count in [0.3_f32, 1.7, 6.25, 20.5] {
            let mut total = 0;
            for id in 0..triangles {
                let part = rounding(&seeds, id);
                let drawn = (0..64).filter(|&i| shown(count, part, i) > 0.0).count();
                assert!((0..drawn as u32).all(|i| shown(count, part, i) > 0.0));
                let more = (0..64).filter(|&i| shown(count + 0.5, part, i) > 0.0);
                assert!(more.count() >= drawn);
                total += drawn;
            }
            let mean = total as f64 / f64::from(triangles);
            let spread = 5.0 * 0.5 / f64::from(triangles).sqrt();
            assert!(
                (mean - f64::from(count)).abs() < spread,
                "{mean} for {count}"
            );
        }
        assert_eq!(shown(10.0, 0.0, 2), 1.0);
    }

    #[test]
    fn places_are_the_plants_that_show() {
        for count in [0.0_f32, 0.2, 0.9, 1.0, 3.5, 64.0] {
            for part in [0.0_f32, 0.1, 0.5, 0.999] {
                let seen = (0..100).filter(|&i| shown(count, part, i) > 0.0).count();
                assert_eq!(places(count, part), seen as u32, "{count} + {part}");
                assert!(places(count, part) <= count.ceil() as u32);
            }
        }
    }

    /// One more place begins a cluster where a copy of the plants or a cluster of it begins.
    #[test]
    fn clusters_hold_all_places() {
        for (per_triangle, cluster) in [(1, 1), (8, 8), (8, 3), (21, 8), (5, 16)] {
            let mut clusters = 0;
            for place in 0..100 {
                assert_eq!(clusters_in(place, per_triangle, cluster), clusters);
                clusters += u32::from(place % per_triangle % cluster == 0);
            }
        }
    }

    /// Eq. 15 by its ends and its ratio; the nearest centre errs by half a step at most.
    #[test]
    fn bins_are_a_geometric_progression() {
        let bins = Bins::up_to(128.0);
        assert_eq!((bins.centres[0], bins.centres[BINS - 1]), (1.0, 128.0));
        let ratio = libm::pow(128.0, 1.0 / 31.0) as f32;
        for pair in bins.centres.windows(2) {
            assert!((pair[1] / pair[0] / ratio - 1.0).abs() < 1e-6);
        }
        for step in 0..1271 {
            let count = 1.0 + 0.1 * step as f32;
            let nearest = bins.binned(count);
            let off = |centre: &f32| (centre - count).abs();
            let least = bins.centres.iter().map(off).fold(f32::INFINITY, f32::min);
            assert_eq!(off(&nearest), least, "{count}");
            // Half of a step of ratio q is (q − 1)/2 of the smaller centre.
            assert!(
                off(&nearest) <= 0.5 * (ratio - 1.0) * count + 1e-4,
                "{count}"
            );
        }
        assert_eq!(bins.binned(0.3), 0.3);
        assert_eq!(Bins::up_to(0.5).centres, [1.0; BINS]);
    }
}
