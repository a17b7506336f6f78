//! Laws with a body: a ball through a billboard.

use super::*;

const RADIUS_M: f64 = 0.15;
const STEP_S: f64 = 1.0 / 120.0;

/// A ball, as the passes know it.
pub(super) struct Ball {
    parts: Parts,
    tested: Tested,
}

impl Ball {
    pub fn new(tested: Tested) -> Self {
        let mut parts = Parts::default();
        let shape = RigidShape {
            parts: vec![ConvexPart {
                solid: PartSolid::Ball { radius: RADIUS_M },
                pose: Pose::IDENTITY,
                bounds_m: [[-RADIUS_M; 3], [RADIUS_M; 3]],
                half_thickness_m: RADIUS_M,
            }],
            bounding_radius_m: RADIUS_M,
            half_thickness_m: RADIUS_M,
            true_mesh: None,
            mesh: DrawMesh::default(),
        };
        parts.extend(&[shape], 0.001, false);
        if tested == Tested::Cube {
            let grown = parts.parts[0].grown.clone();
            parts.parts[0].cube = Some(DepthCube::draw(&grown, 64, |_| false));
        }
        Self { parts, tested }
    }

    pub fn part(&self) -> &Part {
        &self.parts.parts[0]
    }

    pub fn contact(&self, from: Vec3<f64>, to: Vec3<f64>) -> Contact {
        let at = |place| Pose {
            place,
            ..Pose::IDENTITY
        };
        // At most a sixteenth of the half thickness a sweep.
        let sweeps = ((to - from).length() / (RADIUS_M / 16.0)).ceil().max(1.0) as u32;
        Contact {
            part: 0,
            body: 0,
            part_in_body: 0,
            parts_of_body: 1,
            tested: self.tested,
            link: 0,
            shape: 0,
            sweeps,
            from: at(from),
            to: at(to),
            radius_m: self.part().radius_m,
        }
    }
}

pub(super) fn calm() -> WindNow {
    let wind = Wind {
        strength: 0.0,
        gust: 0.0,
        flutter: 0.0,
        ..Wind::default()
    };
    WindNow::at(&wind, 0.0, 2.0, 1.0)
}

/// What a passage did to one billboard.
#[derive(Debug, Default)]
struct Passage {
    touched: u32,
    worst_strain: f64,
    strain_sum: f64,
    over_limit: u32,
    rounds: u32,
    penetration_m: f64,
    replaced: u64,
    reset: u64,
    lean: Vec3<f64>,
    last_strain: f64,
    top_width: f64,
}

/// A ball that rolls past a billboard of half a metre with the given speed, at an angle to its lower
/// edge and at a distance from its root.
fn roll<R: Real>(
    ball: &Ball,
    weave: &Weave,
    settings: &Settings<R>,
    speed: f64,
    [degrees, off_m]: [f64; 2],
) -> Passage {
    let (ground, wind) = (ground(), calm());
    let boards = [billboard(0.5, 0.5)];
    let grown: Solid<R> = ball.part().solid.grown_by(0.001);
    let mut slab: Slab<R> = Slab::new(1, weave.grid.movable());
    let angle = degrees.to_radians();
    let along = vec3(angle.cos(), 0.0, angle.sin());
    let beside = vec3(-angle.sin(), 0.0, angle.cos());
    let mut done = Passage::default();
    let steps = (2.2 / (speed * STEP_S)) as u32;
    let mut found = Vec::new();
    let mut poses = Poses::new(weave);
    for step in 1..=steps {
        let at = |n: u32| {
            along * (f64::from(n) * speed * STEP_S - 1.0) + beside * off_m + Vec3::UP * RADIUS_M
        };
        let contact = ball.contact(at(step - 1), at(step));
        let touches = [Touch::new(0, &contact, ball.part(), &grown)];
        let tile = Tile {
            weave,
            billboards: &boards,
            anchor: &ANCHOR,
            ground: &ground,
            ground_top_m: R::of(1e-6),
            touches: &touches,
            wind: &wind,
            wind_before: &wind,
            now: step,
            // Nothing recovers meanwhile.
            fading: Fading {
                step_over_t: R::of(1e-6),
                recovery: Recovery::Lengths,
                planted: Planted::NONE,
            },
        };
        tile.touched(&slab, &mut poses, &mut found);
        if found.is_empty() {
            continue;
        }
        let mut batch = Batch::new(weave);
        let responded = tile.respond(&mut found, &mut slab, (&mut batch, &mut poses), settings);
        done.note(&responded, settings.strain_limit.to_f64());
        let quad = Quad::<R>::in_wind(&boards[0], &ANCHOR, &wind);
        let rest = grid_of(&quad, weave.grid);
        let node = |n: usize| Vec3::of((rest[weave.grid.columns + n] + slab.offsets[n]).to_f64());
        for n in 0..weave.grid.movable() {
            let inside = RADIUS_M - (node(n) - at(step)).length();
            done.penetration_m = done.penetration_m.max(inside);
            assert!(node(n).is_finite() && node(n).y > -1e-6);
        }
        let (movable, columns) = (weave.grid.movable(), weave.grid.columns);
        let top: Vec<Vec3<f64>> = (movable - columns..movable).map(node).collect();
        done.top_width = (top[columns - 1] - top[0]).length() / 0.5;
        let lean = top.iter().fold(Vec3::ZERO, |sum, &v| sum + v) * (1.0 / columns as f64);
        done.lean = vec3(lean.dot(along), lean.y, lean.dot(beside));
    }
    done
}

