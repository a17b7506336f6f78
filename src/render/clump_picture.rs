//! The program's own pictures of clumps of grass, painted on the processor from blades of its own shapes
//! (P15 eq. 12). O09 takes its pictures from photographs.
//!
//! Colours are factors of the ground's colour under the clump, so that a clump fits wherever it stands.

use crate::base::least;
use crate::base::philox::{Pcg, philox2x32, unit};
use crate::field::blade_shape::{ShapeError, solve, stiffness_for_segments};
use crate::scene::{ClumpKind, ClumpLook, Root, Season};

/// Texels along a picture's side.
pub(super) const CLUMP_SIDE: u32 = 256;
/// Painted points along a texel's side.
const FINE: usize = 3;
/// Points along a painting's side.
const POINTS: usize = CLUMP_SIDE as usize * FINE;
/// Straight pieces of a blade.
const SEGMENTS: u32 = 10;
/// Rounds of Philox; seven leave neighbours uncorrelated.
const ROUNDS: u32 = 7;
/// Free border of a picture, in shares of its side: what is drawn ends before the quad does.
const BORDER: f32 = 0.02;

/// What blades of a look are like. Lengths are shares of the picture's side.
struct LookNumbers {
    blades: u32,
    width: [f32; 2],
    length: [f32; 2],
    /// k′ of P15 for eight segments, drawn evenly by its logarithm.
    stiffness: [f32; 2],
    /// Lean of the root, in radians, of the outermost blade.
    lean_rad: f32,
    /// Half the width of the clump at the ground.
    foot: f32,
    /// Stalks with heads.
    stalks: u32,
}

fn look_numbers(look: ClumpLook) -> LookNumbers {
    let fine = LookNumbers {
        blades: 62,
        width: [0.012, 0.020],
        length: [0.45, 1.12],
        stiffness: [45.0, 220.0],
        lean_rad: 0.75,
        foot: 0.24,
        stalks: 0,
    };
    match look {
        ClumpLook::Fine => fine,
        ClumpLook::Broad => LookNumbers {
            blades: 30,
            width: [0.030, 0.048],
            length: [0.4, 1.15],
            stiffness: [30.0, 110.0],
            ..fine
        },
        ClumpLook::Reed => LookNumbers {
            blades: 24,
            width: [0.018, 0.030],
            length: [0.6, 1.0],
            stiffness: [600.0, 3000.0],
            lean_rad: 0.2,
            foot: 0.3,
            stalks: 0,
        },
        ClumpLook::Flowering => LookNumbers {
            blades: 48,
            length: [0.35, 0.9],
            stalks: 6,
            ..fine
        },
    }
}

/// What the time of the year does to a clump.
struct SeasonNumbers {
    rgb: [f32; 3],
    /// Share of its blades that are dry.
    dry: f32,
    /// Factors of the number of blades, their length and their stiffness.
    blades: f32,
    length: f32,
    stiffness: f32,
    heads: bool,
}

/// Factors of green ground's colour that make it straw.
const STRAW_RGB: [f32; 3] = [1.9, 1.2, 1.0];

fn season_numbers(season: Season) -> SeasonNumbers {
    let summer = SeasonNumbers {
        rgb: [1.0, 1.0, 1.0],
        dry: 0.08,
        blades: 1.0,
        length: 1.0,
        stiffness: 1.0,
        heads: true,
    };
    match season {
        Season::Spring => SeasonNumbers {
            rgb: [1.08, 1.16, 0.8],
            dry: 0.0,
            length: 0.8,
            ..summer
        },
        Season::Summer => summer,
        Season::Autumn => SeasonNumbers {
            rgb: [1.2, 1.02, 0.9],
            dry: 0.5,
            ..summer
        },
        Season::Winter => SeasonNumbers {
            rgb: [1.5, 1.1, 1.0],
            dry: 0.92,
            blades: 0.6,
            length: 0.85,
            stiffness: 0.5,
            heads: false,
        },
    }
}

/// Colours of flower heads and their middles, one per variant.
const HEADS_RGB: [[[f32; 3]; 2]; 4] = [
    [[6.4, 4.2, 1.0], [5.0, 2.2, 0.6]],
    [[5.6, 5.2, 7.6], [6.0, 4.0, 0.8]],
    [[4.6, 0.9, 1.4], [0.5, 0.4, 0.5]],
    [[3.4, 2.2, 7.8], [6.0, 4.4, 1.4]],
];

/// Points of a painting: colour, and whether something is there.
struct Canvas {
    points: Vec<Option<[f32; 3]>>,
}

/// A blade on the picture's plane, from root to tip, x from the middle and y up.
struct Stroke {
    joints: Vec<[f32; 2]>,
    half_width: f32,
    /// Towards the eye, which sorts the strokes.
    depth: f32,
    rgb: [f32; 3],
    head: Option<[[f32; 3]; 2]>,
}

