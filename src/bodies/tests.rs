//! Laws of the bodies' world.

use super::*;
use crate::base::Vec3;
use crate::scene::assets::Assets;
use crate::scene::{Action, Body, Collider, Event, Mass, Motion, Scene, Shape, Waypoint};
use crate::terrain::HeightGrid;

pub(super) const DT_S: f64 = 1.0 / 120.0;

pub(super) fn body(name: &str, shape: Shape, position_m: [f64; 3]) -> Body {
    Body {
        name: name.into(),
        shape,
        position_m,
        above_ground: false,
        rotation_deg: [0.0; 3],
        motion: Motion::Free,
        mass: Mass::default(),
        friction: 0.6,
        restitution: 0.0,
        damping: [0.0; 2],
        collider: Collider::Auto,
        rgb: [0.5; 3],
        coat: None,
    }
}

pub(super) fn ball(name: &str, position_m: [f64; 3]) -> Body {
    body(name, Shape::Ball { radius_m: 0.15 }, position_m)
}

pub(super) fn ground() -> HeightGrid {
    HeightGrid::flat(41, 41, 1.0)
}

pub(super) fn world(bodies: Vec<Body>) -> Bodies {
    let scene = Scene {
        bodies,
        ..Scene::default()
    };
    Bodies::new(&scene, &Assets::default(), &ground()).expect("the scene is sound")
}

pub(super) fn run(bodies: &mut Bodies, from_s: f64, seconds: f64) {
    for k in 0..(seconds / DT_S).round() as u32 {
        bodies.step(from_s + f64::from(k) * DT_S, DT_S);
    }
}

pub(super) fn place(bodies: &Bodies, name: &str) -> [f64; 3] {
    let info = bodies.info_of(name).expect("the body is there");
    info.pose.place.to_f64()
}

#[test]
fn free_fall_follows_the_closed_form() {
    let mut bodies = world(vec![ball("a", [0.0, 100.0, 0.0])]);
    run(&mut bodies, 0.0, 2.0);
    let want = 100.0 - 0.5 * 9.81 * 4.0;
    // A semi-implicit step lags by g·t·dt/2 at most; f32 adds 4e-6 m at each of 240 steps.
    let limit = 0.5 * 9.81 * 2.0 * DT_S + 240.0 * 4e-6;
    let off = (place(&bodies, "a")[1] - want).abs();
    assert!(off < limit, "{off} {limit}");
    let speed = bodies.info_of("a").expect("it is there").velocity_m_per_s[1];
    assert!((speed + 9.81 * 2.0).abs() < 1e-3, "{speed}");
}

#[test]
fn the_order_in_the_file_does_not_matter() {
    let pile = |order: &[usize]| {
        let all = [
            ball("a", [0.0, 0.5, 0.0]),
            ball("b", [0.05, 0.9, 0.02]),
            body(
                "c",
                Shape::Box {
                    size_m: [0.3, 0.2, 0.4],
                },
                [0.1, 1.4, -0.05],
            ),
            ball("d", [0.1, 1.9, 0.1]),
        ];
        let mut bodies = world(order.iter().map(|&i| all[i].clone()).collect());
        run(&mut bodies, 0.0, 2.0);
        let ids: Vec<u32> = bodies.links().iter().map(|l| l.body).collect();
        assert_eq!(ids, [0, 1, 2, 3]);
        bodies.hash()
    };
    let hash = pile(&[0, 1, 2, 3]);
    assert_eq!(hash, pile(&[3, 1, 0, 2]));
    assert_eq!(hash, pile(&[2, 3, 1, 0]));
}

