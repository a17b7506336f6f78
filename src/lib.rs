//! sward: responsive grass. Rigid bodies move through a meadow; the grass is pushed aside by
//! their real shape, keeps an imprint and rises again.
//!
//! Layers, each using only those above it:
//!
//! ```text
//! base     floats, small maths, random numbers, statistics
//! scene    the description: types, defaults, loading, validation
//! terrain  height grid, ground surface
//! field    seeds, blade shapes, tiles, octree, slabs, wind
//! bodies   rapier world, shapes, vehicle; what the grass needs to know of a body
//! sim      the passes as Rust, generic over the float; the tick; the cpu engine
//! gpu      device, typed buffers, WGSL assembly, one host file per pass, the tick as a list
//! render   one file per renderer or layer of the picture
//! run      timeline, expectations, metrics, reports, benches
//! app      command line, window, panels (feature `app`)
//! ```

#[cfg(feature = "app")]
pub mod app;
pub mod base;
pub mod bodies;
pub mod field;
pub mod gpu;
pub mod render;
pub mod run;
pub mod scene;
pub mod sim;
pub mod terrain;
