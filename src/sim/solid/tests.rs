use super::*;

fn solids() -> Vec<Solid<f64>> {
    let s = 0.5_f64.sqrt();
    let plane = |x, y, z| Plane {
        normal: vec3(x, y, z),
        offset: 0.3,
    };
    vec![
        Solid::Ball { radius: 0.4 },
        Solid::Box {
            half: vec3(0.3, 0.2, 0.4),
        },
        Solid::Capsule {
            radius: 0.2,
            half: 0.3,
        },
        Solid::Cylinder {
            radius: 0.3,
            half: 0.2,
        },
        Solid::Convex {
            planes: vec![
                plane(s, s, 0.0),
                plane(-s, s, 0.0),
                plane(0.0, -1.0, 0.0),
                plane(0.0, 0.0, 1.0),
                plane(0.0, 0.0, -1.0),
            ],
            low: vec3(-1.0, -0.3, -0.3),
            high: vec3(1.0, 0.5, 0.3),
        },
    ]
}

#[test]
fn the_way_out_ends_on_the_surface() {
    for solid in solids() {
        let mut inside = 0;
        for k in 0..4000_u32 {
            let word = |salt: u32| crate::base::philox::philox2x32([k, salt], 3, 7)[0];
            let at = |salt: u32| f64::from(crate::base::philox::unit(word(salt))) - 0.5;
            let p = vec3(at(1), at(2), at(3));
            let exit = solid.exit(p, NO_FACE, &Reach::anywhere(), |_| false);
            assert_eq!(exit.is_some(), solid.depth(p) > 0.0, "{solid:?} {p:?}");
            if let Some(exit) = exit {
                inside += 1;
                assert!((exit.depth - solid.depth(p)).abs() < 1e-12);
                let out = p + exit.normal * exit.depth;
                assert!(solid.depth(out).abs() < 1e-12, "{solid:?} {p:?}");
            }
        }
        assert!(inside > 100, "{solid:?}: {inside}");
    }
}

#[test]
fn centres_and_axes_have_a_finite_way_out() {
    for solid in solids() {
        for p in [Vec3::ZERO, vec3(0.0, 0.1, 0.0)] {
            let exit = solid
                .exit(p, NO_FACE, &Reach::anywhere(), |_| false)
                .expect("inside");
            assert!(exit.normal.is_finite() && (exit.normal.length() - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn a_way_out_must_be_in_the_segments_reach() {
    let plank = Solid::Box {
        half: vec3(1.0, 0.05, 0.2),
    };
    let face = |length: f64| {
        let from = vec3(0.0, -0.05, 0.1);
        let reach = Reach {
            from,
            length,
            before: from,
        };
        plank
            .exit(vec3(0.0, 0.0, 0.17), NO_FACE, &reach, |_| false)
            .map(|e| e.face)
    };
    assert_eq!(face(0.12), Some(4), "3 cm to the side");
    assert_eq!(
        face(0.09),
        Some(3),
        "the side is 10 cm from the lower node, the bottom near"
    );
}

#[test]
fn a_face_is_kept_until_another_is_a_tenth_nearer() {
    let cube = Solid::Box {
        half: vec3(1.0, 1.0, 1.0),
    };
    let face = |x: f64, kept| {
        cube.exit(vec3(x, 0.5, 0.0), kept, &Reach::anywhere(), |_| false)
            .map(|e| e.face)
    };
    assert_eq!(face(0.51, NO_FACE), Some(0));
    assert_eq!(face(0.51, 2), Some(2));
    assert_eq!(face(0.56, 2), Some(0));
}

#[test]
fn a_node_laid_into_a_body_goes_back_where_it_came_in() {
    let plate = Solid::Box {
        half: vec3(0.005, 0.25, 0.3),
    };
    let p = vec3(-0.003, 0.0, 0.0);
    let face = |before: Vec3<f64>, length: f64| {
        let from = vec3(before.x * 3.0, -0.02, 0.0);
        let reach = Reach {
            from,
            length,
            before,
        };
        plate.exit(p, NO_FACE, &reach, |_| false).map(|e| e.face)
    };
    assert_eq!(face(vec3(0.006, 0.01, 0.0), 0.05), Some(0), "in front");
    assert_eq!(face(vec3(-0.006, 0.01, 0.0), 0.05), Some(1), "behind");
    assert_eq!(face(vec3(0.001, 0.01, 0.0), 0.05), Some(1), "inside before");
    // Its own side is out of the segment's reach.
    assert_eq!(face(vec3(-0.02, 0.01, 0.0), 0.066), Some(1));
    assert_eq!(face(vec3(0.02, 0.01, 0.0), 0.054), Some(1));
}
