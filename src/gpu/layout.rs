//! Structs that a shader reads, with their layout as data, so that a test can compare it with
//! the WGSL twin member by member.

use bytemuck::Pod;

/// Name, place and size of a struct's field, in bytes.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Field {
    pub name: &'static str,
    pub offset: usize,
    pub size: usize,
}

/// A struct as Rust lays it out.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct StructLayout {
    pub name: &'static str,
    pub size: usize,
    pub fields: Vec<Field>,
}

/// A struct with a WGSL twin of the same name; made by [`gpu_struct!`](crate::gpu_struct).
pub trait GpuStruct: Pod {
    /// The layout to compare with the shader's.
    fn layout() -> StructLayout;
}

/// Layouts of the structs that the shaders of this layer read.
pub fn layouts() -> Vec<StructLayout> {
    use super::billboard_place::{BillboardRecord, BillboardUniform, ClumpUniform};
    use super::billboards::BoardUniform;
    use super::field_data::{
        FieldUniform, SpeciesUniform, TasteUniform, TileRecord, WaveUniform, WindUniform,
    };
    use super::tick_data::{ContactRecord, CubeJob, PartRecord, SolidRecord, TickUniform};
    vec![
        BillboardRecord::layout(),
        BillboardUniform::layout(),
        BoardUniform::layout(),
        ClumpUniform::layout(),
        ContactRecord::layout(),
        CubeJob::layout(),
        FieldUniform::layout(),
        PartRecord::layout(),
        SolidRecord::layout(),
        SpeciesUniform::layout(),
        TasteUniform::layout(),
        TickUniform::layout(),
        TileRecord::layout(),
        WaveUniform::layout(),
        WindUniform::layout(),
    ]
}

/// Defines a plain struct for a shader and registers the layout of every field.
///
/// Write padding as fields of its own: a WGSL `vec3f` takes 12 bytes but starts at multiples
/// of 16, and a uniform or storage struct's size is a multiple of its largest alignment.
#[macro_export]
macro_rules! gpu_struct {
    (
        $(#[$meta:meta])*
        $vis:vis struct $name:ident {
            $( $(#[$field_meta:meta])* $field_vis:vis $field:ident : $type:ty ),* $(,)?
        }
    ) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        $vis struct $name {
            $( $(#[$field_meta])* $field_vis $field: $type ),*
        }

        impl $crate::gpu::GpuStruct for $name {
            fn layout() -> $crate::gpu::layout::StructLayout {
                $crate::gpu::layout::StructLayout {
                    name: stringify!($name),
                    size: size_of::<$name>(),
                    fields: vec![ $(
                        $crate::gpu::layout::Field {
                            name: stringify!($field),
                            offset: std::mem::offset_of!($name, $field),
                            size: size_of::<$type>(),
                        }
                    ),* ],
                }
            }
        }
    };
}
