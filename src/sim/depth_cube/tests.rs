use super::super::solid::{NO_FACE, Plane};
use super::draw::pack_normal;
use super::*;

fn random(k: u32) -> Vec3<f32> {
    let at = |salt: u32| crate::base::philox::philox2x32([k, salt], 5, 7)[0];
    vec3(
        crate::base::philox::unit(at(0)) - 0.5,
        crate::base::philox::unit(at(1)) - 0.5,
        crate::base::philox::unit(at(2)) - 0.5,
    )
}

fn solids() -> Vec<Solid<f32>> {
    // A box of half sides 0.2, 0.3 and 0.25, turned about two axes: within 0.44 of its centre.
    let axes = [
        vec3(0.8, 0.6, 0.0),
        vec3(-0.48, 0.64, 0.6),
        vec3(0.36, -0.48, 0.8),
    ];
    let planes = axes.into_iter().zip([0.2, 0.3, 0.25]);
    let planes = planes
        .flat_map(|(normal, offset)| [normal, -normal].map(|normal| Plane { normal, offset }));
    vec![
        Solid::Ball { radius: 0.4 },
        Solid::Box {
            half: vec3(0.3, 0.2, 0.4),
        },
        Solid::Capsule {
            radius: 0.2,
            half: 0.2,
        },
        Solid::Cylinder {
            radius: 0.3,
            half: 0.2,
        },
        Solid::Convex {
            planes: planes.collect(),
            low: vec3(-0.44, -0.44, -0.44),
            high: vec3(0.44, 0.44, 0.44),
        },
    ]
}

#[test]
fn normals_survive_packing() {
    for k in 0..2000 {
        let n = random(k).unit_or(Vec3::UP);
        let back: Vec3<f32> = unpack_normal(pack_normal(n));
        // Half a step of 2/65535 in x and y moves the point on the octahedron by at most √6 of
        // it (z follows both), and the way to the sphere stretches that by at most √3: 6.5e-5.
        assert!((back - n).length() < 6.5e-5, "{n:?} {back:?}");
    }
}

#[test]
fn inside_and_outside_agree_with_the_shape_but_for_a_texel() {
    for solid in solids() {
        let cube = DepthCube::draw(&solid, 64, |_| false);
        let texel = cube.texel_m();
        for k in 0..20_000 {
            let p = random(k);
            let depth = solid.depth(p);
            if depth.abs() > texel {
                assert_eq!(
                    cube.is_deeper(p, 0.0),
                    depth > 0.0,
                    "{solid:?} {p:?} {depth}"
                );
            }
        }
    }
}

#[test]
fn the_way_out_leaves_at_most_a_texel_inside() {
    for solid in solids() {
        let cube = DepthCube::draw(&solid, 64, |_| false);
        for k in 0..20_000 {
            let p = random(k);
            if let Some(exit) = cube.exit(p, NO_FACE, &Reach::anywhere()) {
                let out = p + exit.normal * exit.depth;
                // One push may end inside next to an edge, where a texel mixes two faces; the
                // second look at it, as every round does, must not.
                let out = match cube.exit(out, exit.face, &Reach::anywhere()) {
                    Some(again) => out + again.normal * again.depth,
                    None => out,
                };
                assert!(solid.depth(out) < cube.texel_m(), "{solid:?} {p:?}");
            }
        }
    }
}

#[test]
fn no_way_out_leads_through_a_hidden_face() {
    let half = vec3(0.2, 0.2, 0.2);
    let cube = DepthCube::draw(&Solid::Box { half }, 32, |p| p.x > 0.199);
    let exit = cube
        .exit(vec3(0.19, 0.1, 0.0), NO_FACE, &Reach::anywhere())
        .expect("inside");
    assert_eq!(exit.face, 2, "{exit:?}");
}

#[test]
fn a_ball_is_met_to_a_fraction_of_a_texel() {
    let radius = 0.15_f32;
    let solid = Solid::Ball { radius };
    let cube = DepthCube::draw(&solid, 64, |_| false);
    // A plane at the distance r along the surface lies r²/2R over it. Bilinear weights give a mean
    // square of h²/4 at most for each of a face's two directions; on the steepest face that is ever
    // the best, |n·a| = 1/√3, one of them is drawn out threefold: r² ≤ h²(1 + 3)/4. The distance of a
    // point 1 mm deep grows with that by less than its share of the radius. A normal's packing tilts
    // a plane by 6.5e-5, and by that times a texel's diagonal of a steep face.
    let texel = cube.texel_m();
    let above = texel * texel / (2.0 * radius) * 1.01 + 6.5e-5 * texel * 3.0;
    for k in 0..20_000 {
        let p = random(k).unit_or(Vec3::UP) * (radius - 0.001);
        let exit = cube.exit(p, NO_FACE, &Reach::anywhere()).expect("inside");
        let out = (p + exit.normal * exit.depth).length() - radius;
        assert!((-1e-6..above).contains(&out), "{p:?}: {out} of {above}");
    }
}
