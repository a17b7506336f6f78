//! Light volumes of a stage: worked out on other threads while the scene is drawn in plain light, and
//! kept on disk.

mod cache;
mod job;
mod stage_light;

pub use cache::{Found, LightCache};
pub use job::{LightJob, LightMade, LightSource, LightTask};
pub use stage_light::{LightNews, StageLight};

#[cfg(test)]
mod tests;
