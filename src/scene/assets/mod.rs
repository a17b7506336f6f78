//! Files a scene names, read and checked once.

mod base64;
mod base_map;
mod cover_maps;
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
use super::{Action, Billboards, Body, Ground, Scene, Shape};

/// Every asset of a scene, by the path the scene gives.
#[derive(Clone, Debug, Default)]
pub struct Assets {
    pub meshes: BTreeMap<String, TriangleMesh>,
    pub height_maps: BTreeMap<String, HeightMap>,
    pub base_maps: BTreeMap<String, ColourPicture>,
    /// Extent and messiness of billboards.
    pub grey_maps: BTreeMap<String, GreyMap>,
    pub direction_maps: BTreeMap<String, DirectionMap>,
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

/// A grey picture; the first row lies at the smallest z.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GreyMap {
    pub columns: u32,
    pub rows: u32,
    /// Black is 0, white 65535.
    pub samples: Vec<u16>,
}

/// A picture of directions, all of which rise; the first row lies at the smallest z.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DirectionMap {
    pub columns: u32,
    pub rows: u32,
    /// A byte b means 2 b/255 − 1, along x, y and z.
    pub texels: Vec<[u8; 3]>,
}

impl Assets {
    /// Files that have been read.
    fn count(&self) -> usize {
        let pictures = self.height_maps.len() + self.base_maps.len();
        self.meshes.len() + pictures + self.grey_maps.len() + self.direction_maps.len()
    }

    /// Columns and rows of a map of billboards, by its key and its file.
    pub(super) fn cover_map_size(&self, key: &str, file: &str) -> Option<[u32; 2]> {
        if key == "direction" {
            let map = self.direction_maps.get(file)?;
            return Some([map.columns, map.rows]);
        }
        let map = self.grey_maps.get(file)?;
        Some([map.columns, map.rows])
    }
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
    read_cover_maps(scene, source, &mut assets)?;
    for (key, body) in bodies_with_keys(scene) {
        let Shape::Mesh { file, .. } = &body.shape else {
            continue;
        };
        if assets.meshes.contains_key(file) {
            continue;
        }
        let mesh = if assets.count() < ASSET_FILES {
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

fn read_cover_maps(
    scene: &Scene,
    source: &dyn AssetSource,
    assets: &mut Assets,
) -> Result<(), (String, AssetError)> {
    for (key, file) in scene.billboards.iter().flat_map(Billboards::maps) {
        let at_key = |error| (format!("billboards.{key}"), error);
        let bytes = source.read(file, ASSET_BYTES).map_err(at_key)?;
        if key == "direction" {
            let map = guarded(file, || cover_maps::read_direction(file, &bytes));
            let map = map.map_err(at_key)?;
            assets.direction_maps.insert(file.clone(), map);
        } else {
            let map = guarded(file, || cover_maps::read_grey(file, &bytes));
            assets.grey_maps.insert(file.clone(), map.map_err(at_key)?);
        }
    }
    Ok(())
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
