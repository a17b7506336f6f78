//! Wavefront OBJ: vertices and faces; polygons become fans of triangles, materials are not read.

use std::collections::HashMap;

use tobj::LoadOptions;

use super::TriangleMesh;
use crate::scene::error::AssetError;
use crate::scene::limits::{MESH_TRIANGLES, MESH_VERTICES};

/// Reads the surface of an OBJ file.
///
/// # Errors
/// A text over budget, counted before anything is built, or damaged.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<TriangleMesh, AssetError> {
    count(file, bytes)?;
    let options = LoadOptions {
        single_index: true,
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let no_materials = |_: &std::path::Path| Ok((Vec::new(), HashMap::new()));
    let (models, _) = tobj::load_obj_buf(&mut &*bytes, &options, no_materials).map_err(|e| {
        AssetError::Damaged {
            file: file.to_owned(),
            reason: format!("it is no valid OBJ: {e}"),
        }
    })?;
    let mut all = TriangleMesh::default();
    for model in &models {
        // At most MESH_VERTICES corners were counted, so the sum fits.
        let first = all.positions.len() as u32;
        let (positions, _) = model.mesh.positions.as_chunks::<3>();
        let (triangles, _) = model.mesh.indices.as_chunks::<3>();
        all.positions.extend_from_slice(positions);
        let shifted = triangles.iter().map(|t| t.map(|i| i.saturating_add(first)));
        all.triangles.extend(shifted);
    }
    Ok(all)
}

/// Counts vertices and triangles in the text itself.
fn count(file: &str, bytes: &[u8]) -> Result<(), AssetError> {
    let (mut vertices, mut triangles) = (0_u64, 0_u64);
    for line in bytes.split(|&b| b == b'\n') {
        let mut words = line
            .split(|b| b.is_ascii_whitespace())
            .filter(|w| !w.is_empty());
        match words.next() {
            Some(b"v") => vertices += 1,
            Some(b"f") => triangles += (words.count() as u64).saturating_sub(2),
            _ => {}
        }
    }
    let over = |count, what, limit| AssetError::OverBudget {
        file: file.to_owned(),
        count,
        what,
        limit,
    };
    if vertices > MESH_VERTICES {
        return Err(over(vertices, "vertices", MESH_VERTICES));
    }
    if triangles > MESH_TRIANGLES {
        return Err(over(triangles, "triangles", MESH_TRIANGLES));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: &str = "\
# four points
mtllib nowhere.mtl
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
vn 0 0 1
usemtl none
f 1//1 3//1 2//1
f 1 2 4
o second
f -4 -1 -2
f 2 3 4
";

    #[test]
    fn faces_of_every_spelling() {
        let mesh = read("t.obj", TETRAHEDRON.as_bytes()).expect("valid");
        assert_eq!(mesh.triangles.len(), 4);
        for triangle in &mesh.triangles {
            for &i in triangle {
                assert!((i as usize) < mesh.positions.len());
            }
        }
    }

    #[test]
    fn polygons_become_fans() {
        let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 1 0\nf 1 2 3 4 5\n";
        let mesh = read("s.obj", square.as_bytes()).expect("valid");
        assert_eq!(mesh.triangles.len(), 3);
    }

    #[test]
    fn bad_faces_are_refused() {
        for bad in [
            "v 0 0 0\nf 1 2 3\n",
            "v 0 0\n",
            "v 0 0 0\nf 1 x 1\n",
            "v 0 0 0\nf 0 0 0\n",
        ] {
            assert!(read("bad.obj", bad.as_bytes()).is_err(), "{bad:?}");
        }
    }

    #[test]
    fn too_many_triangles_are_counted_first() {
        let mut text = String::from("v 0 0 0\n");
        for _ in 0..20 {
            text.push_str(&format!("f{}\n", " 1".repeat(10_003)));
        }
        let error = read("big.obj", text.as_bytes()).expect_err("over budget");
        assert!(
            matches!(error, AssetError::OverBudget { count: 200_020, .. }),
            "{error}"
        );
    }
}