impl Passage {
    fn note(&mut self, responded: &Responded, limit: f64) {
        if responded.rounds == 0 {
            return;
        }
        self.touched += 1;
        self.rounds += responded.rounds;
        self.worst_strain = self.worst_strain.max(responded.strain);
        self.strain_sum += responded.strain;
        self.over_limit += u32::from(responded.strain > limit);
        self.replaced += responded.replaced;
        self.reset += responded.reset;
        self.last_strain = responded.strain;
    }

    fn print(&self, name: &str) {
        let n = f64::from(self.touched.max(1));
        println!(
            "{name}: {} sub-steps, strain {:.3} at most, {:.4} on average, {} over the limit, {:.3} in the end; \
             rounds {:.2}; {:.5} m inside; {} replaced, {} put back; top leans {:.2} along {:.2} aside at \
             {:.2} m, width {:.2}",
            self.touched,
            self.worst_strain,
            self.strain_sum / n,
            self.over_limit,
            self.last_strain,
            f64::from(self.rounds) / n,
            self.penetration_m,
            self.replaced,
            self.reset,
            self.lean.x,
            self.lean.z,
            self.lean.y,
            self.top_width,
        );
    }
}

const WAYS: [[f64; 2]; 7] = [
    [90.0, 0.0],
    [90.0, 0.2],
    [60.0, 0.05],
    [30.0, 0.05],
    [0.0, 0.0],
    [0.0, 0.003],
    [0.0, 0.03],
];

/// Twice the strain limit is what the rounds leave of a contact in motion on average; a crumpled sheet
/// without the step aside is at 80%. The limits of penetration are those of every build.
#[test]
fn a_ball_rolls_through() {
    let settings = Settings::<f64>::new(&Solver::default());
    let weave = weave(4, 4);
    for (tested, limit_m) in [(Tested::Closed, 1e-3), (Tested::Cube, 0.302 / 64.0)] {
        let ball = Ball::new(tested);
        for way in WAYS {
            for speed in [1.0, 3.0] {
                let done = roll(&ball, &weave, &settings, speed, way);
                done.print(&format!("{tested:?} {way:?} at {speed} m/s"));
                assert!(done.touched > 5);
                assert!(done.penetration_m <= limit_m, "{}", done.penetration_m);
                assert!(done.last_strain <= 0.02, "{}", done.last_strain);
            }
        }
    }
}

#[test]
fn what_bends_buy() {
    let ball = Ball::new(Tested::Closed);
    for (name, bend_step) in [("none", 0.0), ("10", 10.0), ("60", 60.0), ("1000", 1000.0)] {
        let bent = bend_step > 0.0;
        let weave = Weave::new(Grid::new([4, 4]).expect("a grid"), bent);
        let settings = Settings::<f64> {
            bend_step: bend_step * STEP_S,
            ..Settings::new(&Solver::default())
        };
        for way in WAYS {
            roll(&ball, &weave, &settings, 1.0, way).print(&format!("bend {name} {way:?}"));
        }
    }
}