/// Random numbers of one picture.
struct Draw(Pcg);

impl Draw {
    fn unit(&mut self) -> f32 {
        unit(self.0.next_word())
    }

    fn between(&mut self, [low, high]: [f32; 2]) -> f32 {
        low + (high - low) * self.unit()
    }
}

/// Paints a picture: RGBA, linear, colours multiplied by the coverage, the upper row first.
///
/// # Errors
/// A blade without a shape, which the looks' numbers rule out.
pub(super) fn paint(
    kind: &ClumpKind,
    number: u32,
    variant: u32,
) -> Result<Vec<[f32; 4]>, ShapeError> {
    let words = philox2x32([number, variant], 0x636c_756d, ROUNDS);
    let mut draw = Draw(Pcg::from_words(words));
    let look = look_numbers(kind.look);
    let season = season_numbers(kind.season);
    let blades = (look.blades as f32 * season.blades) as u32;
    let mut strokes = Vec::new();
    for _ in 0..blades {
        strokes.push(blade(&mut draw, &look, &season)?);
    }
    for _ in 0..look.stalks * u32::from(season.heads) {
        strokes.push(stalk(&mut draw, &look, variant)?);
    }
    strokes.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    let mut canvas = Canvas {
        points: vec![None; POINTS * POINTS],
    };
    for stroke in &strokes {
        canvas.stroke(stroke);
    }
    Ok(canvas.texels())
}

fn blade(
    draw: &mut Draw,
    look: &LookNumbers,
    season: &SeasonNumbers,
) -> Result<Stroke, ShapeError> {
    let stiffness = draw.between(look.stiffness.map(f32::ln)).exp() * season.stiffness;
    let lean_rad = look.lean_rad * draw.unit();
    let azimuth = std::f32::consts::TAU * draw.unit();
    let root = look.foot * (draw.unit() + draw.unit() - 1.0);
    let length = draw.between(look.length) * season.length;
    let half_width = 0.5 * draw.between(look.width) * (0.55 + 0.45 * draw.unit());
    let is_dry = draw.unit() < season.dry;
    // Blades at the back stand in the shade of those before them.
    let depth = azimuth.sin() * (0.3 + lean_rad) + 0.3 * (draw.unit() - 0.5);
    let lightness = (0.78 + 0.3 * draw.unit()) * (0.86 + 0.2 * depth);
    let dry = if is_dry { STRAW_RGB } else { season.rgb };
    let warm = 1.0 + 0.16 * (draw.unit() - 0.5);
    let lift = 0.03 * draw.unit();
    Ok(Stroke {
        joints: joints(stiffness, lean_rad, azimuth, [root, lift], length)?,
        half_width,
        depth,
        rgb: [dry[0] * warm, dry[1], dry[2] / warm].map(|c| c * lightness),
        head: None,
    })
}

fn stalk(draw: &mut Draw, look: &LookNumbers, variant: u32) -> Result<Stroke, ShapeError> {
    let azimuth = std::f32::consts::TAU * draw.unit();
    let root = look.foot * (draw.unit() - 0.5);
    let length = draw.between([0.65, 0.98]);
    let lean_rad = 0.25 * draw.unit();
    let lightness = 0.9 + 0.2 * draw.unit();
    let head = HEADS_RGB[variant as usize % HEADS_RGB.len()];
    Ok(Stroke {
        joints: joints(900.0, lean_rad, azimuth, [root, 0.0], length)?,
        half_width: 0.005,
        depth: 0.1 + 0.4 * draw.unit(),
        rgb: [0.95 * lightness, lightness, 0.8 * lightness],
        head: Some(head.map(|rgb| rgb.map(|c| c * lightness))),
    })
}

/// The joints of a blade, shrunk about its root where it would leave the picture.
fn joints(
    stiffness: f32,
    lean_rad: f32,
    azimuth: f32,
    [root, lift]: [f32; 2],
    length: f32,
) -> Result<Vec<[f32; 2]>, ShapeError> {
    let k_prime = stiffness_for_segments(f64::from(stiffness), SEGMENTS);
    let shape = solve(SEGMENTS, k_prime, Root::default(), f64::from(lean_rad))?;
    let across = azimuth.cos();
    let nodes = shape.nodes.iter().map(|&[x, y]| [x as f32, y as f32]);
    let mut shrink = 1.0_f32;
    for [x, y] in nodes.clone() {
        let (x, y) = (x * across * length, y * length);
        let room = if x < 0.0 { 0.5 + root } else { 0.5 - root } - 2.0 * BORDER;
        shrink = least(shrink, room / x.abs().max(1e-6));
        shrink = least(shrink, (1.0 - lift - 3.0 * BORDER) / y.max(1e-6));
    }
    let scale = length * shrink;
    Ok(nodes
        .map(|[x, y]| [root + x * across * scale, lift + y * scale])
        .collect())
}

