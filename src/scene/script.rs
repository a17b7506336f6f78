//! Timed events.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Body, Wind, limits};

/// Something that happens at a given time.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Seconds since the start; acts at the first sub-step that begins at or after it.
    pub at_s: f64,
    /// What happens.
    pub action: Action,
}

/// What an event does. `body` names a body of the scene or one spawned before.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub enum Action {
    /// Adds a body.
    Spawn(Box<Body>),
    /// Takes a body away; its imprint recovers.
    Remove {
        /// Its name.
        body: String,
    },
    /// Sets position and velocity at once; nothing in between is touched.
    Teleport {
        /// Its name.
        body: String,
        /// Place of its origin in the world.
        #[schemars(inner(range(min = limits::PLACE.min, max = limits::PLACE.max)))]
        position_m: [f64; 3],
        /// Along x, y and z of the world.
        #[serde(default)]
        #[schemars(inner(range(min = limits::VELOCITY.min, max = limits::VELOCITY.max)))]
        velocity_m_per_s: [f32; 3],
    },
    /// Sets the velocity.
    Throw {
        /// Its name.
        body: String,
        /// Along x, y and z of the world.
        #[schemars(inner(range(min = limits::VELOCITY.min, max = limits::VELOCITY.max)))]
        velocity_m_per_s: [f32; 3],
        /// About x, y and z of the world.
        #[serde(default)]
        #[schemars(inner(range(min = limits::SPIN.min, max = limits::SPIN.max)))]
        spin_deg_per_s: [f32; 3],
    },
    /// Adds momentum, in kilogram metres per second.
    Impulse {
        /// Its name.
        body: String,
        /// Along x, y and z of the world.
        #[schemars(inner(range(min = limits::IMPULSE.min, max = limits::IMPULSE.max)))]
        impulse_kg_m_per_s: [f32; 3],
    },
    /// Sets a vehicle's controls until the next `Drive`.
    Drive {
        /// The vehicle's name.
        body: String,
        /// Engine force over the four wheels, in newtons; negative drives backwards.
        #[schemars(range(min = limits::ENGINE_FORCE.min, max = limits::ENGINE_FORCE.max))]
        engine_n: f32,
        /// Turn of the front wheels, in degrees; positive steers to the left.
        #[serde(default)]
        #[schemars(range(min = limits::STEER.min, max = limits::STEER.max))]
        steer_deg: f32,
        /// Brake force, in newtons.
        #[serde(default)]
        #[schemars(range(min = limits::BRAKE_FORCE.min, max = limits::BRAKE_FORCE.max))]
        brake_n: f32,
    },
    /// Replaces the wind.
    SetWind(Wind),
}

impl Action {
    /// The name of the body an action needs to be there; `None` for spawning and for the wind.
    pub fn body(&self) -> Option<&str> {
        match self {
            Self::Spawn(_) | Self::SetWind(_) => None,
            Self::Remove { body }
            | Self::Teleport { body, .. }
            | Self::Throw { body, .. }
            | Self::Impulse { body, .. }
            | Self::Drive { body, .. } => Some(body),
        }
    }
}
