//! The description of a scene: what a `.ron` file says, with defaults and limits.
//!
//! No behaviour lives here. A scene is at once a menu entry of the window, a regression test and
//! a benchmark input. Every length is in metres, every time in seconds, every angle that a person
//! writes in degrees; keys carry their unit.

pub mod assets;
mod billboards;
mod body;
pub mod budget;
pub mod builtin;
mod camera;
mod coat;
mod error;
mod expect;
mod extent;
mod grass;
mod light;
pub mod limits;
mod load;
pub mod method;
mod positions;
mod schema;
mod script;
mod solver;
mod syntax;
mod terrain;
mod validate;
mod wind;

pub use billboards::{Billboards, ClumpKind, ClumpLook, Messiness, Season};
pub use body::{Body, Collider, Mass, Motion, Part, Shape, Waypoint};
pub use camera::Camera;
pub use coat::{Coat, CoatForm, CoatedSurface};
pub use error::{AssetError, Problem, SceneError};
pub use expect::Expectation;
pub use grass::{Form, Grass, Likes, Phototropic, Response, Species};
pub use light::LightVolumes;
pub use load::{
    LoadedScene, load_scene, parse_scene, parse_scene_with, parse_value, read_text, scene_files,
    to_ron, value_to_ron,
};
pub use method::Method;
pub use positions::Position;
pub use schema::json_schema;
pub use script::{Action, Event};
pub use solver::{PhiloxRounds, Root, Solver};
pub use syntax::probably_meant;
pub use terrain::{Ground, Terrain};
pub use validate::{Invalid, validate, validate_assets};
pub use wind::Wind;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One scene file. Every key has a default: the smallest scene is `()`.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scene {
    /// What the scene shows and what it checks, in a sentence or two.
    pub description: String,
    /// Simulated length of a headless run, in seconds.
    #[schemars(range(min = limits::DURATION.min, max = limits::DURATION.max))]
    pub duration_s: f64,
    /// The ground.
    pub terrain: Terrain,
    /// What grows on it.
    pub grass: Grass,
    /// Clumps of grass as billboards, beside the plants or in their place.
    pub billboards: Option<Billboards>,
    /// Wind at the start.
    pub wind: Wind,
    /// Rigid bodies present from the start. Names are unique in the scene.
    pub bodies: Vec<Body>,
    /// Timed events, in any order.
    pub script: Vec<Event>,
    /// Light from volumes: of the sky past the ground and the fixed bodies. Without it nothing hides the
    /// sky but the plants themselves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<LightVolumes>,
    /// Named views. Without one, a camera frames the bodies.
    pub cameras: Vec<Camera>,
    /// What must hold for the scene to pass.
    pub expect: Vec<Expectation>,
    /// Settings of the simulation.
    pub solver: Solver,
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            description: String::new(),
            duration_s: 4.0,
            terrain: Terrain::default(),
            grass: Grass::default(),
            billboards: None,
            wind: Wind::default(),
            bodies: Vec::new(),
            script: Vec::new(),
            light: None,
            cameras: Vec::new(),
            expect: Vec::new(),
            solver: Solver::default(),
        }
    }
}