#[test]
fn bodies_come_go_and_jump() {
    let mut scene = Scene {
        bodies: vec![ball("m", [0.0, 0.15, 0.0])],
        ..Scene::default()
    };
    let spawn = Action::Spawn(Box::new(ball("b", [3.0, 0.15, 0.0])));
    scene.script.push(Event {
        at_s: 0.5,
        action: spawn.clone(),
    });
    let mut bodies =
        Bodies::new(&scene, &Assets::default(), &ground()).expect("the scene is sound");
    // The rank counts the body that is spawned later.
    assert_eq!(bodies.links()[0].body, 1);
    run(&mut bodies, 0.0, 0.5);
    bodies.apply(&spawn, 0.5).expect("the name is free");
    assert!(matches!(
        bodies.apply(&spawn, 0.5),
        Err(BodyError::DuplicateName { .. })
    ));
    let ids: Vec<u32> = bodies.links().iter().map(|l| l.body).collect();
    assert_eq!(ids, [0, 1]);
    assert_eq!(bodies.shapes().len(), 1, "equal shapes are shared");

    let teleport = Action::Teleport {
        body: "m".into(),
        position_m: [10.0, 5.0, -3.0],
        velocity_m_per_s: [0.0, 1.0, 0.0],
    };
    bodies.apply(&teleport, 0.5).expect("m is free");
    let link = &bodies.links()[1];
    assert_eq!(link.from, link.to);
    assert_eq!(link.to.place.to_f64(), [10.0, 5.0, -3.0]);
    bodies.step(0.5, DT_S);
    let rise = bodies.links()[1].to.place.y - 5.0;
    // Gravity takes at most g·dt² of the way of 1 m/s.
    assert!((rise - DT_S).abs() <= 9.81 * DT_S * DT_S + 1e-6, "{rise}");

    let remove = Action::Remove { body: "b".into() };
    bodies.apply(&remove, 0.6).expect("b is there");
    assert_eq!(bodies.links().len(), 1);
    assert!(matches!(
        bodies.apply(&remove, 0.6),
        Err(BodyError::UnknownBody { .. })
    ));
    let dropped = bodies
        .drop_body(&ball("m", [0.0, 1.0, 0.0]), 0.6)
        .expect("a ball is sound");
    assert_eq!(dropped, "m 2");
    assert_eq!(bodies.info_of("m 2").map(|info| info.id), Some(2));
}

#[test]
fn throws_and_impulses_set_and_add_velocity() {
    let mut thrown = ball("a", [0.0, 5.0, 0.0]);
    thrown.mass = Mass::Kilograms(2.0);
    thrown.motion = Motion::Thrown {
        velocity_m_per_s: [1.0, 0.0, 0.0],
        spin_deg_per_s: [0.0, 180.0, 0.0],
    };
    let mut bodies = world(vec![thrown]);
    let info = |bodies: &Bodies| {
        let info = bodies.info_of("a").expect("it is there");
        (info.velocity_m_per_s, info.spin_rad_per_s, info.mass_kg)
    };
    let (velocity, spin, mass) = info(&bodies);
    assert_eq!(velocity, [1.0, 0.0, 0.0]);
    assert!((spin[1] - std::f64::consts::PI).abs() < 1e-6);
    assert!((mass - 2.0).abs() < 1e-6);
    let push = Action::Impulse {
        body: "a".into(),
        impulse_kg_m_per_s: [0.0, 0.0, 3.0],
    };
    bodies.apply(&push, 0.0).expect("a is free");
    assert!((info(&bodies).0[2] - 1.5).abs() < 1e-6);
    let throw = Action::Throw {
        body: "a".into(),
        velocity_m_per_s: [0.0, 2.0, 0.0],
        spin_deg_per_s: [0.0; 3],
    };
    bodies.apply(&throw, 0.0).expect("a is free");
    assert_eq!(info(&bodies).0, [0.0, 2.0, 0.0]);
}

#[test]
fn damping_is_the_share_lost_in_a_second() {
    let mut slowed = ball("a", [0.0, 500.0, 0.0]);
    slowed.damping = [0.5, 0.0];
    slowed.motion = Motion::Thrown {
        velocity_m_per_s: [8.0, 0.0, 0.0],
        spin_deg_per_s: [0.0; 3],
    };
    let mut bodies = world(vec![slowed]);
    run(&mut bodies, 0.0, 1.0);
    let left = bodies.info_of("a").expect("it is there").velocity_m_per_s[0] / 8.0;
    // Rapier divides by 1 + c·dt each step instead of e^(c·dt): c²·dt/2 off over a second.
    assert!(
        (left - 0.5).abs() < 0.5 * 0.5 * 0.693 * 0.693 * DT_S + 1e-4,
        "{left}"
    );
}

#[test]
fn poison_is_taken_out_and_the_others_go_on() {
    let fall = |poisoned: bool| {
        let mut bodies = world(vec![ball("a", [0.0, 5.0, 0.0]), ball("b", [3.0, 5.0, 0.0])]);
        run(&mut bodies, 0.0, 0.25);
        if poisoned {
            let throw = Action::Throw {
                body: "b".into(),
                velocity_m_per_s: [f32::INFINITY, 0.0, 0.0],
                spin_deg_per_s: [0.0; 3],
            };
            bodies.apply(&throw, 0.25).expect("b is free");
            assert_eq!(bodies.quarantined(), ["b"]);
            bodies.apply(&throw, 0.25).expect("without effect");
        }
        run(&mut bodies, 0.25, 0.5);
        assert_eq!(bodies.links().len(), if poisoned { 1 } else { 2 });
        place(&bodies, "a")
    };
    assert_eq!(fall(true), fall(false));
    let far = ball("far", [1e39, 0.0, 0.0]);
    assert_eq!(world(vec![far]).quarantined(), ["far"]);
}

