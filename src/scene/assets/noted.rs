//! Which files a scene has read, and what was in them.

use std::cell::RefCell;
use std::collections::BTreeMap;

use super::source::AssetSource;
use crate::base::Hash64;
use crate::scene::error::AssetError;

/// A source that notes every file it has given out.
pub(in crate::scene) struct Noted<'a> {
    source: &'a dyn AssetSource,
    hashes: RefCell<BTreeMap<String, u64>>,
}

impl<'a> Noted<'a> {
    pub fn new(source: &'a dyn AssetSource) -> Self {
        Self {
            source,
            hashes: RefCell::default(),
        }
    }

    /// The hash of the bytes of every file so far, by the path that was asked for.
    pub fn hashes(self) -> BTreeMap<String, u64> {
        self.hashes.into_inner()
    }
}

impl AssetSource for Noted<'_> {
    fn read(&self, file: &str, limit: u64) -> Result<Vec<u8>, AssetError> {
        let bytes = self.source.read(file, limit)?;
        let mut hash = Hash64::default();
        hash.bytes(&bytes);
        let mut hashes = self.hashes.borrow_mut();
        hashes.insert(file.to_owned(), hash.value());
        Ok(bytes)
    }
}
