//! The billboards' passes on the device, compiled for the grid of a scene.
//! Shaders: `shaders/billboard_collide.wgsl`, `billboard_relax.wgsl`, `billboard_recover.wgsl`; twins:
//! `src/sim/billboard/`.

use super::relax::count_groups;
use super::{Access, Groups, Kernel, Recording};
use crate::gpu::billboards::BillboardBuffers;
use crate::gpu::cubes::CubeBuffers;
use crate::gpu::grass_buffers::{COLLIDE_GROUPS, GrassBuffers, RECOVER_GROUPS, RELAX_GROUPS};
use crate::gpu::turns::{BillboardTurns, TurnsPass};
use crate::gpu::wgsl::{self, Constant};
use crate::gpu::{Gpu, GpuError};
use crate::sim::billboard::Weave;

/// What the passes read besides their own buffers.
#[derive(Clone, Copy, Debug)]
pub struct Around<'a> {
    /// Numbers, tiles and contacts of the sub-step.
    pub grass: &'a GrassBuffers,
    pub cubes: &'a CubeBuffers,
    pub turns: &'a TurnsPass,
}

/// The billboards' passes.
#[derive(Clone, Debug)]
pub struct BillboardPasses {
    collide: Kernel,
    count_groups: Kernel,
    relax: Kernel,
    recover: Kernel,
}

impl BillboardPasses {
    /// # Errors
    /// The shaders'.
    pub fn new(gpu: &Gpu, weave: &Weave, workgroup: u32) -> Result<Self, GpuError> {
        let constant = |name, value: u32| Constant {
            name,
            value: value.into(),
        };
        let constants = [
            constant("WORKGROUP", workgroup),
            constant("BOARD_COLUMNS", weave.grid.columns as u32),
            constant("BOARD_ROWS", weave.grid.rows as u32),
            constant("BOARD_BENDS", u32::from(weave.has_bends())),
        ];
        let kernel = |path, name, bindings: &[(u32, Access)]| {
            Kernel::with_constants(gpu, wgsl::PASSES, path, name, bindings, &constants)
        };
        let responding = [
            (0, Access::Uniform),
            (1, Access::Read),
            (2, Access::Read),
            (3, Access::Write),
            (4, Access::Write),
            (5, Access::Read),
            (6, Access::Read),
            (8, Access::Uniform),
        ];
        let drawing = [
            (0, Access::Uniform),
            (1, Access::Read),
            (3, Access::Write),
            (7, Access::Write),
            (8, Access::Uniform),
        ];
        Ok(Self {
            collide: kernel("billboard_collide.wgsl", "collide_billboards", &responding)?,
            count_groups: count_groups(gpu, workgroup)?,
            relax: kernel("billboard_relax.wgsl", "relax_billboards", &responding)?,
            recover: kernel("billboard_recover.wgsl", "recover_billboards", &drawing)?,
        })
    }

    /// Lists the billboards that a body touches.
    pub fn collide(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        boards: &BillboardBuffers,
        around: Around<'_>,
        turns: BillboardTurns,
    ) {
        into.encoder.clear_buffer(&boards.touched.raw, 0, Some(4));
        let bound = bind(gpu, &self.collide, boards, around);
        let groups = Groups::Indirect(&boards.groups, COLLIDE_GROUPS);
        let (touched, count) = (&boards.touched, turns.collide);
        around.turns.record(gpu, into, touched, count, |into| {
            self.collide.record(into, &bound, groups);
        });
    }

    /// Responds every billboard on the list.
    pub fn relax(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        boards: &BillboardBuffers,
        around: Around<'_>,
        turns: BillboardTurns,
    ) {
        let listed = [(4, &boards.touched.raw), (7, &boards.groups.raw)];
        let counted = self.count_groups.bind(gpu, &listed);
        self.count_groups
            .record(into, &counted, Groups::Direct([1, 1, 1]));
        let bound = bind(gpu, &self.relax, boards, around);
        let groups = Groups::Indirect(&boards.groups, RELAX_GROUPS);
        let (touched, count) = (&boards.touched, turns.relax);
        around.turns.record(gpu, into, touched, count, |into| {
            self.relax.record(into, &bound, groups);
        });
    }

    /// Writes the nodes of every active tile's billboards.
    pub fn recover(
        &self,
        gpu: &Gpu,
        into: &mut Recording<'_>,
        boards: &BillboardBuffers,
        grass: &GrassBuffers,
    ) {
        let bound = self.recover.bind(
            gpu,
            &[
                (0, &grass.tick.raw),
                (1, &grass.tiles.raw),
                (3, &boards.pool.raw),
                (7, &boards.drawn.raw),
                (8, &boards.numbers.raw),
            ],
        );
        let groups = Groups::Indirect(&boards.groups, RECOVER_GROUPS);
        self.recover.record(into, &bound, groups);
    }
}

fn bind(
    gpu: &Gpu,
    kernel: &Kernel,
    boards: &BillboardBuffers,
    around: Around<'_>,
) -> wgpu::BindGroup {
    kernel.bind(
        gpu,
        &[
            (0, &around.grass.tick.raw),
            (1, &around.grass.tiles.raw),
            (2, &around.grass.contacts.raw),
            (3, &boards.pool.raw),
            (4, &boards.touched.raw),
            (5, &around.cubes.texels.raw),
            (6, &around.cubes.planes.raw),
            (8, &boards.numbers.raw),
        ],
    )
}
