//! What can go wrong while a picture is made.

use crate::gpu::GpuError;
use crate::terrain::bintree::MeshError;

/// An error of the renderer.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    #[error(transparent)]
    Gpu(#[from] GpuError),

    #[error(
        "a picture of {width} x {height} pixels: each side must be 1 to {limit}, the device's \
         max_texture_dimension_2d"
    )]
    PictureSize { width: u32, height: u32, limit: u32 },

    #[error(
        "a picture of {width} x {height} pixels needs {asked} bytes of targets; the device's \
         max_buffer_size allows {limit}: make it smaller"
    )]
    PictureBytes {
        width: u32,
        height: u32,
        asked: u64,
        limit: u64,
    },

    #[error("body {body} has shape {shape}, but only {known} shapes were given")]
    UnknownShape {
        body: usize,
        shape: u32,
        known: usize,
    },

    #[error("body {body} has coat {coat}, but only {known} coats were given")]
    UnknownCoat {
        body: usize,
        coat: u32,
        known: usize,
    },

    #[error(
        "billboards.clumps needs {layers} pictures of clumps; the device's textures have at most {limit} \
         layers (its max_texture_array_layers): give fewer kinds"
    )]
    ClumpLayers { layers: u32, limit: u32 },

    #[error(
        "light.slices is {slices}, which needs a texture of {layers} layers; the device's textures have \
         at most {limit} (its max_texture_array_layers): write {most} or less"
    )]
    LightLayers {
        slices: u32,
        layers: u32,
        limit: u32,
        most: u32,
    },

    #[error("{what} is {found}; {wanted}")]
    BadInput {
        what: &'static str,
        found: String,
        wanted: &'static str,
    },

    #[error("the ground's mesh: {0}")]
    Mesh(#[from] MeshError),

    #[error("writing the picture as PNG: {0}")]
    Png(#[from] png::EncodingError),
}
