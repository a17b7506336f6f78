//! glTF 2.0, as text or binary: the triangles of one scene, with the nodes' transforms applied.
//!
//! The `gltf` package trusts its input more than a scene may: it panics on a binary header that is
//! too short, follows links out of the folder, and lets nodes be their own children. So lengths,
//! counts and the tree of nodes are checked here, and buffers are found by `gltf_buffers`.

use std::borrow::Cow;
use std::collections::HashSet;

use gltf::json::Root;
use gltf::mesh::Mode;
use gltf::{Document, Glb, Node, Primitive, Semantic};

use super::gltf_buffers::Buffers;
use super::{AssetSource, TriangleMesh};
use crate::scene::error::AssetError;
use crate::scene::limits::{GLTF_DEPTH, GLTF_OBJECTS, MESH_TRIANGLES, MESH_VERTICES};

/// Rows of an affine transform: the last column is the shift.
type Affine = [[f64; 4]; 3];

const IDENTITY: Affine = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
];
const HEADER_BYTES: usize = 12;

/// Reads the surface of a `.gltf` or `.glb` file; `source` gives its separate buffers.
///
/// # Errors
/// A file over budget or damaged, a buffer that cannot be read, or anything but plain triangles.
pub(super) fn read(
    file: &str,
    bytes: &[u8],
    source: &dyn AssetSource,
) -> Result<TriangleMesh, AssetError> {
    let (document, binary) = parse(file, bytes)?;
    let buffers = Buffers::read(file, &document, binary, source)?;
    let mut surface = Surface {
        file,
        buffers,
        visited: HashSet::new(),
        mesh: TriangleMesh::default(),
    };
    for root in roots(&document) {
        surface.add_tree(&root)?;
    }
    Ok(surface.mesh)
}

/// A binary file's chunk of bytes beside its JSON.
type BinaryChunk<'a> = Option<Cow<'a, [u8]>>;

fn parse<'a>(file: &str, bytes: &'a [u8]) -> Result<(Document, BinaryChunk<'a>), AssetError> {
    let invalid = |e: String| damaged(file, format!("it is no valid glTF: {e}"));
    let (text, binary) = if bytes.starts_with(b"glTF") {
        let said = bytes.get(8..HEADER_BYTES).and_then(|b| b.try_into().ok());
        let said = said.map_or(0, u32::from_le_bytes) as usize;
        if said < HEADER_BYTES || said > bytes.len() {
            let is = bytes.len();
            return Err(invalid(format!(
                "its header says {said} bytes, it has {is}"
            )));
        }
        let glb = Glb::from_slice(bytes).map_err(|e| invalid(e.to_string()))?;
        (glb.json, glb.bin)
    } else {
        (bytes.into(), None)
    };
    let objects = count_objects(&text);
    if objects > GLTF_OBJECTS {
        return Err(AssetError::OverBudget {
            file: file.to_owned(),
            count: objects,
            what: "JSON objects",
            limit: GLTF_OBJECTS,
        });
    }
    let root: Root =
        gltf::json::deserialize::from_slice(&text).map_err(|e| invalid(e.to_string()))?;
    let document = Document::from_json(root).map_err(|e| invalid(e.to_string()))?;
    Ok((document, binary))
}

/// Opening braces outside of strings.
fn count_objects(json: &[u8]) -> u64 {
    let (mut objects, mut in_string, mut escaped) = (0, false, false);
    for &byte in json {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_string => escaped = true,
            b'"' => in_string = !in_string,
            b'{' if !in_string => objects += 1,
            _ => {}
        }
    }
    objects
}

/// The nodes of the default scene, of the first one, or those that are no node's child.
fn roots(document: &Document) -> Vec<Node<'_>> {
    if let Some(scene) = document
        .default_scene()
        .or_else(|| document.scenes().next())
    {
        return scene.nodes().collect();
    }
    let children: HashSet<usize> = document
        .nodes()
        .flat_map(|n| n.children().map(|c| c.index()).collect::<Vec<_>>())
        .collect();
    document
        .nodes()
        .filter(|n| !children.contains(&n.index()))
        .collect()
}

struct Surface<'a> {
    file: &'a str,
    buffers: Buffers<'a>,
    visited: HashSet<usize>,
    mesh: TriangleMesh,
}

