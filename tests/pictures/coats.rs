//! What coats do to a picture.

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::gpu::Gpu;
use sward::render::{Picture, View};

use super::{ALL, Shown, Stage, hold};

const BARE: &str = "(bodies: [(name: \"ball\", shape: Ball(radius_m: 0.4), \
    position_m: (0.0, 0.8, 0.0), motion: Fixed, rgb: (0.1, 0.1, 0.1))])";
const COATED: &str = "(bodies: [(name: \"ball\", shape: Ball(radius_m: 0.4), \
    position_m: (0.0, 0.8, 0.0), motion: Fixed, rgb: (0.1, 0.1, 0.1), \
    coat: Some((per_m2: 3000, height_m: (0.06, 0.08))))])";

/// The ball, level, before the sky and the ground.
fn level() -> Shown {
    Shown {
        blades: false,
        view: View {
            eye_in_world: Vec3::new(0.0, 0.8, 3.0),
            forward: Vec3::new(0.0, 0.0, -1.0),
            fov_rad: 0.5,
        },
        ..ALL
    }
}

/// Pixels above the horizon at which two pictures differ, and by how much green leads red in the first.
fn changed(with: &Picture, without: &Picture) -> (f64, f64) {
    let upper = with.rgba8.len() / 2;
    let pairs = with.rgba8[..upper]
        .chunks_exact(4)
        .zip(without.rgba8[..upper].chunks_exact(4));
    let (mut count, mut lead) = (0.0, 0.0);
    for (a, _) in pairs.filter(|(a, b)| (0..3).any(|i| a[i].abs_diff(b[i]) > 8)) {
        count += 1.0;
        lead += f64::from(a[1]) - f64::from(a[0]);
    }
    (count, lead / f64::max(count, 1.0))
}

/// A grey ball of 0.4 m under leaves that reach 0.06 to 0.08 m out at 15° to 65°: upright ones would cover
/// (0.47 / 0.4)² = 1.38 times as much, leaning ones at least cos 65° · 0.06 m, 1.13 times in all of a
/// closed coat; half of that is asked for, since its outline is torn. And it is green.
pub fn coats_grow_outwards(gpu: &Gpu) -> Result<(), Failed> {
    let mut outlines = Vec::new();
    for scene in [BARE, COATED] {
        let mut stage = Stage::new(gpu, scene, 0)?;
        let with = stage.shoot(gpu, level())?;
        let without = Shown {
            bodies: false,
            ..level()
        };
        outlines.push(changed(&with, &stage.shoot(gpu, without)?));
    }
    let [(bare, grey), (coated, green)] = [outlines[0], outlines[1]];
    hold(
        bare > 500.0 && coated > 1.06 * bare && coated < 1.38 * bare,
        format!("the ball covers {bare} pixels, with a coat {coated}"),
    )?;
    hold(
        green > grey + 10.0,
        format!("green leads red by {green} steps, without a coat by {grey}"),
    )
}

/// Every plant that is drawn stands on a face that looks at the eye; none is where the camera looks away.
pub fn coats_grow_on_faces(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, COATED, 0)?;
    stage.shoot(gpu, level())?;
    let drawn = stage.renderer.drawn_coats(gpu)?.unwrap_or_default();
    hold(
        drawn.plants.len() > 500,
        format!("{} plants", drawn.plants.len()),
    )?;
    for plant in &drawn.plants {
        let [x, y, z] = plant.root_from_eye.map(f64::from);
        let [u, v, w] = plant.normal.map(f64::from);
        // Faces of a ball with 32 sides and 16 rows lean from their smooth normals by up to half of
        // 11.25° both ways, 8° together.
        let facing = -(x * u + y * v + z * w) / f64::sqrt(x * x + y * y + z * z);
        hold(facing > -0.14, format!("a plant on a back face: {plant:?}"))?;
    }
    let half = drawn.counts.iter().filter(|&&count| count > 0.0).count();
    let all = drawn.counts.len();
    // The eye at 7.5 radii sees 43% of a ball.
    hold(
        half > all * 2 / 5 - 40 && half < all / 2,
        format!("{half} of {all} faces"),
    )?;
    let mut away = level();
    away.view.forward = Vec3::new(0.0, 0.0, 1.0);
    stage.shoot(gpu, away)?;
    let drawn = stage.renderer.drawn_coats(gpu)?.unwrap_or_default();
    hold(
        drawn.plants.is_empty(),
        format!("{} plants", drawn.plants.len()),
    )?;
    let hidden = Shown {
        bodies: false,
        ..level()
    };
    stage.shoot(gpu, hidden)?;
    let drawn = stage.renderer.drawn_coats(gpu)?.unwrap_or_default();
    hold(drawn == Default::default(), "plants without their body")
}

/// Without coats there are no kernels and no buffers for them, nor after the last one has gone; taken in
/// again, they are as before.
pub fn no_coats_cost_nothing(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, BARE, 0)?;
    stage.shoot(gpu, level())?;
    let none = stage.renderer.drawn_coats(gpu)?;
    hold(none.is_none(), "a scene without coats has buffers of coats")?;
    let mut stage = Stage::new(gpu, COATED, 0)?;
    let first = stage.shoot(gpu, level())?;
    let (shapes, coats) = (stage.meadow.bodies.shapes(), stage.meadow.bodies.coated());
    stage.renderer.set_shapes(gpu, shapes, coats)?;
    stage.renderer.set_shapes(gpu, shapes, &[])?;
    let none = stage.renderer.drawn_coats(gpu)?;
    hold(none.is_none(), "buffers of coats stay")?;
    stage.renderer.set_shapes(gpu, shapes, coats)?;
    stage.renderer.set_shapes(gpu, shapes, coats)?;
    hold(
        stage.shoot(gpu, level())? == first,
        "taken in again, coats differ",
    )
}
