use super::*;
use crate::scene::assets::{Assets, DirectionMap, GreyMap};
use crate::scene::{ClumpKind, Grass, Messiness, Solver};

/// A field of 16 by 12 m on slopes.
fn ground() -> HeightGrid {
    let mut ground = HeightGrid::flat(17, 13, 1.0);
    for (k, height) in ground.heights_m.iter_mut().enumerate() {
        *height = 2.0 + ((k * 29) % 13) as f32 * 0.1;
    }
    ground
}

fn clumps() -> Vec<ClumpKind> {
    let reed = ClumpKind {
        name: "reed".into(),
        share: 0.5,
        height_m: [0.8, 1.2],
        flexibility: 0.4,
        ..ClumpKind::default()
    };
    vec![ClumpKind::default(), reed]
}

/// An extent that grows from left to right in four steps, and a direction that leans along +x.
fn assets() -> Assets {
    let mut assets = Assets::default();
    let extent = GreyMap {
        columns: 16,
        rows: 12,
        samples: (0..16 * 12)
            .map(|texel| [0, 13_107, 32_768, 65_535][texel % 16 / 4])
            .collect(),
    };
    let direction = DirectionMap {
        columns: 16,
        rows: 12,
        texels: vec![[200, 220, 128]; 16 * 12],
    };
    assets.grey_maps.insert("extent".into(), extent);
    assets.direction_maps.insert("direction".into(), direction);
    assets
}

struct Laid {
    ground: HeightGrid,
    grid: FieldGrid,
    field: BillboardField,
}

fn laid(billboards: &Billboards, tile_m: f32) -> Laid {
    let ground = ground();
    let solver = Solver {
        tile_m,
        ..Solver::default()
    };
    let grid = FieldGrid::new(&ground, &Grass::default(), &solver).expect("a grid");
    let map = CoverMap::of(billboards, &ground, &assets()).expect("its maps");
    let field = BillboardField::new(&ground, &grid, map, billboards, 7).expect("within budget");
    Laid {
        ground,
        grid,
        field,
    }
}

impl Laid {
    /// World places along x and z, from the ground's corner, in metres.
    fn places(&self) -> Vec<[f64; 2]> {
        let mut places = Vec::new();
        for tile in 0..self.grid.tile_count() {
            let anchor = self.grid.anchor_of(tile, &self.ground);
            let origin = self.grid.anchor_in_world(&anchor, &self.ground);
            let corner = self.ground.corner_in_world();
            for one in self.field.in_tile(tile) {
                let [x, _, z] = one.root_in_anchor.map(f64::from);
                places.push([origin[0] - corner[0] + x, origin[2] - corner[1] + z]);
            }
        }
        places
    }
}

fn dense() -> Billboards {
    Billboards {
        density_per_m2: 60.3,
        clumps: clumps(),
        ..Billboards::default()
    }
}

#[test]
fn the_tile_size_changes_no_billboard() {
    let billboards = Billboards {
        extent: Some("extent".into()),
        direction: Some("direction".into()),
        ..dense()
    };
    let bits = |tile_m| {
        let laid = laid(&billboards, tile_m);
        let mut all: Vec<_> = (0..laid.grid.tile_count())
            .flat_map(|tile| {
                let anchor = laid.grid.anchor_of(tile, &laid.ground).index;
                laid.field
                    .in_tile(tile)
                    .iter()
                    .map(move |one| (anchor, one))
            })
            .map(|(anchor, one)| {
                let [x, y, z] = one.root_in_anchor.map(f32::to_bits);
                (anchor, [x, y, z], format!("{one:?}"))
            })
            .collect();
        all.sort();
        all
    };
    let [small, middle, large] = [0.5, 1.0, 2.0].map(bits);
    assert!(small.len() > 4000, "{}", small.len());
    assert!(small == middle && middle == large);
}

/// Where the map is plain, the number is binomial about density · area · extent: five standard deviations
/// of the seeds' draws, and of the triangles' rounding, which is at most ½ for each.
#[test]
fn the_extent_is_the_share_that_grows() {
    let billboards = Billboards {
        extent: Some("extent".into()),
        ..dense()
    };
    let laid = laid(&billboards, 1.0);
    let places = laid.places();
    // Strips 3 m wide inside the map's plain ones, which are 4 m wide.
    for (strip, extent) in [0.0, 0.2, 32_769.0 / 65_536.0, 1.0].into_iter().enumerate() {
        let from = 4.0 * strip as f64 + 0.5;
        let inside = places.iter().filter(|p| (from..from + 3.0).contains(&p[0]));
        let got = inside.count() as f64;
        let white = 3.0 * 12.0 * 60.3_f64;
        let triangles = 3.0 * 12.0 * 8.0;
        let spread = (white * extent * (1.0 - extent) + 0.25 * triangles * extent).sqrt();
        let off = (got - white * extent).abs();
        assert!(off <= 5.0 * spread, "{got} for {}", white * extent);
    }
}

