//! PNG pictures that say how billboards grow: grey shares and RGB directions.

use png::{BitDepth, ColorType};

use super::picture::{Wanted, unpack};
use super::{DirectionMap, GreyMap};
use crate::scene::error::AssetError;
use crate::scene::limits::{COVER_MAP_SIDE, COVER_MAP_TEXELS, LEAST_DIRECTION};

const GREY: Wanted = Wanted {
    formats: &[
        (ColorType::Grayscale, BitDepth::Eight),
        (ColorType::Grayscale, BitDepth::Sixteen),
    ],
    as_text: "an 8-bit or 16-bit grey PNG without transparency",
    side: COVER_MAP_SIDE,
    pixels: COVER_MAP_TEXELS,
    pixel_name: "texels",
};

const DIRECTIONS: Wanted = Wanted {
    formats: &[(ColorType::Rgb, BitDepth::Eight)],
    as_text: "an 8-bit RGB PNG without transparency",
    ..GREY
};

/// Reads a grey map; its size is checked before it is unpacked. A byte b becomes 257 b, so that white
/// stays white.
///
/// # Errors
/// No PNG, another colour type or depth, too large, or damaged.
pub(super) fn read_grey(file: &str, bytes: &[u8]) -> Result<GreyMap, AssetError> {
    let picture = unpack(file, bytes, &GREY)?;
    let samples = if picture.bytes_per_pixel == 1 {
        picture.bytes.iter().map(|&b| u16::from(b) * 257).collect()
    } else {
        let (pairs, _) = picture.bytes.as_chunks::<2>();
        pairs.iter().map(|&p| u16::from_be_bytes(p)).collect()
    };
    Ok(GreyMap {
        columns: picture.columns,
        rows: picture.rows,
        samples,
    })
}

/// Reads a direction map; its size is checked before it is unpacked.
///
/// # Errors
/// As [`read_grey`]; a texel that means no direction, or one that does not rise.
pub(super) fn read_direction(file: &str, bytes: &[u8]) -> Result<DirectionMap, AssetError> {
    let picture = unpack(file, bytes, &DIRECTIONS)?;
    let (texels, _) = picture.bytes.as_chunks::<3>();
    for (texel, rgb) in (0_u32..).zip(texels) {
        let [column, row] = [texel % picture.columns, texel / picture.columns];
        let [x, y, z] = rgb.map(|byte| 2.0 * f64::from(byte) / 255.0 - 1.0);
        let length = (x * x + y * y + z * z).sqrt();
        if length < LEAST_DIRECTION {
            return Err(AssetError::NoDirection {
                file: file.to_owned(),
                column,
                row,
                length,
                limit: LEAST_DIRECTION,
            });
        }
        if y <= 0.0 {
            return Err(AssetError::DirectionDown {
                file: file.to_owned(),
                column,
                row,
                rise: y,
            });
        }
    }
    Ok(DirectionMap {
        columns: picture.columns,
        rows: picture.rows,
        texels: texels.to_vec(),
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
    fn both_depths_of_grey_reach_white() {
        let eight = png(ColorType::Grayscale, BitDepth::Eight, &[0, 1, 128, 255]);
        let map = read_grey("m.png", &eight).expect("valid");
        assert_eq!(map.samples, [0, 257, 32_896, 65_535]);
        let sixteen = [0, 0, 0, 9, 128, 0, 255, 255];
        let sixteen = png(ColorType::Grayscale, BitDepth::Sixteen, &sixteen);
        let map = read_grey("m.png", &sixteen).expect("valid");
        assert_eq!(map.samples, [0, 9, 32_768, 65_535]);
    }

    #[test]
    fn directions_must_exist_and_rise() {
        let up = [128, 255, 128];
        let read = |last: [u8; 3]| {
            let texels = [up, up, up, last].concat();
            read_direction("d.png", &png(ColorType::Rgb, BitDepth::Eight, &texels))
        };
        assert_eq!(read([255, 128, 128]).expect("it rises").texels[0], up);
        let text = read([128, 128, 127]).expect_err("zero").to_string();
        assert!(text.contains("length 0.007 in texel (1, 1)"), "{text}");
        assert!(text.contains("limit of 0.1"), "{text}");
        let text = read([200, 127, 128]).expect_err("down").to_string();
        assert!(text.contains("rises by -0.004 in texel (1, 1)"), "{text}");
    }

    #[test]
    fn other_formats_are_named() {
        let rgb = png(ColorType::Rgb, BitDepth::Eight, &[128; 12]);
        let text = read_grey("m.png", &rgb).expect_err("colours").to_string();
        assert!(text.contains("8-bit or 16-bit grey PNG"), "{text}");
        let grey = png(ColorType::Grayscale, BitDepth::Eight, &[128; 4]);
        let text = read_direction("m.png", &grey)
            .expect_err("grey")
            .to_string();
        assert!(text.contains("8-bit RGB PNG"), "{text}");
    }
}
