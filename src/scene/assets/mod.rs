//! Files a scene names, read and checked once.

mod base64;
mod base_map;
mod gltf;
mod gltf_buffers;
mod height_map;
mod noted;
mod obj;
mod picture;
mod solid;
mod source;

use std::collections::BTreeMap;

pub(super) use noted::Noted;
pub use source::{AssetSource, Embedded, Folders, InOrder};

use super::error::AssetError;
use super::limits::{ASSET_BYTES, ASSET_FILES};
use super::{Action, Body, Ground, Scene, Shape};

/// Every asset of a scene, by the path the scene gives.
#[derive(Clone, Debug, Default)]
pub struct Assets {
    pub meshes: BTreeMap<String, TriangleMesh>,
    pub height_maps: BTreeMap<String, HeightMap>,
    pub base_maps: BTreeMap<String, ColourPicture>,
    /// A hash of the bytes of every file that was read, those named by other assets included.
    pub file_hashes: BTreeMap<String, u64>,
}

/// Triangles as a file gives them, unscaled: finite positions, valid indices, no two equal
/// positions, no triangle without area, no unused position.
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

/// A colour picture; the first row lies at the smallest z.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColourPicture {
    pub columns: u32,
    pub rows: u32,
    /// Four bytes a texel: red, green and blue encoded as sRGB, and 255.
    pub rgba8: Vec<u8>,
}

/// Every body of a scene, spawned ones included, with its key.
pub(super) fn bodies_with_keys(scene: &Scene) -> impl Iterator<Item = (String, &Body)> {
    let present = scene.bodies.iter().enumerate();
    let spawned = scene.script.iter().enumerate();
    present
        .map(|(i, body)| (format!("bodies[{i}]"), body))
        .chain(spawned.filter_map(|(i, event)| match &event.action {
            Action::Spawn(body) => Some((format!("script[{i}].action"), body.as_ref())),
            _ => None,
        }))
}

/// Reads every asset of a scene, each file once.
///
/// # Errors
/// The key that names the file, and what is wrong with it.
pub(super) fn read_assets(
    scene: &Scene,
    source: &dyn AssetSource,
) -> Result<Assets, (String, AssetError)> {
    let mut assets = Assets::default();
    if let Ground::HeightMap { file, .. } = &scene.terrain.ground {
        let map = read_height_map(file, source);
        let map = map.map_err(|e| ("terrain.ground.file".to_owned(), e))?;
        assets.height_maps.insert(file.clone(), map);
    }
    if let Some(file) = &scene.terrain.base_map {
        let map = read_base_map(file, source);
        let map = map.map_err(|e| ("terrain.base_map".to_owned(), e))?;
        assets.base_maps.insert(file.clone(), map);
    }
    for (key, body) in bodies_with_keys(scene) {
        let Shape::Mesh { file, .. } = &body.shape else {
            continue;
        };
        if assets.meshes.contains_key(file) {
            continue;
        }
        let mesh = if assets.meshes.len() + assets.height_maps.len() + assets.base_maps.len()
            < ASSET_FILES
        {
            read_mesh(file, source)
        } else {
            Err(AssetError::OverBudget {
                file: file.clone(),
                count: ASSET_FILES as u64 + 1,
                what: "different asset files before it in the scene, itself included",
                limit: ASSET_FILES as u64,
            })
        };
        let mesh = mesh.map_err(|e| (format!("{key}.shape.file"), e))?;
        assets.meshes.insert(file.clone(), mesh);
    }
    Ok(assets)
}

/// Reads and checks a mesh; the file's ending tells the format.
///
/// # Errors
/// A file that cannot be found or read, is over budget, damaged, or holds no solid.
pub fn read_mesh(file: &str, source: &dyn AssetSource) -> Result<TriangleMesh, AssetError> {
    let ending = ending_of(file);
    let read: fn(&str, &[u8], &dyn AssetSource) -> Result<_, AssetError> = match ending.as_str() {
        "obj" => |file, bytes, _| obj::read(file, bytes),
        "gltf" | "glb" => gltf::read,
        _ => {
            return Err(AssetError::Format {
                file: file.to_owned(),
                found: format!("a `.{ending}` file"),
                wanted: "an .obj, .gltf or .glb file",
            });
        }
    };
    let bytes = source.read(file, ASSET_BYTES)?;
    let triangles = guarded(file, || read(file, &bytes, source))?;
    solid::checked(file, triangles)
}

/// Reads a 16-bit grey PNG.
///
/// # Errors
/// A file that cannot be found or read, is of another format, too large or damaged.
pub fn read_height_map(file: &str, source: &dyn AssetSource) -> Result<HeightMap, AssetError> {
    let bytes = source.read(file, ASSET_BYTES)?;
    guarded(file, || height_map::read(file, &bytes))
}

/// Reads an 8-bit colour PNG.
///
/// # Errors
/// A file that cannot be found or read, is of another format, too large or damaged.
pub fn read_base_map(file: &str, source: &dyn AssetSource) -> Result<ColourPicture, AssetError> {
    let bytes = source.read(file, ASSET_BYTES)?;
    guarded(file, || base_map::read(file, &bytes))
}

fn ending_of(file: &str) -> String {
    let path = std::path::Path::new(file);
    path.extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase()
}

/// Runs a reader of foreign bytes; a panic inside its package becomes an error.
fn guarded<T>(file: &str, read: impl FnOnce() -> Result<T, AssetError>) -> Result<T, AssetError> {
    // Nothing the reader leaves half done outlives the call: it only owns what it returns.
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(read)).unwrap_or_else(|_| {
        Err(AssetError::Damaged {
            file: file.to_owned(),
            reason: "its reader gave up on it".to_owned(),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_formats_are_named() {
        let error = read_mesh("cow.stl", &Embedded(&[])).expect_err("no reader");
        assert!(error.to_string().contains("`.stl`"), "{error}");
    }

    #[test]
    fn a_panic_becomes_an_error() {
        let error = guarded::<()>("x.obj", || panic!("on purpose")).expect_err("caught");
        assert!(matches!(error, AssetError::Damaged { .. }));
    }
}
