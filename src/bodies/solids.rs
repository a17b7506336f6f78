//! From a scene's shape to the solids, bounds and triangles of a rigid shape.

use std::collections::BTreeMap;
use std::sync::Arc;

use rapier3d::math::Vector;

use crate::base::{Pose, Vec3};
use crate::scene::Shape;
use crate::scene::assets::TriangleMesh;

use super::convex::Hull;
use super::decompose::convex_parts;
use super::error::ShapeError;
use super::frame::turn_of_degrees;
use super::shape::{ConvexPart, DrawMesh, RigidShape, Solid};
use super::true_mesh::TrueMesh;

/// Most convex parts of a mesh: more than 128 cost the grass more than they show.
const MOST_PARTS: u32 = 128;

/// Meshes by the path that a scene gives.
pub(super) type Meshes = BTreeMap<String, TriangleMesh>;

/// The rigid shape of any scene shape but a vehicle.
pub(super) fn rigid_shape(shape: &Shape, meshes: &Meshes) -> Result<RigidShape, ShapeError> {
    match shape {
        Shape::Compound { parts } => {
            let mut built = Built::default();
            for part in parts {
                let body_from_part = Pose {
                    turn: turn_of_degrees(part.rotation_deg.map(f64::from)),
                    place: Vec3::of_f32(part.position_m),
                };
                built.add(simple(&part.shape)?, body_from_part);
            }
            if parts.is_empty() {
                return Err(ShapeError::EmptyCompound);
            }
            Ok(built.finish())
        }
        Shape::Mesh {
            file,
            scale,
            max_parts,
        } => {
            let mesh = meshes
                .get(file)
                .ok_or_else(|| ShapeError::MissingMesh { file: file.clone() })?;
            mesh_shape(file, mesh, *scale, *max_parts)
        }
        Shape::Vehicle { .. } => Err(ShapeError::Vehicle),
        other => {
            let mut built = Built::default();
            built.add(simple(other)?, Pose::IDENTITY);
            Ok(built.finish())
        }
    }
}

/// A solid about its own origin, with half its thickness and its triangles.
struct Simple {
    solid: Solid,
    half_thickness_m: f64,
    mesh: DrawMesh,
}

/// A shape of one convex solid.
fn simple(shape: &Shape) -> Result<Simple, ShapeError> {
    let nested = |inner| Err(ShapeError::Nested { inner });
    match shape {
        Shape::Ball { radius_m } => {
            let radius = length("radius_m", *radius_m)?;
            Ok(Simple {
                solid: Solid::Ball { radius },
                half_thickness_m: radius,
                mesh: DrawMesh::ball(radius),
            })
        }
        Shape::Box { size_m } => {
            let mut half = [0.0; 3];
            for (h, s) in half.iter_mut().zip(size_m) {
                *h = 0.5 * length("size_m", *s)?;
            }
            Ok(Simple {
                solid: Solid::Box { half },
                half_thickness_m: half.iter().copied().fold(f64::INFINITY, f64::min),
                mesh: DrawMesh::cuboid(half),
            })
        }
        Shape::Capsule { radius_m, length_m } => {
            let radius = length("radius_m", *radius_m)?;
            let half = 0.5 * length("length_m", *length_m)?;
            Ok(Simple {
                solid: Solid::Capsule { radius, half },
                half_thickness_m: radius,
                mesh: DrawMesh::capsule(radius, half),
            })
        }
        Shape::Cylinder { radius_m, height_m } => {
            let radius = length("radius_m", *radius_m)?;
            let half = 0.5 * length("height_m", *height_m)?;
            Ok(Simple {
                solid: Solid::Cylinder { radius, half },
                half_thickness_m: radius.min(half),
                mesh: DrawMesh::cylinder(radius, half),
            })
        }
        Shape::ConvexHull { points_m } => {
            let points: Vec<Vector> = points_m.iter().map(|&p| Vector::from_array(p)).collect();
            let hull = Hull::of(&points).ok_or(ShapeError::FlatHull {
                points: points.len(),
            })?;
            Ok(Simple {
                half_thickness_m: 0.5 * hull.smallest_width(),
                mesh: DrawMesh::hull(&hull),
                solid: convex(hull),
            })
        }
        Shape::Mesh { .. } => nested("mesh"),
        Shape::Compound { .. } => nested("compound"),
        Shape::Vehicle { .. } => nested("vehicle"),
    }
}

fn convex(hull: Hull) -> Solid {
    Solid::Convex {
        planes: hull.planes,
        vertices: hull.vertices,
    }
}

fn length(key: &'static str, value: f32) -> Result<f64, ShapeError> {
    if value > 0.0 && value.is_finite() {
        Ok(f64::from(value))
    } else {
        Err(ShapeError::Size { key, value })
    }
}

