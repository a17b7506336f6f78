//! What depth cubes make of shapes: points that they take for inside or outside wrongly, and ways out
//! that lead the other way.

use std::io::{self, Write};

use crate::base::philox::{philox2x32, unit};
use crate::base::{Vec3, most, vec3};
use crate::scene::method::Sampling;
use crate::sim::depth_cube::DepthCube;
use crate::sim::solid::{NO_FACE, Reach, Solid};

/// Texels along an edge.
const RESOLUTIONS: [u32; 3] = [16, 64, 256];
const SAMPLINGS: [(Sampling, &str); 4] = [
    (Sampling::Planes, "planes"),
    (Sampling::Masked, "masked"),
    (Sampling::Bilinear, "bilinear"),
    (Sampling::Nearest, "nearest"),
];
/// Points asked of a shape, evenly in its bounds grown by a tenth.
const POINTS: u32 = 20_000;
/// A point so close to the surface is on neither side, in metres.
const ON_SURFACE_M: f64 = 1e-5;

/// What was found of the shapes.
#[derive(Clone, Debug, Default)]
pub struct Shapes {
    rows: Vec<ShapeRow>,
}

#[derive(Clone, Debug)]
struct ShapeRow {
    shape: &'static str,
    sampling: &'static str,
    wrong: [Wrong; RESOLUTIONS.len()],
}

/// Points that a cube takes wrongly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrong {
    inside: u32,
    missed: u32,
    false_inside: u32,
    other_way: u32,
    /// Farthest from the surface of a missed point, and of a false one, in metres.
    missed_m: f64,
    false_m: f64,
}

fn solids() -> [(&'static str, Solid<f32>); 6] {
    [
        ("ball, radius 150 mm", Solid::Ball { radius: 0.15 }),
        (
            "box, 300 × 200 × 400 mm",
            Solid::Box {
                half: vec3(0.15, 0.1, 0.2),
            },
        ),
        (
            "plate, 10 × 500 × 600 mm",
            Solid::Box {
                half: vec3(0.005, 0.25, 0.3),
            },
        ),
        (
            "capsule, radius 80, 360 mm",
            Solid::Capsule {
                radius: 0.08,
                half: 0.1,
            },
        ),
        (
            "rod, radius 30, 2000 mm",
            Solid::Capsule {
                radius: 0.03,
                half: 0.97,
            },
        ),
        (
            "cylinder, radius 100, 200 mm",
            Solid::Cylinder {
                radius: 0.1,
                half: 0.1,
            },
        ),
    ]
}

impl Shapes {
    /// Asks every cube of every shape.
    pub fn measure() -> Self {
        let mut rows = Vec::new();
        for (shape, solid) in solids() {
            let cubes =
                RESOLUTIONS.map(|resolution| DepthCube::draw(&solid, resolution, |_| false));
            for (sampling, word) in SAMPLINGS {
                let wrong = cubes.each_ref().map(|cube| {
                    let mut cube = cube.clone();
                    cube.sampling = sampling;
                    Wrong::of(&solid, &cube)
                });
                rows.push(ShapeRow {
                    shape,
                    sampling: word,
                    wrong,
                });
            }
        }
        Self { rows }
    }

    /// Writes the table in Markdown.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(
            out,
            "## What depth cubes make of shapes\n\n\
             {POINTS} points, evenly in a shape's bounds and a tenth around, against its closed form, for cubes of \
             {} texels. *False inside*: outside, but the cube pushes it; *missed*: inside, but the cube lets it \
             be; both as a share of the points inside, with how far the worst is from the surface; *other way*: \
             the way out leads away from the nearest surface. `auto` takes the closed form where half the \
             thickness is less than two texels.\n\n\
             | shape | sampling | false inside | missed | other way |\n|---|---|---|---|---|",
            RESOLUTIONS.map(|n| n.to_string()).join(", ")
        )?;
        for row in &self.rows {
            let all = |one: fn(&Wrong) -> String| row.wrong.each_ref().map(one).join("; ");
            writeln!(
                out,
                "| {} | {} | {} | {} | {} |",
                row.shape,
                row.sampling,
                all(|w| w.told(w.false_inside, Some(w.false_m))),
                all(|w| w.told(w.missed, Some(w.missed_m))),
                all(|w| w.told(w.other_way, None)),
            )?;
        }
        writeln!(out)
    }
}