impl Surface<'_> {
    /// Adds a node and all below it.
    fn add_tree(&mut self, root: &Node<'_>) -> Result<(), AssetError> {
        let mut waiting = vec![(root.clone(), IDENTITY, 1)];
        while let Some((node, parent, depth)) = waiting.pop() {
            let index = node.index();
            if !self.visited.insert(index) {
                let reason = format!("node {index} hangs in its tree of nodes more than once");
                return Err(damaged(self.file, reason));
            }
            if depth > GLTF_DEPTH {
                return Err(AssetError::OverBudget {
                    file: self.file.to_owned(),
                    count: depth as u64,
                    what: "levels of nodes",
                    limit: GLTF_DEPTH as u64,
                });
            }
            let file_from_node = compose(&parent, &affine(&node));
            if let Some(mesh) = node.mesh() {
                for primitive in mesh.primitives() {
                    self.add_primitive(&primitive, &file_from_node)?;
                }
            }
            waiting.extend(node.children().map(|c| (c, file_from_node, depth + 1)));
        }
        Ok(())
    }

    fn add_primitive(
        &mut self,
        primitive: &Primitive<'_>,
        file_from_node: &Affine,
    ) -> Result<(), AssetError> {
        if primitive.mode() != Mode::Triangles {
            let found = format!("made of {:?}", primitive.mode());
            return Err(AssetError::Format {
                file: self.file.to_owned(),
                found,
                wanted: "a mesh of separate triangles",
            });
        }
        let positions = primitive.get(&Semantic::Positions).ok_or_else(|| {
            damaged(
                self.file,
                "a mesh in it has no POSITION attribute".to_owned(),
            )
        })?;
        let first = self.mesh.positions.len();
        self.budget(
            first as u64 + positions.count() as u64,
            "vertices",
            MESH_VERTICES,
        )?;
        let positions = self.buffers.positions(&positions)?;
        let corners = match primitive.indices() {
            Some(indices) => {
                let triangles = (self.mesh.triangles.len() + indices.count() / 3) as u64;
                self.budget(triangles, "triangles", MESH_TRIANGLES)?;
                self.buffers.indices(&indices)?
            }
            None => (0..positions.len() as u32).collect(),
        };
        let placed = positions.iter().map(|&p| transform(file_from_node, p));
        self.mesh.positions.extend(placed);
        // A mirror turns every triangle inside out; swapping two corners turns it back.
        let mirrored = determinant(file_from_node) < 0.0;
        let (triangles, _) = corners.as_chunks::<3>();
        for triangle in triangles {
            // Both terms are below 2³²; a sum that is not names no vertex and is refused later.
            let [a, b, c] = triangle.map(|i| i.saturating_add(first as u32));
            self.mesh
                .triangles
                .push(if mirrored { [a, c, b] } else { [a, b, c] });
        }
        Ok(())
    }

    fn budget(&self, count: u64, what: &'static str, limit: u64) -> Result<(), AssetError> {
        if count <= limit {
            return Ok(());
        }
        Err(AssetError::OverBudget {
            file: self.file.to_owned(),
            count,
            what,
            limit,
        })
    }
}

fn affine(node: &Node<'_>) -> Affine {
    let columns = node.transform().matrix();
    [0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| f64::from(columns[column][row])))
}

fn compose(outer: &Affine, inner: &Affine) -> Affine {
    outer.map(|row| {
        [0, 1, 2, 3].map(|c| {
            let shift = if c == 3 { row[3] } else { 0.0 };
            row[0] * inner[0][c] + row[1] * inner[1][c] + row[2] * inner[2][c] + shift
        })
    })
}

fn transform(affine: &Affine, p: [f32; 3]) -> [f32; 3] {
    let p = p.map(f64::from);
    affine.map(|row| (row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]) as f32)
}

fn determinant([a, b, c]: &Affine) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

