//! Files a scene names, read and checked once.

use std::collections::BTreeMap;

/// Every asset of a scene, by the path the scene gives.
#[derive(Clone, Debug, Default)]
pub struct Assets {
    pub meshes: BTreeMap<String, TriangleMesh>,
    pub height_maps: BTreeMap<String, HeightMap>,
}

/// Triangles as a file gives them, unscaled.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    pub positions: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

/// A 16-bit grey picture; the first row lies at the smallest z.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeightMap {
    pub columns: u32,
    pub rows: u32,
    pub samples: Vec<u16>,
}
