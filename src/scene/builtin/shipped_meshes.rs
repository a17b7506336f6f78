//! Makes the meshes in `scenes/assets`, and checks that the files are what is made here.
//!
//! After a change here, `SWARD_BLESS=1 cargo test --release shipped_meshes` writes them anew.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use crate::base::trig::{cos_turns, sin_turns};
use crate::scene::assets::{Folders, read_mesh};

/// A ring of 0.4 m with a quarter left open towards +z, eight-sided in its section.
fn horseshoe() -> String {
    const STEPS: u32 = 24;
    // Half width and half height of the section, in metres, with its edges broken.
    const SECTION: [[f64; 2]; 8] = [
        [0.10, -0.05],
        [0.10, 0.05],
        [0.07, 0.08],
        [-0.07, 0.08],
        [-0.10, 0.05],
        [-0.10, -0.05],
        [-0.07, -0.08],
        [0.07, -0.08],
    ];
    let mut text =
        String::from("# A horseshoe, open towards +z. Lengths in metres.\no horseshoe\n");
    for step in 0..=STEPS {
        // From 45° left of +z the long way round to 45° right of it.
        let turns = 0.125 + 0.75 * f64::from(step) / f64::from(STEPS);
        for [out, up] in SECTION {
            let radius = 0.4 + out;
            let (x, z) = (radius * sin_turns(turns), radius * cos_turns(turns));
            writeln!(text, "v {x:.4} {up:.4} {z:.4}").expect("a string takes any text");
        }
    }
    for step in 0..STEPS {
        for side in 0..8 {
            let next = (side + 1) % 8;
            let [a, b] = [8 * step + 1, 8 * step + 9];
            let [p, q, r, s] = [b + side, b + next, a + next, a + side];
            writeln!(text, "f {p} {q} {r} {s}").expect("a string takes any text");
        }
    }
    let last = 8 * STEPS;
    let cap = |corners: Vec<u32>| {
        let words: Vec<_> = corners.iter().map(u32::to_string).collect();
        format!("f {}\n", words.join(" "))
    };
    text.push_str(&cap((1..=8).collect()));
    text.push_str(&cap((last + 1..=last + 8).rev().collect()));
    text
}

/// A chair of blocks: four legs, seat and back, looking towards +z, its origin in the seat.
fn chair() -> String {
    const ACROSS: [f32; 4] = [-0.26, -0.14, 0.14, 0.26];
    const UP: [f32; 4] = [-0.46, -0.06, 0.06, 0.50];
    let filled = |x: i32, y: i32, z: i32| {
        if !(0..3).contains(&x) || !(0..3).contains(&z) {
            return false;
        }
        match y {
            0 => x != 1 && z != 1,
            1 => true,
            2 => z == 0,
            _ => false,
        }
    };
    let mut positions: Vec<[i32; 3]> = Vec::new();
    let mut indices: Vec<u16> = Vec::new();
    let mut corner = |at: [i32; 3]| {
        let index = positions.iter().position(|&p| p == at).unwrap_or_else(|| {
            positions.push(at);
            positions.len() - 1
        });
        index as u16
    };
    for cell in (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]) {
        let [x, y, z] = cell;
        if !filled(x, y, z) {
            continue;
        }
        for (axis, side) in [0, 1, 2]
            .into_iter()
            .flat_map(|axis| [(axis, 0), (axis, 1)])
        {
            let mut beyond = cell;
            beyond[axis] += 2 * side - 1;
            if filled(beyond[0], beyond[1], beyond[2]) {
                continue;
            }
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            // Counter-clockwise as seen from beyond the face.
            let mut face = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[du, dv]| {
                let mut at = cell;
                at[axis] += side;
                at[u] += du;
                at[v] += dv;
                corner(at)
            });
            if side == 0 {
                face.reverse();
            }
            let [a, b, c, d] = face;
            indices.extend([a, b, c, a, c, d]);
        }
    }
    let place = |[x, y, z]: [i32; 3]| [ACROSS[x as usize], UP[y as usize], ACROSS[z as usize]];
    gltf(
        &positions.into_iter().map(place).collect::<Vec<_>>(),
        &indices,
    )
}

