//! The plants as a whole, as far as the light is concerned.

use crate::field::Field;
use crate::scene::Form;

/// How tall and how dense the plants are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Canopy {
    /// Height of the tallest kind, 0 where nothing grows.
    pub(super) height_m: f32,
    /// Share of the ground's sky that plants hide, 0 to 1.
    pub(super) cover: f32,
}

impl Canopy {
    pub(super) fn of(field: &Field) -> Self {
        if field.is_bare() {
            return Self {
                height_m: 0.0,
                cover: 0.0,
            };
        }
        let kinds = &field.seeds.species;
        let mean = |[low, span]: [f32; 2]| low + 0.5 * span;
        // What lies on the ground hides none of its sky.
        let stands = |form: &Form| !matches!(form, Form::Twig | Form::Gravel);
        let area_m2: f32 = kinds
            .iter()
            .filter(|kind| stands(&kind.form))
            .map(|kind| mean(kind.height_m) * mean(kind.width_m))
            .sum::<f32>()
            / kinds.len() as f32;
        let cell_m2 = field.grid.cell_m * field.grid.cell_m;
        // Companions are thinner and shorter: two of them hide about as much as a plant.
        let per_m2 = 2.0 * field.grid.plants_per_triangle() as f32 / cell_m2 * 2.0;
        Self {
            height_m: field.reach_m,
            // Beer's law for leaves that stand at random angles.
            cover: 1.0 - (-area_m2 * per_m2).exp(),
        }
    }
}
