//! What of a field a picture may show: seeding triangles, and the tiles they make up.
//!
//! Both are levels of the ground's bintree: the two triangles of a seeding cell are two of its
//! triangles, with the same corners, and so are the two halves of a tile.

use crate::base::most;
use crate::terrain::bintree::{SeedCounts, SeedTriangle, Seeding, Viewpoint};

use super::Field;
use super::grid::TileId;

impl Field {
    /// The traversal that finds this field's seeding triangles within `reach_m` of the eye.
    pub fn seeding(&self, reach_m: f32) -> Seeding {
        Seeding {
            halvings: self.grid.halvings as i32,
            reach_m,
            plant_m: self.reach_m,
            drops_hidden: true,
        }
    }

    /// Calls `found` with the number of every seeding triangle in view, each once.
    pub fn triangles_in_view(
        &self,
        viewpoint: &Viewpoint,
        reach_m: f32,
        mut found: impl FnMut(u32),
    ) -> SeedCounts {
        let columns = self.grid.cells[0];
        let seeding = self.seeding(reach_m);
        (self.bintree).seed(viewpoint, &seeding, |triangle| found(triangle.id(columns)))
    }

    /// Tiles of which at least one half may be in view, each once, in no particular order. The
    /// closest corner of that half is within `reach_m` of the eye. What stands on it is of either layer.
    pub fn tiles_in_view(&self, viewpoint: &Viewpoint, reach_m: f32) -> Vec<TileId> {
        let seeding = Seeding {
            halvings: self.grid.halvings as i32 - self.grid.tile_cells.ilog2() as i32,
            plant_m: (self.billboards.as_ref())
                .map_or(self.reach_m, |field| most(self.reach_m, field.reach_m)),
            ..self.seeding(reach_m)
        };
        // Most tiles are found half after half; only of the others the second half is sought.
        let (mut tiles, mut halves) = (Vec::new(), Vec::new());
        let mut waiting = None;
        let found = |SeedTriangle { cell, .. }| {
            let tile = self.grid.tile_at(cell[0], cell[1]);
            if waiting == Some(tile) {
                tiles.push(tile);
                waiting = None;
            } else {
                halves.extend(waiting.replace(tile));
            }
        };
        self.bintree.seed(viewpoint, &seeding, found);
        halves.extend(waiting);
        halves.sort_unstable();
        halves.dedup();
        tiles.append(&mut halves);
        tiles
    }
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeSet, HashMap};

    use super::*;
    use crate::base::Vec3;
    use crate::field::grid::SeedPlace;
    use crate::scene::{Grass, Solver};
    use crate::terrain::HeightGrid;

    fn field(columns: u32, rows: u32, spacing_m: f32, tile_m: f32) -> Field {
        let mut ground = HeightGrid::flat(columns, rows, spacing_m);
        for (k, h) in ground.heights_m.iter_mut().enumerate() {
            *h = ((k % columns as usize) as f32 * 0.4).sin() * spacing_m;
        }
        let solver = Solver {
            tile_m,
            ..Solver::default()
        };
        Field::new(ground, &Grass::default(), &solver).expect("a field")
    }

    fn looking(eye: Vec3<f64>, forward: Vec3<f64>) -> Viewpoint {
        let forward = forward.unit_or(Vec3::UP);
        let right = forward.cross(Vec3::UP).unit_or(Vec3::new(1.0, 0.0, 0.0));
        Viewpoint {
            eye_in_world: eye,
            right,
            up: right.cross(forward),
            forward,
            half_tan: [0.8, 0.5],
            pixel_rad: 1e-3,
        }
    }

    /// Sees all of a field of some metres.
    fn from_above() -> Viewpoint {
        looking(Vec3::new(0.0, 300.0, 0.0), Vec3::new(0.0, -1.0, 0.0))
    }

    #[test]
    fn the_bintrees_triangles_are_the_grids() {
        for (columns, rows, spacing_m) in [(9, 7, 1.0), (6, 11, 0.5), (4, 3, 2.0), (8, 5, 0.3)] {
            let field = field(columns, rows, spacing_m, 1.0);
            let mut ids = Vec::new();
            field.triangles_in_view(&from_above(), 1e3, |id| ids.push(id));
            ids.sort_unstable();
            let [wide, deep] = field.grid.cells;
            let every: Vec<u32> = (0..2 * wide * deep).collect();
            assert_eq!(ids, every, "{columns} x {rows}");

            let mut tiles = field.tiles_in_view(&from_above(), 1e3);
            tiles.sort_unstable();
            let every: Vec<u32> = (0..field.grid.tile_count()).collect();
            assert_eq!(tiles, every, "{columns} x {rows}");
        }
    }

    /// The seeds of a triangle's number stand within the corners that the bintree gives it.
    #[test]
    fn seeds_stand_on_the_bintrees_triangle() {
        let field = field(9, 7, 1.0, 1.0);
        let mut halves = HashMap::new();
        let seeding = field.seeding(1e3);
        field.bintree.seed(&from_above(), &seeding, |t| {
            halves.insert(t.id(field.grid.cells[0]), t);
        });
        for tile in 0..field.grid.tile_count() {
            let anchor = field.grid.anchor_of(tile, &field.ground);
            for place in 0..field.grid.plants_per_tile() {
                let seed = field.grid.seed_place(tile, place);
                let Some(plant) = field.plant(&anchor, tile, place) else {
                    continue;
                };
                let triangle = halves[&field.grid.triangle(&seed)];
                let SeedPlace { cell, half, .. } = seed;
                assert_eq!((triangle.cell, triangle.half), (cell, half));
                let first = [cell[0] % 4, cell[1] % 4].map(|n| n as f32 * field.grid.cell_m);
                let u = (plant.root_in_anchor[0] - first[0]) / field.grid.cell_m;
                let v = (plant.root_in_anchor[2] - first[1]) / field.grid.cell_m;
                let is_even = (cell[0] + cell[1]) % 2 == 0;
                let below_cut = if is_even { v - u } else { u + v - 1.0 };
                // Half 1 has its right angle at the larger z. Places are f32 of order 2 m.
                let side = if half == 1 { below_cut } else { -below_cut };
                assert!(side >= -2e-6, "{seed:?}: {u} {v}");
            }
        }
    }

    /// One field under two cameras: what both see has one number and one place.
    #[test]
    fn numbers_and_roots_do_not_depend_on_the_camera() {
        let field = field(40, 30, 1.0, 1.0);
        let views = [
            looking(Vec3::new(-9.0, 3.0, 4.0), Vec3::new(1.0, -0.2, -0.3)),
            looking(Vec3::new(2.0, 9.0, 12.0), Vec3::new(-0.1, -0.8, -1.0)),
        ];
        let seen = views.map(|view| {
            let mut ids = BTreeSet::new();
            field.triangles_in_view(&view, 25.0, |id| {
                assert!(ids.insert(id), "{id} twice");
            });
            ids
        });
        let both: Vec<u32> = seen[0].intersection(&seen[1]).copied().collect();
        assert!(both.len() > 100 && seen[0] != seen[1]);
        let tiles = views.map(|view| field.tiles_in_view(&view, 25.0));
        for id in both {
            let cell = [id / 2 % field.grid.cells[0], id / 2 / field.grid.cells[0]];
            let [column, row] = cell.map(|n| n / field.grid.tile_cells);
            let tile = field.grid.tile_at(column, row);
            assert!(tiles.iter().all(|tiles| tiles.contains(&tile)));
            let anchor = field.grid.anchor_of(tile, &field.ground);
            let [x, y, z] = field
                .plant(&anchor, tile, id & 1)
                .map_or([0.0; 3], |p| p.root_in_anchor);
            let origin = field.grid.anchor_in_world(&anchor, &field.ground);
            let ground = field
                .ground
                .height_in_world(origin[0] + f64::from(x), origin[2] + f64::from(z));
            // An f32 height of order 1 m over the anchor.
            assert!(
                (origin[1] + f64::from(y) - ground).abs() < 2e-6 || (x, y, z) == (0.0, 0.0, 0.0)
            );
        }
    }
}