fn gltf(positions: &[[f32; 3]], indices: &[u16]) -> String {
    let place_bytes = positions.iter().flatten().flat_map(|x| x.to_le_bytes());
    let index_bytes = indices.iter().flat_map(|i| i.to_le_bytes());
    let bytes: Vec<u8> = place_bytes.chain(index_bytes).collect();
    let bound = |pick: fn(f32, f32) -> f32, start: f32| {
        [0, 1, 2].map(|a| positions.iter().map(|p| p[a]).fold(start, pick))
    };
    let (least, most) = (bound(f32::min, f32::MAX), bound(f32::max, f32::MIN));
    let (vertices, corners) = (positions.len(), indices.len());
    let (split, total) = (12 * vertices, bytes.len());
    let data = base64(&bytes);
    format!(
        r#"{{
  "asset": {{ "version": "2.0", "generator": "sward's shipped_meshes" }},
  "scene": 0,
  "scenes": [{{ "nodes": [0] }}],
  "nodes": [{{ "name": "chair", "mesh": 0 }}],
  "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": 0 }}, "indices": 1 }}] }}],
  "accessors": [
    {{ "bufferView": 0, "componentType": 5126, "count": {vertices}, "type": "VEC3", "min": {least:?}, "max": {most:?} }},
    {{ "bufferView": 1, "componentType": 5123, "count": {corners}, "type": "SCALAR" }}
  ],
  "bufferViews": [
    {{ "buffer": 0, "byteLength": {split} }},
    {{ "buffer": 0, "byteOffset": {split}, "byteLength": {} }}
  ],
  "buffers": [{{ "byteLength": {total}, "uri": "data:application/octet-stream;base64,{data}" }}]
}}
"#,
        total - split
    )
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let mut word = [0_u8; 4];
        word[1..=group.len()].copy_from_slice(group);
        let bits = u32::from_be_bytes(word);
        for digit in 0..4 {
            let sextet = (bits >> (18 - 6 * digit)) as usize % 64;
            text.push(if digit <= group.len() {
                DIGITS[sextet].into()
            } else {
                '='
            });
        }
    }
    text
}

#[test]
fn shipped_meshes_are_as_made() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/assets");
    for (name, made) in [("horseshoe.obj", horseshoe()), ("chair.gltf", chair())] {
        let path = folder.join(name);
        if std::env::var_os("SWARD_BLESS").is_some() {
            fs::write(&path, &made).expect("a writable folder");
        }
        let shipped = fs::read_to_string(&path).expect("a shipped mesh");
        assert!(
            shipped == made,
            "{name} differs from what is made; see the head of this file"
        );
    }
}

/// The signed volume, positive where the faces look outward, and the number of corners.
fn volume(name: &str) -> (f64, usize) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/assets");
    let mesh = read_mesh(name, &Folders::new([folder])).expect("a valid mesh");
    let place = |i: u32| mesh.positions[i as usize].map(f64::from);
    let sum = mesh.triangles.iter().map(|t| {
        let [a, b, c] = t.map(place);
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    });
    (sum.sum::<f64>() / 6.0, mesh.positions.len())
}

#[test]
fn shipped_meshes_are_closed_and_look_outward() {
    // Section area 0.2 · 0.16 less four corners of 0.03 · 0.03 / 2, along three quarters of a
    // ring of 0.4 m drawn as 24 chords: sin(x)/x of a step of 11.25° is lost, 0.6%.
    let (horseshoe, corners) = volume("horseshoe.obj");
    let ring = (0.2 * 0.16 - 4.0 * 0.00045) * 0.75 * std::f64::consts::TAU * 0.4;
    assert!(
        (horseshoe / ring - 0.9936).abs() < 1e-3,
        "{horseshoe} {ring}"
    );
    assert_eq!(corners, 8 * 25);
    let (chair, _) = volume("chair.gltf");
    let blocks = 4.0 * 0.12 * 0.12 * 0.40 + 0.52 * 0.52 * 0.12 + 0.52 * 0.12 * 0.44;
    assert!((chair - blocks).abs() < 1e-6, "{chair} {blocks}");
}
