//! Poses of bodies: to the bit where the driver is known, because blades under a body make much of a
//! rounding.

use libtest_mimic::Failed;
use sward::base::philox::{philox2x32, unit};
use sward::base::{Pose, Quat, Vec3, most};
use sward::field::WindNow;
use sward::gpu::field_data::TileRecord;
use sward::scene::Solver;

use super::Device;
use super::compare::ensure;
use super::meadows::bumpy_field;
use super::probe::{self, ROWS};

const POSES: &str = r#"
#import "shared/philox.wgsl"
#import "shared/rigid.wgsl"
#import "shared/tile.wgsl"
@group(1) @binding(1) var<storage, read> tiles: array<TileRecord>;
@group(1) @binding(7) var<storage, read_write> rows: array<vec4u>;

fn drawn(n: u32, which: u32) -> vec4f {
    let a = philox2x32(vec2u(n, 2u * which), tiles[0].tile, 7u);
    let b = philox2x32(vec2u(n, 2u * which + 1u), tiles[0].tile, 7u);
    return vec4f(unit(a.x), unit(a.y), unit(b.x), unit(b.y)) * 2.0 - 1.0;
}

@compute @workgroup_size(1)
fn probe(@builtin(workgroup_id) group: vec3u) {
    let n = group.x;
    let row = n * 24u;
    let from_pose = Pose(drawn(n, 0u), drawn(n, 1u).xyz);
    let to_pose = Pose(drawn(n, 2u), drawn(n, 3u).xyz);
    let p = drawn(n, 4u).xyz;
    let share = f32(1u + n % 13u) / 13.0;
    let pose = lerp_poses(from_pose, to_pose, share);
    rows[row] = vec4u(bitcast<u32>(share), 0u, 0u, 0u);
    rows[row + 1u] = bitcast<vec4u>(pose.turn);
    rows[row + 2u] = vec4u(bitcast<vec3u>(pose.place), 0u);
    rows[row + 3u] = vec4u(bitcast<vec3u>(rotate(from_pose.turn, p)), 0u);
    rows[row + 4u] = vec4u(bitcast<vec3u>(inverse_point(from_pose, p)), 0u);
}
"#;

fn drawn(n: u32, which: u32) -> [f32; 4] {
    let word = |at: u32| philox2x32([n, at], 0, 7);
    let (a, b) = (word(2 * which), word(2 * which + 1));
    [a[0], a[1], b[0], b[1]].map(|word| unit(word) * 2.0 - 1.0)
}

fn place(n: u32, which: u32) -> Vec3<f32> {
    let [x, y, z, _] = drawn(n, which);
    Vec3::new(x, y, z)
}

pub fn poses_are_equal(device: &Device) -> Result<(), Failed> {
    let field = bumpy_field(&Solver::default())?;
    let tile = TileRecord::resting(&field, 0);
    let count = 4096;
    let wind = WindNow::default();
    let rows = probe::run(&device.gpu, POSES, &field, &wind, &[tile], count)?;
    let mut differ = [0; 5];
    let mut largest = 0.0_f32;
    for (n, rows) in (0..count).zip(rows.chunks_exact(ROWS)) {
        let pose = |turn, at| Pose {
            turn: Quat::of_array(drawn(n, turn)),
            place: place(n, at),
        };
        let (from, to, p) = (pose(0, 1), pose(2, 3), place(n, 4));
        let share = (1 + n % 13) as f32 / 13.0;
        let between = from.lerp(to, share);
        let bits = |v: Vec3<f32>| [v.x.to_bits(), v.y.to_bits(), v.z.to_bits(), 0];
        let want = [
            [share.to_bits(), 0, 0, 0],
            between.turn.to_array().map(f32::to_bits),
            bits(between.place),
            bits(from.turn.rotate(p)),
            bits(from.inverse_point(p)),
        ];
        for (differ, (row, want)) in differ.iter_mut().zip(rows.iter().zip(&want)) {
            *differ += u32::from(row != want);
            for (&found, &want) in row.iter().zip(want) {
                let apart = (f32::from_bits(found) - f32::from_bits(want)).abs();
                largest = most(largest, apart);
            }
        }
    }
    let text = format!(
        "of {count}: shares, turns, places, rotated and inverse points differ: {differ:?}, by \
         {largest:e} at most"
    );
    // Quaternions of length 2 at most turn points of length √3 into ones of length 14 at most, in a
    // dozen roundings of 14·2⁻²⁴ each.
    ensure(largest <= 12.0 * 14.0 * f32::EPSILON / 2.0, || text.clone())?;
    // Scenes that are equal to the last bit rest on this; other drivers may round in another order.
    let is_known = device.gpu.adapter.driver.contains("llvmpipe");
    ensure(!is_known || differ == [0; 5], || text)
}
