//! The plants that grow on a body: P15 section 2, on any triangles.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Shape, limits};
use crate::base::{least, most};

/// Plants on the surface of a body. They are drawn only: nothing presses them. Pairs are smallest and
/// largest value; a plant draws evenly between them.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Coat {
    /// What its plants look like.
    pub form: CoatForm,
    /// Plants per square metre of the surface.
    #[schemars(range(min = limits::COAT_DENSITY.min, max = limits::COAT_DENSITY.max))]
    pub per_m2: f32,
    /// Length of a plant, in metres.
    #[schemars(inner(range(min = limits::PLANT_HEIGHT.min, max = limits::PLANT_HEIGHT.max)))]
    pub height_m: [f32; 2],
    /// Width of a plant where it is widest, in metres.
    #[schemars(inner(range(min = limits::PLANT_WIDTH.min, max = limits::PLANT_WIDTH.max)))]
    pub width_m: [f32; 2],
    /// Colour, linear RGB in 0…1.
    #[schemars(inner(range(min = limits::FRACTION.min, max = limits::FRACTION.max)))]
    pub rgb: [f32; 3],
    /// Lean from the surface's normal, to all sides alike, in degrees.
    #[schemars(inner(range(min = limits::ROOT_LEAN.min, max = limits::ROOT_LEAN.max)))]
    pub lean_deg: [f32; 2],
    /// Key of the random numbers of its plants.
    pub seed: u32,
}

impl Default for Coat {
    fn default() -> Self {
        Self {
            form: CoatForm::default(),
            per_m2: 900.0,
            height_m: [0.03, 0.06],
            width_m: [0.015, 0.03],
            rgb: [0.06, 0.13, 0.025],
            lean_deg: [15.0, 65.0],
            seed: 1,
        }
    }
}

/// The shape a coat's plants are drawn with.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
pub enum CoatForm {
    /// A small leaf with a midrib.
    #[default]
    Leaf,
    /// A blade that tapers to a point.
    Blade,
}

/// What a coat on a shape comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatedSurface {
    /// Never less than the drawn surface's; for a hull, that of its bounds.
    pub area_m2: f64,
    /// Triangles that are drawn of it, or a few more.
    pub triangles: u64,
}

impl CoatedSurface {
    /// The surface of a shape; of a mesh as of nothing, since its file says it.
    pub fn of(shape: &Shape) -> Self {
        use std::f64::consts::PI;
        /// Of a ball, a capsule or a cylinder, at most: 32 sides in 17 rows.
        const ROUND: u64 = 32 * 17 * 2;
        let cuboid = |size: [f64; 3]| {
            let [x, y, z] = size;
            2.0 * (x * y + y * z + z * x)
        };
        let cylinder = |radius: f64, height: f64| 2.0 * PI * radius * (radius + height);
        let (area_m2, triangles) = match shape {
            Shape::Ball { radius_m } => (4.0 * PI * f64::from(*radius_m).powi(2), ROUND),
            Shape::Box { size_m } => (cuboid(size_m.map(f64::from)), 12),
            Shape::Capsule { radius_m, length_m } => {
                let radius = f64::from(*radius_m);
                (
                    2.0 * PI * radius * (2.0 * radius + f64::from(*length_m)),
                    ROUND,
                )
            }
            Shape::Cylinder { radius_m, height_m } => {
                (cylinder((*radius_m).into(), (*height_m).into()), ROUND)
            }
            // A convex body has no more surface than a box around it.
            Shape::ConvexHull { points_m } => {
                (cuboid(bounds_of(points_m)), 2 * points_m.len() as u64)
            }
            Shape::Mesh { .. } => (0.0, 0),
            Shape::Compound { parts } => {
                return parts.iter().fold(Self::NONE, |sum, part| {
                    let own = Self::of(&part.shape);
                    Self {
                        area_m2: sum.area_m2 + own.area_m2,
                        triangles: sum.triangles + own.triangles,
                    }
                });
            }
            Shape::Vehicle {
                chassis_m,
                wheel_radius_m,
                wheel_width_m,
            } => {
                let wheel = cylinder((*wheel_radius_m).into(), (*wheel_width_m).into());
                (
                    cuboid(chassis_m.map(f64::from)) + 4.0 * wheel,
                    12 + 4 * ROUND,
                )
            }
        };
        Self { area_m2, triangles }
    }

    /// The surface of a mesh whose file's unit is `scale` metres.
    pub fn of_mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]], scale: f32) -> Self {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| positions[i as usize].map(f64::from));
            let [u, v] = [b, c].map(|p| [0, 1, 2].map(|i| p[i] - a[i]));
            let across = [0, 1, 2].map(|i| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                u[j] * v[k] - u[k] * v[j]
            });
            0.5 * across.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        let units2: f64 = triangles.iter().map(area).sum();
        Self {
            area_m2: units2 * f64::from(scale).powi(2),
            triangles: triangles.len() as u64,
        }
    }

    const NONE: Self = Self {
        area_m2: 0.0,
        triangles: 0,
    };
}

/// Extents of the box around points.
fn bounds_of(points_m: &[[f32; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|axis| {
        let along = || points_m.iter().map(|p| f64::from(p[axis]));
        along().fold(f64::MIN, most) - along().fold(f64::MAX, least)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_of_shapes_are_known() {
        let area = |text: &str| {
            let shape: Shape = ron::from_str(text).expect("a shape");
            CoatedSurface::of(&shape).area_m2
        };
        let pi = std::f64::consts::PI;
        for (text, want) in [
            ("Ball(radius_m: 0.5)", pi),
            ("Box(size_m: (1, 2, 3))", 22.0),
            ("Capsule(radius_m: 0.5, length_m: 2)", 3.0 * pi),
            ("Cylinder(radius_m: 1, height_m: 2)", 6.0 * pi),
            (
                "Compound(parts: [(shape: Box(size_m: (1, 1, 1))), (shape: Ball(radius_m: 0.5))])",
                6.0 + pi,
            ),
            (
                "ConvexHull(points_m: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])",
                6.0,
            ),
        ] {
            assert!((area(text) - want).abs() < 1e-9 * want, "{text}");
        }
        let mesh = CoatedSurface::of_mesh(
            &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            &[[0, 1, 2]],
            2.0,
        );
        assert_eq!((mesh.area_m2, mesh.triangles), (2.0, 1));
    }
}
