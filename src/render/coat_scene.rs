//! The triangles on which a scene's coats grow, on the device.

use wgpu::BufferUsages;

use crate::bodies::{CoatedShape, RigidShape};
use crate::field::coat::{self, CoatRanges, coat_triangles};
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::gpu_struct;
use crate::scene::{Coat, CoatForm};

gpu_struct! {
    /// Twin of `CoatTriangle` in `shaders/coat_place.wgsl`.
    pub(super) struct CoatTriangle {
        a: [f32; 3],
        full: f32,
        b: [f32; 3],
        spare_b: f32,
        c: [f32; 3],
        spare_c: f32,
        normal_a: [f32; 3],
        spare_d: f32,
        normal_b: [f32; 3],
        spare_e: f32,
        normal_c: [f32; 3],
        spare_f: f32,
    }
}

impl CoatTriangle {
    fn of(triangle: &coat::CoatTriangle) -> Self {
        let [a, b, c] = triangle.corners.map(|p| p.to_f32());
        let [normal_a, normal_b, normal_c] = triangle.normals.map(|n| n.to_f32());
        Self {
            a,
            full: triangle.full,
            b,
            spare_b: 0.0,
            c,
            spare_c: 0.0,
            normal_a,
            spare_d: 0.0,
            normal_b,
            spare_e: 0.0,
            normal_c,
            spare_f: 0.0,
        }
    }
}

/// A coat on a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShapeCoat {
    pub(super) ranges: CoatRanges,
    /// Place of the form among the buckets.
    pub(super) form: u32,
    pub(super) rgb: [f32; 3],
    pub(super) per_m2: f32,
    /// Share of the sky that the plants hide at the surface.
    pub(super) cover: f32,
    pub(super) first_triangle: u32,
    pub(super) triangles: u32,
    /// A number that its plants do not exceed.
    pub(super) most_plants: usize,
}

/// All coats of a scene.
#[derive(Debug)]
pub(super) struct CoatScene {
    pub(super) coats: Vec<ShapeCoat>,
    pub(super) triangles: Buffer<CoatTriangle>,
}

impl CoatScene {
    /// Coats of plants that follow from Philox of this many rounds.
    ///
    /// # Errors
    /// More triangles than the device can hold.
    pub(super) fn new(
        gpu: &Gpu,
        rounds: u32,
        shapes: &[RigidShape],
        coated: &[CoatedShape],
    ) -> Result<Self, GpuError> {
        let mut triangles: Vec<CoatTriangle> = Vec::new();
        let mut coats = Vec::with_capacity(coated.len());
        for one in coated {
            let mesh = shapes.get(one.shape as usize).map(|shape| &shape.mesh);
            let own = mesh.map_or_else(Vec::new, |mesh| {
                let (positions, normals) = (&mesh.positions, &mesh.normals);
                coat_triangles(positions, normals, &mesh.indices, one.coat.per_m2)
            });
            coats.push(ShapeCoat {
                ranges: CoatRanges::new(&one.coat, rounds),
                form: form_index(one.coat.form),
                rgb: one.coat.rgb,
                per_m2: one.coat.per_m2,
                cover: cover(&one.coat),
                first_triangle: triangles.len() as u32,
                triangles: own.len() as u32,
                most_plants: own.iter().map(|on| on.full.ceil() as usize).sum(),
            });
            triangles.extend(own.iter().map(CoatTriangle::of));
        }
        let storage = BufferUsages::STORAGE;
        Ok(Self {
            coats,
            triangles: Buffer::with(gpu, "triangles of coats", &triangles, storage)?,
        })
    }
}

/// Place of a coat's form among the buckets.
pub(super) fn form_index(form: CoatForm) -> u32 {
    match form {
        CoatForm::Leaf => 0,
        CoatForm::Blade => 1,
    }
}

/// Share of the sky that a coat hides at the surface: Beer's law for leaves at random angles, which fill
/// two thirds of their length times their width.
pub(super) fn cover(coat: &Coat) -> f32 {
    let mean = |[low, high]: [f32; 2]| 0.5 * (low + high);
    1.0 - (-0.67 * coat.per_m2 * mean(coat.height_m) * mean(coat.width_m)).exp()
}