pub(super) fn damaged(file: &str, reason: String) -> AssetError {
    AssetError::Damaged {
        file: file.to_owned(),
        reason,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::assets::{Embedded, read_mesh};

    /// A tetrahedron: four positions, then four triangles of 16-bit indices.
    fn buffer() -> Vec<u8> {
        let positions = [
            [0.0_f32, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ];
        let corners = [0_u16, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
        let positions = positions.iter().flatten().flat_map(|x| x.to_le_bytes());
        positions
            .chain(corners.iter().flat_map(|i| i.to_le_bytes()))
            .collect()
    }

    fn json(nodes: &str, uri: &str) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
            "accessors":[
              {{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}},
              {{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}}],
            "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":24}}],
            "buffers":[{{{uri}"byteLength":72}}]}}"#
        )
    }

    fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
        let mut text = json.as_bytes().to_vec();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bytes = b"glTF".to_vec();
        let total = 12 + 8 + text.len() + 8 + binary.len();
        for word in [2, total as u32, text.len() as u32] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(b"JSON");
        bytes.extend(text);
        bytes.extend((binary.len() as u32).to_le_bytes());
        bytes.extend(b"BIN\0");
        bytes.extend(binary);
        bytes
    }

    fn read_with(json: &str, buffers: &[(&str, &[u8])]) -> Result<TriangleMesh, AssetError> {
        let mut files = vec![("a/t.gltf", json.as_bytes())];
        files.extend(buffers);
        read_mesh("a/t.gltf", &Embedded(&files))
    }

    #[test]
    fn a_buffer_beside_the_file_and_a_moved_node() {
        let json = json(
            r#"{"mesh":0,"translation":[0,5,0],"scale":[2,2,2]}"#,
            r#""uri":"my%20t.bin","#,
        );
        let mesh = read_with(&json, &[("a/my t.bin", &buffer())]).expect("valid");
        assert_eq!(mesh.triangles.len(), 4);
        assert!(
            mesh.positions.contains(&[0.0, 7.0, 0.0]),
            "{:?}",
            mesh.positions
        );
    }

    #[test]
    fn a_binary_file_and_a_child_under_a_mirror() {
        let nodes = r#"{"children":[1],"scale":[-1,1,1]},{"mesh":0,"translation":[1,0,0]}"#;
        let bytes = glb(&json(nodes, ""), &buffer());
        let mesh = read_mesh("t.glb", &Embedded(&[("t.glb", &bytes)])).expect("valid");
        assert!(
            mesh.positions.contains(&[-2.0, 0.0, 0.0]),
            "{:?}",
            mesh.positions
        );
        // Outward faces stay outward: the signed volume of the tetrahedron stays +1/6.
        let volume: f32 = mesh
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                    + a[2] * (b[0] * c[1] - b[1] * c[0]))
                    / 6.0
            })
            .sum();
        assert!((volume - 1.0 / 6.0).abs() < 1e-6, "{volume}");
    }

    #[test]
    fn every_cut_of_a_binary_file_is_refused() {
        let bytes = glb(&json(r#"{"mesh":0}"#, ""), &buffer());
        for length in 0..bytes.len() {
            let cut = &bytes[..length];
            assert!(read("t.glb", cut, &Embedded(&[])).is_err(), "{length}");
        }
        let mut short = bytes.clone();
        short[8..12].copy_from_slice(&3_u32.to_le_bytes());
        assert!(read("t.glb", &short, &Embedded(&[])).is_err());
        // Twelve bytes that promise four gigabytes.
        let mut promise = b"glTF".to_vec();
        promise.extend([2, 0, 0, 0, 255, 255, 255, 255]);
        assert!(read("t.glb", &promise, &Embedded(&[])).is_err());
    }

    #[test]
    fn trees_that_are_none_are_refused() {
        for nodes in [
            r#"{"mesh":0,"children":[0]}"#,
            r#"{"children":[1]},{"children":[0]}"#,
            r#"{"children":[1,1]},{"mesh":0}"#,
        ] {
            let bytes = glb(&json(nodes, ""), &buffer());
            let text = read("t.glb", &bytes, &Embedded(&[]))
                .expect_err(nodes)
                .to_string();
            assert!(text.contains("more than once"), "{text}");
        }
    }

    #[test]
    fn buffers_stay_inside_and_whole() {
        let text = |uri: &str| {
            let json = json(r#"{"mesh":0}"#, &format!(r#""uri":"{uri}","#));
            read_with(&json, &[("a/short.bin", &[1, 2])])
                .expect_err(uri)
                .to_string()
        };
        assert!(text("%FF").contains("%FF"));
        assert!(text("short.bin").contains("2 of the 72 bytes"));
        assert!(text("missing.bin").contains("a/missing.bin"));
        assert!(text("https://example.org/t.bin").contains("https"));
        assert!(text("data:application/octet-stream;base64,!!").contains("base64"));
        let cut = json(r#"{"mesh":0}"#, "").replace("\"byteLength\":48", "\"byteLength\":40");
        let bytes = glb(&cut, &buffer());
        assert!(read("t.glb", &bytes, &Embedded(&[])).is_err());
    }

    #[test]
    fn objects_are_counted_outside_strings() {
        assert_eq!(count_objects(br#"{"a{\"{":[{},{}]}"#), 3);
    }
}
