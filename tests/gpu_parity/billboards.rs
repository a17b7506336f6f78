//! Billboards: how many, which and how they grow, as the device has them, against Rust.

use std::time::Instant;

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::field::billboards::PackedBillboard;
use sward::field::{Field, WindNow};
use sward::gpu::billboard_place::BillboardPlacing;
use sward::gpu::field_data::TileRecord;
use sward::scene::assets::{Assets, DirectionMap, GreyMap};
use sward::scene::builtin::ASSETS;
use sward::scene::{Billboards, ClumpKind, Messiness, Solver, Wind, parse_scene_with};
use sward::sim::Meadow;
use sward::sim::billboard::Quad;
use sward::terrain::CoverMap;

use super::Device;
use super::compare::{Difference, ensure};
use super::meadows::bumpy_field;
use super::probe::{self, ROWS};

/// Maps of other sizes than the ground's squares, with borders, all directions and every messiness.
fn assets() -> Assets {
    let mut assets = Assets::default();
    let grey = |scale: u32, shift: u32| GreyMap {
        columns: 39,
        rows: 30,
        samples: (0..39 * 30_u32)
            .map(|n| ((n.wrapping_mul(scale) >> shift) & 0xffff) as u16)
            .collect(),
    };
    let byte = |n: u32, shift: u32| (n.wrapping_mul(2_654_435_761) >> shift) as u8;
    let direction = DirectionMap {
        columns: 13,
        rows: 10,
        texels: (0..13 * 10_u32)
            .map(|n| [byte(n, 24), byte(n, 16) | 128, byte(n, 8)])
            .collect(),
    };
    assets.grey_maps.insert("extent".into(), grey(40_503, 4));
    assets
        .grey_maps
        .insert("messiness".into(), grey(2_654_435_761, 13));
    assets.direction_maps.insert("direction".into(), direction);
    assets
}

fn clumps() -> Vec<ClumpKind> {
    let kind = |share, height_m, flexibility| ClumpKind {
        share,
        height_m,
        flexibility,
        ..ClumpKind::default()
    };
    vec![
        kind(1.0, [0.3, 0.5], 1.0),
        kind(0.0, [1.0, 1.0], 0.3),
        kind(0.37, [0.7, 1.31], 0.21),
    ]
}

fn field(billboards: &Billboards, tile_m: f32) -> Result<Field, Failed> {
    let solver = Solver {
        tile_m,
        ..Solver::default()
    };
    let field = bumpy_field(&solver)?;
    let map = CoverMap::of(billboards, &field.ground, &assets())?;
    Ok(field.with_billboards(billboards, map)?)
}

fn signed(word: u32) -> [i32; 2] {
    [word as i16, (word >> 16) as i16].map(i32::from)
}

