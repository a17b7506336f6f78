//! Bodies that are buried in the grass, or have a vertex in a place without a clear way out.

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::base::philox::{philox2x32, unit};
use sward::run::Engine;
use sward::sim::measure::GrassState;

use super::Measured;
use super::rig::{
    CALM, FRAME_TICKS, Handmade, Rig, SECOND_TICKS, Setting, all_in_wind_pose, ensure,
};

/// Where a body is put so that a chosen vertex lies in one of its degenerate places, in the body's
/// coordinates.
const DEGENERATE: &[(&str, &str, [f64; 3])] = &[
    ("centre of a ball", "Ball(radius_m: 0.15)", [0.0; 3]),
    ("centre of a box", "Box(size_m: (0.3, 0.3, 0.3))", [0.0; 3]),
    (
        "medial axis of a box",
        "Box(size_m: (0.3, 0.3, 0.3))",
        [0.05, 0.05, 0.0],
    ),
    (
        "edge of a box",
        "Box(size_m: (0.3, 0.3, 0.3))",
        [0.15, 0.15, 0.02],
    ),
    (
        "corner of a box",
        "Box(size_m: (0.3, 0.3, 0.3))",
        [0.15, 0.15, 0.15],
    ),
    // 64 texels over 0.302 m with the skin: borders lie at whole multiples from the middle.
    (
        "texel border of a box",
        "Box(size_m: (0.3, 0.3, 0.3))",
        [10.0 * 0.302 / 64.0, 0.04, 0.0],
    ),
    (
        "axis of a capsule",
        "Capsule(radius_m: 0.1, length_m: 0.2)",
        [0.0, 0.03, 0.0],
    ),
    (
        "centre of a cylinder",
        "Cylinder(radius_m: 0.12, height_m: 0.24)",
        [0.0; 3],
    ),
    (
        "rim of a cylinder",
        "Cylinder(radius_m: 0.12, height_m: 0.24)",
        [0.12, 0.12, 0.0],
    ),
];
/// Frames over which a vertex must leave through the same face.
const STEADY_FRAMES: u32 = 100;
/// Frames after which blades under a fixed body have found their place: 3 s, nine times the time of
/// bend springs at 3 per second, which by then have e⁻⁹ of their way left.
const SETTLED_FRAMES: u32 = 180;

/// A vertex at the centre of a body, on its medial axis, an edge, a corner, a texel's border: no
/// way out is the shortest there. Choosing anew in every frame makes the blade jump from side to
/// side, and a normal made of a zero vector is not a number.
pub fn degenerate_point(setting: &Setting) -> Measured {
    let mut flips = Vec::new();
    let mut pushed = 0;
    for &(what, shape, place) in DEGENERATE {
        // A body of one part would be let down from above, and meet the vertex somewhere else: this
        // one has a second part, far above the grass.
        let parts =
            format!("(shape: {shape}), (shape: Ball(radius_m: 0.1), position_m: (0, 4, 0))");
        let compound = format!("Compound(parts: [{parts}])");
        let (mut rig, vertex) = with_vertex_at(setting, &compound, place)?;
        // The chosen vertex from its first contact on.
        rig.ticks(FRAME_TICKS)?;
        let first = faces(&mut rig)?;
        ensure(first.get(vertex).is_some_and(|&face| face != 0), || {
            format!("{what}: the vertex was not pushed")
        })?;
        let mut before = first.clone();
        let mut changes = vec![0_u32; first.len()];
        for frame in 1..=SETTLED_FRAMES + STEADY_FRAMES {
            rig.ticks(FRAME_TICKS)?;
            let now = faces(&mut rig)?;
            if frame <= STEADY_FRAMES && now.get(vertex) != first.get(vertex) {
                flips.push(format!(
                    "{what}: the vertex leaves through another face, frame {frame}"
                ));
            }
            for ((before, now), changes) in before.iter_mut().zip(now).zip(&mut changes) {
                *changes += u32::from(now != *before && frame > SETTLED_FRAMES);
                *before = now;
            }
        }
        // Every other one once its blade has settled: it may slide over an edge, once, but not
        // come back.
        let jumping = changes.iter().filter(|&&changes| changes > 1).count();
        if jumping > 0 {
            flips.push(format!(
                "{what}: {jumping} vertices change their face to and fro"
            ));
        }
        rig.look()?;
        pushed += before.iter().filter(|&&face| face != 0).count();
    }
    ensure(pushed > 100, || {
        format!("only {pushed} vertices were pushed")
    })?;
    ensure(flips.is_empty(), || flips.join("; "))?;
    Ok(format!(
        "{} places, {pushed} pushed vertices, no face changed in {STEADY_FRAMES} frames",
        DEGENERATE.len()
    ))
}

