//! How a vehicle drives.

use super::tests::{body, run, world};
use super::*;
use crate::base::Vec3;
use crate::scene::assets::Assets;
use crate::scene::{Action, Body, Ground, Mass, Scene, Shape, Terrain};
use crate::terrain::height_grid;

const RADIUS_M: f64 = 0.35;
/// Half the chassis's height and a radius: the floor rests level with the axles.
const RIDE_M: f64 = 0.3 + RADIUS_M;

fn car() -> Body {
    let shape = Shape::Vehicle {
        chassis_m: [1.5, 0.6, 3.2],
        wheel_radius_m: RADIUS_M as f32,
        wheel_width_m: 0.22,
    };
    let mut car = body("car", shape, [0.0, RIDE_M, -12.0]);
    car.mass = Mass::Kilograms(900.0);
    car
}

fn drive(bodies: &mut Bodies, engine_n: f32, steer_deg: f32, brake_n: f32) {
    let action = Action::Drive {
        body: "car".into(),
        engine_n,
        steer_deg,
        brake_n,
    };
    bodies.apply(&action, 0.0).expect("a car can be driven");
}

fn car_of(bodies: &Bodies) -> BodyInfo<'_> {
    bodies.info_of("car").expect("the car is there")
}

/// Up and ahead of the chassis.
fn axes(bodies: &Bodies) -> [Vec3<f64>; 2] {
    let turn = car_of(bodies).pose.turn;
    [Vec3::UP, Vec3::new(0.0, 0.0, 1.0)].map(|axis| turn.rotate(axis))
}

#[test]
fn it_stands_on_its_wheels_and_falls_asleep() {
    let mut bodies = world(vec![car()]);
    assert_eq!(bodies.links().len(), 5);
    assert_eq!(bodies.shapes().len(), 2, "four wheels share a shape");
    run(&mut bodies, 0.0, 5.0);
    let height = car_of(&bodies).pose.place.y;
    // Balanced springs: the damped rest of a 1.7 Hz swing after 5 s, and f32.
    assert!((height - RIDE_M).abs() < 2e-3, "{height}");
    for wheel in &bodies.links()[1..] {
        assert!((wheel.to.place.y - RADIUS_M).abs() < 2e-3, "{wheel:?}");
        let axle = wheel.to.turn.rotate(Vec3::UP);
        assert!(axle.x.abs() > 1.0 - 1e-6, "a wheel stands across");
    }
    assert!(!car_of(&bodies).awake);
    let links = bodies.links().to_vec();
    run(&mut bodies, 5.0, 0.5);
    for (before, after) in links.iter().zip(bodies.links()) {
        assert_eq!(before.to, after.to, "a sleeping car keeps its bits");
    }
}

#[test]
fn it_drives_straight_on_level_ground() {
    let mut bodies = world(vec![car()]);
    run(&mut bodies, 0.0, 0.5);
    drive(&mut bodies, 1800.0, 0.0, 0.0);
    run(&mut bodies, 0.5, 3.0);
    let info = car_of(&bodies);
    let ahead = info.pose.place.z + 12.0;
    // 1,800 N less 5% of the weight on 900 kg for 3 s: 1.51 m/s² and 6.8 m.
    let want = 0.5 * (1800.0 / 900.0 - 0.05 * 9.81) * 9.0;
    assert!((ahead - want).abs() < 0.05 * want, "{ahead} {want}");
    assert!(info.pose.place.x.abs() < 0.01, "{:?}", info.pose.place);
    let spin = &bodies.links()[1];
    let turned = spin.from.turn.inverse().then(spin.to.turn).v.x;
    let angle = 2.0 * turned.abs();
    let rolled = info.velocity_m_per_s[2] / 120.0 / RADIUS_M;
    assert!((angle - rolled).abs() < 0.05 * rolled, "{angle} {rolled}");
    assert!(turned > 0.0, "wheels roll ahead about +x");
}

