//! Random words, plants and wind poses: what a plant is before anything touches it.

use libtest_mimic::Failed;
use sward::base::philox::philox2x32;
use sward::field::blade_table::Spacing;
use sward::field::{Field, WindNow, wind_pose};
use sward::gpu::field_data::TileRecord;
use sward::scene::{Solver, Wind};

use super::Device;
use super::compare::{Difference, distance, ensure, ulps};
use super::meadows::{bumpy_field, coloured_field, leaning_field};
use super::probe::{self, ROWS};

const WORDS: &str = r#"
#import "shared/field.wgsl"
#import "shared/philox.wgsl"
#import "shared/tile.wgsl"
@group(1) @binding(1) var<storage, read> tiles: array<TileRecord>;
@group(1) @binding(7) var<storage, read_write> rows: array<vec4u>;

@compute @workgroup_size(1)
fn probe(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = group.y * groups.x + group.x;
    let counter = vec2u(n * 2654435761u + tiles[group.y].tile, n ^ 0xffffffffu);
    let seven = philox2x32(counter, n * 97u, 7u);
    let three = philox2x32(counter, n * 97u, 3u);
    var random = pcg_from_words(seven);
    let first = pcg_next(&random);
    let row = n * 24u;
    rows[row] = vec4u(seven, three);
    rows[row + 1u] = vec4u(first, pcg_next(&random), bitcast<u32>(unit(first)), 0u);
}
"#;

pub fn random_words_are_equal(device: &Device) -> Result<(), Failed> {
    let field = bumpy_field(&Solver::default())?;
    let wind = WindNow::default();
    let tile = TileRecord::resting(&field, 0);
    let count = 4096;
    let rows = probe::run(&device.gpu, WORDS, &field, &wind, &[tile], count)?;
    for (n, rows) in (0..count).zip(rows.chunks_exact(ROWS)) {
        let counter = [n.wrapping_mul(2_654_435_761), n ^ u32::MAX];
        let seven = philox2x32(counter, n * 97, 7);
        let three = philox2x32(counter, n * 97, 3);
        let mut random = sward::base::philox::Pcg::from_words(seven);
        let first = random.next_word();
        let unit = sward::base::philox::unit(first).to_bits();
        let want = [
            [seven[0], seven[1], three[0], three[1]],
            [first, random.next_word(), unit, 0],
        ];
        ensure(rows[..2] == want, || {
            format!("word {n}: {:x?} for {want:x?}", &rows[..2])
        })?;
    }
    Ok(())
}

const PLANTS: &str = r#"
#import "shared/plant.wgsl"
#import "shared/pose.wgsl"
#import "shared/tile.wgsl"
#import "shared/wind.wgsl"
@group(1) @binding(1) var<storage, read> tiles: array<TileRecord>;
@group(1) @binding(7) var<storage, read_write> rows: array<vec4u>;

@compute @workgroup_size(1)
fn probe(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let row = (group.y * groups.x + group.x) * 24u;
    let tile = tiles[group.y];
    let plant = plant_at(tile, group.x);
    rows[row] = vec4u(bitcast<vec3u>(plant.root), u32(plant.grows));
    if !plant.grows {
        return;
    }
    let drawn = vec4f(plant.height_m, plant.width_m, plant.stiffness, plant.lean);
    rows[row + 1u] = bitcast<vec4u>(drawn);
    rows[row + 2u] = vec4u(bitcast<vec2u>(plant.azimuth), plant.species, plant.shade);
    let bend = wind_bend(tile, plant);
    rows[row + 3u] = bitcast<vec4u>(vec4f(plant.flexibility, plant.flutter_turns, bend));
    var nodes = wind_pose(plant, bend);
    for (var j = 0u; j <= field.segments; j++) {
        let one = wind_pose_at(plant, bend, j);
        rows[row + 4u + j] = vec4u(
            bitcast<vec3u>(nodes[j]),
            bitcast<u32>(distance(one.place, nodes[j]) + abs(1.0 - length(one.direction))),
        );
    }
}
"#;

struct Probed {
    field: Field,
    wind: WindNow,
    rows: Vec<[u32; 4]>,
}

/// Every plant of a field on bumpy ground, as the device sees it.
fn probed(device: &Device, tile_m: f32) -> Result<Probed, Failed> {
    let solver = Solver {
        tile_m,
        ..Solver::default()
    };
    probed_field(device, bumpy_field(&solver)?)
}

fn probed_field(device: &Device, field: Field) -> Result<Probed, Failed> {
    let anchor_m = f64::from(field.grid.cell_m) * 4.0;
    let wind = WindNow::at(&Wind::default(), 1234.5, anchor_m, 1.0);
    let tiles: Vec<_> = (0..field.grid.tile_count())
        .map(|tile| TileRecord::resting(&field, tile))
        .collect();
    let plants = field.grid.plants_per_tile();
    let rows = probe::run(&device.gpu, PLANTS, &field, &wind, &tiles, plants)?;
    Ok(Probed { field, wind, rows })
}

