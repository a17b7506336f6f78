//! Prefix sums of rows of numbers on the device. Shader: `shaders/sum_rows.wgsl`.

use super::passes::{Access, Groups, Kernel, Recording, WORKGROUP};
use super::{Buffer, Gpu, GpuError};

/// Turns every number of some rows into the sum of those before it in its row.
#[derive(Clone, Debug)]
pub struct RowSums {
    kernel: Kernel,
}

/// Rows that lie one after the other.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// Numbers of each row, in the first word.
    pub length: &'a Buffer<u32>,
    /// Their numbers, row by row.
    pub rows: &'a Buffer<u32>,
    /// Takes the sum of each whole row.
    pub totals: &'a Buffer<u32>,
    /// How many rows.
    pub count: u32,
}

impl RowSums {
    /// # Errors
    /// The shader's.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let bindings = [(0, Access::Read), (1, Access::Write), (2, Access::Write)];
        let kernel = Kernel::new(gpu, "sum_rows.wgsl", "sum_rows", &bindings, WORKGROUP)?;
        Ok(Self { kernel })
    }

    /// Records the sums of some rows.
    pub fn record(&self, gpu: &Gpu, into: &mut Recording<'_>, rows: Rows<'_>) {
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