#[test]
fn it_steers_to_the_side_asked_for() {
    for (steer_deg, side) in [(15.0, 1.0), (-15.0, -1.0)] {
        let mut bodies = world(vec![car()]);
        drive(&mut bodies, 1500.0, steer_deg, 0.0);
        run(&mut bodies, 0.0, 3.0);
        let x = side * car_of(&bodies).pose.place.x;
        let [up, ahead] = axes(&bodies);
        assert!(
            x > 0.5 && side * ahead.x > 0.2,
            "{steer_deg}: {x} {ahead:?}"
        );
        assert!(up.y > 0.99, "{up:?}");
    }
}

#[test]
fn it_brakes_within_its_grip_and_rolls_out_without() {
    let stop = |brake_n: f32, seconds: f64| {
        let mut bodies = world(vec![car()]);
        run(&mut bodies, 0.0, 1.0);
        let throw = Action::Throw {
            body: "car".into(),
            velocity_m_per_s: [0.0, 0.0, 6.0],
            spin_deg_per_s: [0.0; 3],
        };
        bodies.apply(&throw, 1.0).expect("a car is free");
        drive(&mut bodies, 0.0, 0.0, brake_n);
        let start = car_of(&bodies).pose.place.z;
        run(&mut bodies, 1.0, seconds);
        let info = car_of(&bodies);
        (info.pose.place.z - start, info.velocity_m_per_s[2])
    };
    // v²/2a with a = F/m plus the rolling resistance.
    let (way, speed) = stop(2700.0, 3.0);
    let want = 18.0 / (3.0 + 0.05 * 9.81);
    assert!(
        speed.abs() < 0.02 && (way - want).abs() < 0.1 * want,
        "{way} {want} {speed}"
    );
    let (_, rolling) = stop(0.0, 3.0);
    let want = 6.0 - 3.0 * 0.05 * 9.81;
    assert!((rolling - want).abs() < 0.2, "{rolling} {want}");
}

#[test]
fn it_keeps_its_wheels_down_on_gentle_hills() {
    let scene = Scene {
        terrain: Terrain {
            ground: Ground::Rolling {
                size_m: [128.0, 128.0],
                spacing_m: 1.0,
                amplitude_m: 0.8,
                wavelength_m: 16.0,
                octaves: 3,
                seed: 1,
            },
            ..Terrain::default()
        },
        bodies: vec![Body {
            above_ground: true,
            ..car()
        }],
        ..Scene::default()
    };
    let assets = Assets::default();
    let ground = height_grid(&scene.terrain, &assets).expect("sound hills");
    let mut bodies = Bodies::new(&scene, &assets, &ground).expect("a sound car");
    drive(&mut bodies, 2500.0, 6.0, 0.0);
    for k in 0..8 {
        run(&mut bodies, f64::from(k), 1.0);
        let place = car_of(&bodies).pose.place;
        let [up, _] = axes(&bodies);
        assert!(up.y > 0.8, "{k} s: it tips, {up:?}");
        let above = place.y - ground.height_in_world(place.x, place.z);
        assert!((0.3..1.2).contains(&above), "{k} s: {above} m above ground");
    }
    let way = (car_of(&bodies).pose.place - Vec3::new(0.0, 0.0, -12.0)).length();
    assert!(way > 8.0, "{way}");
}

#[test]
fn only_free_vehicles_drive() {
    let mut bodies = world(vec![body("rock", Shape::Ball { radius_m: 0.2 }, [0.0; 3])]);
    let action = Action::Drive {
        body: "rock".into(),
        engine_n: 1.0,
        steer_deg: 0.0,
        brake_n: 0.0,
    };
    assert!(matches!(
        bodies.apply(&action, 0.0),
        Err(BodyError::NotAVehicle { .. })
    ));
    let mut held = car();
    held.motion = crate::scene::Motion::Fixed;
    assert!(matches!(
        bodies.drop_body(&held, 0.0),
        Err(BodyError::HeldVehicle { .. })
    ));
}