/// Width along a blade, relative to the root's: as in `shaders/blades.wgsl`.
fn taper(along: f32) -> f32 {
    let up = (along / 0.2).clamp(0.0, 1.0);
    let full = 0.7 + 0.3 * up * up * (3.0 - 2.0 * up);
    full * (1.0 - along * along).max(0.0).sqrt() * (1.0 - 0.35 * along)
}

impl Canvas {
    fn stroke(&mut self, stroke: &Stroke) {
        let count = (stroke.joints.len() - 1) as f32;
        for (n, pair) in stroke.joints.windows(2).enumerate() {
            self.piece(stroke, [pair[0], pair[1]], n as f32 / count, 1.0 / count);
        }
        if let (Some([petals, middle]), Some(&tip)) = (stroke.head, stroke.joints.last()) {
            self.disc(tip, 0.028, petals);
            self.disc(tip, 0.011, middle);
        }
    }

    /// Asks `paint` for the colour of every point of a box.
    fn in_box(
        &mut self,
        low: [f32; 2],
        high: [f32; 2],
        mut paint: impl FnMut([f32; 2]) -> Option<[f32; 3]>,
    ) {
        let points = POINTS as f32;
        let index = |share: f32| (share * points).clamp(0.0, points) as usize;
        let (left, right) = (index(low[0] + 0.5), index(high[0] + 0.5) + 1);
        let (top, bottom) = (index(1.0 - high[1]), index(1.0 - low[1]) + 1);
        for row in top..bottom.min(POINTS) {
            for column in left..right.min(POINTS) {
                let x = (column as f32 + 0.5) / points - 0.5;
                let y = 1.0 - (row as f32 + 0.5) / points;
                if let Some(rgb) = paint([x, y]) {
                    self.points[row * POINTS + column] = Some(rgb);
                }
            }
        }
    }

    fn piece(&mut self, stroke: &Stroke, [a, b]: [[f32; 2]; 2], from: f32, span: f32) {
        let along = [b[0] - a[0], b[1] - a[1]];
        let squared = (along[0] * along[0] + along[1] * along[1]).max(1e-12);
        let reach = stroke.half_width;
        let low = [a[0].min(b[0]) - reach, a[1].min(b[1]) - reach];
        let high = [a[0].max(b[0]) + reach, a[1].max(b[1]) + reach];
        self.in_box(low, high, |[x, y]| {
            let share = ((x - a[0]) * along[0] + (y - a[1]) * along[1]) / squared;
            let share = share.clamp(0.0, 1.0);
            let off = [x - a[0] - along[0] * share, y - a[1] - along[1] * share];
            let away = (off[0] * off[0] + off[1] * off[1]).sqrt();
            let place = from + span * share;
            let half = stroke.half_width * taper(place);
            (away < half).then(|| {
                // A pale midrib, a dark foot, a paler tip.
                let side = (away / half).min(1.0);
                let rib = 1.1 - 0.22 * side;
                let foot = 0.72 + 0.28 * (y / 0.35).clamp(0.0, 1.0);
                let tone = rib * foot * (0.92 + 0.2 * place);
                stroke.rgb.map(|c| c * tone)
            })
        });
    }

    fn disc(&mut self, [x0, y0]: [f32; 2], radius: f32, rgb: [f32; 3]) {
        let low = [x0 - radius, y0 - radius];
        let high = [x0 + radius, y0 + radius];
        self.in_box(low, high, |[x, y]| {
            // Seen from the side a head is flat, and its rim is lobed.
            let (x, y) = (x - x0, (y - y0) * 1.5);
            let lobes = 0.85 + 0.15 * (5.0 * y.atan2(x)).cos();
            let share = (x * x + y * y).sqrt() / (radius * lobes);
            (share < 1.0).then(|| rgb.map(|c| c * (0.75 + 0.25 * share)))
        });
    }

    fn texels(&self) -> Vec<[f32; 4]> {
        let side = CLUMP_SIDE as usize;
        let share = 1.0 / (FINE * FINE) as f32;
        let texel = |at: usize| {
            let (column, row) = (at % side * FINE, at / side * FINE);
            let mut sum = [0.0; 4];
            for n in 0..FINE * FINE {
                let point = (row + n / FINE) * POINTS + column + n % FINE;
                if let Some([r, g, b]) = self.points[point] {
                    for (total, part) in sum.iter_mut().zip([r, g, b, 1.0]) {
                        *total += part * share;
                    }
                }
            }
            sum
        };
        (0..side * side).map(texel).collect()
    }
}
