//! PNG pictures, unpacked within limits that are checked before anything is allocated.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits};

use crate::scene::error::AssetError;

/// Bytes the PNG reader may take for itself beside the picture: a few rows and the metadata.
const READER_BYTES: usize = 16 << 20;
/// Most bytes one packed byte can become: DEFLATE repeats at most 258 bytes for two bits.
const MOST_UNPACKED: u64 = 1032;

/// What a picture must be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub formats: &'static [(ColorType, BitDepth)],
    /// The formats in words.
    pub as_text: &'static str,
    /// Most columns and rows.
    pub side: u32,
    pub pixels: u64,
    /// What a pixel is called in errors.
    pub pixel_name: &'static str,
}

/// A picture's bytes, row by row.
#[derive(Clone, Debug)]
pub(super) struct Unpacked {
    pub columns: u32,
    pub rows: u32,
    pub bytes_per_pixel: usize,
    pub bytes: Vec<u8>,
}

/// Unpacks a PNG; its size is checked before.
///
/// # Errors
/// No PNG, another colour type or depth, too large, or damaged.
pub(super) fn unpack(file: &str, bytes: &[u8], wanted: &Wanted) -> Result<Unpacked, AssetError> {
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
    let format = (header.color_type, header.bit_depth);
    if !wanted.formats.contains(&format) {
        let bits = format.1 as u8;
        let article = if bits == 8 { "an" } else { "a" };
        return Err(AssetError::Format {
            file: file.to_owned(),
            found: format!("{article} {bits}-bit {:?} PNG", format.0),
            wanted: wanted.as_text,
        });
    }
    check_size(file, columns, rows, wanted)?;
    let bytes_per_pixel = format.0.samples() * format.1 as usize / 8;
    let length = bytes_per_pixel as u64 * u64::from(columns) * u64::from(rows);
    if length > MOST_UNPACKED * bytes.len() as u64 {
        let (has, name) = (bytes.len(), wanted.pixel_name);
        return Err(damaged(format!(
            "its {has} bytes cannot hold {columns} by {rows} {name}"
        )));
    }
    let broken = |e| damaged(format!("it cannot be unpacked: {e}"));
    let mut reader = decoder.read_info().map_err(broken)?;
    let mut unpacked = vec![0; length as usize];
    let frame = reader.next_frame(&mut unpacked).map_err(broken)?;
    if (frame.width, frame.height) != (columns, rows) {
        return Err(damaged(
            "its first picture is smaller than its header says".to_owned(),
        ));
    }
    Ok(Unpacked {
        columns,
        rows,
        bytes_per_pixel,
        bytes: unpacked,
    })
}

pub(super) fn check_size(
    file: &str,
    columns: u32,
    rows: u32,
    wanted: &Wanted,
) -> Result<(), AssetError> {
    let over = |count, what, limit| AssetError::OverBudget {
        file: file.to_owned(),
        count,
        what,
        limit,
    };
    for (side, what) in [(columns, "columns"), (rows, "rows")] {
        if side > wanted.side {
            return Err(over(side.into(), what, wanted.side.into()));
        }
        if side < 2 {
            return Err(AssetError::Format {
                file: file.to_owned(),
                found: format!("{columns} by {rows} {}", wanted.pixel_name),
                wanted: "a picture of at least 2 by 2",
            });
        }
    }
    let pixels = u64::from(columns) * u64::from(rows);
    if pixels > wanted.pixels {
        return Err(over(pixels, wanted.pixel_name, wanted.pixels));
    }
    Ok(())
}