impl Probed {
    /// Calls `each` with every plant's place, what Rust makes of it, and the device's rows.
    fn each(
        &self,
        mut each: impl FnMut(
            &str,
            &sward::field::Anchor,
            Option<sward::field::Plant>,
            &[[u32; 4]],
        ) -> Result<(), Failed>,
    ) -> Result<(), Failed> {
        let plants = self.field.grid.plants_per_tile();
        for (n, rows) in self.rows.chunks_exact(ROWS).enumerate() {
            let (tile, place) = (n as u32 / plants, n as u32 % plants);
            let anchor = self.field.grid.anchor_of(tile, &self.field.ground);
            let plant = self.field.plant(&anchor, tile, place);
            each(&format!("tile {tile} plant {place}"), &anchor, plant, rows)?;
        }
        Ok(())
    }
}

/// Integers and roots' x and z bit for bit. Numbers drawn as low + span·unit: the device may fuse
/// the product into the sum, which saves one rounding of at most half an ulp of a product that is
/// not larger than the sum, and the sums' own roundings then differ by at most one step: 2 ulp.
/// The azimuth's polynomial is stated to be within 2.5e-7 on either side: 5e-7; that of a phototropic
/// plant has a square root in it, good to 2.5 ulp of at most 1, a third of which counts, and a sum that
/// may be fused: 1.6e-7 turns, another 1e-6. Heights of roots: a
/// sum of three terms of at most h = 1.6 m (the range of the ground), six roundings of 2⁻²⁴·2h on
/// either side: 2.3e-6 m.
pub fn plants_are_equal(device: &Device) -> Result<(), Failed> {
    let probed = probed(device, 1.0)?;
    let mut drawn = Difference::new("drawn numbers", "ulp");
    let mut azimuth = Difference::new("azimuth", "");
    let mut heights = Difference::new("root height", "m");
    let mut species = [0_u32; 2];
    let mut bare = 0_u32;
    probed.each(|name, _, plant, rows| {
        let float = |row: usize, n: usize| f32::from_bits(rows[row][n]);
        ensure((rows[0][3] == 1) == plant.is_some(), || {
            format!("{name}: grows on one side only")
        })?;
        let Some(plant) = plant else {
            bare += 1;
            return Ok(());
        };
        species[plant.species as usize] += 1;
        let got = [rows[2][2], rows[2][3], rows[0][0], rows[0][2], rows[3][1]];
        let [x, y, z] = plant.root_in_anchor;
        let want = [
            plant.species,
            plant.shade,
            x.to_bits(),
            z.to_bits(),
            plant.flutter_turns.to_bits(),
        ];
        ensure(got == want, || format!("{name}: {got:x?} for {want:x?}"))?;
        let numbers = [plant.height_m, plant.width_m, plant.stiffness, plant.lean];
        for (n, number) in numbers.into_iter().enumerate() {
            drawn.add(f64::from(ulps(number, float(1, n))), || name.to_owned());
        }
        for n in 0..2 {
            let off = f64::from(plant.azimuth[n]) - f64::from(float(2, n));
            azimuth.add(off.abs(), || name.to_owned());
        }
        heights.add((f64::from(y) - f64::from(float(0, 1))).abs(), || {
            name.to_owned()
        });
        Ok(())
    })?;
    println!("{species:?} plants of each kind, {bare} bare places");
    ensure(species.iter().all(|&n| n > 1000) && bare > 100, || {
        format!("too few cases: {species:?}, {bare} bare")
    })?;
    drawn.check(2.0)?;
    azimuth.check(1.5e-6)?;
    heights.check(2.3e-6)
}

/// Kinds that follow from a base map: chosen in integers, so the same on both sides for every seed,
/// bare ground included. A plant's vigour adds two roundings to its height and stiffness, and up to
/// two more where the device fuses: 6 ulp.
pub fn kinds_by_colour_are_equal(device: &Device) -> Result<(), Failed> {
    let mut drawn = Difference::new("height and stiffness", "ulp");
    let (mut kinds, mut bare) = ([0_u32; 3], 0_u32);
    for (tile_m, cluster) in [(0.5, 1), (2.0, 1), (1.0, 4)] {
        let solver = Solver {
            tile_m,
            ..Solver::default()
        };
        let field = coloured_field(&solver, cluster)?;
        probed_field(device, field)?.each(|name, _, plant, rows| {
            let want = plant.map(|plant| {
                let [x, _, z] = plant.root_in_anchor;
                [plant.species, plant.shade, x.to_bits(), z.to_bits()]
            });
            let grown = [rows[2][2], rows[2][3], rows[0][0], rows[0][2]];
            let got = (rows[0][3] == 1).then_some(grown);
            ensure(got == want, || format!("{name}: {got:x?} for {want:x?}"))?;
            let Some(plant) = plant else {
                bare += 1;
                return Ok(());
            };
            kinds[plant.species as usize] += 1;
            let float = |n: usize| f32::from_bits(rows[1][n]);
            let off = ulps(plant.height_m, float(0)).max(ulps(plant.stiffness, float(2)));
            drawn.add(f64::from(off), || name.to_owned());
            Ok(())
        })?;
    }
    println!("{kinds:?} plants of each kind, {bare} bare places");
    ensure(kinds.iter().all(|&n| n > 1000) && bare > 1000, || {
        format!("too few cases: {kinds:?}, {bare} bare")
    })?;
    drawn.check(6.0)
}

