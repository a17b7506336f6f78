//! Counts the turns of a pass whose sweeps do not fit one dispatch: see [`Turns`].
//! Shader: `shaders/turns.wgsl`.

use super::{Access, Groups, Kernel, Recording};
use crate::gpu::grass_buffers::GrassBuffers;
use crate::gpu::turns::Turns;
use crate::gpu::{Gpu, GpuError};

/// The kernel that goes on to the next turn.
#[derive(Clone, Debug)]
pub struct TurnsPass {
    next_turn: Kernel,
}

impl TurnsPass {
    /// # Errors
    /// The shader's.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let bindings = [(4, Access::Write)];
        Ok(Self {
            next_turn: Kernel::new(gpu, "turns.wgsl", "next_turn", &bindings, 1)?,
        })
    }

    /// Records a pass once per turn.
    pub fn record(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        grass: &GrassBuffers,
        turns: Turns,
        mut pass: impl FnMut(&mut Recording<'_>),
    ) {
        into.encoder.clear_buffer(&grass.touched.raw, 8, Some(4));
        pass(into);
        if turns.count == 1 {
            return;
        }
        let bound = self.next_turn.bind(gpu, &[(4, &grass.touched.raw)]);
        for _ in 1..turns.count {
            self.next_turn
                .record(into, &bound, Groups::Direct([1, 1, 1]));
            pass(into);
        }
    }
}
