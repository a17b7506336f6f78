//! The passes as Rust, generic over the float, and the tick that runs them.

pub mod billboard;
pub mod checkpoint;
pub mod collide;
pub mod contact;
pub mod cpu;
pub mod depth_cube;
pub mod fault;
pub mod meadow;
pub mod measure;
pub mod parts;
pub mod recover;
pub mod reference;
pub mod relax;
pub mod slab;
pub mod solid;
pub mod springs;
pub mod state_hash;
pub mod state_size;
pub mod tick;
pub mod true_bodies;
pub mod voxel_field;
pub mod weight;
pub mod work;

pub use checkpoint::Checkpoint;
pub use cpu::Grass;
pub use meadow::{Meadow, MeadowError};
pub use state_hash::StateHash;
pub use tick::tick;
pub use work::Work;