/// The same with the bodies as they are, and the blade put back into its wind pose before every
/// frame, with the vertex within a few roundings of its place: whichever way out it took first, it
/// takes again. Without a memory of faces the roundings choose.
pub fn degenerate_point_put_back(setting: &Setting) -> Measured {
    for &(what, shape, place) in DEGENERATE {
        let (mut rig, vertex) = with_vertex_at(setting, shape, place)?;
        let mut first = None;
        let mut state = rig.state()?;
        for frame in 0..=STEADY_FRAMES {
            put_back(&rig, &mut state, vertex, frame)?;
            rig.take_over(&state)?;
            rig.ticks(FRAME_TICKS)?;
            state = rig.state()?;
            // The first frame finds the way out without a memory.
            if frame == 0 {
                continue;
            }
            let (slab, node) = place_of(&rig, vertex)?;
            let face = state.slabs[slab]
                .as_ref()
                .map_or(0, |slab| slab.faces[node]);
            let first = *first.get_or_insert(face);
            ensure(face != 0 && face == first, || {
                format!("{what}: face {face:x} in frame {frame}, {first:x} at first")
            })?;
        }
        rig.look()?;
    }
    Ok(format!(
        "{} places, put back before each of {STEADY_FRAMES} frames, through the same face every time",
        DEGENERATE.len()
    ))
}

/// Most by which the vertex misses its place along an axis, in metres: four roundings of a coordinate
/// below 2 m.
const ASIDE_M: f64 = 5e-7;

/// The number of the slab that a vertex of [`with_vertex_at`] is in, and its place there.
fn place_of(rig: &Rig, vertex: usize) -> Result<(usize, usize), Failed> {
    let segments = rig.meadow.scene.solver.segments as usize;
    let per_slab = rig.meadow.field.grid.plants_per_tile() as usize * segments;
    let tile = rig.meadow.work.tiles.get(vertex / per_slab);
    let tile = tile.ok_or("the vertex is in no active tile")?;
    Ok((tile.slab as usize, vertex % per_slab))
}

/// Puts the blade of a vertex into its wind pose, as if the body had left it there in this sub-step.
/// The memory of its faces is wiped before the first frame alone.
fn put_back(rig: &Rig, state: &mut Handmade, vertex: usize, frame: u32) -> Result<(), Failed> {
    let segments = rig.meadow.scene.solver.segments as usize;
    let (slab, node) = place_of(rig, vertex)?;
    let slab = state.slabs[slab].as_mut().ok_or("the tile has no slab")?;
    let plant = node / segments;
    slab.touched_at[plant] = rig.meadow.work.now;
    let nodes = plant * segments..(plant + 1) * segments;
    slab.offsets[nodes.clone()].fill(Vec3::ZERO);
    let aside = |axis| {
        let word = philox2x32([frame, axis], 13, 7)[0];
        (2.0 * f64::from(unit(word)) - 1.0) * ASIDE_M
    };
    slab.offsets[node] = Vec3::of([aside(0), aside(1), aside(2)]);
    if frame == 0 {
        slab.faces[nodes].fill(0);
    }
    Ok(())
}

/// A fixed body placed so that the fifth node of some plant lies at `place` of the body, and the
/// index of that node's word in [`faces`].
fn with_vertex_at(setting: &Setting, shape: &str, place: [f64; 3]) -> Result<(Rig, usize), Failed> {
    let scene = |body: &str| {
        format!(
            "(duration_s: 10, terrain: (ground: Flat(size_m: (3, 3))), {CALM}, bodies: [{body}])"
        )
    };
    let mut bare = setting.rig(&scene(""))?;
    let plants = bare.engine.near(&bare.meadow, [0.1, 0.1], 0.3)?;
    let plant = plants.first().ok_or("no plant near the middle")?;
    let node = plant.nodes[5].to_f64();
    let at = [0, 1, 2].map(|a| plant.origin[a] + node[a] - place[a]);
    let mut rig = setting.rig(&scene(&format!(
        "(name: \"thing\", shape: {shape}, position_m: ({}, {}, {}), motion: Fixed, collider: {})",
        at[0],
        at[1],
        at[2],
        setting.collider()
    )))?;
    rig.tick()?;
    let segments = rig.meadow.scene.solver.segments as usize;
    let per_tile = rig.meadow.field.grid.plants_per_tile() as usize;
    let tiles = rig.meadow.work.tiles.clone();
    for (n, tile) in tiles.iter().enumerate() {
        let standing = rig.engine.standing(&rig.meadow, tile)?;
        let found = standing
            .iter()
            .position(|p| p.root_in_world() == plant.root_in_world());
        // Every triangle of a whole density has all its plants, so ranks are places.
        if let Some(rank) = found {
            return Ok((rig, (n * per_tile + rank) * segments + 4));
        }
    }
    Err("the plant is in no active tile".into())
}

