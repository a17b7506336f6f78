//! The buffers of a meadow's grass on the device, by lifetime: state lives as long as the scene,
//! lists and numbers for one tick.

use wgpu::BufferUsages;

use super::field_data::TileRecord;
use super::tick_data::{ContactRecord, TickUniform};
use super::{Buffer, Gpu, GpuError};

/// Where the passes' sizes start in [`GrassBuffers::groups`], in words; three each. The middle one
/// is written by the device itself.
pub const COLLIDE_GROUPS: u32 = 0;
pub const RELAX_GROUPS: u32 = 3;
pub const RECOVER_GROUPS: u32 = 6;
/// Words before the first entry of the list of touched plants: their count, the most rounds any
/// plant took since the start, the turn of the pass, how often a kernel's loops were cut short.
pub const TOUCHED_HEADER: u32 = 4;
/// Where the last of these is, in bytes.
pub const CUT_SHORT_BYTE: u64 = 12;
/// Most tiles that may be active at once: an entry of the touched list names its tile in 16 bits.
pub const MOST_TILES: u32 = 65_535;

/// What the passes read and write.
#[derive(Debug)]
pub struct GrassBuffers {
    /// Scene: by slab, per plant a row with the tick of its last contact, then a row per segment.
    pub state: Buffer<[u32; 4]>,
    /// Tick: its numbers, the active tiles (colliding ones first), and their contacts.
    pub tick: Buffer<TickUniform>,
    pub tiles: Buffer<TileRecord>,
    pub contacts: Buffer<ContactRecord>,
    /// Tick: the list of touched plants, and the passes' sizes.
    pub touched: Buffer<u32>,
    pub groups: Buffer<u32>,
}

impl GrassBuffers {
    /// # Errors
    /// The driver's.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let storage = BufferUsages::STORAGE;
        Ok(Self {
            state: Buffer::new(gpu, "grass state", 0, storage)?,
            tick: Buffer::new(gpu, "tick", 1, BufferUsages::UNIFORM)?,
            tiles: Buffer::new(gpu, "active tiles", 0, storage)?,
            contacts: Buffer::new(gpu, "contacts", 0, storage)?,
            touched: Buffer::new(gpu, "touched plants", TOUCHED_HEADER as usize, storage)?,
            groups: Buffer::new(gpu, "workgroups", 9, storage | BufferUsages::INDIRECT)?,
        })
    }
}

/// Most slabs of `slab_bytes` that the device can bind at once, and the passes can number.
pub fn slab_limit(gpu: &Gpu, slab_bytes: u64) -> u32 {
    let limits = gpu.device.limits();
    let bytes = limits
        .max_storage_buffer_binding_size
        .min(limits.max_buffer_size);
    (bytes / slab_bytes.max(1)).min(u64::from(MOST_TILES)) as u32
}