#[test]
fn a_state_that_breaks_inside_rapier_is_quarantined() {
    let mut bodies = world(vec![ball("a", [0.0, 5.0, 0.0]), ball("b", [3.0, 5.0, 0.0])]);
    let handle = bodies.actors["b"].handle;
    let inner = &mut bodies.physics.bodies[handle];
    inner.set_linvel(rapier3d::math::Vector::new(f32::NAN, 0.0, 0.0), true);
    bodies.step(0.0, DT_S);
    assert_eq!(bodies.quarantined(), ["b"]);
    assert_eq!(bodies.links().len(), 1);
    assert!(bodies.links()[0].to.is_finite());
}

#[test]
fn bad_times_move_nothing() {
    let mut bodies = world(vec![ball("a", [0.0, 5.0, 0.0])]);
    let before = bodies.hash();
    for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        bodies.step(0.0, dt);
    }
    bodies.step(f64::NAN, DT_S);
    assert_eq!(bodies.hash(), before);
}

#[test]
fn a_body_on_a_path_is_where_the_path_says() {
    let mut mover = ball("a", [9.0, 9.0, 9.0]);
    let at = |at_s, x| Waypoint {
        at_s,
        position_m: [x, 0.15, 0.0],
        rotation_deg: [0.0; 3],
    };
    mover.motion = Motion::Path {
        waypoints: vec![at(0.0, 0.0), at(1.0, 2.0), at(2.0, 2.0)],
        repeat: true,
    };
    let mut bodies = world(vec![mover]);
    assert_eq!(place(&bodies, "a"), [0.0, f64::from(0.15_f32), 0.0]);
    run(&mut bodies, 0.0, 1.0);
    assert!((place(&bodies, "a")[0] - 2.0).abs() < 1e-6);
    run(&mut bodies, 1.0, 1.0);
    // The open lap ended: back at the start, with nothing swept on the way.
    let link = &bodies.links()[0];
    assert!(
        link.to.place.x.abs() < 1e-6 && link.from == link.to,
        "{link:?}"
    );
    let speed = bodies.info_of("a").expect("it is there").velocity_m_per_s;
    assert!(speed[0].abs() < 1e-3, "{speed:?}");
    assert!(matches!(
        bodies.apply(
            &Action::Throw {
                body: "a".into(),
                velocity_m_per_s: [1.0; 3],
                spin_deg_per_s: [0.0; 3]
            },
            2.0
        ),
        Err(BodyError::NotFree { .. })
    ));
}

#[test]
fn a_ray_finds_the_body_and_the_ground() {
    let bodies = world(vec![ball("a", [2.0, 0.15, 0.0])]);
    let down = |x| bodies.ray([x, 5.0, 0.0], [0.0, -2.0, 0.0], 10.0);
    let hit = down(2.0).expect("the ball is there");
    assert_eq!(hit.body, Some("a"));
    assert!((Vec3::of(hit.point_m) - Vec3::new(2.0, 0.3, 0.0)).length() < 1e-5);
    let hit = down(0.0).expect("the ground is there");
    assert_eq!(hit.body, None);
    assert!(hit.point_m[1].abs() < 1e-5);
    assert_eq!(bodies.ray([0.0, 5.0, 0.0], [0.0, 1.0, 0.0], 10.0), None);
}

#[test]
fn impossible_bodies_are_refused() {
    let refuse = |body: Body| {
        let scene = Scene {
            bodies: vec![body],
            ..Scene::default()
        };
        Bodies::new(&scene, &Assets::default(), &ground())
            .err()
            .map(|e| e.to_string())
    };
    let flat = body(
        "a",
        Shape::ConvexHull {
            points_m: vec![[0.0; 3]; 5],
        },
        [0.0; 3],
    );
    assert!(refuse(flat).is_some_and(|e| e.contains("no volume")));
    let mut weightless = ball("a", [0.0; 3]);
    weightless.mass = Mass::Kilograms(0.0);
    assert!(refuse(weightless).is_some_and(|e| e.contains("mass")));
    let mesh = Shape::Mesh {
        file: "nowhere.obj".into(),
        scale: 1.0,
        max_parts: 4,
    };
    assert!(refuse(body("a", mesh, [0.0; 3])).is_some_and(|e| e.contains("nowhere.obj")));
}
