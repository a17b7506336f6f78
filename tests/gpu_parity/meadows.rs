//! Small meadows for the trials.

use std::f32::consts::TAU;
use std::sync::Arc;

use libtest_mimic::Failed;
use sward::base::philox::philox2x32;
use sward::field::Field;
use sward::scene::{
    Collider, Grass, Likes, LoadedScene, Phototropic, Solver, Species, parse_scene,
};
use sward::sim::Meadow;
use sward::terrain::{ColourMap, HeightGrid};

/// A field on bumpy ground with two kinds of plants and a density that is no whole number.
pub fn bumpy_field(solver: &Solver) -> Result<Field, Failed> {
    let plain = Species::default();
    leaning_field(solver, [plain.stiffness, [50.0, 400.0]], plain.lean_deg)
}

/// The same, its kinds of these stiffnesses, the second of which leans by this many degrees.
pub fn leaning_field(
    solver: &Solver,
    [first, second]: [[f32; 2]; 2],
    lean_deg: [f32; 2],
) -> Result<Field, Failed> {
    let mut ground = HeightGrid::flat(14, 11, 1.0);
    for (n, height) in ground.heights_m.iter_mut().enumerate() {
        *height = 2.3 + 0.8 * (TAU * n as f32 * 0.137).sin();
    }
    let grass = Grass {
        density_per_m2: 203.7,
        seed: 77,
        species: vec![
            Species {
                stiffness: first,
                ..Species::default()
            },
            Species {
                name: "fescue".into(),
                share: 0.4,
                height_m: [0.08, 0.2],
                stiffness: second,
                lean_deg,
                phototropic: Some(Phototropic {
                    light_deg: 150.0,
                    spread_deg: 120.0,
                }),
                flexibility: 0.6,
                ..Species::default()
            },
        ],
        ..Grass::default()
    };
    Ok(Field::new(ground, &grass, solver)?)
}

/// The scene file of the rolling ball.
fn ball_roll() -> Result<LoadedScene, Failed> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/ball_roll.ron");
    Ok(sward::scene::load_scene(path.as_ref(), &[])?)
}

/// The rolling ball with every body tested in one way.
pub fn rolling_ball(collider: Collider) -> Result<Meadow, Failed> {
    let mut loaded = ball_roll()?;
    for body in &mut loaded.scene.bodies {
        body.collider = collider;
    }
    Ok(Meadow::new(loaded.scene, &loaded.assets)?)
}

/// One body of each kind, pushed through the grass on hilly ground side by side.
pub fn parade(collider: &str) -> Result<Meadow, Failed> {
    let shapes = [
        "Ball(radius_m: 0.14)",
        "Box(size_m: (0.3, 0.24, 0.36))",
        "Capsule(radius_m: 0.1, length_m: 0.2)",
        "Cylinder(radius_m: 0.13, height_m: 0.28)",
        "ConvexHull(points_m: [(0.2, 0, 0), (-0.2, 0.02, 0), (0, 0.18, 0.03), (0, -0.16, 0), \
         (0.02, 0, 0.22), (0, 0.03, -0.2)])",
        "Compound(parts: [(shape: Box(size_m: (0.3, 0.1, 0.1))), \
         (shape: Box(size_m: (0.1, 0.3, 0.1)), position_m: (0.05, 0, 0.02), rotation_deg: (0, 20, 10))])",
    ];
    let mut bodies = String::new();
    for (n, shape) in shapes.iter().enumerate() {
        let z = -2.2 + 0.9 * n as f64;
        let way = |at: f64, x: f64, turn: f64| {
            format!(
                "(at_s: {at}, position_m: ({x}, 0.12, {z}), rotation_deg: ({turn}, {}, 12))",
                turn * 0.5
            )
        };
        bodies.push_str(&format!(
            "(name: \"b{n}\", shape: {shape}, position_m: (-1.4, 0.12, {z}), above_ground: true, \
             collider: {collider}, motion: Path(waypoints: [{}, {}])),",
            way(0.0, -1.4, 0.0),
            way(1.0, 1.1, 90.0),
        ));
    }
    let text = format!(
        "(duration_s: 1, \
          terrain: (ground: Rolling(size_m: (8, 8), amplitude_m: 0.15, wavelength_m: 5, seed: 3)), \
          bodies: [{bodies}])"
    );
    let loaded = parse_scene("parade", &text, &[])?;
    Ok(Meadow::new(loaded.scene, &loaded.assets)?)
}

/// A ball led over stones and thin grass.
pub fn shoved_stones() -> Result<Meadow, Failed> {
    let text = "(duration_s: 1, \
        terrain: (ground: Rolling(size_m: (4, 4), amplitude_m: 0.1, wavelength_m: 3)), \
        grass: (density_per_m2: 1000, species: [(share: 0.2), (form: Gravel, response: Stays, share: 0.2), \
            (form: Gravel, response: Shoved, height_m: (0.02, 0.06), lean_deg: (0, 5), stiffness: (4000, 4000))]), \
        bodies: [(name: \"ball\", shape: Ball(radius_m: 0.15), above_ground: true, motion: Path(waypoints: [ \
            (at_s: 0, position_m: (-1, 0.15, 0)), (at_s: 1, position_m: (1, 0.15, 0))]))])";
    let loaded = parse_scene("stones", text, &[])?;
    Ok(Meadow::new(loaded.scene, &loaded.assets)?)
}

/// The scene in which nothing moves.
pub fn still() -> Result<Meadow, Failed> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/still.ron");
    let loaded = sward::scene::load_scene(path.as_ref(), &[])?;
    Ok(Meadow::new(loaded.scene, &loaded.assets)?)
}

/// The same in clusters, with kinds that grow where a base map of coloured noise has what they like.
pub fn coloured_field(solver: &Solver, cluster: u32) -> Result<Field, Failed> {
    let mut ground = HeightGrid::flat(14, 11, 1.0);
    for (n, height) in ground.heights_m.iter_mut().enumerate() {
        *height = 2.3 + 0.8 * (TAU * n as f32 * 0.137).sin();
    }
    let liking = |hsv, exponent, dwindle| Likes {
        hsv,
        exponent,
        dwindle,
        ..Likes::default()
    };
    let kind = |name: &str, likes, share| Species {
        name: name.into(),
        likes: Some(likes),
        share,
        ..Species::default()
    };
    let grass = Grass {
        density_per_m2: 203.7,
        seed: 78,
        cluster,
        species: vec![
            kind("green", liking([110.0, 0.6, 0.4], 3.0, 0.7), 1.0),
            kind("red", liking([350.0, 0.5, 0.6], 2.0, 0.0), 9.0),
            kind("blue", liking([230.0, 0.9, 0.2], 5.5, 0.3), 2.0),
        ],
        bare: vec![liking([0.0, 0.0, 0.9], 4.0, 0.0)],
    };
    let (columns, rows) = (39, 30);
    let texels = (0..columns * rows).flat_map(|n| {
        let [a, _] = philox2x32([n, 3], 1, 7);
        let [r, g, b, _] = a.to_le_bytes();
        [r, g, b, 255]
    });
    let map = ColourMap {
        columns,
        rows,
        texel_m: 1.0 / 3.0,
        rgba8: texels.collect(),
    };
    Ok(Field::on_map(ground, Arc::new(map), &grass, solver)?)
}
