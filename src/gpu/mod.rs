//! The graphics device: typed buffers, WGSL assembly, pass timing.
//!
//! Three lifetimes: the device, shader modules and pipelines live as long as the process needs
//! them; buffers and bind groups as long as a scene; uniforms for one tick or frame. Everything
//! stays inside WebGPU's default limits and features, except for larger storage bindings where
//! the adapter has them and for timestamps, which are optional.

mod buffer;
mod device;
mod error;
pub mod field_data;
pub mod layout;
mod timing;
pub mod wgsl;

pub(crate) use buffer::read_mapped;
pub use buffer::{Buffer, checked_bytes};
pub use device::{AdapterReport, Gpu};
pub use error::GpuError;
pub use field_data::FieldBuffers;
pub use layout::GpuStruct;
pub use timing::PassTimer;