/// A mesh about the file's origin: convex parts for physics and grass, its triangles to draw.
fn mesh_shape(
    file: &str,
    mesh: &TriangleMesh,
    scale: f32,
    max_parts: u32,
) -> Result<RigidShape, ShapeError> {
    let file = || file.to_owned();
    if !(1..=MOST_PARTS).contains(&max_parts) {
        return Err(ShapeError::PartCount {
            file: file(),
            max_parts,
            most: MOST_PARTS,
        });
    }
    let vertices = mesh.positions.len();
    for (triangle, indices) in mesh.triangles.iter().enumerate() {
        if let Some(&vertex) = indices.iter().find(|&&i| i as usize >= vertices) {
            return Err(ShapeError::MeshIndex {
                file: file(),
                triangle,
                vertex,
                vertices,
            });
        }
    }
    let flat = || ShapeError::FlatMesh {
        file: file(),
        scale,
    };
    let scaled: Vec<Vector> = mesh
        .positions
        .iter()
        .map(|&p| Vector::from_array(p) * scale)
        .collect();
    let usable = scale > 0.0 && !mesh.triangles.is_empty() && scaled.iter().all(|p| p.is_finite());
    let hulls = if usable {
        convex_parts(&scaled, &mesh.triangles, max_parts)
    } else {
        Vec::new()
    };
    if hulls.is_empty() {
        return Err(flat());
    }
    let positions: Vec<[f64; 3]> = scaled
        .iter()
        .map(|p| [p.x, p.y, p.z].map(f64::from))
        .collect();
    let mut built = Built::default();
    for hull in hulls {
        let half_thickness_m = 0.5 * hull.smallest_width();
        built.add_solid(convex(hull), half_thickness_m, Pose::IDENTITY);
    }
    built.mesh = DrawMesh::smooth(&positions, &mesh.triangles);
    built.true_mesh = TrueMesh::new(&scaled, &mesh.triangles).map(Arc::new);
    Ok(built.finish())
}

/// Parts gathered so far.
#[derive(Default)]
struct Built {
    parts: Vec<ConvexPart>,
    true_mesh: Option<Arc<TrueMesh>>,
    mesh: DrawMesh,
}

impl Built {
    fn add(&mut self, simple: Simple, body_from_part: Pose<f64>) {
        self.mesh.append(&simple.mesh, body_from_part);
        self.add_solid(simple.solid, simple.half_thickness_m, body_from_part);
    }

    fn add_solid(&mut self, solid: Solid, half_thickness_m: f64, pose: Pose<f64>) {
        self.parts.push(ConvexPart {
            bounds_m: bounds_in_body(&solid, pose),
            solid,
            pose,
            half_thickness_m,
        });
    }

    fn finish(self) -> RigidShape {
        let thickness = self.parts.iter().map(|p| p.half_thickness_m);
        RigidShape {
            bounding_radius_m: self.parts.iter().map(farthest).fold(0.0, f64::max),
            half_thickness_m: thickness.fold(f64::INFINITY, f64::min),
            parts: self.parts,
            true_mesh: self.true_mesh,
            mesh: self.mesh,
        }
    }
}

/// Smallest and largest corner of a solid in the body's space.
fn bounds_in_body(solid: &Solid, pose: Pose<f64>) -> [[f64; 3]; 2] {
    if let Solid::Convex { vertices, .. } = solid {
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for &v in vertices {
            let p = pose.point(Vec3::of(v)).to_f64();
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(p[axis]);
                bounds[1][axis] = bounds[1][axis].max(p[axis]);
            }
        }
        return bounds;
    }
    // The support of the other solids along each of the body's axes, seen from the part.
    let place = pose.place.to_f64();
    let mut bounds = [place; 2];
    for axis in 0..3 {
        let mut along = [0.0; 3];
        along[axis] = 1.0;
        let [x, y, z] = pose.turn.inverse().rotate(Vec3::of(along)).to_f64();
        let reach = match *solid {
            Solid::Ball { radius } => radius,
            Solid::Box { half } => half[0] * x.abs() + half[1] * y.abs() + half[2] * z.abs(),
            Solid::Capsule { radius, half } => half * y.abs() + radius,
            Solid::Cylinder { radius, half } => half * y.abs() + radius * (x * x + z * z).sqrt(),
            Solid::Convex { .. } => 0.0,
        };
        bounds[0][axis] -= reach;
        bounds[1][axis] += reach;
    }
    bounds
}

