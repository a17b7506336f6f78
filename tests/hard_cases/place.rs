//! Bodies that are suddenly elsewhere, and scenes far from the world's origin.

use std::collections::BTreeMap;

use libtest_mimic::Failed;
use sward::scene::Scene;
use sward::sim::measure::Standing;

use super::Measured;
use super::rig::{CALM, PlantKey, SECOND_TICKS, Setting, apart, ensure, parse};

/// A ball put 50 m away within one sub-step. A method that sweeps from the old place to the new
/// one lays a furrow across the whole meadow.
pub fn teleport(setting: &Setting) -> Measured {
    let mut rig = setting.rig(&format!(
        "(duration_s: 10, terrain: (ground: Flat(size_m: (60, 3))), {CALM}, bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.15), position_m: (-25, 0.12, 0),
             motion: Thrown(velocity_m_per_s: (1, 0, 0)), collider: {})],
          script: [(at_s: 0.5, action: Teleport(body: \"ball\", position_m: (25, 0.15, 0.3)))])",
        setting.collider()
    ))?;
    rig.run_to(SECOND_TICKS / 2, 4)?;
    let old_place = rig.look()?;
    let pressed = old_place
        .values()
        .filter(|plant| plant.offset_m() > 0.02)
        .count();
    let jump = rig.meadow.ticks;
    rig.run_to(jump + rig.meadow.recovery_ticks() + SECOND_TICKS, 4)?;
    let plants = rig.look()?;
    // The ball comes no farther than 1.2 m from either place.
    let between = |plant: &&Standing<f64>| plant.root_in_world()[0].abs() < 23.0;
    let touched = plants
        .values()
        .filter(between)
        .filter(|plant| plant.touched_at > 0)
        .count();
    let tiles = rig.meadow.tiles.peak;
    let left = plants
        .values()
        .filter(|plant| plant.root_in_world()[0] < 0.0)
        .count();
    let here = plants
        .values()
        .filter(|p| p.root_in_world()[0] > 23.0 && p.offset_m() > 0.02);
    let here = here.count();
    let text = format!(
        "{pressed} plants pressed at the old place, {here} at the new one, {touched} touched in \
         between, {left} still active at the old place, {tiles} tiles at most"
    );
    // Six tiles around either place, and as many again for those that still recover.
    let holds = pressed > 20 && here > 5 && touched == 0 && left == 0 && tiles <= 24;
    ensure(holds, || text.clone())?;
    rig.nothing_is_inside()?;
    Ok(text)
}

/// How far from the origin the same scene is run, in metres along x and, the other way, z.
const FAR_M: [f64; 3] = [1e3, 1e4, 1e5];
/// Most by which a scene far away may differ from the one at the origin, in metres.
const FAR_LIMIT_M: f64 = 1e-5;

/// A rolling ball and a tumbling box, 0, 1, 10 and 100 km from the origin. World coordinates in f32
/// are rounded to 8 mm at 100 km: blades and bodies jump.
pub fn far_away(setting: &Setting) -> Measured {
    let home = displaced(setting, [0.0, 0.0])?;
    let moved = home.values().filter(|p| p.offset_m() > 0.02).count();
    ensure(moved > 50, || {
        format!("only {moved} plants were moved at the origin")
    })?;
    let mut worst = Vec::new();
    for far in FAR_M {
        // Not a whole number of cells, so that nothing is exact by chance.
        let there = displaced(setting, [far + 0.3, -far - 0.7])?;
        ensure(there.len() == home.len(), || {
            format!("{} plants at {far} m, {} at home", there.len(), home.len())
        })?;
        let offs = home.iter().map(|(key, plant)| {
            there
                .get(key)
                .map_or(f64::INFINITY, |other| apart(&plant.nodes, &other.nodes))
        });
        worst.push(offs.fold(0.0, f64::max));
    }
    let text = format!(
        "at 1, 10, 100 km off by {:.1e}, {:.1e}, {:.1e} m (limit {FAR_LIMIT_M:.0e}), {moved} plants \
         moved",
        worst[0], worst[1], worst[2]
    );
    ensure(worst.iter().all(|&off| off <= FAR_LIMIT_M), || text.clone())?;
    Ok(text)
}

/// The plants after 1.5 s of a scene that was moved as a whole. Nodes are relative to the plants'
/// own anchors.
fn displaced(
    setting: &Setting,
    by_m: [f64; 2],
) -> Result<BTreeMap<PlantKey, Standing<f64>>, Failed> {
    let collider = setting.collider();
    let ground = "Rolling(size_m: (7, 7), amplitude_m: 0.1, wavelength_m: 6, seed: 4)";
    let mut scene = parse(&format!(
        "(duration_s: 4, terrain: (ground: {ground}), wind: (strength: 0.2), bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.15), position_m: (-1.3, 0.15, 0.2),
             above_ground: true, motion: Thrown(velocity_m_per_s: (2, 0, 0.3)),
             collider: {collider}),
            (name: \"box\", shape: Box(size_m: (0.3, 0.2, 0.25)), position_m: (0.6, 0.5, -1),
             above_ground: true, collider: {collider},
             motion: Thrown(velocity_m_per_s: (0.5, 0, 0.4), spin_deg_per_s: (90, 40, 200)))])"
    ))?
    .scene;
    move_scene(&mut scene, by_m);
    let mut rig = setting.rig_of(scene)?;
    rig.run_to(3 * SECOND_TICKS / 2, 12)?;
    rig.nothing_is_inside()?;
    rig.look()
}

