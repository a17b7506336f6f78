//! The state of one active tile's plants.

use crate::base::{Real, Vec3};

/// Offsets from the wind pose at the last contact, and when that was. Everything is zero for a
/// plant that nothing has touched since the tile woke.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slab<R> {
    /// Per plant: tick of the last contact, 0 for never.
    pub touched_at: Vec<u32>,
    /// Per plant and segment: offset of the segment's upper node, in metres.
    pub offsets: Vec<Vec3<R>>,
    /// Per plant and segment: which body, part and face that node was pushed out through.
    pub faces: Vec<u32>,
}

impl<R: Real> Slab<R> {
    pub fn new(plants: usize, segments: usize) -> Self {
        Self {
            touched_at: vec![0; plants],
            offsets: vec![Vec3::ZERO; plants * segments],
            faces: vec![0; plants * segments],
        }
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> u64 {
        let Self {
            touched_at,
            offsets,
            faces,
        } = self;
        (size_of_val(&touched_at[..]) + size_of_val(&offsets[..]) + size_of_val(&faces[..])) as u64
    }
}

/// Bytes of one slab of plants or billboards: for each a tick, per movable node three floats and a face word, padded
/// to whole 16-byte rows as on the GPU.
pub fn slab_bytes(plants: u32, nodes: u32) -> u64 {
    u64::from(plants) * (16 + 16 * u64::from(nodes))
}