impl Wrong {
    /// Compares a cube with the solid that it was drawn of.
    pub fn of(solid: &Solid<f32>, cube: &DepthCube) -> Self {
        let exact: Solid<f64> = solid.grown_by(0.0);
        let low: Vec3<f64> = Vec3::of(cube.low.to_f64());
        let size: Vec3<f64> = Vec3::of((cube.high - cube.low).to_f64());
        let mut wrong = Self::default();
        for n in 0..POINTS {
            let [a, b] = philox2x32([n, 0], 11, 7);
            let [c, _] = philox2x32([n, 1], 11, 7);
            let [u, v, w] = [a, b, c].map(|word| f64::from(unit(word)) * 1.2 - 0.1);
            let p = low + vec3(u * size.x, v * size.y, w * size.z);
            wrong.ask(&exact, cube, p);
        }
        wrong
    }

    fn ask(&mut self, exact: &Solid<f64>, cube: &DepthCube, p: Vec3<f64>) {
        let anywhere = Reach::anywhere();
        let found = cube.exit(p, NO_FACE, &anywhere);
        let truth = exact.exit(p, NO_FACE, &anywhere, |_| false);
        let far_m = truth.map_or_else(|| exact.gap(p), |exit| exit.depth);
        if far_m < ON_SURFACE_M {
            return;
        }
        self.inside += u32::from(truth.is_some());
        match (truth, found) {
            (Some(truth), Some(found)) => {
                self.other_way += u32::from(truth.normal.dot(found.normal) < 0.0);
            }
            (Some(_), None) => {
                self.missed += 1;
                self.missed_m = most(self.missed_m, far_m);
            }
            (None, Some(_)) => {
                self.false_inside += 1;
                self.false_m = most(self.false_m, far_m);
            }
            (None, None) => {}
        }
    }

    /// A number of points as a share of those inside, and the worst distance.
    fn told(&self, points: u32, far_m: Option<f64>) -> String {
        let percent = 100.0 * f64::from(points) / f64::from(self.inside.max(1));
        match far_m.filter(|_| points > 0) {
            Some(far_m) => format!("{percent:.1}% ({:.1} mm)", far_m * 1e3),
            None => format!("{percent:.1}%"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wrong(solid: &Solid<f32>, resolution: u32, sampling: Sampling) -> Wrong {
        let mut cube = DepthCube::draw(solid, resolution, |_| false);
        cube.sampling = sampling;
        Wrong::of(solid, &cube)
    }

    /// The planes of a box's faces are the box, whatever the texels; half a texel of a face lies beyond
    /// its edge, where one beside it is read.
    #[test]
    fn planes_know_a_box() {
        let solid = solids()[1].1.clone();
        let wrong = wrong(&solid, 64, Sampling::Planes);
        assert!(wrong.inside > 5_000);
        // Depths are kept in 2²⁴ steps or more of the box's 0.4 m: none is off by the margin.
        assert_eq!((wrong.missed, wrong.false_inside), (0, 0), "{wrong:?}");
    }

    /// Plain bilinear sampling mixes in texels that were not hit, and so takes off the edge of every
    /// silhouette; planes go on to it.
    #[test]
    fn bilinear_sampling_misses_the_edge_of_a_rod() {
        let solid = solids()[4].1.clone();
        let [bilinear, planes] =
            [Sampling::Bilinear, Sampling::Planes].map(|sampling| wrong(&solid, 16, sampling));
        assert!(
            planes.missed * 5 < bilinear.missed,
            "{planes:?} {bilinear:?}"
        );
    }
}