/// Places of a white field in 8 by 6 squares of 2 m: chi-square with 47 degrees of freedom is above 100
/// with a chance below 1e-5. Whole triangles share their count, so it is smaller than of free points.
#[test]
fn places_are_spread_evenly() {
    let laid = laid(&dense(), 1.0);
    let places = laid.places();
    let mut squares = [0_u32; 48];
    // Within triangles: the shares of a cell.
    let mut within = [0_u32; 64];
    for [x, z] in &places {
        squares[(z / 2.0) as usize * 8 + (x / 2.0) as usize] += 1;
        let [u, v] = [x, z].map(|p| (p * 2.0).fract() * 8.0);
        within[v as usize * 8 + u as usize] += 1;
    }
    let chi = |counts: &[u32]| {
        let mean = places.len() as f64 / counts.len() as f64;
        let squared = |&n: &u32| (f64::from(n) - mean).powi(2) / mean;
        counts.iter().map(squared).sum::<f64>()
    };
    assert!(chi(&squares) < 100.0, "{}", chi(&squares));
    // 63 degrees of freedom: above 122 with a chance below 1e-5.
    assert!(chi(&within) < 122.0, "{}", chi(&within));
}

/// The places of a billboard and of the blade of the same triangle, number and seed do not go together:
/// about the middles of their triangles, the correlation of n independent pairs is normal with the
/// deviation 1/√n.
#[test]
fn billboards_do_not_follow_the_blades() {
    let billboards = Billboards {
        density_per_m2: 8.0,
        seed: 1,
        ..Billboards::default()
    };
    let laid = laid(&billboards, 1.0);
    let field = crate::field::Field::new(ground(), &Grass::default(), &Solver::default());
    let field = field.expect("a field");
    let seeds = &laid.field.seeds;
    assert_eq!(field.seeds.key, seeds.key);
    // By the way the cell is cut and the half of it.
    let mut of_class: [Vec<[f64; 4]>; 4] = Default::default();
    for tile in 0..laid.grid.tile_count() {
        let start = seeds.start_of(&laid.ground, tile);
        for place in 0..seeds.grid.plants_per_tile() {
            let clump = seeds.billboard(&laid.ground, &start, place);
            let blade = field.plant(&start.anchor, tile, place);
            let (Some(clump), Some(blade)) = (clump, blade) else {
                continue;
            };
            let seed = seeds.grid.seed_place(tile, place);
            let class = (seed.cell[0] + seed.cell[1]) % 2 * 2 + seed.half;
            let in_cell = |p: f32| f64::from(p * 2.0).fract();
            let [x, _, z] = clump.root_in_anchor.map(in_cell);
            let [u, _, v] = blade.root_in_anchor.map(in_cell);
            assert!(x != u && z != v, "the same words");
            of_class[class as usize].push([x, z, u, v]);
        }
    }
    let mut pairs = Vec::new();
    for class in &of_class {
        let count = class.len() as f64;
        let mean = [0, 1, 2, 3].map(|a| class.iter().map(|p| p[a]).sum::<f64>() / count);
        pairs.extend(class.iter().map(|p| [0, 1, 2, 3].map(|a| p[a] - mean[a])));
    }
    let count = pairs.len() as f64;
    assert!(count > 1400.0, "{count}");
    let product = |a: usize, b: usize| pairs.iter().map(|p| p[a] * p[b]).sum::<f64>();
    for (a, b) in [(0, 2), (0, 3), (1, 2), (1, 3)] {
        let r = product(a, b) / (product(a, a) * product(b, b)).sqrt();
        assert!(r.abs() < 5.0 / count.sqrt(), "{a} {b}: {r} of {count}");
    }
}

/// A prefix of a tile's order is the tile of a sparser field: fewer billboards per square metre take away
/// the last ones of each triangle, and none moves.
#[test]
fn a_sparser_field_is_part_of_a_denser_one() {
    let roots = |density_per_m2| {
        let billboards = Billboards {
            density_per_m2,
            ..dense()
        };
        let laid = laid(&billboards, 1.0);
        let all = laid.field.all.iter();
        let mut bits: Vec<_> = all.map(|b| b.root_in_anchor.map(f32::to_bits)).collect();
        bits.sort_unstable();
        bits
    };
    let (few, many) = (roots(16.0), roots(48.0));
    assert_eq!((few.len(), many.len()), (16 * 192, 48 * 192));
    assert!(few.iter().all(|root| many.binary_search(root).is_ok()));
}

