//! Makes the maps of billboards in `scenes/assets`, and checks that the files hold what is made here.
//!
//! `SWARD_BLESS=1 cargo test --release --lib shipped_maps` writes them anew.

use std::fs;
use std::path::Path;

use png::{BitDepth, ColorType, Decoder, Encoder};

use crate::base::philox::{philox2x32, unit};

/// Texels along a side.
const SIDE: u32 = 192;
/// Middle of the clearing, as shares of the sides.
const CLEARING: [f64; 2] = [0.72, 0.7];

/// Smooth noise in −1…1 at a place in lattice cells.
fn noise(x: f64, z: f64, key: u32) -> f64 {
    let (i, j) = (x.floor(), z.floor());
    let at = |di: f64, dj: f64| {
        let counter = [(i + di) as i64 as u32, (j + dj) as i64 as u32];
        2.0 * f64::from(unit(philox2x32(counter, key, 4)[0])) - 1.0
    };
    let [u, v] = [x - i, z - j].map(|t| t * t * (3.0 - 2.0 * t));
    let low = at(0.0, 0.0) * (1.0 - u) + at(1.0, 0.0) * u;
    let high = at(0.0, 1.0) * (1.0 - u) + at(1.0, 1.0) * u;
    low * (1.0 - v) + high * v
}

/// 0 below `low`, 1 above `high`, smooth between.
fn smooth(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Raggedness of borders.
fn ragged(x: f64, z: f64) -> f64 {
    0.02 * noise(14.0 * x, 14.0 * z, 1) + 0.01 * noise(37.0 * x, 37.0 * z, 2)
}

/// Distance from the middle of a path that winds along x.
fn from_path(x: f64, z: f64) -> f64 {
    let middle = 0.3 + 0.1 * libm::sin(5.2 * x + 0.6) + 0.015 * noise(9.0 * x, 0.0, 3);
    (z - middle).abs()
}

fn from_clearing(x: f64, z: f64) -> [f64; 3] {
    let [dx, dz] = [x - CLEARING[0], z - CLEARING[1]];
    [dx, dz, libm::hypot(dx, dz) + 1e-9]
}

/// How much the clumps whirl about the clearing, 0…1.
fn whirl(x: f64, z: f64) -> f64 {
    let [.., away] = from_clearing(x, z);
    libm::exp(-(away / 0.28) * (away / 0.28))
}

fn byte(share: f64) -> u8 {
    (255.0 * share.clamp(0.0, 1.0)).round() as u8
}

/// A meadow with a ragged border, a path through it, a clearing, and thinner patches.
fn extent(x: f64, z: f64) -> Vec<u8> {
    let rag = ragged(x, z);
    let inside = x.min(z).min(1.0 - x).min(1.0 - z) + rag;
    let [.., away] = from_clearing(x, z);
    let grown = smooth(0.02, 0.05, inside)
        * smooth(0.022, 0.036, from_path(x, z) + 0.5 * rag)
        * smooth(0.075, 0.1, away + 1.5 * rag);
    let patches = noise(7.0 * x, 7.0 * z, 4) + 0.4 * noise(19.0 * x, 19.0 * z, 5);
    vec![byte(grown * (0.72 + 0.28 * smooth(-0.4, 0.3, patches)))]
}

/// Combed along +x, and whirled about the clearing.
fn direction(x: f64, z: f64) -> Vec<u8> {
    let [dx, dz, away] = from_clearing(x, z);
    let whirl = whirl(x, z);
    let lean = 2.0 * (0.18 + 0.55 * whirl);
    let way = [
        lean * (-dz / away * whirl + 0.5 * (1.0 - whirl)),
        1.0,
        lean * (dx / away * whirl + 0.12 * noise(5.0 * x, 5.0 * z, 6)),
    ];
    let length = way.iter().map(|c| c * c).sum::<f64>().sqrt();
    way.map(|c| byte(0.5 + 0.5 * c / length)).to_vec()
}

/// Tidy in the whirl and along the path, wild elsewhere.
fn messiness(x: f64, z: f64) -> Vec<u8> {
    let trodden = smooth(0.12, 0.03, from_path(x, z));
    let patches = 0.2 * noise(6.0 * x, 6.0 * z, 7);
    vec![byte(0.75 - 0.6 * whirl(x, z) - 0.25 * trodden + patches)]
}

/// Bytes of the texel at shares of the sides.
type Texel = fn(f64, f64) -> Vec<u8>;

fn made(texel: Texel) -> Vec<u8> {
    let middle = |n: u32| (f64::from(n) + 0.5) / f64::from(SIDE);
    (0..SIDE)
        .flat_map(|row| (0..SIDE).map(move |column| [middle(column), middle(row)]))
        .flat_map(|[x, z]| texel(x, z))
        .collect()
}

fn write(path: &Path, colour: ColorType, texels: &[u8]) {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, SIDE, SIDE);
    encoder.set_color(colour);
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header().expect("a valid header");
    let written = writer.write_image_data(texels);
    written.expect("as many bytes as the header says");
    drop(writer);
    fs::write(path, bytes).expect("a writable folder");
}

fn read(path: &Path) -> Vec<u8> {
    let bytes = fs::read(path).expect("a shipped map");
    let decoder = Decoder::new(std::io::Cursor::new(bytes));
    let mut reader = decoder.read_info().expect("a valid picture");
    let mut texels = vec![0; reader.output_buffer_size().expect("it fits")];
    reader.next_frame(&mut texels).expect("a whole picture");
    texels
}

#[test]
fn shipped_maps_are_as_made() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/assets");
    let maps: [(&str, ColorType, Texel); 3] = [
        ("clumps_extent.png", ColorType::Grayscale, extent),
        ("clumps_direction.png", ColorType::Rgb, direction),
        ("clumps_messiness.png", ColorType::Grayscale, messiness),
    ];
    for (name, colour, texel) in maps {
        let (path, made) = (folder.join(name), made(texel));
        if std::env::var_os("SWARD_BLESS").is_some() {
            write(&path, colour, &made);
        }
        assert!(read(&path) == made, "{name} differs from what is made");
    }
}
