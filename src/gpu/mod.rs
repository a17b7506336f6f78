//! The graphics device: typed buffers, WGSL assembly, pass timing.
//!
//! Three lifetimes: the device, shader modules and pipelines live as long as the process needs
//! them; buffers and bind groups as long as a scene; uniforms for one tick or frame. Everything
//! stays inside WebGPU's default limits and features, except for larger storage bindings where
//! the adapter has them and for timestamps, which are optional.

mod assemble;
mod base_texels;
pub mod billboard_place;
pub mod billboards;
mod buffer;
pub mod cubes;
mod device;
mod error;
pub mod field_data;
mod grass;
mod grass_buffers;
mod grass_state;
mod late_count;
pub mod layout;
pub mod passes;
pub mod sum_rows;
mod texture;
mod tick;
pub mod tick_data;
mod timing;
pub mod turns;
pub mod wgsl;

pub(crate) use buffer::read_mapped;
pub use buffer::{Buffer, checked_bytes};
pub use device::{AdapterReport, Gpu};
pub use error::GpuError;
pub use field_data::FieldBuffers;
pub use grass::{Dispatches, GpuGrass, GrassKernels, knows_method};
pub use grass_state::{Counts, GpuState};
pub use layout::GpuStruct;
pub use tick::{TickError, tick};
pub use timing::PassTimer;