/// Unit lengths, sizes in their ranges, pictures of their kinds, and corners that keep the quad open: the
/// edge is off the right angle by at most a quarter turn times 1 − lean², so that its cosine, lean · sin of
/// that, is below 0.52.
#[test]
fn quads_are_well_formed() {
    for mess in [0.0, 0.3, 1.0] {
        let billboards = Billboards {
            direction: Some("direction".into()),
            messiness: Messiness::Even(mess),
            ..dense()
        };
        let field = laid(&billboards, 1.0).field;
        let mut of_kind = [0_u32; 2];
        let mut pictures = [0_u32; 8];
        for one in &field.all {
            let up = one.up.map(f64::from);
            let length = up.iter().map(|c| c * c).sum::<f64>();
            let across = one.across.map(f64::from);
            let wide = across[0].powi(2) + across[1].powi(2);
            assert!((length - 1.0).abs() < 5e-7 && (wide - 1.0).abs() < 5e-7);
            assert!(up[1] >= 0.0);
            let cosine = (across[0] * up[0] + across[1] * up[2]).abs();
            assert!(cosine < 0.52, "{one:?}");
            let kind = &billboards.clumps[one.kind as usize];
            let within = |x: f32, [low, high]: [f32; 2]| {
                // Ranges are rounded to steps.
                (low - 2e-4..=high + 2e-4).contains(&x)
            };
            assert!(within(one.height_m, kind.height_m) && within(one.width_m, kind.width_m));
            assert!((one.flexibility - kind.flexibility).abs() < 2e-4);
            assert!(one.height_m + 0.5 * one.width_m <= field.reach_m + 1e-3);
            of_kind[one.kind as usize] += 1;
            pictures[one.texture as usize] += 1;
        }
        let all = field.all.len() as f64;
        // A third of them reeds, then quarters: five standard deviations.
        let reeds = f64::from(of_kind[1]);
        assert!((reeds - all / 3.0).abs() < 5.0 * (all * 2.0 / 9.0).sqrt());
        for (picture, &count) in pictures.iter().enumerate() {
            let mean = f64::from(of_kind[picture / 4]) / 4.0;
            let spread = 5.0 * (mean * 0.75).sqrt();
            assert!((f64::from(count) - mean).abs() < spread, "{pictures:?}");
        }
    }
}

/// The map's colour (200, 220, 128) means (0.569, 0.725, 0.004): tidy clumps have that direction to the
/// packing's half step, messy ones lie within an eighth of a turn of it, with the map's as their mean side.
#[test]
fn mess_tilts_and_turns() {
    let ups = |mess| {
        let billboards = Billboards {
            direction: Some("direction".into()),
            messiness: Messiness::Even(mess),
            ..dense()
        };
        laid(&billboards, 1.0).field.all
    };
    let want =
        [145.0_f64, 185.0, 1.0].map(|n| n / (145.0_f64.powi(2) + 185.0_f64.powi(2) + 1.0).sqrt());
    let dot = |one: &Billboard| {
        let up = one.up.map(f64::from);
        up[0] * want[0] + up[1] * want[1] + up[2] * want[2]
    };
    let (tidy, messy) = (ups(0.0), ups(1.0));
    for one in &tidy {
        // A length that is 1 to some roundings of 6e-8; half a step along two axes adds 5e-10.
        assert!(dot(one) > 1.0 - 3e-7, "{one:?}");
        // Its face shows along the lean: the edge is at right angles to it.
        assert!((f64::from(one.across[0]) * want[0]).abs() < 0.01, "{one:?}");
    }
    let least_dot = messy.iter().map(dot).fold(1.0, crate::base::least);
    assert!((0.70..0.72).contains(&least_dot), "{least_dot}");
    let count = messy.len() as f64;
    let mean = |axis: usize| messy.iter().map(|b| f64::from(b.up[axis])).sum::<f64>() / count;
    // The mean of cos over tilts spread evenly up to 1/8 turn is sin(π/4)/(π/4) = 0.900.
    let scale = 0.900_316;
    for (axis, want) in want.iter().enumerate() {
        // A component's spread is below ½.
        let off = (mean(axis) - scale * want).abs();
        assert!(off < 5.0 * 0.5 / count.sqrt(), "axis {axis}: {off}");
    }
}

#[test]
fn too_many_are_refused_with_numbers() {
    let ground = ground();
    let grid = FieldGrid::new(&ground, &Grass::default(), &Solver::default()).expect("a grid");
    let refused = |billboards: &Billboards, ground: &HeightGrid, grid: &FieldGrid| {
        let map = CoverMap::of(billboards, ground, &assets()).expect("its maps");
        let field = BillboardField::new(ground, grid, map, billboards, 7);
        field.map(|_| ()).expect_err("too many").to_string()
    };
    let denser = Billboards {
        density_per_m2: 5000.0,
        ..Billboards::default()
    };
    let text = refused(&denser, &ground, &grid);
    assert!(
        text.contains("5000 billboards in a tile, more than 4096"),
        "{text}"
    );
    let wide = HeightGrid::flat(601, 601, 1.0);
    let wide_grid = FieldGrid::new(&wide, &Grass::default(), &Solver::default()).expect("a grid");
    let text = refused(&Billboards::default(), &wide, &wide_grid);
    assert!(text.contains("8640000 billboards"), "{text}");
    let none = Billboards {
        clumps: Vec::new(),
        ..Billboards::default()
    };
    let text = refused(&none, &ground, &grid);
    assert!(text.contains("0 kinds: give 1 to 8"), "{text}");
}