fn move_scene(scene: &mut Scene, by_m: [f64; 2]) {
    scene.terrain.centre_m = by_m;
    for body in &mut scene.bodies {
        body.position_m[0] += by_m[0];
        body.position_m[2] += by_m[1];
    }
}

/// A ball on one meadow that is 204.8 km long, at its middle and 1, 10 and 100 km from it: nothing
/// may depend on where the scene's own origin is. The plants differ from place to place, so what is
/// compared is the ball's way; the plants must keep the common limits.
pub fn far_in_a_wide_meadow(setting: &Setting) -> Measured {
    let home = thrown_at(setting, 0.0)?;
    let mut worst_m = 0.0_f64;
    for far in FAR_M {
        let there = thrown_at(setting, far)?;
        let off = (0..3).map(|a| {
            let moved = if a == 0 { far } else { 0.0 };
            (there[a] - moved - home[a]).abs()
        });
        worst_m = off.fold(worst_m, f64::max);
    }
    let text = format!("the ball's way differs by {worst_m:.1e} m (limit {FAR_LIMIT_M:.0e})");
    ensure(worst_m <= FAR_LIMIT_M, || text.clone())?;
    Ok(text)
}

/// Where a ball thrown through the grass is before it comes down. Places differ by whole metres: the
/// physics rounds each alike, and what is left is what the distance does.
fn thrown_at(setting: &Setting, x: f64) -> Result<[f64; 3], Failed> {
    let mut rig = setting.rig(&format!(
        "(duration_s: 4, terrain: (ground: Flat(size_m: (204800, 32), spacing_m: 16)),
          {CALM}, bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.15), position_m: ({}, 0.5, 0.2),
             motion: Thrown(velocity_m_per_s: (1.5, 0, 0.2)), collider: {})])",
        x - 0.25,
        setting.collider()
    ))?;
    rig.run_to(SECOND_TICKS / 4, 6)?;
    rig.nothing_is_inside()?;
    let moved = rig.look()?.values().filter(|p| p.offset_m() > 0.02).count();
    ensure(moved > 5, || {
        format!("only {moved} plants were moved at {x} m")
    })?;
    let ball = rig
        .meadow
        .bodies
        .info_of("ball")
        .ok_or("the ball is gone")?;
    Ok(ball.pose.place.to_f64())
}

/// A ball and a box that leave the field. Where the ground ends at the field's rim they fall, and cut
/// through the rim and the grass on it by 64 mm.
pub fn over_the_edge(setting: &Setting) -> Measured {
    let collider = setting.collider();
    let mut rig = setting.rig(&format!(
        "(duration_s: 4, terrain: (ground: Flat(size_m: (4, 3))), {CALM}, bodies: [
            (name: \"ball\", shape: Ball(radius_m: 0.12), position_m: (1.4, 0.12, 0.4), collider: {collider},
             motion: Thrown(velocity_m_per_s: (2, 0, 0))),
            (name: \"box\", shape: Box(size_m: (0.3, 0.2, 0.3)), position_m: (1.5, 0.11, -0.4), collider: {collider},
             motion: Thrown(velocity_m_per_s: (3, 0, 0)))])",
    ))?;
    rig.run_to(2 * SECOND_TICKS, 1)?;
    let ball = rig
        .meadow
        .bodies
        .info_of("ball")
        .ok_or("the ball is gone")?;
    let [x, y, _] = ball.pose.place.to_f64();
    let text = format!(
        "the ball is at x = {x:.2} m, {y:.3} m up; deepest node at {:.2} of its limit",
        rig.seen.depth_over_limit
    );
    ensure(x > 2.5 && (y - 0.12).abs() < 1e-3, || text.clone())?;
    rig.nothing_is_inside()?;
    Ok(text)
}
