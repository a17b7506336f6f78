//! The depth cubes of a scene on the device: one per rigid part that needs it, drawn once.

use wgpu::BufferUsages;

use super::passes::Recording;
use super::passes::depth_cube::DepthCubePass;
use super::tick_data::{CubeJob, PartRecord, SolidRecord};
use super::{Buffer, Gpu, GpuError};
use crate::base::Vec3;
use crate::sim::depth_cube::{DepthCube, cover_m};
use crate::sim::parts::Parts;

/// Buffers that hold every part and its depth cube; they live as long as the scene.
#[derive(Debug)]
pub struct CubeBuffers {
    /// Six faces of resolution² texels per cube, one cube after the other.
    pub texels: Buffer<[u32; 2]>,
    /// Normal and offset of the planes of convex parts.
    pub planes: Buffer<[f32; 4]>,
    pub parts: Buffer<PartRecord>,
    pub jobs: Buffer<CubeJob>,
}

/// Every part of a scene as the shaders see it.
#[derive(Debug)]
pub struct Cubes {
    pub buffers: CubeBuffers,
    parts: Vec<PartRecord>,
    planes: Vec<[f32; 4]>,
    /// Texels along the edge of a face.
    resolution: u32,
    skin_m: f64,
    cubes: u32,
}

impl Cubes {
    /// # Errors
    /// The driver's.
    pub fn new(gpu: &Gpu, resolution: u32, skin_m: f64) -> Result<Self, GpuError> {
        let storage = BufferUsages::STORAGE;
        Ok(Self {
            buffers: CubeBuffers {
                texels: Buffer::new(gpu, "depth cubes", 0, storage)?,
                planes: Buffer::new(gpu, "planes", 0, storage)?,
                parts: Buffer::new(gpu, "parts", 0, storage)?,
                jobs: Buffer::new(gpu, "depth cube jobs", 0, storage)?,
            },
            parts: Vec::new(),
            planes: Vec::new(),
            resolution,
            skin_m,
            cubes: 0,
        })
    }

    /// The solid of a part taken in before.
    pub fn solid(&self, part: u32) -> &SolidRecord {
        &self.parts[part as usize].solid
    }

    /// Takes in new parts and draws the cubes that are wanted for the first time. Returns how many
    /// were drawn.
    ///
    /// # Errors
    /// More cubes than the device can bind.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        pass: &DepthCubePass,
        into: &mut Recording<'_>,
        parts: &Parts,
    ) -> Result<u32, GpuError> {
        let taken_in = self.take_in(parts);
        let jobs = self.wanted(parts);
        if !jobs.is_empty() {
            let per_cube = 6 * self.resolution as usize * self.resolution as usize;
            self.buffers
                .texels
                .grow_to(gpu, self.cubes as usize * per_cube)?;
            self.buffers.jobs.write_or_grow(gpu, &jobs)?;
        }
        if taken_in || !jobs.is_empty() {
            self.buffers.planes.write_or_grow(gpu, &self.planes)?;
            self.buffers.parts.write_or_grow(gpu, &self.parts)?;
        }
        if !jobs.is_empty() {
            pass.record(gpu, into, &self.buffers, self.resolution, jobs.len() as u32);
        }
        Ok(jobs.len() as u32)
    }

    fn take_in(&mut self, parts: &Parts) -> bool {
        let first_new = self.parts.len();
        for (index, part) in parts.parts.iter().enumerate().skip(first_new) {
            let siblings = parts.shape_of(index);
            self.parts.push(PartRecord {
                turn: part.pose.turn.cast().to_array(),
                place: part.pose.place.to_f32(),
                first_sibling: siblings.start as u32,
                end_sibling: siblings.end as u32,
                spare_a: 0,
                spare_b: [0; 2],
                solid: SolidRecord::new(&part.grown, &mut self.planes),
            });
        }
        self.parts.len() > first_new
    }

    /// Gives every wanted part without a cube a place for one, and lists the work.
    fn wanted(&mut self, parts: &Parts) -> Vec<CubeJob> {
        let mut jobs = Vec::new();
        for index in parts.wanted() {
            let solid = &mut self.parts[index].solid;
            if !solid.has_cube() {
                solid.resolution = self.resolution;
                solid.first_texel = self.cubes * 6 * self.resolution * self.resolution;
                self.cubes += 1;
                jobs.push(CubeJob {
                    part: index as u32,
                    cover_m: cover_m(self.skin_m),
                });
            }
        }
        jobs
    }

    /// Reads a part's cube back; `None` if it has none. Waits for the device.
    ///
    /// # Errors
    /// The device's.
    pub fn read(&self, gpu: &Gpu, part: u32) -> Result<Option<DepthCube>, GpuError> {
        let Some(solid) = self.parts.get(part as usize).map(|p| p.solid) else {
            return Ok(None);
        };
        if !solid.has_cube() {
            return Ok(None);
        }
        let first = solid.first_texel as usize;
        let count = 6 * (solid.resolution * solid.resolution) as usize;
        let texels = self.buffers.texels.read(gpu, first + count)?;
        Ok(Some(DepthCube::of_texels(
            [solid.low, solid.high].map(Vec3::of_f32),
            solid.resolution,
            texels[first..].to_vec(),
        )))
    }
}
