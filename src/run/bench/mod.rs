//! Benches: speed, always with the error beside it.

pub mod machine;
mod rig;
pub mod tiles;

pub use machine::Machine;
pub use tiles::{TilesBench, bench_tiles};
