//! The plants as a whole, as far as the light is concerned.

use crate::base::most;
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

/// Share of a quad that its clump's picture covers, about.
const CLUMP_COVER: f64 = 0.35;

impl Canopy {
    const BARE: Self = Self {
        height_m: 0.0,
        cover: 0.0,
    };

    pub(super) fn of(field: &Field) -> Self {
        Self::of_plants(field).with(Self::of_billboards(field))
    }

    /// Two layers on one ground: light that passes one may be caught by the other.
    fn with(self, other: Self) -> Self {
        Self {
            height_m: most(self.height_m, other.height_m),
            cover: 1.0 - (1.0 - self.cover) * (1.0 - other.cover),
        }
    }

    /// Clumps that hide a part of their quads, where they grow at all.
    fn of_billboards(field: &Field) -> Self {
        let Some(billboards) = field
            .billboards
            .as_ref()
            .filter(|field| !field.all.is_empty())
        else {
            return Self::BARE;
        };
        let (mut area_m2, mut height_m) = (0.0_f64, 0.0_f32);
        for billboard in &billboards.all {
            area_m2 += f64::from(billboard.height_m) * f64::from(billboard.width_m);
            height_m = most(height_m, billboard.height_m);
        }
        let [wide_m, deep_m] = field.ground.size_m();
        let layers = CLUMP_COVER * area_m2 / (wide_m * deep_m);
        Self {
            height_m,
            cover: 1.0 - (-layers).exp() as f32,
        }
    }

    fn of_plants(field: &Field) -> Self {
        if field.is_bare() {
            return Self::BARE;
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
