//! WGSL assembly: embedded files, imports, and constants that exist once, in Rust.
//!
//! A line `#import "shared/philox.wgsl"` stands for that file's text, once per shader however
//! often it is named; circles are harmless, since WGSL does not mind the order of declarations.
//! A file's constants are put in front wherever it is imported. Lines of the assembled text map
//! back to file and line, so that a compiler's message can be read.

pub use super::assemble::{Assembled, WgslError, assemble, assemble_named, assemble_with};
use super::billboard_place::ROW_TILES;
use super::billboards::{BOARD_BENDS, BOARD_COLUMNS, BOARD_ROWS};
use super::field_data::{NO_SLAB, TILE_COLLIDING, TILE_RECOVERING, TILE_RESTING};
use super::grass_buffers::{RELAX_GROUPS, TOUCHED_HEADER};
use super::passes::{MOST_GROUPS, WORKGROUP};
use super::tick_data::{SOLID_BALL, SOLID_BOX, SOLID_CAPSULE, SOLID_CONVEX, SOLID_CYLINDER};
use crate::base::fixed::{EXP2_TABLE, LOG2_TABLE};
use crate::base::trig::SINE_QUARTER;
use crate::field::billboards::{
    AZIMUTH_STEPS, BILLBOARD_COUNT_WORD, BILLBOARD_WORD, CLUMP_VARIANTS, FACES_FROM, FINE_STEPS,
    MAX_CLUMPS, MOST_TILT_TURNS, UNIT_STEP, UNIT_STEPS, WIND_SHARE,
};
use crate::field::clusters::{CLUSTER_WORD, GRID_WORD};
use crate::field::grid::ANCHOR_CELLS;
use crate::field::kinds::{HUE_TURN, LEAST_SQUARED, MAX_TASTES};
use crate::field::plant::{CELL_STEPS, MAX_SPECIES};
use crate::field::pose::{MAX_NODES, MAX_SEGMENTS};
use crate::field::wind::WAVES;
use crate::sim::billboard::recover::PASSES as BOARD_RECOVER_PASSES;
use crate::sim::billboard::relax::{FINENESS as BOARD_FINENESS, PUSH_ASIDE};
use crate::sim::billboard::springs::POINT_M2 as BOARD_POINT_M2;
use crate::sim::collide::PINNED_M;
use crate::sim::contact::{FACE_MASK, ON_SURFACE_M};
use crate::sim::depth_cube::{DEPTH_STEPS, HIDDEN, HIDDEN_SHARE, HIT, LEAST_WEIGHT};
use crate::sim::recover::ASIDE;
use crate::sim::relax::{LOOKS, ON_GROUND_M, SPRING_TRIES, STICKS};
use crate::sim::solid::{
    CAME_THROUGH_M, HIDDEN_M, KEEP_FACE, LEAST_SPAN_M2, NO_FACE, OPPOSITE, OUT_OF_REACH_M,
};
use crate::sim::springs::crumpled::CRUMPLED_SHARE;

/// A WGSL file, embedded, with the Rust constants it uses.
#[derive(Clone, Copy, Debug)]
pub struct WgslFile {
    /// Path inside `shaders/`.
    pub path: &'static str,
    pub text: &'static str,
    /// Constants the file's text names.
    pub constants: fn() -> Vec<Constant>,
}

/// A Rust constant under its own name.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    pub name: &'static str,
    pub value: Value,
}

/// The value of a constant.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    U32(u32),
    I32(i32),
    F32(f32),
    F32Array(Vec<f32>),
    U32Array(Vec<u32>),
}

macro_rules! value_from {
    ($($from:ty => |$v:ident| $to:expr),* $(,)?) => {
        $( impl From<$from> for Value {
            fn from($v: $from) -> Self {
                $to
            }
        } )*
    };
}

value_from! {
    u32 => |v| Value::U32(v),
    usize => |v| Value::U32(v as u32),
    i32 => |v| Value::I32(v),
    f64 => |v| Value::F32(v as f32),
    f32 => |v| Value::F32(v),
}

impl<const N: usize> From<[f32; N]> for Value {
    fn from(v: [f32; N]) -> Self {
        Self::F32Array(v.to_vec())
    }
}

impl<const N: usize> From<[u32; N]> for Value {
    fn from(v: [u32; N]) -> Self {
        Self::U32Array(v.to_vec())
    }
}

impl<const N: usize> From<[f64; N]> for Value {
    fn from(v: [f64; N]) -> Self {
        Self::F32Array(v.iter().map(|&x| x as f32).collect())
    }
}

/// A list of constants in scope, each under its Rust name: `constants![WORKGROUP, SKIN_M]`.
#[macro_export]
macro_rules! wgsl_constants {
    ($($name:ident),* $(,)?) => {
        || vec![ $( $crate::gpu::wgsl::Constant {
            name: stringify!($name),
            value: $crate::gpu::wgsl::Value::from($name),
        } ),* ]
    };
}

