//! How far two runs of one scene differ: poses, imprints, plants on another side of a body.
//!
//! Which side of a body a plant ended on is decided where it was last touched: afterwards it rises in
//! both runs, and even one that was laid the other way comes near in the end.

use std::borrow::Cow;
use std::collections::BTreeMap;

use crate::base::Vec3;
use crate::base::statistics::quantile;
use crate::field::{Field, TileId};
use crate::gpu::GpuError;
use crate::sim::Meadow;
use crate::sim::measure::Standing;

use super::engine::Engine;

/// A plant by its tile and number.
pub type PlantId = (TileId, u32);
/// Plants as they stand at one instant.
pub type Plants = BTreeMap<PlantId, Standing<f64>>;

/// A plant leans if its tip is this far from the vertical over its root.
const LEANS_DEG: f64 = 30.0;
/// A plant stands on another side of a body if its tip is this far from the other run's, over the
/// plant's length: errors of a method are millimetres, the way around a body is a good part of a
/// blade.
const OTHER_SIDE: f64 = 0.25;

/// Every plant that a body has touched and that is not back at rest.
///
/// # Errors
///
/// The engine's.
pub fn touched_plants(meadow: &Meadow, engine: &mut Engine) -> Result<Plants, GpuError> {
    let mut plants = Plants::new();
    for tile in &meadow.work.tiles {
        for plant in engine.standing(meadow, tile)? {
            if plant.touched_at != 0 {
                plants.insert((tile.tile, plant.place), plant);
            }
        }
    }
    Ok(plants)
}

/// What differed so far between a run and the one that is taken for true.
#[derive(Clone, Debug, Default)]
pub struct Comparison {
    touched: BTreeMap<PlantId, Touched>,
    /// Per plant and frame.
    distances: Vec<Distance>,
    /// Plants that lean in both, and in either, summed over frames.
    lean_both: u64,
    lean_either: u64,
}

/// A plant that a body has touched in one of the runs.
#[derive(Clone, Copy, Debug, Default)]
struct Touched {
    /// Tick of its last contact in either.
    at: [u32; 2],
    on_other_side: bool,
}

#[derive(Clone, Copy, Debug)]
struct Distance {
    plant: PlantId,
    /// Mean over the nodes.
    square_m2: f64,
    /// The plant's.
    length_m: f64,
}

/// What a comparison came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Difference {
    /// Over touched plants that ended on the same side of the bodies, all frames.
    pub pose_rms_m: f64,
    pub pose_p95_m: f64,
    /// The same over each plant's length.
    pub pose_rms_lengths: f64,
    pub pose_p95_lengths: f64,
    /// Overlap of the plants that lean more than 30°; `None` where none ever leaned.
    pub imprint_iou: Option<f64>,
    /// Plants that ended on another side of a body than in the reference.
    pub side_flips: u64,
    pub touched_plants: u64,
    /// World x and z of their roots.
    pub flipped_roots_m: Vec<[f64; 2]>,
    /// Most billboards at once that a body had touched: they are not compared.
    pub billboards_left_out: u64,
}

impl Comparison {
    /// Takes in one instant. A plant that only one run has touched stands in the wind in the
    /// other.
    pub fn frame(&mut self, ours: &Plants, theirs: &Plants) {
        for (&id, truth) in theirs {
            let plant = ours
                .get(&id)
                .map_or_else(|| Cow::Owned(resting(truth)), Cow::Borrowed);
            self.plant(id, &plant, truth);
        }
        for (&id, plant) in ours {
            if !theirs.contains_key(&id) {
                self.plant(id, plant, &resting(plant));
            }
        }
    }

    fn plant(&mut self, id: PlantId, plant: &Standing<f64>, truth: &Standing<f64>) {
        let leans = [plant, truth].map(|p| p.lean_rad() > LEANS_DEG.to_radians());
        self.lean_both += u64::from(leans == [true, true]);
        self.lean_either += u64::from(leans != [false, false]);
        let distances = distances_m(plant, truth);
        let tip_m = distances.last().copied().unwrap_or(0.0);
        let length_m = f64::from(truth.plant.height_m);
        let seen = self.touched.entry(id).or_default();
        let at = [plant.touched_at, truth.touched_at];
        // One that is back at rest in a run has given its tick of contact back there.
        if at[0] > seen.at[0] || at[1] > seen.at[1] {
            *seen = Touched {
                at,
                on_other_side: tip_m > OTHER_SIDE * length_m,
            };
        }
        let sum: f64 = distances.iter().map(|d| d * d).sum();
        self.distances.push(Distance {
            plant: id,
            square_m2: sum / distances.len().max(1) as f64,
            length_m,
        });
    }

    /// What differed over all frames, in a field of plants.
    pub fn finish(&self, field: &Field) -> Difference {
        let ended_alike = |plant| !self.touched.get(plant).is_some_and(|t| t.on_other_side);
        let alike = self.distances.iter().filter(|d| ended_alike(&d.plant));
        let metres: Vec<f64> = alike.clone().map(|d| d.square_m2).collect();
        let lengths: Vec<f64> = alike.map(|d| d.square_m2 / d.length_m.powi(2)).collect();
        let overlap = || self.lean_both as f64 / self.lean_either as f64;
        let flipped = self.touched.iter().filter(|(_, t)| t.on_other_side);
        let roots: Vec<_> = flipped.map(|(&id, _)| root_m(field, id)).collect();
        Difference {
            pose_rms_m: root_of_mean(&metres),
            pose_p95_m: root_of_p95(&metres),
            pose_rms_lengths: root_of_mean(&lengths),
            pose_p95_lengths: root_of_p95(&lengths),
            imprint_iou: (self.lean_either > 0).then(overlap),
            side_flips: roots.len() as u64,
            touched_plants: self.touched.len() as u64,
            flipped_roots_m: roots.into_iter().flatten().collect(),
            billboards_left_out: 0,
        }
    }
}

