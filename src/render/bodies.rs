//! Rigid bodies, drawn by shape, and their shadows. Shader: `shaders/bodies.wgsl`.

use bytemuck::{Pod, Zeroable};
use wgpu::{BufferUsages, ShaderStages};

use crate::base::Pose;
use crate::bodies::{RigidShape, Solid};
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::gpu_struct;

use super::camera::View;
use super::coat::CoatLayer;
use super::coat_place::CoatFrame;
use super::error::RenderError;
use super::pipeline::{DepthUse, Drawing, READ_STORAGE, bind_group, group_layout};
use super::shadow::Caster;
use super::view_group::ViewGroups;

/// A rigid piece to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyInstance {
    /// Index into the shapes given to the renderer.
    pub shape: u32,
    pub world_from_body: Pose<f64>,
    /// Linear RGB.
    pub rgb: [f32; 3],
    /// Index into the coats given to the renderer.
    pub coat: Option<u32>,
}

gpu_struct! {
    pub(super) struct BodyRecord {
        turn: [f32; 4],
        place_from_eye: [f32; 3],
        pattern: f32,
        rgb: [f32; 3],
        cover: f32,
    }
}

/// One corner of a body's mesh; a vertex buffer's element.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct MeshVertex {
    position_in_body: [f32; 3],
    normal_in_body: [f32; 3],
}

/// Where a shape's triangles lie in the common buffers.
#[derive(Clone, Debug)]
struct ShapeRange {
    indices: std::ops::Range<u32>,
    first_vertex: i32,
    radius_m: f64,
    pattern: f32,
}

/// Draws all bodies.
#[derive(Debug)]
pub(super) struct BodiesLayer {
    pipeline: wgpu::RenderPipeline,
    shadow_pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    vertices: Buffer<MeshVertex>,
    indices: Buffer<u32>,
    shapes: Vec<ShapeRange>,
    records: Buffer<BodyRecord>,
    group: wgpu::BindGroup,
    /// Shape and run of records of each draw call.
    draws: Vec<(usize, std::ops::Range<u32>)>,
}

