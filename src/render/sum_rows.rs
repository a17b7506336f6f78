//! Prefix sums of rows of numbers on the device. Shader: `shaders/sum_rows.wgsl`.

use crate::gpu::passes::{Access, Groups, Kernel, Recording, WORKGROUP};
use crate::gpu::{Buffer, Gpu, GpuError};

use super::SHADERS;

/// Turns every number of some rows into the sum of those before it in its row.
#[derive(Debug)]
pub(super) struct RowSums {
    kernel: Kernel,
}

/// Rows that lie one after the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows<'a> {
    /// Numbers of each row, in the first word.
    pub(super) length: &'a Buffer<u32>,
    pub(super) rows: &'a Buffer<u32>,
    /// Takes the sum of each whole row.
    pub(super) totals: &'a Buffer<u32>,
    pub(super) count: u32,
}

impl RowSums {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let bindings = [(0, Access::Read), (1, Access::Write), (2, Access::Write)];
        let kernel = Kernel::of_library(
            gpu,
            SHADERS,
            "sum_rows.wgsl",
            "sum_rows",
            &bindings,
            WORKGROUP,
        )?;
        Ok(Self { kernel })
    }

    pub(super) fn record(&self, gpu: &Gpu, into: &mut Recording<'_>, rows: Rows<'_>) {
        let bound = self.kernel.bind(
            gpu,
            &[
                (0, &rows.length.raw),
                (1, &rows.rows.raw),
                (2, &rows.totals.raw),
            ],
        );
        let groups = Groups::Direct([rows.count, 1, 1]);
        self.kernel.record(into, &bound, groups);
    }
}
