//! Benches: speed, always with the error beside it.

pub mod bodies;
pub mod flight;
pub mod light;
pub mod machine;
pub mod popping;
mod rig;
mod still_field;
pub mod submission;
pub mod terrain;
pub mod tiles;

pub use bodies::{BodiesBench, bench_bodies};
pub use flight::{FlightBench, FlightRequest, bench_flight};
pub use light::{LightBench, bench_light};
pub use machine::Machine;
pub use popping::{PoppingBench, bench_popping};
pub use still_field::DrawBenchError;
pub use submission::{SubmissionBench, bench_submission};
pub use terrain::{TerrainBench, TerrainBenchError, bench_terrain};
pub use tiles::{TilesBench, bench_tiles};