/// Radius of a ball about the body's origin that holds a part.
fn farthest(part: &ConvexPart) -> f64 {
    let offset = part.pose.place.length();
    match &part.solid {
        Solid::Ball { radius } => offset + radius,
        Solid::Box { half } => offset + Vec3::<f64>::of(*half).length(),
        Solid::Capsule { radius, half } => offset + half + radius,
        Solid::Cylinder { radius, half } => offset + (half * half + radius * radius).sqrt(),
        Solid::Convex { vertices, .. } => vertices
            .iter()
            .map(|&v| part.pose.point(Vec3::of(v)).length())
            .fold(0.0, f64::max),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Part;

    fn made(shape: &Shape) -> RigidShape {
        rigid_shape(shape, &Meshes::new()).expect("a sound shape")
    }

    /// One part of every kind, turned and moved.
    fn mixed() -> Shape {
        let part = |shape, x: f32| Part {
            shape,
            position_m: [x, 0.2, -0.1],
            rotation_deg: [20.0 * x, 35.0, -50.0],
        };
        Shape::Compound {
            parts: vec![
                part(Shape::Ball { radius_m: 0.3 }, -2.0),
                part(
                    Shape::Box {
                        size_m: [0.2, 0.5, 0.9],
                    },
                    -1.0,
                ),
                part(
                    Shape::Capsule {
                        radius_m: 0.1,
                        length_m: 0.6,
                    },
                    0.0,
                ),
                part(
                    Shape::Cylinder {
                        radius_m: 0.3,
                        height_m: 0.2,
                    },
                    1.0,
                ),
                part(
                    Shape::ConvexHull {
                        points_m: vec![
                            [0.0, 0.0, 0.0],
                            [0.5, 0.0, 0.0],
                            [0.0, 0.5, 0.0],
                            [0.0, 0.0, 0.5],
                        ],
                    },
                    2.0,
                ),
            ],
        }
    }

    #[test]
    fn bounds_hold_what_is_drawn_and_touch_it() {
        let shape = made(&mixed());
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let mut farthest: f64 = 0.0;
        for p in &shape.mesh.positions {
            let p = p.map(f64::from);
            farthest = farthest.max(Vec3::<f64>::of(p).length());
            for axis in 0..3 {
                low[axis] = low[axis].min(p[axis]);
                high[axis] = high[axis].max(p[axis]);
            }
        }
        // Drawn round surfaces lie inside the true ones by up to 0.5% of a radius of 0.3 m; as far
        // again where the outermost point falls between two meridians.
        let slack = 0.003;
        for axis in 0..3 {
            let least = shape.parts.iter().map(|p| p.bounds_m[0][axis]);
            let most = shape.parts.iter().map(|p| p.bounds_m[1][axis]);
            let (least, most) = (
                least.fold(f64::INFINITY, f64::min),
                most.fold(f64::NEG_INFINITY, f64::max),
            );
            assert!((-1e-6..slack).contains(&(low[axis] - least)), "{axis}");
            assert!((-1e-6..slack).contains(&(most - high[axis])), "{axis}");
        }
        assert!(shape.bounding_radius_m >= farthest - 1e-6);
        assert!(shape.bounding_radius_m < farthest + 0.1);
    }

    #[test]
    fn half_the_smallest_extent_is_the_thickness() {
        let thickness: Vec<f64> = made(&mixed())
            .parts
            .iter()
            .map(|p| p.half_thickness_m)
            .collect();
        // The corner of a cube is thinnest across its slanted face: 0.5/√3 from the corner.
        let corner = 0.25 / 3.0_f64.sqrt();
        for (got, want) in thickness.iter().zip([0.3, 0.1, 0.1, 0.1, corner]) {
            assert!((got - want).abs() < 1e-6, "{got} {want}");
        }
        assert!((made(&mixed()).half_thickness_m - 0.1).abs() < 1e-6);
    }

    #[test]
    fn shapes_without_an_inside_are_refused() {
        let refuse = |shape: Shape| rigid_shape(&shape, &Meshes::new()).err();
        assert_eq!(
            refuse(Shape::Compound { parts: vec![] }),
            Some(ShapeError::EmptyCompound)
        );
        let nested = Shape::Compound {
            parts: vec![Part {
                shape: mixed(),
                position_m: [0.0; 3],
                rotation_deg: [0.0; 3],
            }],
        };
        assert_eq!(
            refuse(nested),
            Some(ShapeError::Nested { inner: "compound" })
        );
        for radius_m in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(refuse(Shape::Ball { radius_m }).is_some());
        }
    }

    #[test]
    fn a_mesh_keeps_its_origin_and_takes_its_scale() {
        let cube = DrawMesh::cuboid([0.5; 3]);
        let mesh = TriangleMesh {
            positions: cube
                .positions
                .iter()
                .map(|p| [p[0] + 2.0, p[1], p[2]])
                .collect(),
            triangles: cube
                .indices
                .chunks_exact(3)
                .map(|t| [t[0], t[1], t[2]])
                .collect(),
        };
        let meshes = Meshes::from([("cube.obj".to_owned(), mesh)]);
        let of = |scale, max_parts| {
            let file = "cube.obj".to_owned();
            let shape = Shape::Mesh {
                file,
                scale,
                max_parts,
            };
            rigid_shape(&shape, &meshes)
        };
        let shape = of(0.1, 8).expect("a cube");
        assert_eq!(shape.parts.len(), 1);
        let [low, high] = shape.parts[0].bounds_m;
        for (got, want) in low
            .iter()
            .chain(&high)
            .zip([0.15, -0.05, -0.05, 0.25, 0.05, 0.05])
        {
            assert!((got - want).abs() < 1e-6, "{got} {want}");
        }
        assert!((shape.half_thickness_m - 0.05).abs() < 1e-6);
        assert!(matches!(of(0.0, 8), Err(ShapeError::FlatMesh { .. })));
        assert!(matches!(of(1.0, 0), Err(ShapeError::PartCount { .. })));
    }
}
