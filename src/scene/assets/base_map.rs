//! 8-bit colour PNG pictures as base maps of the ground.

use png::{BitDepth, ColorType};

use super::ColourPicture;
use super::picture::{Wanted, unpack};
use crate::scene::error::AssetError;
use crate::scene::limits::{BASE_MAP_SIDE, BASE_MAP_TEXELS};

const BASE_MAP: Wanted = Wanted {
    formats: &[
        (ColorType::Rgb, BitDepth::Eight),
        (ColorType::Rgba, BitDepth::Eight),
    ],
    as_text: "an 8-bit RGB or RGBA PNG",
    side: BASE_MAP_SIDE,
    pixels: BASE_MAP_TEXELS,
    pixel_name: "texels",
};

/// Reads a base map; its size is checked before it is unpacked.
///
/// # Errors
/// No PNG, another colour type or depth, too large, or damaged.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<ColourPicture, AssetError> {
    let picture = unpack(file, bytes, &BASE_MAP)?;
    let texels = picture.bytes.chunks_exact(picture.bytes_per_pixel);
    Ok(ColourPicture {
        columns: picture.columns,
        rows: picture.rows,
        rgba8: texels.flat_map(|t| [t[0], t[1], t[2], 255]).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
        encoder.set_color(color);
        encoder.set_depth(depth);
        let mut writer = encoder.write_header().expect("a valid header");
        let written = writer.write_image_data(data);
        written.expect("as many bytes as the header says");
        drop(writer);
        bytes
    }

    #[test]
    fn alpha_is_ignored() {
        let rgb = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];
        let want = [1, 2, 3, 255, 4, 5, 6, 255, 7, 8, 9, 255, 10, 11, 12, 255];
        let from_rgb = read("m.png", &png(ColorType::Rgb, BitDepth::Eight, &rgb));
        assert_eq!(from_rgb.expect("valid").rgba8, want);
        let rgba: Vec<u8> = want.iter().map(|&b| if b == 255 { 7 } else { b }).collect();
        let from_rgba = read("m.png", &png(ColorType::Rgba, BitDepth::Eight, &rgba));
        assert_eq!(from_rgba.expect("valid").rgba8, want);
    }

    #[test]
    fn other_formats_are_named() {
        for (color, depth, bytes) in [
            (ColorType::Grayscale, BitDepth::Eight, 4),
            (ColorType::Rgb, BitDepth::Sixteen, 24),
        ] {
            let text = read("m.png", &png(color, depth, &vec![0; bytes]));
            let text = text.expect_err("no base map").to_string();
            assert!(text.contains("8-bit RGB or RGBA PNG is needed"), "{text}");
        }
    }
}
