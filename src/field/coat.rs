//! Plants on any triangles: the basic form of P15, section 2.
//!
//! The triangles of a mesh are split until none holds more than [`MOST_ON_TRIANGLE`] plants, so that
//! what is near or in sight is told finely enough. Plant `index` of triangle `t` follows from the words
//! of (t, index): its place by eq. 23 to 25, the rest by the small generator. How many there are
//! follows the triangle's area, how many of them are drawn eq. 1; both are prefixes of one sequence, so
//! that no plant moves. WGSL twin: `shaders/coat_place.wgsl`.
//!
//! Deviations: a triangle's number takes the place of its centre's coordinates in the seed, since a body
//! moves; a triangle that the eye is behind grows nothing that is seen.

use crate::base::philox::{Pcg, philox2x32, unit};
use crate::base::trig::{cos_turns, sin_turns};
use crate::base::{Pose, Vec3};
use crate::scene::Coat;

use super::clusters::folded;
use super::count::{COUNT_WORD, CountView, by_projected_area, shown_share};

/// Plants of a triangle, on average.
pub const MOST_ON_TRIANGLE: f32 = 256.0;

/// A triangle on which plants grow, in the body's space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatTriangle {
    pub corners: [Vec3<f32>; 3],
    /// Of the smooth surface, at the corners.
    pub normals: [Vec3<f32>; 3],
    /// Plants on it, with their fraction.
    pub full: f32,
}

/// The plant of a triangle's sequence at an index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatPlant {
    /// Place of the root.
    pub root: Vec3<f32>,
    /// Of the surface there.
    pub normal: Vec3<f32>,
    /// Unit vector from the root along the plant.
    pub direction: Vec3<f32>,
    /// Metres.
    pub height_m: f32,
    /// Metres.
    pub width_m: f32,
    /// Random bytes for its look.
    pub shade: u32,
}

/// What a coat's plants draw from, as the device gets it. Pairs are the smallest value and the span
/// above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatRanges {
    pub height_m: [f32; 2],
    pub width_m: [f32; 2],
    /// From the normal.
    pub lean_turns: [f32; 2],
    pub key: u32,
    /// Of Philox.
    pub rounds: u32,
}

impl CoatRanges {
    pub fn new(coat: &Coat, rounds: u32) -> Self {
        let span = |[low, high]: [f32; 2]| [low, high - low];
        Self {
            height_m: span(coat.height_m),
            width_m: span(coat.width_m),
            lean_turns: span(coat.lean_deg.map(|degrees| degrees / 360.0)),
            key: coat.seed,
            rounds,
        }
    }

    /// What is added to a triangle's count before its fraction is cut off.
    pub fn rounding(&self, triangle: u32) -> f32 {
        unit(philox2x32([triangle, COUNT_WORD], self.key, self.rounds)[0])
    }

    /// A plant in the body's space.
    pub fn plant(&self, on: &CoatTriangle, triangle: u32, index: u32) -> CoatPlant {
        let words = philox2x32([triangle, index], self.key, self.rounds);
        let [r1, r2] = folded(words).map(unit);
        let at = |[a, b, c]: [Vec3<f32>; 3]| a + (b - a) * r1 + (c - a) * r2;
        let root = at(on.corners);
        let normal = at(on.normals).unit_or(on.normals[0]);
        let mut random = Pcg::from_words(words);
        let mut next = || unit(random.next_word());
        let mut drawn = |[low, span]: [f32; 2]| low + span * next();
        let (height_m, width_m) = (drawn(self.height_m), drawn(self.width_m));
        let (lean, azimuth) = (drawn(self.lean_turns), drawn([0.0, 1.0]));
        let east = normal.across();
        let north = normal.cross(east);
        let aside = east * cos_turns(azimuth) + north * sin_turns(azimuth);
        CoatPlant {
            root,
            normal,
            direction: normal * cos_turns(lean) + aside * sin_turns(lean),
            height_m,
            width_m,
            shade: random.next_word(),
        }
    }
}

/// How many plants of a triangle are drawn, with a fraction: P15 eq. 1 with the triangle's own plants as
/// its ceiling; none where the eye is behind the triangle.
pub fn drawn_count(
    on: &CoatTriangle,
    eye_from_body: Pose<f32>,
    view: &CountView,
    per_px: f32,
    density: f32,
) -> f32 {
    let corners = on.corners.map(|p| eye_from_body.point(p));
    let [a, b, c] = corners;
    if (b - a).cross(c - a).dot(a) >= 0.0 {
        return 0.0;
    }
    by_projected_area(corners, view, per_px * density, on.full * density.min(1.0))
}

/// Share of its size at which plant `index` of a triangle of this count is drawn; above 0 for the first
/// [`places`](super::count::places). As [`shown`](super::count::shown) but for triangles far smaller than
/// the ground's: of few plants most would be small.
pub fn grown(count: f32, rounding: f32, index: u32) -> f32 {
    shown_share(count + rounding, (0.2 * count).max(0.2), index)
}

/// The triangles on which plants grow, in the order of the mesh's: those with more than
/// [`MOST_ON_TRIANGLE`] plants are halved across their longest sides. Indices must name positions.
pub fn coat_triangles(
    positions: &[[f32; 3]],
    normals: &[[f32; 3]],
    indices: &[u32],
    per_m2: f32,
) -> Vec<CoatTriangle> {
    let mut made = Vec::new();
    for t in indices.chunks_exact(3) {
        let of = |from: &[[f32; 3]]| [0, 1, 2].map(|i| Vec3::of_f32(from[t[i] as usize]));
        let mut open = vec![with_count(of(positions), of(normals), per_m2)];
        while let Some(triangle) = open.pop() {
            if triangle.full > MOST_ON_TRIANGLE {
                // The first half comes next.
                let [first, second] = halves(&triangle, per_m2);
                open.extend([second, first]);
            } else {
                made.push(triangle);
            }
        }
    }
    made
}

fn with_count(corners: [Vec3<f32>; 3], normals: [Vec3<f32>; 3], per_m2: f32) -> CoatTriangle {
    let [a, b, c] = corners.map(|p| Vec3::<f64>::of(p.to_f64()));
    let area_m2 = 0.5 * (b - a).cross(c - a).length();
    CoatTriangle {
        corners,
        normals,
        full: (area_m2 * f64::from(per_m2)) as f32,
    }
}

fn halves(triangle: &CoatTriangle, per_m2: f32) -> [CoatTriangle; 2] {
    let side = |i: usize| triangle.corners[(i + 1) % 3] - triangle.corners[i];
    let squared = [0, 1, 2].map(|i| side(i).length_squared());
    let longest = (1..3).fold(
        0,
        |best, i| if squared[i] > squared[best] { i } else { best },
    );
    let (from, to) = (longest, (longest + 1) % 3);
    let middle = |of: [Vec3<f32>; 3]| (of[from] + of[to]) * 0.5;
    let (corner, normal) = (middle(triangle.corners), middle(triangle.normals));
    let normal = normal.unit_or(triangle.normals[from]);
    [to, from].map(|moved| {
        let (mut corners, mut normals) = (triangle.corners, triangle.normals);
        corners[moved] = corner;
        normals[moved] = normal;
        with_count(corners, normals, per_m2)
    })
}

#[cfg(test)]
mod tests;
