//! Scenes of the accuracy report: bodies on paths, so that every method meets the same ones at the
//! same time whatever its sub-step, and flat ground, so that nothing else is measured.

use crate::scene::{LoadedScene, SceneError, parse_scene};

/// A scene of the report.
#[derive(Clone, Copy, Debug)]
pub struct AccuracyScene {
    pub name: &'static str,
    /// What it shows, in words.
    pub what: &'static str,
    /// Body and length of the run; the rest is common to all.
    body: &'static str,
    duration_s: f64,
}

/// Meadow, solver and wind of every scene: blades of 0.4 m, as the limits are stated for.
const COMMON: &str = r#"
    terrain: (ground: Flat(size_m: (8, 4))),
    grass: (density_per_m2: 256, species: [(name: "meadow grass", height_m: (0.38, 0.42), stiffness: (90, 160), lean_deg: (2, 12))]),
    wind: (strength: 0, gust: 0, flutter: 0),
"#;

/// Every scene of the report.
pub const SCENES: &[AccuracyScene] = &[
    AccuracyScene {
        name: "roll",
        what: "a ball of 0.15 m radius at 1 m/s",
        duration_s: 2.2,
        body: r#"(name: "ball", shape: Ball(radius_m: 0.15), motion: Path(waypoints: [
            (at_s: 0, position_m: (-1.0, 0.15, 0.1)),
            (at_s: 0.4, position_m: (-0.6, 0.15, 0.1), rotation_deg: (0, 0, -153)),
            (at_s: 0.8, position_m: (-0.2, 0.15, 0.1), rotation_deg: (0, 0, -306)),
            (at_s: 1.2, position_m: (0.2, 0.15, 0.1), rotation_deg: (0, 0, -458)),
            (at_s: 1.6, position_m: (0.6, 0.15, 0.1), rotation_deg: (0, 0, -611)),
        ]))"#,
    },
    AccuracyScene {
        name: "roll-3",
        what: "the same ball at 3 m/s",
        duration_s: 1.4,
        body: r#"(name: "ball", shape: Ball(radius_m: 0.15), motion: Path(waypoints: [
            (at_s: 0, position_m: (-1.4, 0.15, 0.1)),
            (at_s: 0.2, position_m: (-0.8, 0.15, 0.1), rotation_deg: (0, 0, -229)),
            (at_s: 0.4, position_m: (-0.2, 0.15, 0.1), rotation_deg: (0, 0, -458)),
            (at_s: 0.6, position_m: (0.4, 0.15, 0.1), rotation_deg: (0, 0, -688)),
            (at_s: 0.8, position_m: (1.0, 0.15, 0.1), rotation_deg: (0, 0, -917)),
        ]))"#,
    },
    AccuracyScene {
        name: "box-slide",
        what: "a turned box is pushed through at 1.2 m/s",
        duration_s: 1.8,
        body: r#"(name: "box", shape: Box(size_m: (0.3, 0.24, 0.4)), motion: Path(waypoints: [
            (at_s: 0, position_m: (-0.8, 0.121, 0), rotation_deg: (0, 25, 0)),
            (at_s: 0.4, position_m: (-0.32, 0.121, 0), rotation_deg: (0, 25, 0)),
            (at_s: 0.8, position_m: (0.16, 0.121, 0), rotation_deg: (0, 25, 0)),
            (at_s: 1.2, position_m: (0.64, 0.121, 0), rotation_deg: (0, 25, 0)),
        ]))"#,
    },
    AccuracyScene {
        name: "plate",
        what: "a plate of 10 mm, tilted by 37°, at 1.5 m/s",
        duration_s: 1.5,
        body: r#"(name: "plate", shape: Box(size_m: (0.4, 0.01, 0.5)), motion: Path(waypoints: [
            (at_s: 0, position_m: (-0.9, 0.2, 0), rotation_deg: (0, 0, 37)),
            (at_s: 0.3, position_m: (-0.45, 0.2, 0), rotation_deg: (0, 0, 37)),
            (at_s: 0.6, position_m: (0, 0.2, 0), rotation_deg: (0, 0, 37)),
            (at_s: 0.9, position_m: (0.45, 0.2, 0), rotation_deg: (0, 0, 37)),
        ]))"#,
    },
    AccuracyScene {
        name: "drop",
        what: "a ball comes down onto the ground and goes up again",
        duration_s: 1.8,
        body: r#"(name: "ball", shape: Ball(radius_m: 0.2), motion: Path(waypoints: [
            (at_s: 0, position_m: (0.1, 1, 0.1)),
            (at_s: 0.5, position_m: (0.1, 0.2, 0.1)),
            (at_s: 0.9, position_m: (0.1, 0.2, 0.1)),
            (at_s: 1.2, position_m: (0.1, 1, 0.1)),
        ]))"#,
    },
    AccuracyScene {
        name: "fork",
        what: "two prongs under a bar, which is not convex, at 1 m/s",
        duration_s: 1.8,
        body: r#"(name: "fork", shape: Compound(parts: [
            (shape: Box(size_m: (0.5, 0.2, 0.14)), position_m: (0, 0, -0.22)),
            (shape: Box(size_m: (0.5, 0.2, 0.14)), position_m: (0, 0, 0.22)),
            (shape: Box(size_m: (0.14, 0.2, 0.58)), position_m: (-0.3, 0, 0)),
        ]), motion: Path(waypoints: [
            (at_s: 0, position_m: (-0.6, 0.101, 0.1)),
            (at_s: 0.4, position_m: (-0.2, 0.101, 0.1)),
            (at_s: 0.8, position_m: (0.2, 0.101, 0.1)),
            (at_s: 1.2, position_m: (0.6, 0.101, 0.1)),
        ]))"#,
    },
];

impl AccuracyScene {
    /// The scene, read from its text.
    ///
    /// # Errors
    ///
    /// A text that breaks a limit, which the tests rule out.
    pub fn load(&self) -> Result<LoadedScene, SceneError> {
        let (what, duration_s, body) = (self.what, self.duration_s, self.body);
        let source = format!(
            "(\n    description: \"{what}\",\n    duration_s: {duration_s},{COMMON}    \
             bodies: [{body}],\n)\n"
        );
        parse_scene(self.name, &source, &[])
    }
}

/// The scene of a name.
pub fn scene(name: &str) -> Option<&'static AccuracyScene> {
    SCENES.iter().find(|scene| scene.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::accuracy::has_free_bodies;

    #[test]
    fn every_scene_loads_and_leads_its_bodies() {
        for named in SCENES {
            let loaded = named.load().expect("a scene of the program");
            assert!(!has_free_bodies(&loaded.scene), "{}", named.name);
        }
    }
}
