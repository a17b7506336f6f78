//! 16-bit grey PNG pictures as heights.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits};

use super::HeightMap;
use crate::scene::error::AssetError;
use crate::scene::limits::{HEIGHT_MAP_SIDE, HEIGHT_SAMPLES};

/// Bytes the PNG reader may take for itself beside the picture: a few rows and the metadata.
const READER_BYTES: usize = 16 << 20;

/// Most bytes one packed byte can become: DEFLATE repeats at most 258 bytes for two bits.
const MOST_UNPACKED: u64 = 1032;

/// Reads a height map; its size is checked before it is unpacked.
///
/// # Errors
/// No PNG, another colour type or depth, too large, or damaged.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<HeightMap, AssetError> {
    let damaged = |reason: String| AssetError::Damaged {
        file: file.to_owned(),
        reason,
    };
    let limits = Limits {
        bytes: READER_BYTES,
    };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    // Texts and colour profiles may be packed a thousandfold.
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder
        .read_header_info()
        .map_err(|e| damaged(format!("it is no valid PNG: {e}")))?;
    let (columns, rows) = (header.width, header.height);
    if (header.color_type, header.bit_depth) != (ColorType::Grayscale, BitDepth::Sixteen) {
        return Err(AssetError::Format {
            file: file.to_owned(),
            found: format!(
                "a {}-bit {:?} PNG",
                header.bit_depth as u8, header.color_type
            ),
            wanted: "a 16-bit grey PNG without transparency",
        });
    }
    check_size(file, columns, rows)?;
    if 2 * u64::from(columns) * u64::from(rows) > MOST_UNPACKED * bytes.len() as u64 {
        let has = bytes.len();
        return Err(damaged(format!(
            "its {has} bytes cannot hold {columns} by {rows} samples"
        )));
    }
    let unpack = |e| damaged(format!("it cannot be unpacked: {e}"));
    let mut reader = decoder.read_info().map_err(unpack)?;
    let mut packed = vec![0; columns as usize * rows as usize * 2];
    let frame = reader.next_frame(&mut packed).map_err(unpack)?;
    if (frame.width, frame.height) != (columns, rows) {
        return Err(damaged(
            "its first picture is smaller than its header says".to_owned(),
        ));
    }
    let (pairs, _) = packed.as_chunks::<2>();
    Ok(HeightMap {
        columns,
        rows,
        samples: pairs.iter().map(|&p| u16::from_be_bytes(p)).collect(),
    })
}

fn check_size(file: &str, columns: u32, rows: u32) -> Result<(), AssetError> {
    let over = |count, what, limit| AssetError::OverBudget {
        file: file.to_owned(),
        count,
        what,
        limit,
    };
    for (side, what) in [(columns, "columns"), (rows, "rows")] {
        if side > HEIGHT_MAP_SIDE {
            return Err(over(side.into(), what, HEIGHT_MAP_SIDE.into()));
        }
        if side < 2 {
            return Err(AssetError::Format {
                file: file.to_owned(),
                found: format!("{columns} by {rows} samples"),
                wanted: "a picture of at least 2 by 2",
            });
        }
    }
    let samples = u64::from(columns) * u64::from(rows);
    if samples > HEIGHT_SAMPLES {
        return Err(over(samples, "height samples", HEIGHT_SAMPLES));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
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
        assert!(check_size("h.png", 16_385, 2).is_err());
        assert!(check_size("h.png", 16_384, 16_384).is_err());
        assert!(check_size("h.png", 1, 100).is_err());
        assert!(check_size("h.png", 4096, 4096).is_ok());
    }
}
