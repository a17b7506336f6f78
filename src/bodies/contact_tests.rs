//! Bodies and the ground.

use super::collider::LAND_M;
use super::tests::{DT_S, ball, body, place, run, world};
use crate::scene::{Motion, Shape};

#[test]
fn every_simple_shape_comes_to_rest_on_the_ground() {
    let shapes = [
        (Shape::Ball { radius_m: 0.15 }, 0.15),
        (
            Shape::Box {
                size_m: [0.4, 0.2, 0.3],
            },
            0.1,
        ),
        (
            Shape::Cylinder {
                radius_m: 0.2,
                height_m: 0.3,
            },
            0.15,
        ),
        (
            Shape::ConvexHull {
                points_m: vec![
                    [-0.2, -0.1, -0.2],
                    [0.2, -0.1, -0.2],
                    [-0.2, -0.1, 0.2],
                    [0.2, -0.1, 0.2],
                    [0.0, 0.2, 0.0],
                ],
            },
            0.1,
        ),
    ];
    for (shape, height_m) in shapes {
        let mut bodies = world(vec![body("a", shape.clone(), [0.3, height_m + 0.2, 0.4])]);
        run(&mut bodies, 0.0, 4.0);
        let off = place(&bodies, "a")[1] - height_m;
        // Rapier's slop is set to 0.5 mm.
        assert!(off.abs() < 5e-4, "{shape:?}: {off}");
        let link = &bodies.links()[0];
        assert_eq!(link.from, link.to, "{shape:?} still moves");
    }
}

#[test]
fn a_fast_ball_does_not_pass_the_ground() {
    let mut bullet = ball("a", [0.0, 20.0, 0.0]);
    bullet.motion = Motion::Thrown {
        velocity_m_per_s: [100.0, -400.0, 0.0],
        spin_deg_per_s: [0.0; 3],
    };
    let mut bodies = world(vec![bullet]);
    bodies.step(0.0, DT_S);
    let travel = bodies.links()[0].to.place - bodies.links()[0].from.place;
    // A step at 412 m/s, with no limit on its speed.
    assert!((travel.length() - 412.3 * DT_S).abs() < 0.01, "{travel:?}");
    run(&mut bodies, DT_S, 0.1);
    assert!(place(&bodies, "a")[1] > 0.0);
}

#[test]
fn what_does_not_move_keeps_its_bits() {
    let mut rock = ball("a", [0.1, 0.3, 0.7]);
    rock.rotation_deg = [13.0, 57.0, -98.0];
    rock.motion = Motion::Fixed;
    let mut bodies = world(vec![rock]);
    let before = bodies.links()[0].to;
    run(&mut bodies, 0.0, 0.1);
    assert_eq!(bodies.links()[0].from, before);
    assert_eq!(bodies.links()[0].to, before);
}

#[test]
fn a_body_beyond_the_land_falls_and_harms_nothing() {
    let mut bodies = world(vec![
        ball("a", [10.0 + LAND_M + 20.0, 1.0, 0.0]),
        ball("b", [0.0, 1.0, 0.0]),
        ball("c", [10.0 + 0.5 * LAND_M, 1.0, 0.0]),
    ]);
    run(&mut bodies, 0.0, 30.0);
    assert!(place(&bodies, "a")[1] < -1000.0);
    assert!((place(&bodies, "b")[1] - 0.15).abs() < 5e-4);
    assert!((place(&bodies, "c")[1] - 0.15).abs() < 5e-4);
    assert!(bodies.quarantined().is_empty());
}

#[test]
fn a_ball_bounces_as_its_restitution_says() {
    let mut bouncing = ball("a", [0.0, 1.15, 0.0]);
    bouncing.restitution = 0.6;
    let mut bodies = world(vec![bouncing]);
    let (mut speed, mut struck, mut left) = (0.0, 0.0, 0.0);
    for k in 0..120 {
        bodies.step(f64::from(k) * DT_S, DT_S);
        let info = bodies.info_of("a").expect("it is there");
        let before = speed;
        speed = info.velocity_m_per_s[1];
        if before < 0.0 && speed > 0.0 {
            (struck, left) = (-before, speed);
            break;
        }
    }
    // The ground has none of its own, so the ball's 0.6 counts whole; gravity changes the speed
    // by at most g·dt within the step.
    assert!(
        (left - 0.6 * struck).abs() < 1.6 * 9.81 * DT_S,
        "{struck} {left}"
    );
    assert!(struck > 4.0);
}
