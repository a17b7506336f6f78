//! The plants of a meadow, as ranges from which each seed draws.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::limits;

/// The plant cover of a scene.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Grass {
    /// Mean number of plants per square metre of the ground's plan, 0 or more.
    #[schemars(range(min = limits::PLANT_DENSITY.min, max = limits::PLANT_DENSITY.max))]
    pub density_per_m2: f32,
    /// Key of the random numbers of every plant.
    pub seed: u32,
    /// Seeds of a cluster, which lie together and are of one kind: P15 section 3.4. 1 for plants that
    /// stand alone.
    #[schemars(range(min = limits::CLUSTER.min, max = limits::CLUSTER.max))]
    pub cluster: u32,
    /// Kinds of plants; at most 8. An empty list grows nothing.
    #[schemars(length(max = limits::SPECIES))]
    pub species: Vec<Species>,
    /// Grounds on which nothing grows, at most 4, for kinds that have `likes`: where one of these is
    /// liked more than every kind, the ground stays bare.
    #[schemars(length(max = limits::BARE_GROUNDS))]
    pub bare: Vec<Likes>,
}

impl Grass {
    /// Whether kinds are chosen by the colour of the ground, not by their shares alone.
    pub fn grows_by_colour(&self) -> bool {
        self.species.iter().any(|kind| kind.likes.is_some())
    }
}

impl Default for Grass {
    fn default() -> Self {
        Self {
            density_per_m2: 256.0,
            seed: 1,
            cluster: 1,
            species: vec![Species::default()],
            bare: Vec::new(),
        }
    }
}

/// One kind of plant. Pairs are smallest and largest value; a plant draws evenly between them.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Species {
    /// For people.
    pub name: String,
    /// What it looks like.
    pub form: Form,
    /// What it does when a body comes.
    pub response: Response,
    /// The ground it grows on: all kinds say so, or none. Then a plant's kind follows from the base
    /// map's colour at its root.
    pub likes: Option<Likes>,
    /// Share of this kind among all plants, relative to the other kinds' shares; with `likes`, a
    /// factor of its score.
    #[schemars(range(min = limits::SHARE.min, max = limits::SHARE.max))]
    pub share: f32,
    /// Length of the blade along its centre line, in metres.
    #[schemars(inner(range(min = limits::PLANT_HEIGHT.min, max = limits::PLANT_HEIGHT.max)))]
    pub height_m: [f32; 2],
    /// Width at the root, in metres.
    #[schemars(inner(range(min = limits::PLANT_WIDTH.min, max = limits::PLANT_WIDTH.max)))]
    pub width_m: [f32; 2],
    /// k′ of P15 eq. 12 for eight segments: spring constant over segment weight and length.
    #[schemars(inner(range(min = limits::STIFFNESS.min, max = limits::STIFFNESS.max)))]
    pub stiffness: [f32; 2],
    /// Lean of the root from the vertical, in degrees.
    #[schemars(inner(range(min = limits::ROOT_LEAN.min, max = limits::ROOT_LEAN.max)))]
    pub lean_deg: [f32; 2],
    /// Where its plants lean to; without it to all sides alike.
    pub phototropic: Option<Phototropic>,
    /// How far wind bends the tip: 0 rigid, 1 as the wind's strength says.
    #[schemars(range(min = limits::FLEXIBILITY.min, max = limits::FLEXIBILITY.max))]
    pub flexibility: f32,
    /// Colour of the blade relative to the ground under it, linear RGB factors.
    #[schemars(inner(range(min = limits::TINT.min, max = limits::TINT.max)))]
    pub tint_rgb: [f32; 3],
}

impl Default for Species {
    fn default() -> Self {
        Self {
            name: "meadow grass".into(),
            form: Form::default(),
            response: Response::default(),
            likes: None,
            share: 1.0,
            height_m: [0.25, 0.42],
            width_m: [0.005, 0.009],
            stiffness: [60.0, 160.0],
            lean_deg: [2.0, 16.0],
            phototropic: None,
            flexibility: 1.0,
            tint_rgb: [1.0, 1.0, 1.0],
        }
    }
}