fn root_of_mean(squares: &[f64]) -> f64 {
    // The sum of nothing is −0, which would be printed.
    let sum = squares.iter().fold(0.0, |sum, s| sum + s);
    (sum / squares.len().max(1) as f64).sqrt()
}

fn root_of_p95(squares: &[f64]) -> f64 {
    quantile(squares, 0.95).unwrap_or(0.0).sqrt()
}

fn resting(plant: &Standing<f64>) -> Standing<f64> {
    Standing {
        nodes: plant.wind.clone(),
        touched_at: 0,
        ..plant.clone()
    }
}

fn root_m(field: &Field, (tile, place): PlantId) -> Option<[f64; 2]> {
    let anchor = field.grid.anchor_of(tile, &field.ground);
    let origin = field.grid.anchor_in_world(&anchor, &field.ground);
    let [x, _, z] = field.plant(&anchor, tile, place)?.root_in_anchor;
    Some([origin[0] + f64::from(x), origin[2] + f64::from(z)])
}

/// Distances of the true plant's movable nodes from the places at the same arc length in the other:
/// its nodes, where it has as many, else points on its segments.
fn distances_m(plant: &Standing<f64>, truth: &Standing<f64>) -> Vec<f64> {
    let segments = truth.nodes.len().saturating_sub(1);
    let nodes = truth.nodes.iter().enumerate().skip(1);
    nodes
        .filter_map(|(n, &node)| Some((at_share(&plant.nodes, n, segments)? - node).length()))
        .collect()
}

/// The place at the share `part / parts` of the length of a line of equal segments.
fn at_share(nodes: &[Vec3<f64>], part: usize, parts: usize) -> Option<Vec3<f64>> {
    let along = part * (nodes.len().checked_sub(1)?);
    let (whole, rest) = (along / parts, along % parts);
    let from = *nodes.get(whole)?;
    if rest == 0 {
        return Some(from);
    }
    let to = *nodes.get(whole + 1)?;
    Some(from + (to - from) * (rest as f64 / parts as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Plant;
    use crate::scene::parse_scene;

    #[test]
    fn lines_of_other_segments_meet_at_equal_arc_length() {
        let line = |n: u32| -> Vec<Vec3<f64>> {
            (0..=n)
                .map(|k| Vec3::new(0.0, f64::from(k) / f64::from(n), 0.0))
                .collect()
        };
        for (ours, theirs) in [(8, 8), (3, 8), (16, 8), (8, 3)] {
            let nodes = line(ours);
            for (part, truth) in line(theirs).iter().enumerate() {
                let found = at_share(&nodes, part, theirs as usize).expect("on the line");
                // A straight line is its own interpolation up to one rounding.
                assert!((found - *truth).length() <= f64::EPSILON);
            }
        }
        assert!(at_share(&[], 0, 8).is_none());
    }

    /// A blade of 0.4 m whose tip is pushed to `x_m`, last touched at a tick.
    fn blade(touched_at: u32, x_m: f64) -> Plants {
        let plant = Plant {
            root_in_anchor: [0.0; 3],
            azimuth: [1.0, 0.0],
            height_m: 0.4,
            width_m: 0.007,
            stiffness: 0.5,
            lean: 0.0,
            flexibility: 1.0,
            species: 0,
            flutter_turns: 0.0,
            shade: 0,
        };
        let nodes = |x_m| vec![Vec3::ZERO, Vec3::new(x_m, 0.4, 0.0)];
        let standing = Standing {
            place: 0,
            plant,
            origin: [0.0; 3],
            wind: nodes(0.0),
            nodes: nodes(x_m),
            offsets: Vec::new(),
            touched_at,
        };
        Plants::from([((0, 0), standing)])
    }

    fn compared(frames: &[(Plants, Plants)]) -> Difference {
        let mut comparison = Comparison::default();
        for (ours, theirs) in frames {
            comparison.frame(ours, theirs);
        }
        let text = "(terrain: (ground: Flat(size_m: (2, 2))))";
        let loaded = parse_scene("sides", text, &[]).expect("a valid scene");
        let meadow = Meadow::new(loaded.scene, &loaded.assets).expect("a meadow");
        comparison.finish(&meadow.field)
    }

    #[test]
    fn a_plant_that_comes_back_to_its_side_counts_with_all_its_frames() {
        let found = compared(&[
            (blade(1, -0.2), blade(1, 0.2)),
            (blade(2, 0.2), blade(2, 0.2)),
        ]);
        assert_eq!((found.side_flips, found.touched_plants), (0, 1));
        // 0.4 m in one of two frames.
        assert!((found.pose_rms_m - 0.4 / 2.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_plant_let_go_on_another_side_stays_there_although_it_rises() {
        let found = compared(&[
            (blade(1, 0.2), blade(1, 0.2)),
            (blade(2, -0.2), blade(2, 0.2)),
            (blade(2, -0.01), blade(2, 0.01)),
            (Plants::new(), blade(2, 0.0)),
        ]);
        assert_eq!((found.side_flips, found.touched_plants), (1, 1));
        assert_eq!(found.pose_rms_m, 0.0, "none of its frames counts");
    }
}
