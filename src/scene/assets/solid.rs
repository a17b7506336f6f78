//! Checks that triangles bound something solid, and tidies them.

use std::collections::HashMap;

use super::TriangleMesh;
use crate::scene::error::AssetError;
use crate::scene::extent::extents;
use crate::scene::limits::{MESH_TRIANGLES, MESH_VERTICES};

/// A mesh is flat if it is thinner than this share of its length: f32 positions of a tilted plane
/// scatter by about 1e-7 of their size.
const FLATNESS: f64 = 1e-5;

/// Merges equal positions, leaves out triangles without area (they bound nothing) and positions no
/// triangle uses.
///
/// # Errors
/// Positions that are not finite, indices out of range, a mesh over budget, without area or flat.
pub(super) fn checked(file: &str, raw: TriangleMesh) -> Result<TriangleMesh, AssetError> {
    check_numbers(file, &raw)?;
    let welded = weld(&raw);
    let no_solid = |reason: String| AssetError::NoSolid {
        file: file.to_owned(),
        reason,
    };
    if welded.triangles.is_empty() {
        let count = raw.triangles.len();
        return Err(no_solid(format!(
            "none of its {count} triangles has an area"
        )));
    }
    let [length, _, thickness] = extents(&welded.positions);
    if thickness <= FLATNESS * length {
        return Err(no_solid(format!(
            "it is flat, {thickness} thick at a length of {length}"
        )));
    }
    Ok(welded)
}

fn check_numbers(file: &str, mesh: &TriangleMesh) -> Result<(), AssetError> {
    let counts = [
        (mesh.positions.len() as u64, "vertices", MESH_VERTICES),
        (mesh.triangles.len() as u64, "triangles", MESH_TRIANGLES),
    ];
    for (count, what, limit) in counts {
        if count > limit {
            return Err(AssetError::OverBudget {
                file: file.to_owned(),
                count,
                what,
                limit,
            });
        }
    }
    let damaged = |reason: String| AssetError::Damaged {
        file: file.to_owned(),
        reason,
    };
    for (i, p) in mesh.positions.iter().enumerate() {
        if !p.iter().all(|x| x.is_finite()) {
            return Err(damaged(format!(
                "vertex {} is at {p:?}, which is no place",
                i + 1
            )));
        }
    }
    for (i, t) in mesh.triangles.iter().enumerate() {
        let count = mesh.positions.len();
        if let Some(bad) = t.iter().find(|&&v| v as usize >= count) {
            let (i, bad) = (i + 1, u64::from(*bad) + 1);
            return Err(damaged(format!(
                "triangle {i} names vertex {bad} of {count}"
            )));
        }
    }
    Ok(())
}

/// Expects indices in range.
fn weld(raw: &TriangleMesh) -> TriangleMesh {
    let mut index_of = HashMap::new();
    let mut mesh = TriangleMesh::default();
    for triangle in &raw.triangles {
        let corners = triangle.map(|i| raw.positions[i as usize]);
        if !has_area(corners) {
            continue;
        }
        mesh.triangles.push(corners.map(|p| {
            // Adding zero turns −0 into 0, its equal with other bits.
            let bits = p.map(|x| (x + 0.0).to_bits());
            *index_of.entry(bits).or_insert_with(|| {
                mesh.positions.push(p);
                // At most MESH_VERTICES positions, which was checked.
                (mesh.positions.len() - 1) as u32
            })
        }));
    }
    mesh
}

fn has_area([a, b, c]: [[f32; 3]; 3]) -> bool {
    let edge = |to: [f32; 3]| [0, 1, 2].map(|i| f64::from(to[i]) - f64::from(a[i]));
    let (u, v) = (edge(b), edge(c));
    let cross = [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ];
    cross.iter().any(|&x| x != 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> TriangleMesh {
        TriangleMesh {
            positions: vec![
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
            ],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        }
    }

    #[test]
    fn equal_positions_become_one() {
        let mut split = tetrahedron();
        split.positions.push([-0.0, 0.0, 0.0]);
        split.positions.push([9.0, 9.0, 9.0]);
        split.triangles[1][0] = 4;
        split.triangles.push([1, 1, 2]);
        let mesh = checked("t", split).expect("a solid");
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (4, 4));
    }

    #[test]
    fn what_is_no_solid_is_refused() {
        let reason = |change: fn(&mut TriangleMesh)| {
            let mut mesh = tetrahedron();
            change(&mut mesh);
            checked("t", mesh).expect_err("no solid").to_string()
        };
        assert!(reason(|m| m.triangles.clear()).contains("none of its 0 triangles"));
        assert!(reason(|m| m.positions[3] = [0.3, 0.3, 0.0]).contains("flat"));
        assert!(reason(|m| m.positions.fill([1.0; 3])).contains("has an area"));
        assert!(reason(|m| m.positions[2][0] = f32::NAN).contains("vertex 3"));
        assert!(reason(|m| m.triangles[3][1] = 7).contains("vertex 8 of 4"));
    }
}