/// A kind that grows towards the light: P15 section 2.3. The directions its plants lean to are dense
/// about the light's and thin out evenly to both sides.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Phototropic {
    /// Direction towards the light, from +x towards +z, in degrees.
    #[schemars(range(min = limits::ANGLE.min, max = limits::ANGLE.max))]
    pub light_deg: f32,
    /// Largest angle between the light and where a plant leans to, in degrees.
    #[schemars(range(min = limits::AZIMUTH_SPREAD.min, max = limits::AZIMUTH_SPREAD.max))]
    pub spread_deg: f32,
}

impl Default for Phototropic {
    /// The sun of pictures, unless it is told otherwise.
    fn default() -> Self {
        Self {
            light_deg: 215.0,
            spread_deg: 90.0,
        }
    }
}

/// The shape a kind of plant is drawn with. Its sizes are the kind's `height_m` and `width_m`.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub enum Form {
    /// A blade of grass with companions around it.
    #[default]
    Blade,
    /// A stem with a flower head that looks at the sky.
    Flower {
        /// Diameter of the head, in metres.
        #[schemars(range(min = limits::PLANT_WIDTH.min, max = limits::PLANT_WIDTH.max))]
        head_m: f32,
        /// Petals of the head.
        #[serde(default = "thirteen")]
        #[schemars(range(min = limits::PETALS.min, max = limits::PETALS.max))]
        petals: u32,
        /// Linear RGB.
        #[schemars(inner(range(min = limits::FRACTION.min, max = limits::FRACTION.max)))]
        petal_rgb: [f32; 3],
        /// Linear RGB of the middle.
        #[schemars(inner(range(min = limits::FRACTION.min, max = limits::FRACTION.max)))]
        centre_rgb: [f32; 3],
    },
    /// A broad leaf with a midrib.
    Leaf,
    /// A thin round stick with a side branch.
    Twig,
    /// A stone: `height_m` is its length, `width_m` its thickness. It does not bend: its `response` is
    /// `Shoved` or `Stays`.
    Gravel,
}

fn thirteen() -> u32 {
    13
}

/// What a kind of plant does when a body comes.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
pub enum Response {
    /// It is pushed aside, and rises again.
    #[default]
    Bends,
    /// It stays where it is; bodies pass through it.
    Stays,
    /// It keeps its shape, is shoved aside and rocked, and goes back: for `Gravel` only. Bodies push the
    /// centre line that it would have if it bent, and it is moved by as much as the tip of that is, level:
    /// by at most its length, where that line stands upright and straight (`lean_deg` near 0, `stiffness`
    /// of some thousands). Then bodies pass over it. It is back after the scene's recovery time: nothing
    /// is kept of plants at rest, so that none can stay where it was carried.
    Shoved,
}

/// A liking for a colour of the ground: P15 eq. 16. The score of a ground is the distance of its
/// colour from `hsv`, each difference multiplied by its weight, to the power of minus `exponent`.
/// A plant grows of one of the two kinds with the largest scores, by chance in their proportion.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Likes {
    /// Reference colour: hue in degrees, saturation and value from 0 to 1, of the base map's sRGB
    /// values as they are stored.
    pub hsv: [f32; 3],
    /// Weights of the differences in hue (in turns), saturation and value; not all 0.
    #[schemars(inner(range(min = limits::COLOUR_WEIGHT.min, max = limits::COLOUR_WEIGHT.max)))]
    pub weights: [f32; 3],
    /// How sharp the border to other kinds is.
    #[schemars(range(min = limits::SCORE_EXPONENT.min, max = limits::SCORE_EXPONENT.max))]
    pub exponent: f32,
    /// Score below which the kind does not grow, however little the others like the ground.
    #[schemars(range(min = limits::SCORE_THRESHOLD.min, max = limits::SCORE_THRESHOLD.max))]
    pub threshold: f32,
    /// Part of its height and stiffness that a plant lacks on ground that is wholly another kind's.
    #[schemars(range(min = limits::FRACTION.min, max = limits::FRACTION.max))]
    pub dwindle: f32,
}

impl Default for Likes {
    fn default() -> Self {
        Self {
            hsv: [90.0, 0.5, 0.5],
            weights: [1.0, 0.5, 0.25],
            exponent: 4.0,
            threshold: 0.0,
            dwindle: 0.5,
        }
    }
}
