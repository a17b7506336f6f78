//! The forms that plants are drawn with: one file each says how many vertices a plant takes and
//! which shader shapes them.

use crate::scene::Form;

use super::{blades, flowers, gravel, leaves, twigs};

/// Forms; a plant's form is its place in [`FORMS`].
pub(super) const FORM_COUNT: u32 = 5;
pub(super) const FORM_BLADE: u32 = 0;
/// Steps of detail, 0 the finest.
pub(super) const DETAILS: u32 = 4;
/// Ranges into which a frame's plants are sorted: one per form and detail.
pub(super) const BUCKETS: u32 = FORM_COUNT * DETAILS;
/// Vertices reserved per bucket, so that a vertex tells its bucket.
pub(super) const BUCKET_VERTICES: u32 = 512;

/// Strides of forms that take every node at the finest detail, then half as many; whole plants last.
pub(super) const HALVING_STRIDES: [u32; DETAILS as usize] = [1, 2, 4, u32::MAX];

/// How one form is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct FormDrawing {
    pub(super) shader: &'static str,
    pub(super) vertex: &'static str,
    pub(super) fragment: &'static str,
    pub(super) topology: wgpu::PrimitiveTopology,
    /// Nodes per drawn segment at each detail; whole plants where it is more than there are.
    pub(super) strides: [u32; DETAILS as usize],
    /// Vertices of a plant of this many drawn segments.
    pub(super) vertices: fn(steps: u32) -> u32,
}

pub(super) const FORMS: [FormDrawing; FORM_COUNT as usize] = [
    blades::FORM,
    flowers::FORM,
    leaves::FORM,
    twigs::FORM,
    gravel::FORM,
];

/// Place of a scene's form in [`FORMS`].
pub(super) fn form_index(form: &Form) -> u32 {
    match form {
        Form::Blade => FORM_BLADE,
        Form::Flower { .. } => 1,
        Form::Leaf => 2,
        Form::Twig => 3,
        Form::Gravel => 4,
    }
}

impl FormDrawing {
    /// Nodes per drawn segment, and drawn segments, of plants of `segments`.
    pub(super) fn steps(&self, detail: u32, segments: u32) -> [u32; 2] {
        let stride = self.strides[detail as usize].min(segments).max(1);
        [stride, segments.div_ceil(stride)]
    }

    /// Triangles of a plant of this many vertices.
    pub(super) fn triangles(&self, vertices: u32) -> u32 {
        match self.topology {
            wgpu::PrimitiveTopology::TriangleStrip => vertices.saturating_sub(2),
            _ => vertices / 3,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::MAX_SEGMENTS;

    #[test]
    fn every_form_fits_into_its_buckets() {
        for form in FORMS {
            for detail in 0..DETAILS {
                for segments in 1..=MAX_SEGMENTS as u32 {
                    let [stride, steps] = form.steps(detail, segments);
                    assert!(stride * steps >= segments && stride * (steps - 1) < segments);
                    assert!((form.vertices)(steps) <= BUCKET_VERTICES, "{}", form.shader);
                }
            }
        }
    }
}