/// Counts, ranges, order, sizes, phases, tiles and textures are integers, and equal. So are roots along x
/// and z, which are exact; their heights are sums of three products of heights up to 4 m, two or three
/// roundings of 2.4e-7 m on either side where a device contracts them. Directions are rounded to steps of
/// 1/32767 on both sides from numbers that differ by some 5e-7, 0.016 steps: one step apart for at most
/// 2 · 2 · 0.016 = 7% of them. An edge follows from the direction's steps; of equal ones it is at most one
/// step apart. (Of an almost upright clump one step may turn the edge anywhere.)
fn agree(device: &Device, field: &Field) -> Result<(), Failed> {
    let placing = BillboardPlacing::new(&device.gpu)?;
    let started = Instant::now();
    let placed = placing.lay_out(&device.gpu, field)?;
    device.gpu.wait()?;
    let took_ms = 1e3 * started.elapsed().as_secs_f64();
    let placed = placed.ok_or("the field has billboards")?;
    let own = field
        .billboards
        .as_deref()
        .ok_or("the field has billboards")?;
    let tiles = field.grid.tile_count();
    let ranges = placed.ranges.read(&device.gpu, tiles as usize + 1)?;
    ensure(ranges == own.ranges, || {
        format!(
            "ranges differ: {:?}… for {:?}…",
            &ranges[..9],
            &own.ranges[..9]
        )
    })?;
    ensure(placed.count as usize == own.all.len(), || {
        format!("{} for {}", placed.count, own.all.len())
    })?;
    let records = placed.records.read(&device.gpu, own.all.len())?;
    let expected = (0..tiles).flat_map(|tile| own.seeds.in_tile(&field.ground, tile));
    let mut heights = Difference::new("heights of roots", "m");
    let mut ups = Difference::new("directions of billboards", "steps");
    let mut edges = Difference::new("edges of billboards", "steps");
    let (mut equal, mut other_ways) = (0, 0);
    for (n, (record, want)) in records.iter().zip(expected).enumerate() {
        let got = PackedBillboard::from(record);
        let [x, y, z] = got.root_in_anchor;
        let [u, v, w] = want.root_in_anchor;
        let same = [got.size, got.sway, got.tile_and_texture]
            == [want.size, want.sway, want.tile_and_texture];
        ensure(same && [x, z] == [u, w], || {
            format!("{n}: {got:x?}\n{want:x?}")
        })?;
        heights.add(f64::from((y - v).abs()), || format!("{n}"));
        let apart = |a: u32, b: u32| {
            let (a, b) = (signed(a), signed(b));
            f64::from(a[0].abs_diff(b[0]).max(a[1].abs_diff(b[1])))
        };
        ups.add(apart(got.up, want.up), || format!("{n}"));
        if got.up == want.up {
            edges.add(apart(got.across, want.across), || format!("{n}"));
        } else {
            other_ways += 1;
        }
        equal += usize::from(got == want);
    }
    println!(
        "{equal} of {} billboards on {tiles} tiles equal bit for bit; laid out in {took_ms:.1} ms",
        own.all.len()
    );
    heights.check(3e-6)?;
    ups.check(1.0)?;
    edges.check(1.0)?;
    ensure(other_ways * 100 <= 7 * own.all.len(), || {
        format!("{other_ways} directions of {} differ", own.all.len())
    })
}

pub fn billboards_are_equal(device: &Device) -> Result<(), Failed> {
    let mapped = Billboards {
        density_per_m2: 41.7,
        seed: 9,
        clumps: clumps(),
        extent: Some("extent".into()),
        direction: Some("direction".into()),
        messiness: Messiness::Map("messiness".into()),
        resample: true,
        ..Billboards::default()
    };
    for tile_m in [0.5, 1.0, 2.0] {
        agree(device, &field(&mapped, tile_m)?)?;
    }
    let plain = Billboards {
        clumps: clumps(),
        messiness: Messiness::Even(1.0),
        ..Billboards::default()
    };
    agree(device, &field(&plain, 1.0)?)
}

/// The scene of the paper's measurements.
pub fn sixty_thousand_billboards_are_equal(device: &Device) -> Result<(), Failed> {
    let source = include_str!("../../scenes/meadow_60k.ron");
    let loaded = parse_scene_with("meadow_60k", source, &ASSETS)?;
    let started = Instant::now();
    let meadow = Meadow::new(loaded.scene, &loaded.assets)?;
    let took_ms = 1e3 * started.elapsed().as_secs_f64();
    println!("laid out in Rust, with ground and bodies, in {took_ms:.1} ms");
    agree(device, &meadow.field)
}

/// More tiles than one row of sums has, by one: the sums of rows count.
pub fn ranges_of_many_tiles_are_equal(device: &Device) -> Result<(), Failed> {
    let ground = sward::terrain::HeightGrid::flat(242, 18, 1.0);
    let solver = Solver::default();
    let field = Field::new(ground, &sward::scene::Grass::default(), &solver)?;
    let billboards = Billboards {
        density_per_m2: 6.0,
        ..Billboards::default()
    };
    let map = CoverMap::of(&billboards, &field.ground, &assets())?;
    let field = field.with_billboards(&billboards, map)?;
    let tiles = field.grid.tile_count() as usize;
    ensure(tiles == 4097, || format!("{tiles} tiles"))?;
    let placed = BillboardPlacing::new(&device.gpu)?.lay_out(&device.gpu, &field)?;
    let placed = placed.ok_or("the field has billboards")?;
    let own = field
        .billboards
        .as_deref()
        .ok_or("the field has billboards")?;
    let ranges = placed.ranges.read(&device.gpu, tiles + 1)?;
    ensure(ranges == own.ranges, || "ranges differ".into())?;
    ensure(own.all.len() > 24_000, || {
        format!("{} billboards", own.all.len())
    })
}

