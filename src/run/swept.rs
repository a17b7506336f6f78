//! Which plants and billboards a body has gone through: the truth an imprint is compared with.
//!
//! A plant counts as swept if its undisturbed centre line (nodes and midpoints of its wind pose)
//! was more than [`BENT_M`] inside the body's true shape in some piece of some sub-step. Pieces are twice as fine as the
//! engine's own sweeps, so that a body that jumps over plants is caught.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use crate::base::Vec3;
use crate::field::{TileId, wind_pose};
use crate::sim::Meadow;
use crate::sim::billboard::Quad;
use crate::sim::work::{Contact, TileWork};

/// Depth in a body from which a plant counts as swept, and distance from the wind pose from which
/// it counts as bent, in metres: the skin's, which a body pushes grass by without touching it.
pub const BENT_M: f64 = 0.001;

/// Plants swept by one body, with the tick of the last time. Billboards of a tile are counted on from its
/// plants, and count as swept by their columns.
#[derive(Clone, Debug, Default)]
pub struct Swept {
    plants: BTreeMap<(TileId, u32), u32>,
}

impl Swept {
    /// Takes in one sub-step of body `body`.
    pub fn tick(&mut self, meadow: &Meadow, body: u32) {
        let found: Vec<Vec<(TileId, u32)>> = meadow
            .work
            .tiles
            .par_iter()
            .map(|tile| swept_in(meadow, tile, body))
            .collect();
        for plant in found.into_iter().flatten() {
            self.plants.insert(plant, meadow.ticks);
        }
    }

    /// The plants swept within the last `ticks` ticks.
    pub fn since(&self, now: u32, ticks: u32) -> BTreeSet<(TileId, u32)> {
        let recent = self.plants.iter().filter(|&(_, &at)| now - at < ticks);
        recent.map(|(&plant, _)| plant).collect()
    }
}

fn swept_in(meadow: &Meadow, tile: &TileWork, body: u32) -> Vec<(TileId, u32)> {
    let contacts = meadow.work.contacts_of(tile);
    let contacts: Vec<&Contact> = contacts.iter().filter(|c| c.body == body).collect();
    if contacts.is_empty() {
        return Vec::new();
    }
    let field = &meadow.field;
    let segments = field.table.segments as usize;
    let plants = field.grid.plants_per_tile();
    let mut found = Vec::new();
    for place in 0..plants {
        let Some(plant) = field.responding_plant(&tile.anchor, tile.tile, place) else {
            continue;
        };
        let bend = meadow.work.wind.bend::<f64>(&tile.anchor, &plant);
        let line = wind_pose(&plant, &field.table, bend);
        let root = Vec3::<f64>::of_f32(plant.root_in_anchor);
        let reach_m = f64::from(plant.height_m);
        if are_swept(meadow, &contacts, root, reach_m, &[&line[..=segments]]) {
            found.push((tile.tile, place));
        }
    }
    let billboards = meadow.field.billboards_in(tile.tile);
    for (billboard, place) in billboards.iter().zip(plants..) {
        let quad = Quad::<f64>::in_wind(billboard, &tile.anchor, &meadow.work.wind);
        let columns = columns_of(meadow, &quad);
        let columns: Vec<&[Vec3<f64>]> = columns.iter().map(Vec::as_slice).collect();
        if are_swept(meadow, &contacts, quad.root, billboard.reach_m(), &columns) {
            found.push((tile.tile, place));
        }
    }
    found
}

/// Nodes of the columns of a quad's grid, each from the ground up.
fn columns_of(meadow: &Meadow, quad: &Quad<f64>) -> Vec<Vec<Vec3<f64>>> {
    let Some(weave) = &meadow.weave else {
        return Vec::new();
    };
    let mut columns = vec![Vec::new(); weave.grid.columns];
    quad.nodes(weave.grid, |node, place| {
        columns[node % weave.grid.columns].push(place);
    });
    columns
}

/// Whether a movable node or a middle of a segment of lines rooted about a place was in a body.
fn are_swept(
    meadow: &Meadow,
    contacts: &[&Contact],
    root: Vec3<f64>,
    reach_m: f64,
    lines: &[&[Vec3<f64>]],
) -> bool {
    let near = |contact: &&&Contact| {
        let reach = contact.radius_m + reach_m;
        let way = contact.to.place - contact.from.place;
        let middle = (contact.to.place + contact.from.place) * 0.5;
        (root - middle).length() <= reach + 0.5 * way.length()
    };
    contacts.iter().filter(near).any(|contact| {
        (1..=2 * contact.sweeps).any(|piece| {
            let share = f64::from(piece) / f64::from(2 * contact.sweeps);
            let pose = contact.from.lerp(contact.to, share);
            let solid = &meadow.parts.parts[contact.part as usize].solid;
            let holds = |p: Vec3<f64>| solid.depth(pose.inverse_point(p)) > BENT_M;
            let mut segments = lines.iter().flat_map(|line| line.windows(2));
            segments.any(|ends| holds(ends[1]) || holds((ends[0] + ends[1]) * 0.5))
        })
    })
}