/// The face words of every vertex of the active tiles.
fn faces(rig: &mut Rig) -> Result<Vec<u32>, Failed> {
    let (engine, meadow) = (&rig.engine, &rig.meadow);
    let slabs = meadow.work.tiles.iter().map(|tile| tile.slab);
    Ok(match engine {
        Engine::Cpu(grass) => slabs
            .filter_map(|slab| grass.slab(slab))
            .flat_map(|slab| slab.faces.clone())
            .collect(),
        Engine::Reference(_) => Vec::new(),
        Engine::Gpu(engine) => {
            let state = engine.grass.read_state(meadow)?;
            slabs
                .filter_map(|slab| state.slab(slab))
                .flat_map(|slab| slab.faces.clone())
                .collect()
        }
    })
}

/// Largest relative change of a segment's length under a body that covers whole plants.
const BURIED_STRAIN: f64 = 0.05;

/// A box larger than any blade set onto the roots. There is no way out for most vertices: pushing
/// them through the nearest face stretches the blades across the body.
pub fn buried(setting: &Setting) -> Measured {
    let mut rig = setting.rig(&format!(
        "(duration_s: 10, terrain: (ground: Flat(size_m: (4, 4))), {CALM}, bodies: [
            (name: \"box\", shape: Box(size_m: (1.2, 0.8, 1)), position_m: (0.1, 0.4, -0.1),
             rotation_deg: (0, 25, 0), motion: Fixed, collider: {})],
          script: [(at_s: 2, action: Remove(body: \"box\"))])",
        setting.collider()
    ))?;
    rig.run_to(2 * SECOND_TICKS, 8)?;
    let strain = rig.seen.strain;
    let snapshot = rig.engine.snapshot(&rig.meadow)?;
    let pinched = snapshot.pinched;
    let buried = snapshot.buried;
    let lifted = rig.meadow.ticks;
    rig.run_to(lifted + rig.meadow.recovery_ticks(), 8)?;
    let plants = rig.look()?;
    let text = format!(
        "strain {strain:.4} (limit {BURIED_STRAIN}), {buried} plants buried, {pinched} vertices \
         pinched"
    );
    ensure(strain <= BURIED_STRAIN && buried > 0, || text.clone())?;
    ensure(!plants.is_empty() && all_in_wind_pose(&plants), || {
        "not every plant is back in its wind pose".into()
    })?;
    rig.nothing_is_inside()?;
    Ok(text)
}

/// Bodies sunk into the ground askew and round, and one that is pushed through the grass it stands on and
/// lifted. A segment that starts under a body is too short for every way out: left as it is it stands
/// up to 127 mm deep in the body, beside others that lie on the ground.
pub fn buried_askew(setting: &Setting) -> Measured {
    let collider = setting.collider();
    let mut rig = setting.rig(&format!(
        "(duration_s: 10, terrain: (ground: Flat(size_m: (8, 4))), {CALM}, bodies: [
            (name: \"box\", shape: Box(size_m: (1.2, 0.8, 1)), position_m: (-2.5, 0.35, 0),
             rotation_deg: (10, 25, 15), motion: Fixed, collider: {collider}),
            (name: \"ball\", shape: Ball(radius_m: 0.6), position_m: (-0.5, 0.2, 0), motion: Fixed,
             collider: {collider}),
            (name: \"pushed\", shape: Box(size_m: (1, 0.8, 0.9)), collider: {collider},
             motion: Path(waypoints: [(at_s: 0, position_m: (1.2, 0.4, 0)), (at_s: 0.3, position_m: (1.2, 0.4, 0)),
                (at_s: 1.8, position_m: (2.4, 0.4, 0), rotation_deg: (0, 60, 0)),
                (at_s: 2.3, position_m: (2.4, 1.4, 0), rotation_deg: (0, 60, 0))]))])",
    ))?;
    rig.run_to(5 * SECOND_TICKS / 2, 2)?;
    let buried = rig.engine.snapshot(&rig.meadow)?.buried;
    let text = format!(
        "strain {:.4} (limit {BURIED_STRAIN}), deepest node at {:.2} of its limit, {buried} plants buried",
        rig.seen.strain, rig.seen.depth_over_limit
    );
    ensure(rig.seen.strain <= BURIED_STRAIN && buried > 300, || {
        text.clone()
    })?;
    rig.nothing_is_inside()?;
    Ok(text)
}
