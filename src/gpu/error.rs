//! What can go wrong between the program and the graphics driver.

/// An error of the graphics device. Each names the thing, the value and what to do.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    #[error(
        "no graphics adapter found ({reason}); on Debian or Ubuntu a software one comes with \
         `apt-get install mesa-vulkan-drivers libvulkan1`"
    )]
    NoAdapter { reason: String },

    #[error("adapter '{adapter}' gave no device: {reason}")]
    NoDevice { adapter: String, reason: String },

    #[error("{what}: {reason}")]
    Rejected { what: String, reason: String },

    #[error("{what} needs {asked} bytes; the device allows {limit} (its {limit_name})")]
    TooLarge {
        what: String,
        asked: u64,
        limit: u64,
        limit_name: &'static str,
    },

    #[error(
        "the gpu engine does not have these settings of solver.method: {asked}; leave them out, or \
         take --engine cpu"
    )]
    UnknownMethod { asked: String },

    #[error(
        "the driver of adapter '{adapter}' has ended loops of {count} kernels early, so that their \
         plants are wrong: lower solver.max_sweeps, or take --engine cpu"
    )]
    CutShort { adapter: String, count: u32 },

    #[error("the graphics device was lost: {reason}; make a new device to go on")]
    Lost { reason: String },

    #[error("reading back {what}: {reason}")]
    ReadBack { what: String, reason: String },

    #[error(transparent)]
    Wgsl(#[from] super::wgsl::WgslError),
}