impl BodiesLayer {
    pub(super) fn new(gpu: &Gpu, groups: &ViewGroups, samples: u32) -> Result<Self, GpuError> {
        let both = ShaderStages::VERTEX_FRAGMENT;
        let layout = group_layout(gpu, "bodies", &[(both, READ_STORAGE)]);
        let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
        let buffers = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<MeshVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        })];
        let drawing = Drawing {
            shader: "bodies.wgsl",
            vertex: "body_vertex",
            fragment: "body_fragment",
            groups: groups.lit(&layout),
            buffers: &buffers,
            samples,
            ..Drawing::default()
        };
        let shadow = Drawing {
            vertex: "shadow_vertex",
            groups: groups.unlit(&layout),
            depth: DepthUse::Shadow,
            samples: 1,
            ..drawing
        };
        let records = Buffer::new(gpu, "body records", 16, BufferUsages::STORAGE)?;
        Ok(Self {
            pipeline: drawing.pipeline(gpu)?,
            shadow_pipeline: shadow.pipeline(gpu)?,
            group: bind_group(gpu, "bodies", &layout, &[records.binding()]),
            layout,
            vertices: Buffer::new(gpu, "body vertices", 1, BufferUsages::VERTEX)?,
            indices: Buffer::new(gpu, "body indices", 1, BufferUsages::INDEX)?,
            shapes: Vec::new(),
            records,
            draws: Vec::new(),
        })
    }

    /// Takes the scene's shapes in place of the old ones.
    pub(super) fn set_shapes(&mut self, gpu: &Gpu, shapes: &[RigidShape]) -> Result<(), GpuError> {
        let mut vertices: Vec<MeshVertex> = Vec::new();
        let mut indices: Vec<u32> = Vec::new();
        self.shapes = shapes
            .iter()
            .map(|shape| {
                let (first_vertex, first_index) = (vertices.len() as i32, indices.len() as u32);
                let mesh = &shape.mesh;
                vertices.extend(mesh.positions.iter().zip(&mesh.normals).map(
                    |(&position_in_body, &normal_in_body)| MeshVertex {
                        position_in_body,
                        normal_in_body,
                    },
                ));
                indices.extend(&mesh.indices);
                ShapeRange {
                    indices: first_index..indices.len() as u32,
                    first_vertex,
                    radius_m: shape.bounding_radius_m,
                    pattern: pattern_of(shape),
                }
            })
            .collect();
        self.vertices = Buffer::with(gpu, "body vertices", &vertices, BufferUsages::VERTEX)?;
        self.indices = Buffer::with(gpu, "body indices", &indices, BufferUsages::INDEX)?;
        self.draws.clear();
        Ok(())
    }

    /// Writes this frame's records, sorted by shape; coats darken what is under them. Returns balls
    /// around the bodies, for the shadow map.
    ///
    /// # Errors
    /// `UnknownShape`; a pose that is not finite; the device's own errors.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        view: &View,
        bodies: &[BodyInstance],
        coats: Option<(&CoatLayer, &CoatFrame<'_>)>,
    ) -> Result<Vec<Caster>, RenderError> {
        let mut order: Vec<usize> = (0..bodies.len()).collect();
        order.sort_by_key(|&index| bodies[index].shape);
        self.draws.clear();
        let mut records = Vec::with_capacity(order.len());
        let mut casters = Vec::with_capacity(order.len());
        for index in order {
            let body = &bodies[index];
            let shape = body.shape as usize;
            let range = self.shapes.get(shape).ok_or(RenderError::UnknownShape {
                body: index,
                shape: body.shape,
                known: self.shapes.len(),
            })?;
            if !body.world_from_body.is_finite() {
                return Err(RenderError::BadInput {
                    what: "the pose of a body",
                    found: format!("{:?}", body.world_from_body),
                    wanted: "give finite numbers, or leave the body out",
                });
            }
            let at = records.len() as u32;
            match self.draws.last_mut() {
                Some((last, run)) if *last == shape => run.end = at + 1,
                _ => self.draws.push((shape, at..at + 1)),
            }
            records.push(BodyRecord {
                turn: body.world_from_body.turn.cast::<f32>().to_array(),
                place_from_eye: view.from_eye(body.world_from_body.place),
                // Under a coat there is nothing to be seen of it.
                pattern: if body.coat.is_some() {
                    0.0
                } else {
                    range.pattern
                },
                rgb: body.rgb,
                cover: coats.map_or(0.0, |(coats, frame)| coats.cover(frame, body)),
            });
            casters.push(Caster {
                centre_in_world: body.world_from_body.place,
                radius_m: range.radius_m,
            });
        }
        if self.records.write_or_grow(gpu, &records)? {
            self.group = bind_group(gpu, "bodies", &self.layout, &[self.records.binding()]);
        }
        Ok(casters)
    }

    /// Depth from the sun.
    pub(super) fn draw_shadow(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.shadow_pipeline);
        self.draw_all(pass);
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        self.draw_all(pass);
    }

    fn draw_all(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(3, &self.group, &[]);
        pass.set_vertex_buffer(0, self.vertices.raw.slice(..));
        pass.set_index_buffer(self.indices.raw.slice(..), wgpu::IndexFormat::Uint32);
        for (shape, records) in &self.draws {
            let range = &self.shapes[*shape];
            pass.draw_indexed(range.indices.clone(), range.first_vertex, records.clone());
        }
    }
}

/// A round body looks the same however it is turned: it gets a pattern that shows its rolling.
fn pattern_of(shape: &RigidShape) -> f32 {
    match shape.parts.as_slice() {
        [part] => match part.solid {
            Solid::Ball { .. } => 1.0,
            Solid::Capsule { .. } | Solid::Cylinder { .. } => 0.55,
            Solid::Box { .. } | Solid::Convex { .. } => 0.0,
        },
        _ => 0.0,
    }
}
