//! 16-bit grey PNG pictures as heights.

use png::{BitDepth, ColorType};

use super::HeightMap;
use super::picture::{Wanted, unpack};
use crate::scene::error::AssetError;
use crate::scene::limits::{HEIGHT_MAP_SIDE, HEIGHT_SAMPLES};

const HEIGHTS: Wanted = Wanted {
    formats: &[(ColorType::Grayscale, BitDepth::Sixteen)],
    as_text: "a 16-bit grey PNG without transparency",
    side: HEIGHT_MAP_SIDE,
    pixels: HEIGHT_SAMPLES,
    pixel_name: "height samples",
};

/// Reads a height map; its size is checked before it is unpacked.
///
/// # Errors
/// No PNG, another colour type or depth, too large, or damaged.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<HeightMap, AssetError> {
    let picture = unpack(file, bytes, &HEIGHTS)?;
    let (pairs, _) = picture.bytes.as_chunks::<2>();
    Ok(HeightMap {
        columns: picture.columns,
        rows: picture.rows,
        samples: pairs.iter().map(|&p| u16::from_be_bytes(p)).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::picture::check_size;
    use super::*;

    fn png(color: ColorType, depth: BitDepth, size: [u32; 2], data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
        encoder.set_color(color);
        encoder.set_depth(depth);
        let mut writer = encoder.write_header().expect("a valid header");
        writer
            .write_image_data(data)
            .expect("as many bytes as the header says");
        drop(writer);
        bytes
    }

    /// The checksum of a PNG chunk (ISO 3309), bit by bit.
    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |c, _| {
                if c & 1 == 1 {
                    0xEDB8_8320 ^ (c >> 1)
                } else {
                    c >> 1
                }
            })
        })
    }

    #[test]
    fn samples_are_big_endian_rows() {
        let data = [0, 1, 1, 0, 255, 255, 0, 0, 18, 52, 0, 9];
        let bytes = png(ColorType::Grayscale, BitDepth::Sixteen, [3, 2], &data);
        let map = read("h.png", &bytes).expect("valid");
        assert_eq!((map.columns, map.rows), (3, 2));
        assert_eq!(map.samples, [1, 256, 65_535, 0, 0x1234, 9]);
    }

    #[test]
    fn other_formats_are_named() {
        let bytes = png(ColorType::Grayscale, BitDepth::Eight, [2, 2], &[0; 4]);
        let text = read("h.png", &bytes).expect_err("8 bits").to_string();
        assert!(text.contains("8-bit Grayscale"), "{text}");
        let bytes = png(ColorType::Rgb, BitDepth::Sixteen, [2, 2], &[0; 24]);
        let text = read("h.png", &bytes).expect_err("colours").to_string();
        assert!(text.contains("16-bit Rgb"), "{text}");
        assert!(read("h.png", b"P5 no png").is_err());
    }

    #[test]
    fn a_cut_file_is_damaged() {
        let bytes = png(ColorType::Grayscale, BitDepth::Sixteen, [16, 16], &[7; 512]);
        for length in 0..bytes.len() - 12 {
            assert!(read("h.png", &bytes[..length]).is_err(), "{length}");
        }
    }

    #[test]
    fn a_huge_header_is_refused_before_unpacking() {
        let mut lies = png(ColorType::Grayscale, BitDepth::Sixteen, [2, 2], &[7; 8]);
        // The header chunk: 8 bytes of signature, 8 of chunk head, then width and height.
        lies[16..24].copy_from_slice(&[0, 0, 0x10, 0, 0, 0, 0x10, 0]);
        let crc = crc32(&lies[12..29]);
        lies[29..33].copy_from_slice(&crc.to_be_bytes());
        let text = read("h.png", &lies)
            .expect_err("no such picture")
            .to_string();
        assert!(text.contains("cannot hold 4096 by 4096"), "{text}");
        assert!(check_size("h.png", 16_385, 2, &HEIGHTS).is_err());
        assert!(check_size("h.png", 16_384, 16_384, &HEIGHTS).is_err());
        assert!(check_size("h.png", 1, 100, &HEIGHTS).is_err());
        assert!(check_size("h.png", 4096, 4096, &HEIGHTS).is_ok());
    }
}
