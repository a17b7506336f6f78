//! The blades of a tile: what bodies touch, and how it responds.

use crate::base::{Real, Vec3};
use crate::field::grid::ground_in_anchor;
use crate::field::{Field, Nodes, Plant, wind_pose};
use crate::sim::collide::{self, Movable};
use crate::sim::contact::Touch;
use crate::sim::fault::Fault;
use crate::sim::meadow::Meadow;
use crate::sim::recover::{Fading, is_back, recovering_pose};
use crate::sim::relax::{self, Ground, Place, RelaxSettings};
use crate::sim::slab::Slab;
use crate::sim::solid::Solid;
use crate::sim::work::{TileWork, Work};

/// A plant to respond: its place in the tile and the sweeps it needs, 0 if it is merely held.
#[derive(Clone, Copy, Debug)]
pub struct Touched {
    place: u32,
    sweeps: u32,
}

/// A plant's wind pose and its pose of now.
pub fn poses<R: Real>(
    field: &Field,
    work: &Work,
    fading: &Fading<R>,
    tile: &TileWork,
    plant: &Plant,
    slab: &Slab<R>,
    place: u32,
) -> (Nodes<R>, Nodes<R>) {
    let segments = field.table.segments as usize;
    let wind = wind_pose(plant, &field.table, work.wind.bend(&tile.anchor, plant));
    let mut touched_at = slab.touched_at[place as usize];
    if touched_at == 0 {
        return (wind, wind);
    }
    if fading.planted.is(Fault::TimerPerTile) {
        touched_at = slab.touched_at.iter().copied().max().unwrap_or(0);
    }
    let first = place as usize * segments;
    let pose = recovering_pose(
        &wind,
        &slab.offsets[first..first + segments],
        work.now - touched_at,
        fading,
        segment_length(plant, segments),
    );
    (wind, pose)
}

/// Whether a plant was touched in the sub-step before this one.
fn was_touched(work: &Work, touched_at: u32) -> bool {
    touched_at != 0 && work.now - touched_at == 1
}

/// A plant's wind pose of now, and the pose that bodies meet in this sub-step: the one it was left
/// in if it was touched in the sub-step before, wherever the wind has gone since, else its pose of
/// now.
fn poses_before<R: Real>(
    field: &Field,
    work: &Work,
    fading: &Fading<R>,
    tile: &TileWork,
    plant: &Plant,
    slab: &Slab<R>,
    place: u32,
) -> (Nodes<R>, Nodes<R>) {
    if !was_touched(work, slab.touched_at[place as usize]) {
        return poses(field, work, fading, tile, plant, slab, place);
    }
    let segments = field.table.segments as usize;
    let mut pose = wind_pose(
        plant,
        &field.table,
        work.wind_before.bend(&tile.anchor, plant),
    );
    let offsets = &slab.offsets[place as usize * segments..][..segments];
    for (node, &offset) in pose[1..].iter_mut().zip(offsets) {
        *node += offset;
    }
    let wind = wind_pose(plant, &field.table, work.wind.bend(&tile.anchor, plant));
    (wind, pose)
}

/// Rest length of a plant's segments, in metres.
pub fn segment_length<R: Real>(plant: &Plant, segments: usize) -> R {
    R::of_f32(plant.height_m) * R::of(1.0 / segments as f64)
}

pub(super) fn touches_of<'a, R: Real>(
    meadow: &'a Meadow,
    grown: &'a [Solid<R>],
    tile: &TileWork,
) -> Vec<Touch<'a, R>> {
    meadow
        .work
        .contacts_of(tile)
        .iter()
        .enumerate()
        .map(|(number, contact)| {
            let part = contact.part as usize;
            Touch::new(number, contact, &meadow.parts.parts[part], &grown[part])
        })
        .collect()
}

pub(super) fn touched_plants<R: Real>(
    meadow: &Meadow,
    grown: &[Solid<R>],
    tile: &TileWork,
    slab: &Slab<R>,
) -> Vec<Touched> {
    let field = &meadow.field;
    let segments = field.table.segments as usize;
    let fading = Fading::new(meadow);
    let touches = touches_of(meadow, grown, tile);
    let mut found = Vec::new();
    for place in 0..field.grid.plants_per_tile() {
        let Some(plant) = field.responding_plant(&tile.anchor, tile.tile, place) else {
            continue;
        };
        let reach = R::of_f32(plant.height_m);
        let sweeps = relax::sweeps_for(&touches, Vec3::of_f32(plant.root_in_anchor), reach);
        if sweeps == 0 {
            continue;
        }
        let (_, pose) = poses_before(field, &meadow.work, &fading, tile, &plant, slab, place);
        let before = was_touched(&meadow.work, slab.touched_at[place as usize]);
        let pinned = |p: Vec3<R>| {
            before
                && p.y - ground_in_anchor(&field.ground, &tile.anchor, p.x, p.z)
                    <= R::of(collide::PINNED_M)
        };
        if collide::touched(
            Movable::of_blade(&pose, segments),
            &touches,
            sweeps,
            reach,
            pinned,
        ) {
            found.push(Touched { place, sweeps });
        } else if before {
            let let_go = || poses(field, &meadow.work, &fading, tile, &plant, slab, place).1;
            if collide::held(Movable::of_blade(&pose, segments), &touches, reach)
                || collide::in_the_way(Movable::of_blade(&let_go(), segments), &touches, reach)
            {
                found.push(Touched { place, sweeps: 0 });
            }
        }
    }
    found
}

pub(super) fn respond<R: Real>(
    meadow: &Meadow,
    grown: &[Solid<R>],
    tile: &TileWork,
    touched: &[Touched],
    slab: &mut Slab<R>,
    settings: &RelaxSettings<R>,
) -> (u64, u32) {
    let field = &meadow.field;
    let segments = field.table.segments as usize;
    let fading = Fading::new(meadow);
    let touches = touches_of(meadow, grown, tile);
    let mut rounds_peak = 0;
    for &Touched { place, sweeps } in touched {
        let Some(plant) = field.plant(&tile.anchor, tile.tile, place) else {
            continue;
        };
        let (wind, mut pose) =
            poses_before(field, &meadow.work, &fading, tile, &plant, slab, place);
        let first = place as usize * segments;
        let surroundings = Place {
            ground: Ground {
                heights: &field.ground,
                anchor: &tile.anchor,
            },
            wind: &wind,
            segments,
            length: segment_length(&plant, segments),
        };
        let age = meadow.work.now - slab.touched_at[place as usize];
        // What is back in the wind pose has no memory of faces, whenever its tile gave its slab
        // back.
        if is_back(age, meadow.step_over_t() as f32) {
            slab.faces[first..first + segments].fill(0);
        }
        let rounds = relax::respond(
            &mut pose,
            &mut slab.faces[first..first + segments],
            &touches,
            sweeps,
            R::of_f32(plant.height_m),
            &surroundings,
            settings,
        );
        rounds_peak = rounds_peak.max(rounds);
        for j in 0..segments {
            slab.offsets[first + j] = pose[j + 1] - wind[j + 1];
        }
        slab.touched_at[place as usize] = meadow.work.now;
    }
    (touched.len() as u64, rounds_peak)
}