/// Corners of quads in the wind, as drawn: lower left and right, upper left and right.
const QUADS: &str = r#"
#import "shared/billboard_quad.wgsl"
#import "shared/tile.wgsl"
@group(1) @binding(1) var<storage, read> tiles: array<TileRecord>;
@group(1) @binding(7) var<storage, read_write> rows: array<vec4u>;

@compute @workgroup_size(1)
fn probe(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = group.x;
    let root = vec3f(f32(n % 64u), f32(n % 7u), f32(n % 50u)) * 0.0625;
    let record = BillboardRecord(
        root,
        (400u + n) | ((700u + 3u * n) << 16u),
        signed_pair(vec2i(i32(n % 401u) - 200, i32(n % 301u) - 150) * 70),
        signed_pair(vec2i(i32(n % 173u) - 86, i32(n % 211u) - 105) * 150 + 1),
        (n * 4u) | ((n * 2741u) << 16u),
        0u,
    );
    let quad = wind_quad(tiles[group.y].anchor, open_billboard(record));
    let row = (group.y * groups.x + n) * 24u;
    for (var corner = 0u; corner < 4u; corner++) {
        let at = vec2f(f32(corner & 1u), f32(corner >> 1u));
        rows[row + corner] = vec4u(bitcast<vec3u>(quad_place(quad, at)), record.size);
    }
}
"#;

/// The corners that are drawn are those that the kernel simulates from. A corner is a sum of three terms of
/// up to 4 m, each rounded, 2.4e-7 m a time, on either side: 1.5e-6 m. Its lean is a unit vector of numbers
/// that differ by 4e-7 after the gusts' sines (`wind_poses_agree`), over up to 0.35 m.
pub fn quads_in_the_wind_agree(device: &Device) -> Result<(), Failed> {
    let field = bumpy_field(&Solver::default())?;
    let anchor_m = f64::from(field.grid.cell_m) * 4.0;
    let wind = WindNow::at(&Wind::default(), 1234.5, anchor_m, 1.0);
    let records: Vec<TileRecord> = (0..field.grid.tile_count())
        .map(|tile| TileRecord::resting(&field, tile))
        .collect();
    let count = 1024;
    let rows = probe::run(&device.gpu, QUADS, &field, &wind, &records, count)?;
    let mut apart = Difference::new("corners of quads", "m");
    let (mut equal, mut all) = (0, 0);
    for (at, rows) in rows.chunks_exact(ROWS).enumerate() {
        let (tile, n) = (at as u32 / count, at as u32 % count);
        let pair = |x: i32, z: i32| (x as u32 & 0xffff) | ((z as u32) << 16);
        let packed = PackedBillboard {
            root_in_anchor: [n % 64, n % 7, n % 50].map(|n| n as f32 * 0.0625),
            size: (400 + n) | ((700 + 3 * n) << 16),
            up: pair((n as i32 % 401 - 200) * 70, (n as i32 % 301 - 150) * 70),
            across: pair(
                (n as i32 % 173 - 86) * 150 + 1,
                (n as i32 % 211 - 105) * 150 + 1,
            ),
            sway: (n * 4) | (n.wrapping_mul(2741) << 16),
            tile_and_texture: 0,
        };
        let anchor = field.grid.anchor_of(tile, &field.ground);
        let quad: Quad<f32> = Quad::in_wind(&packed.open(), &anchor, &wind);
        for (want, row) in quad.vertices().into_iter().zip(rows) {
            let got: Vec3<f32> = Vec3::of_f32([row[0], row[1], row[2]].map(f32::from_bits));
            equal += u32::from(got == want);
            all += 1;
            let off = Vec3::<f64>::of_f32(got.to_f32()) - Vec3::of_f32(want.to_f32());
            apart.add(off.length(), || format!("tile {tile}, billboard {n}"));
        }
    }
    println!("{equal} of {all} corners equal bit for bit");
    apart.check(2e-6)
}
