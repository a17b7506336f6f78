//! Files that scenes name and that cannot be used.

use std::fs;
use std::path::PathBuf;

use sward::scene::load_scene;

/// A folder of its own that goes when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("sward-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        fs::create_dir_all(path.parent().expect("inside the folder")).expect("a folder");
        fs::write(&path, bytes).expect("a temporary file");
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A folder that stays behind must not hide why the test failed.
        let _ = fs::remove_dir_all(&self.0);
    }
}

pub const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

#[test]
fn assets_that_cannot_be_used() {
    let folder = Folder::new("assets");
    folder.write("scenes/good.obj", TETRAHEDRON);
    folder.write("outside.obj", TETRAHEDRON);
    folder.write("scenes/flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("scenes/line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    folder.write(
        "scenes/nan.obj",
        TETRAHEDRON.replace("v 1 0 0", "v nan 0 0"),
    );
    folder.write(
        "scenes/big.obj",
        TETRAHEDRON.replace("v 1 0 0", "v 1e39 0 0"),
    );
    folder.write("scenes/short.glb", b"glTF\x02\0\0\0\xff\xff\xff\xff");
    folder.write("scenes/picture.png", "no picture");
    let outside = folder.0.join("outside.obj").display().to_string();
    let mesh = |file: &str, scale: &str| {
        format!("(bodies: [\n(name: \"a\", shape: Mesh(file: {file:?}{scale}))])")
    };
    let cases = [
        (
            mesh("none.obj", ""),
            "2:31",
            "file",
            "in none of the folders looked in",
        ),
        (mesh("../outside.obj", ""), "2:31", "file", "stays inside"),
        (mesh(&outside, ""), "2:31", "file", "stays inside"),
        (mesh("", ""), "2:31", "file", "`.` file"),
        (mesh("good.stl", ""), "2:31", "file", ".obj, .gltf or .glb"),
        (mesh("flat.obj", ""), "2:31", "file", "flat"),
        (
            mesh("line.obj", ""),
            "2:31",
            "file",
            "none of its 1 triangles has an area",
        ),
        (mesh("nan.obj", ""), "2:31", "file", "vertex"),
        (mesh("big.obj", ""), "2:31", "file", "vertex"),
        (mesh("short.glb", ""), "2:31", "file", "4294967295 bytes"),
        (
            mesh("good.obj", ", scale: 1000"),
            "2:50",
            "scale",
            "0.001 to 100 m",
        ),
    ];
    for (source, place, field, says) in cases {
        let path = folder.write("scenes/s.ron", &source);
        let text = load_scene(&path, &[]).expect_err(&source).to_string();
        let head = format!("{}:{place}: bodies[0].shape.{field}: ", path.display());
        assert!(
            text.starts_with(&head) && text.contains(says),
            "{source}\n{text}"
        );
    }
    let map = "(terrain: (ground: HeightMap(file: \"picture.png\", spacing_m: 1, height_m: 2)))";
    let path = folder.write("scenes/s.ron", map);
    let text = load_scene(&path, &[]).expect_err(map).to_string();
    assert!(
        text.contains("s.ron:1:36: terrain.ground.file: `picture.png` is damaged"),
        "{text}"
    );
    let path = folder.write("scenes/s.ron", mesh("outside.obj", ""));
    assert!(load_scene(&path, &[]).is_err());
    let found = load_scene(&path, std::slice::from_ref(&folder.0)).expect("found by --assets");
    assert_eq!(found.assets.meshes["outside.obj"].triangles.len(), 4);
    let path = folder.write("scenes/latin.ron", b"(\n// gr\xfc\xdf\n)");
    let text = load_scene(&path, &[]).expect_err("no UTF-8").to_string();
    assert!(
        text.contains("latin.ron:2:6: scene: the file is no UTF-8 text"),
        "{text}"
    );
}

/// A PNG of a size and pixel format, all of one value.
fn plain_png([columns, rows]: [u32; 2], colour: png::ColorType, depth: png::BitDepth) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns, rows);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().expect("a valid header");
    let bits = colour.samples() * depth as usize;
    let data = vec![7; (columns as usize * bits).div_ceil(8) * rows as usize];
    writer.write_image_data(&data).expect("as many bytes");
    drop(writer);
    bytes
}

/// A base map has a resolution of its own, but the ground's proportions and one of two pixel formats.
#[test]
fn base_maps_that_cannot_be_used() {
    use png::{BitDepth, ColorType};
    let folder = Folder::new("base-maps");
    let scene = "(terrain: (ground: Flat(size_m: (8, 4)),\n base_map: \"map.png\"))";
    let path = folder.write("s.ron", scene);
    let load = |size, colour, depth| {
        folder.write("map.png", plain_png(size, colour, depth));
        load_scene(&path, &[]).map_err(|error| error.to_string())
    };
    for size in [[8, 4], [32, 16], [31, 16]] {
        let loaded = load(size, ColorType::Rgb, BitDepth::Eight);
        assert!(loaded.is_ok(), "{size:?}: {loaded:?}");
    }
    assert!(load([32, 16], ColorType::Rgba, BitDepth::Eight).is_ok());
    for (size, colour, depth, says) in [
        (
            [32, 32],
            ColorType::Rgb,
            BitDepth::Eight,
            "for 32 columns it needs 16 rows",
        ),
        (
            [32, 17],
            ColorType::Rgb,
            BitDepth::Eight,
            "for 32 columns it needs 16 rows",
        ),
        ([32, 16], ColorType::Grayscale, BitDepth::Eight, "8-bit RGB"),
        ([32, 16], ColorType::Rgb, BitDepth::Sixteen, "8-bit RGB"),
    ] {
        let text = load(size, colour, depth).expect_err("of no use");
        let head = format!("{}:2:12: terrain.base_map: ", path.display());
        assert!(text.starts_with(&head) && text.contains(says), "{text}");
    }
}
