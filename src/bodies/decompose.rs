//! Splits a triangle mesh into convex parts: voxel-based approximate convex decomposition
//! (V-HACD, Mamou and Ghorbel 2009) as parry splits, then the merging that parry leaves out.
//!
//! Deviations. Parry takes the hull of a part's pieces of surface only, which loses what lies
//! behind a cut: the corners of its inner voxels count here too. Parry may give twice as many
//! parts as asked for: here the mesh is split finely, then pairs of parts are joined until no more
//! than the wished number are left. Hulls are thinned to the vertices that matter.

use std::collections::HashSet;

use rapier3d::math::Vector;
use rapier3d::parry::transformation::vhacd::{VHACD, VHACDParameters};
use rapier3d::parry::transformation::voxelization::{FillMode, VoxelSet};
use rayon::prelude::*;

use super::convex::Hull;

/// Voxels along the mesh's longest side. Gaps narrower than a voxel or two are filled.
const RESOLUTION: u32 = 64;
/// A part is split while its hull exceeds it by this share of the whole mesh's hull.
const CONCAVITY: f32 = 0.0007;
/// Most parts before merging; parry may go to twice as many.
const SPLIT_INTO: u32 = 64;
/// Two parts are joined, however many are allowed, if their hull adds at most this share of
/// their volume.
const JOINED_GAIN: f64 = 0.01;
/// Thinned hulls keep every vertex within this share of the mesh's size: a tenth of a voxel.
const THINNING: f64 = 0.002;

/// Hulls whose union approximates the solid that the triangles enclose; at least one and at most
/// `max_parts`, or none if nothing has a volume.
pub(super) fn convex_parts(
    positions: &[Vector],
    triangles: &[[u32; 3]],
    max_parts: u32,
) -> Vec<Hull> {
    let Some(whole) = Hull::of(positions) else {
        return Vec::new();
    };
    if max_parts <= 1 {
        return vec![whole.thinned(THINNING * whole.size())];
    }
    // A little before joining, which looks at every pair, and the rest after.
    let tolerance_m = THINNING * whole.size();
    let mut hulls: Vec<Hull> = split(positions, triangles, max_parts)
        .par_iter()
        .filter_map(|points| Hull::of(points))
        .map(|hull| hull.thinned(0.25 * tolerance_m))
        .collect();
    join(&mut hulls, max_parts as usize);
    hulls
        .par_iter()
        .map(|hull| hull.thinned(0.75 * tolerance_m))
        .collect()
}

/// The points of every part.
fn split(positions: &[Vector], triangles: &[[u32; 3]], max_parts: u32) -> Vec<Vec<Vector>> {
    let fill = FillMode::FloodFill {
        detect_cavities: false,
    };
    let voxels = VoxelSet::voxelize(positions, triangles, RESOLUTION, fill, true);
    let inner: HashSet<_> = voxels
        .voxels()
        .iter()
        .filter(|voxel| !voxel.is_on_surface)
        .map(|voxel| voxel.coords.to_array())
        .collect();
    let parameters = VHACDParameters {
        concavity: CONCAVITY,
        max_convex_hulls: SPLIT_INTO.max(max_parts),
        fill_mode: fill,
        ..VHACDParameters::default()
    };
    let parts = VHACD::from_voxels(&parameters, voxels);
    let surface = parts.compute_primitive_intersections(positions, triangles);
    let with_inside = |(part, mut points): (&VoxelSet, Vec<Vector>)| {
        let half = 0.5 * part.scale;
        // Only those beside a cut: parry marks them as surface when it cuts.
        let rim = part.voxels().iter().filter(|v| v.is_on_surface);
        for voxel in rim.filter(|v| inner.contains(&v.coords.to_array())) {
            let middle = part.get_voxel_point(voxel);
            for corner in 0..8 {
                let side = |bit: u32| if corner >> bit & 1 == 1 { half } else { -half };
                points.push(middle + Vector::new(side(0), side(1), side(2)));
            }
        }
        points
    };
    parts
        .voxel_parts()
        .iter()
        .zip(surface)
        .map(with_inside)
        .collect()
}

/// Two parts and what joining them would bring.
struct Pair {
    keys: [u64; 2],
    hull: Hull,
    /// Added volume over the volume of both.
    share: f64,
    /// Added volume times that share. The volume alone would web thin horns and legs first.
    cost: f64,
}

impl Pair {
    fn of(a: &(u64, Hull), b: &(u64, Hull)) -> Option<Self> {
        let hull = Hull::of(&[a.1.points(), b.1.points()].concat())?;
        let apart = a.1.volume() + b.1.volume();
        // Parts overlap a little at their cuts: a joint may even save volume.
        let gain = (hull.volume() - apart).max(0.0);
        let share = gain / apart;
        Some(Self {
            keys: [a.0, b.0],
            hull,
            share,
            cost: gain * share,
        })
    }
}