/// A segment's direction before it is made a unit vector is a sum of table entries of at most 1
/// (four roundings), times the azimuth (5e-7 on it, see above), plus the wind's bend. A gust's phase
/// is at most 4 turns + 1, known to 2⁻²² turns, so its sine to 2π·2⁻²² + 5e-7 = 2e-6 on either
/// side; of that the bend takes gust + flutter = 0.14. In all 4·2⁻²³ + 5e-7 + 2·0.14·2e-6 =
/// 1.5e-6 per component, 2.7e-6 in three. Eight segments of 0.42/8 m add up to 0.42·2.7e-6 =
/// 1.1e-6 m, and eight sums of coordinates below 4 m to 8·2⁻²³·2 = 1.9e-6 m, on top of the root's
/// 2.3e-6 m: 5.3e-6 m.
pub fn wind_poses_agree(device: &Device) -> Result<(), Failed> {
    let mut nodes = Difference::new("wind pose", "m");
    let mut single = Difference::new("single nodes and directions", "m");
    for tile_m in [0.5, 2.0] {
        let probed = probed(device, tile_m)?;
        let segments = probed.field.table.segments as usize;
        probed.each(|name, anchor, plant, rows| {
            let Some(plant) = plant else {
                return Ok(());
            };
            let bend = probed.wind.bend::<f32>(anchor, &plant);
            let want = wind_pose(&plant, &probed.field.table, bend);
            for j in 0..=segments {
                let [x, y, z, off] = rows[4 + j].map(f32::from_bits);
                nodes.add(distance([x, y, z], want[j].to_f32()), || {
                    format!("{name} node {j}")
                });
                single.add(f64::from(off), || format!("{name} node {j}"));
            }
            Ok(())
        })?;
    }
    nodes.check(5.3e-6)?;
    // The same sums in one shader: equal but for how they are fused, and a direction's length.
    single.check(1.9e-6 + 4.0 * f64::from(f32::EPSILON))
}

/// A table with a knee has entries at fourth powers of even steps away from the critical stiffness.
/// A fused rounding of a plant's fraction, 6e-8, is worth most at the knee itself: the root of it,
/// 2.4e-4 of the angle's rise over half the axis (some 4 rad), 1e-3 rad or 4e-4 m of the longest
/// blade. Few plants lie there: one whose fraction is 1e-3 off is wrong by a 60th of that.
pub fn poses_about_the_knee_agree(device: &Device) -> Result<(), Failed> {
    // The knee within the axis, at its end and at its start.
    for stiffness in [
        [[60.0, 160.0], [50.0, 400.0]],
        [[8.0, 20.0], [30.0, 60.0]],
        [[80.0, 160.0], [70.0, 400.0]],
    ] {
        let field = leaning_field(&Solver::default(), stiffness, [0.0, 16.0])?;
        tips_about_the_knee(device, field)?;
    }
    Ok(())
}

fn tips_about_the_knee(device: &Device, field: Field) -> Result<(), Failed> {
    let mut tips = Difference::new("tips about the knee", "m");
    let probed = probed_field(device, field)?;
    ensure(probed.field.table.log2_k.spacing != Spacing::Even, || {
        "the table has no knee".into()
    })?;
    let segments = probed.field.table.segments as usize;
    probed.each(|name, anchor, plant, rows| {
        let Some(plant) = plant else {
            return Ok(());
        };
        let bend = probed.wind.bend::<f32>(anchor, &plant);
        let want = wind_pose(&plant, &probed.field.table, bend)[segments].to_f32();
        let [x, y, z, _] = rows[4 + segments].map(f32::from_bits);
        tips.add(distance([x, y, z], want), || name.to_owned());
        Ok(())
    })?;
    ensure(tips.rms() <= 1e-5, || {
        format!("tips about the knee: rms {:e} m", tips.rms())
    })?;
    tips.check(4e-4)
}
