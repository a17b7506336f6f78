//! The buffers of a glTF file: found, measured, and read as positions and indices.

use std::borrow::Cow;

use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::Source;
use gltf::{Accessor, Document};

use super::AssetSource;
use super::base64;
use super::gltf::damaged;
use super::source::beside;
use crate::scene::error::AssetError;
use crate::scene::limits::ASSET_BYTES;

/// The bytes of every buffer, at least as many as the file says.
pub(super) struct Buffers<'a> {
    file: &'a str,
    bytes: Vec<Cow<'a, [u8]>>,
}

impl<'a> Buffers<'a> {
    /// Reads the buffers: the binary chunk, data inside the file, or files beside it.
    ///
    /// # Errors
    /// A buffer that is missing, too short, too large, elsewhere than inside the folders, or more
    /// than [`ASSET_BYTES`] of buffers together.
    pub(super) fn read(
        file: &'a str,
        document: &Document,
        binary: Option<Cow<'a, [u8]>>,
        source: &dyn AssetSource,
    ) -> Result<Self, AssetError> {
        let mut binary = binary;
        let mut left = ASSET_BYTES;
        let mut all = Vec::new();
        for buffer in document.buffers() {
            let bytes = match buffer.source() {
                Source::Bin => binary.take().ok_or_else(|| {
                    damaged(file, "its binary chunk is missing or used twice".to_owned())
                })?,
                Source::Uri(uri) => Cow::Owned(fetch(file, uri, source, left)?),
            };
            if bytes.len() < buffer.length() {
                let (index, has, says) = (buffer.index(), bytes.len(), buffer.length());
                let reason = format!("buffer {index} has {has} of the {says} bytes it should");
                return Err(damaged(file, reason));
            }
            left = left.saturating_sub(bytes.len() as u64);
            all.push(bytes);
        }
        Ok(Self { file, bytes: all })
    }

    /// The positions an accessor describes.
    ///
    /// # Errors
    /// Another type than three 32-bit floats, or bytes outside the buffer.
    pub(super) fn positions(&self, accessor: &Accessor<'_>) -> Result<Vec<[f32; 3]>, AssetError> {
        if (accessor.data_type(), accessor.dimensions()) != (DataType::F32, Dimensions::Vec3) {
            return Err(self.format(accessor, "positions of three 32-bit floats"));
        }
        let elements = self.elements::<12>(accessor)?;
        Ok(elements
            .map(|e| {
                let (words, _) = e.as_chunks::<4>();
                [0, 1, 2].map(|i| f32::from_le_bytes(words[i]))
            })
            .collect())
    }

    /// The vertex indices an accessor describes.
    ///
    /// # Errors
    /// Another type than a whole number, or bytes outside the buffer.
    pub(super) fn indices(&self, accessor: &Accessor<'_>) -> Result<Vec<u32>, AssetError> {
        Ok(match (accessor.data_type(), accessor.dimensions()) {
            (DataType::U8, Dimensions::Scalar) => {
                self.elements::<1>(accessor)?.map(|&[i]| i.into()).collect()
            }
            (DataType::U16, Dimensions::Scalar) => self
                .elements::<2>(accessor)?
                .map(|&e| u16::from_le_bytes(e).into())
                .collect(),
            (DataType::U32, Dimensions::Scalar) => self
                .elements::<4>(accessor)?
                .map(|&e| u32::from_le_bytes(e))
                .collect(),
            _ => return Err(self.format(accessor, "indices of 8, 16 or 32 bits")),
        })
    }

    /// The elements of an accessor, each of `SIZE` bytes.
    fn elements<const SIZE: usize>(
        &self,
        accessor: &Accessor<'_>,
    ) -> Result<impl Iterator<Item = &[u8; SIZE]>, AssetError> {
        let index = accessor.index();
        let view = match (accessor.sparse(), accessor.view()) {
            (None, Some(view)) => view,
            _ => return Err(self.format(accessor, "a plain, not sparse, accessor")),
        };
        let stride = view.stride().unwrap_or(SIZE);
        let range = |from: usize, length: usize| Some(from..from.checked_add(length)?);
        let bytes = (|| {
            let buffer = self.bytes.get(view.buffer().index())?;
            let viewed = buffer.get(range(view.offset(), view.length())?)?;
            let before_last = stride.checked_mul(accessor.count().checked_sub(1)?)?;
            viewed.get(range(accessor.offset(), before_last.checked_add(SIZE)?)?)
        })();
        let bytes = bytes.filter(|_| stride >= SIZE).ok_or_else(|| {
            damaged(
                self.file,
                format!("accessor {index} reaches outside its buffer"),
            )
        })?;
        Ok(bytes.chunks(stride).filter_map(|e| e.first_chunk()))
    }

    fn format(&self, accessor: &Accessor<'_>, wanted: &'static str) -> AssetError {
        let (kind, size) = (accessor.data_type(), accessor.dimensions());
        let sparse = if accessor.sparse().is_some() {
            ", sparse"
        } else {
            ""
        };
        AssetError::Format {
            file: self.file.to_owned(),
            found: format!(
                "with accessor {} of {size:?} of {kind:?}{sparse}",
                accessor.index()
            ),
            wanted,
        }
    }
}

fn fetch(
    file: &str,
    uri: &str,
    source: &dyn AssetSource,
    limit: u64,
) -> Result<Vec<u8>, AssetError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        return text.and_then(base64::decode).ok_or_else(|| {
            damaged(
                file,
                "a buffer inside it is no valid base64 data".to_owned(),
            )
        });
    }
    if let Some((scheme, _)) = uri.split_once(':') {
        let reason = format!("a buffer is at `{scheme}:`; only files beside it are read");
        return Err(damaged(file, reason));
    }
    let name = percent_decoded(uri)
        .ok_or_else(|| damaged(file, format!("`{uri}` is no valid name of a buffer file")))?;
    source.read(&beside(file, &name), limit)
}

/// Replaces `%20` and the like; `None` where the bytes are no UTF-8 text.
fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        if first == b'%' {
            let digits = std::str::from_utf8(tail.get(..2)?).ok()?;
            if !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
                return None;
            }
            bytes.push(u8::from_str_radix(digits, 16).ok()?);
            rest = tail.get(2..)?;
        } else {
            bytes.push(first);
            rest = tail;
        }
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_codes() {
        assert_eq!(percent_decoded("a%20b.bin").as_deref(), Some("a b.bin"));
        assert_eq!(percent_decoded("%C3%A4").as_deref(), Some("ä"));
        for bad in ["%FF", "%", "%2", "%zz", "%+1"] {
            assert_eq!(percent_decoded(bad), None, "{bad}");
        }
    }
}
