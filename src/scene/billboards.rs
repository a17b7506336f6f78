//! Clumps of grass as billboards: O09 section 4.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::limits;

/// A cover of semi-transparent quads, each of which stands for a clump of grass. Three maps say where
/// they grow, which way, and how untidily. A map covers the whole ground in its proportions, its first
/// row at the smallest z; it is looked up like every asset. Between texels it is mixed.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Billboards {
    /// Mean number of billboards per square metre of the ground's plan where the extent map is white.
    #[schemars(range(min = limits::BILLBOARD_DENSITY.min, max = limits::BILLBOARD_DENSITY.max))]
    pub density_per_m2: f32,
    /// Key of the random numbers of every billboard.
    pub seed: u32,
    /// Columns and rows of nodes that a billboard has while it is touched and until it has recovered.
    #[schemars(inner(range(min = limits::BILLBOARD_NODES.min, max = limits::BILLBOARD_NODES.max)))]
    pub nodes: [u32; 2],
    /// Drawn segments per segment between the nodes of a touched billboard: more than 1 draw the smooth
    /// surface through the nodes, 1 the nodes joined by straight lines, 0 the quad as if nothing had
    /// touched it.
    #[schemars(range(min = limits::DRAW_SUBDIVISION.min, max = limits::DRAW_SUBDIVISION.max))]
    pub draw_subdivision: u32,
    /// Kinds of clumps, 1 to 8.
    #[schemars(length(min = 1, max = limits::CLUMPS))]
    pub clumps: Vec<ClumpKind>,
    /// Where billboards grow: a grey PNG of 8 or 16 bits. A billboard stands at a place with the chance
    /// that its grey says, none where it is black. Without a map they grow everywhere.
    pub extent: Option<String>,
    /// Which way they grow: an 8-bit RGB PNG. A colour c means the direction 2c − 1 along x, y (up) and
    /// z; it must have a length of at least 0.1 and point above the ground's level. Without a map they
    /// grow straight up.
    pub direction: Option<String>,
    /// How much billboards stray from the direction.
    pub messiness: Messiness,
    /// Whether maps of different sizes are brought to the size of the largest. Without it they are an
    /// error.
    pub resample: bool,
}

impl Default for Billboards {
    fn default() -> Self {
        Self {
            density_per_m2: 24.0,
            seed: 1,
            nodes: [4, 4],
            draw_subdivision: 2,
            clumps: vec![ClumpKind::default()],
            extent: None,
            direction: None,
            messiness: Messiness::default(),
            resample: false,
        }
    }
}

impl Billboards {
    /// The maps the scene names, each with its key.
    pub fn maps(&self) -> impl Iterator<Item = (&'static str, &String)> {
        let messiness = match &self.messiness {
            Messiness::Even(_) => None,
            Messiness::Map(file) => Some(file),
        };
        [
            ("extent", self.extent.as_ref()),
            ("direction", self.direction.as_ref()),
            ("messiness", messiness),
        ]
        .into_iter()
        .filter_map(|(key, file)| Some((key, file?)))
    }
}

/// How much billboards stray from the direction map: at 0 they grow along it and show their faces the
/// way they lean; at 1 they lean from it by up to 45 degrees to any side and face anywhere.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub enum Messiness {
    /// The same everywhere, 0 to 1.
    Even(f32),
    /// A grey PNG of 8 or 16 bits: black is 0, white is 1.
    Map(String),
}

impl Default for Messiness {
    fn default() -> Self {
        Self::Even(0.3)
    }
}

/// One kind of clump. Pairs are smallest and largest value; a billboard draws evenly between them.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ClumpKind {
    /// For people.
    pub name: String,
    /// The plants its pictures show.
    pub look: ClumpLook,
    /// The time of the year its pictures show.
    pub season: Season,
    /// Share of this kind among all billboards, relative to the other kinds' shares.
    #[schemars(range(min = limits::SHARE.min, max = limits::SHARE.max))]
    pub share: f32,
    /// Height of the quad along its growth direction, in metres; kept to 1/4096 m.
    #[schemars(inner(range(min = limits::CLUMP_SIZE.min, max = limits::CLUMP_SIZE.max)))]
    pub height_m: [f32; 2],
    /// Width of the quad, in metres; kept to 1/4096 m.
    #[schemars(inner(range(min = limits::CLUMP_SIZE.min, max = limits::CLUMP_SIZE.max)))]
    pub width_m: [f32; 2],
    /// How far wind bends the upper edge: 0 rigid, 1 as the wind's strength says; kept to 1/4096.
    #[schemars(range(min = limits::FLEXIBILITY.min, max = limits::FLEXIBILITY.max))]
    pub flexibility: f32,
    /// Colour relative to that of the pictures, linear RGB factors.
    #[schemars(inner(range(min = limits::TINT.min, max = limits::TINT.max)))]
    pub tint_rgb: [f32; 3],
}

impl Default for ClumpKind {
    fn default() -> Self {
        Self {
            name: "meadow clump".into(),
            look: ClumpLook::default(),
            season: Season::default(),
            share: 1.0,
            height_m: [0.3, 0.5],
            width_m: [0.35, 0.55],
            flexibility: 1.0,
            tint_rgb: [1.0; 3],
        }
    }
}

/// The plants of a clump's pictures.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
pub enum ClumpLook {
    /// Many thin blades.
    #[default]
    Fine,
    /// Fewer, wider blades.
    Broad,
    /// Stiff upright stalks.
    Reed,
    /// Thin blades with flower heads among them.
    Flowering,
}

/// The time of the year of a clump's pictures.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
pub enum Season {
    /// Short and light green.
    Spring,
    /// Full-grown and green.
    #[default]
    Summer,
    /// Yellowing, with dry blades among green ones.
    Autumn,
    /// Dry, brown and thin.
    Winter,
}