/// Joins the cheapest pair again and again, until at most `most` parts are left and every further
/// joint would add too much.
fn join(hulls: &mut Vec<Hull>, most: usize) {
    let mut parts: Vec<(u64, Hull)> = (0..).zip(hulls.drain(..)).collect();
    let mut next_key = parts.len() as u64;
    let mut pairs: Vec<Pair> = (0..parts.len())
        .into_par_iter()
        .flat_map_iter(|i| {
            let a = &parts[i];
            parts[i + 1..].iter().filter_map(|b| Pair::of(a, b))
        })
        .collect();
    loop {
        let crowded = parts.len() > most;
        let best = pairs
            .iter()
            .enumerate()
            .filter(|(_, pair)| crowded || pair.share <= JOINED_GAIN)
            .min_by(|(_, p), (_, q)| p.cost.total_cmp(&q.cost))
            .map(|(index, _)| index);
        let Some(index) = best else { break };
        let Pair { keys, hull, .. } = pairs.swap_remove(index);
        // Only pairs with a joined part change: recomputing no others keeps this quadratic.
        pairs.retain(|pair| !pair.keys.iter().any(|key| keys.contains(key)));
        parts.retain(|(key, _)| !keys.contains(key));
        let part = (next_key, hull);
        next_key += 1;
        pairs.extend(parts.iter().filter_map(|other| Pair::of(other, &part)));
        parts.push(part);
    }
    hulls.extend(parts.into_iter().map(|(_, hull)| hull));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A prism 1 deep over an outline in the x, y plane, given with the triangles that fill it.
    fn prism(outline: &[[f32; 2]], faces: &[[u32; 3]]) -> (Vec<Vector>, Vec<[u32; 3]>) {
        let n = outline.len() as u32;
        let layer = |z: f32| outline.iter().map(move |p| Vector::new(p[0], p[1], z));
        let points = layer(0.0).chain(layer(1.0)).collect();
        let mut triangles = Vec::new();
        for &[a, b, c] in faces {
            triangles.push([a, c, b]);
            triangles.push([a + n, b + n, c + n]);
        }
        for i in 0..n {
            let j = (i + 1) % n;
            triangles.push([i, j, j + n]);
            triangles.push([i, j + n, i + n]);
        }
        (points, triangles)
    }

    /// A U, 3 wide and 3 high, with a notch of 1 by 2 open upwards.
    fn u_shape() -> (Vec<Vector>, Vec<[u32; 3]>) {
        let outline = [
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 3.0],
            [2.0, 3.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ];
        let faces = [
            [0, 1, 4],
            [0, 4, 5],
            [1, 2, 3],
            [1, 3, 4],
            [0, 5, 6],
            [0, 6, 7],
        ];
        prism(&outline, &faces)
    }

    fn holds(hull: &Hull, p: [f64; 3]) -> bool {
        let inside = |q: &[f64; 4]| q[0] * p[0] + q[1] * p[1] + q[2] * p[2] <= q[3];
        hull.planes.iter().all(inside)
    }

    #[test]
    fn a_notch_stays_empty_and_the_solid_full() {
        let (points, triangles) = u_shape();
        let parts = convex_parts(&points, &triangles, 16);
        assert!((3..=16).contains(&parts.len()), "{}", parts.len());
        let any = |p| parts.iter().any(|part| holds(part, p));
        // A voxel is 3/64; the hulls are thinned by 0.2% of 4.4.
        let off = 3.0 / 64.0 + 0.009;
        let range = |from: f64, to: f64| {
            (0..=10).map(move |k| from + off + (to - from - 2.0 * off) * 0.1 * f64::from(k))
        };
        for z in range(0.0, 1.0) {
            for v in range(1.0, 3.0) {
                for u in range(1.0, 2.0) {
                    assert!(!any([u, v, z]), "the notch is filled at {u} {v} {z}");
                }
                for u in range(0.0, 1.0).chain(range(2.0, 3.0)) {
                    assert!(any([u, v, z]), "an arm is empty at {u} {v} {z}");
                }
            }
            for v in range(0.0, 1.0) {
                for u in range(0.0, 3.0) {
                    assert!(any([u, v, z]), "the base is empty at {u} {v} {z}");
                }
            }
        }
    }

    #[test]
    fn the_number_of_parts_is_a_limit() {
        let (points, triangles) = u_shape();
        for most in [2, 3] {
            let parts = convex_parts(&points, &triangles, most);
            assert!(
                (1..=most as usize).contains(&parts.len()),
                "{most}: {}",
                parts.len()
            );
        }
        let whole = convex_parts(&points, &triangles, 1);
        assert!(holds(&whole[0], [1.5, 2.5, 0.5]), "one part is the hull");
    }

    #[test]
    fn a_convex_mesh_is_one_part() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        let (points, triangles) = prism(&square, &[[0, 1, 2], [0, 2, 3]]);
        let parts = convex_parts(&points, &triangles, 16);
        assert_eq!(parts.len(), 1);
        assert_eq!(parts[0].planes.len(), 6);
        assert!((parts[0].volume() - 2.0).abs() < 1e-6);
    }

    #[test]
    fn a_flat_mesh_has_no_parts() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, z]| Vector::new(x, 0.0, z));
        assert!(convex_parts(&points, &[[0, 1, 2]], 16).is_empty());
    }
}
