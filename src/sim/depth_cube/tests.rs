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
                assert_eq!(cube.inside(p), depth > 0.0, "{solid:?} {p:?} {depth}");
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