/// A file of `shaders/` with the constants it names.
#[macro_export]
macro_rules! wgsl_file {
    ($path:literal) => {
        $crate::wgsl_file!($path,)
    };
    ($path:literal, $($name:ident),* $(,)?) => {
        $crate::gpu::wgsl::WgslFile {
            path: $path,
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path)),
            constants: $crate::wgsl_constants![$($name),*],
        }
    };
}

/// Files that any layer's shaders may import.
pub const SHARED: &[WgslFile] = &[
    wgsl_file!(
        "shared/billboard.wgsl",
        AZIMUTH_STEPS,
        CLUMP_VARIANTS,
        FINE_STEPS,
        UNIT_STEP,
        UNIT_STEPS
    ),
    wgsl_file!(
        "shared/billboard_grid.wgsl",
        ASIDE,
        BOARD_BENDS,
        BOARD_POINT_M2,
        BOARD_RECOVER_PASSES
    ),
    wgsl_file!("shared/billboard_quad.wgsl", WIND_SHARE),
    wgsl_file!("shared/billboard_state.wgsl", BOARD_COLUMNS, BOARD_ROWS),
    wgsl_file!("shared/clusters.wgsl", CLUSTER_WORD, GRID_WORD),
    wgsl_file!("shared/contact.wgsl", FACE_MASK, NO_FACE, ON_SURFACE_M),
    wgsl_file!(
        "shared/cube.wgsl",
        HIDDEN,
        HIDDEN_SHARE,
        HIT,
        LEAST_WEIGHT,
        NO_FACE
    ),
    wgsl_file!("shared/field.wgsl", MAX_SPECIES, MAX_TASTES),
    wgsl_file!("shared/fixed.wgsl", EXP2_TABLE, LOG2_TABLE),
    wgsl_file!("shared/ground.wgsl"),
    wgsl_file!("shared/laid.wgsl", ON_GROUND_M, STICKS),
    wgsl_file!("shared/kinds.wgsl", HUE_TURN, LEAST_SQUARED, MAX_TASTES),
    wgsl_file!("shared/on_map.wgsl", ANCHOR_CELLS),
    wgsl_file!("shared/philox.wgsl"),
    wgsl_file!("shared/plant.wgsl", ANCHOR_CELLS, CELL_STEPS),
    wgsl_file!("shared/pose.wgsl", MAX_NODES),
    wgsl_file!("shared/recovering.wgsl", ASIDE),
    wgsl_file!("shared/rigid.wgsl"),
    wgsl_file!(
        "shared/solid.wgsl",
        CAME_THROUGH_M,
        HIDDEN_M,
        KEEP_FACE,
        LEAST_SPAN_M2,
        NO_FACE,
        OPPOSITE,
        OUT_OF_REACH_M,
        SOLID_BALL,
        SOLID_BOX,
        SOLID_CAPSULE,
        SOLID_CONVEX,
        SOLID_CYLINDER
    ),
    wgsl_file!("shared/state.wgsl"),
    wgsl_file!("shared/texel.wgsl", DEPTH_STEPS, HIT, HIDDEN),
    wgsl_file!("shared/tick.wgsl"),
    wgsl_file!(
        "shared/tile.wgsl",
        NO_SLAB,
        TILE_COLLIDING,
        TILE_RECOVERING,
        TILE_RESTING
    ),
    wgsl_file!("shared/touched.wgsl", TOUCHED_HEADER),
    wgsl_file!("shared/trig.wgsl", SINE_QUARTER),
    wgsl_file!("shared/wind.wgsl", WAVES),
];

/// One file per compute pass.
pub const PASSES: &[WgslFile] = &[
    wgsl_file!(
        "billboard/collide.wgsl",
        BOARD_FINENESS,
        ON_SURFACE_M,
        PINNED_M,
        WORKGROUP
    ),
    wgsl_file!(
        "billboard_place.wgsl",
        ANCHOR_CELLS,
        BILLBOARD_COUNT_WORD,
        BILLBOARD_WORD,
        CELL_STEPS,
        CLUMP_VARIANTS,
        FACES_FROM,
        MAX_CLUMPS,
        MOST_TILT_TURNS,
        NO_SLAB,
        ROW_TILES,
        UNIT_STEP,
        UNIT_STEPS,
        WORKGROUP,
    ),
    wgsl_file!("billboard/recover.wgsl", WORKGROUP),
    wgsl_file!(
        "billboard/relax.wgsl",
        BOARD_POINT_M2,
        CRUMPLED_SHARE,
        FACE_MASK,
        LOOKS,
        NO_FACE,
        PUSH_ASIDE,
        WORKGROUP
    ),
    wgsl_file!("collide.wgsl", PINNED_M, WORKGROUP),
    wgsl_file!("depth_cube.wgsl", WORKGROUP),
    wgsl_file!("recover.wgsl", WORKGROUP),
    wgsl_file!(
        "relax.wgsl",
        FACE_MASK,
        LOOKS,
        MAX_NODES,
        MAX_SEGMENTS,
        MOST_GROUPS,
        NO_FACE,
        RELAX_GROUPS,
        SPRING_TRIES,
        WORKGROUP,
    ),
    wgsl_file!("sum_rows.wgsl", WORKGROUP),
    wgsl_file!("turns.wgsl"),
];
