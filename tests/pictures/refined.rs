//! Billboards of tiles that are awake, beside the quads they are at rest.

use std::time::Instant;

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::field::Horizon;
use sward::gpu::{Buffer, Gpu, PassTimer};
use sward::render::{
    BillboardNodes, BladeDetail, BladesInput, Exposure, FrameInput, Picture, View, bodies_at,
};
use sward::sim::billboard::Quad;
use sward::sim::{Grass, Meadow, tick};

use super::{ALL, Shown, Stage, WHOLE, difference, hold};

/// A ball that hangs 20 cm over the tallest clumps' tips, and within their bounding balls.
const NEAR: &str = "(terrain: (ground: Flat(size_m: (8, 8))), grass: (species: []), \
    billboards: Some((density_per_m2: 30)), wind: (strength: 0.1, gust: 0.1), \
    bodies: [(name: \"ball\", shape: Ball(radius_m: 0.1), position_m: (0, 0.8, 1), motion: Fixed)])";

/// A ball that lies in the clumps until it is taken out.
const PRESSED: &str = "(terrain: (ground: Flat(size_m: (8, 8))), grass: (species: []), \
    billboards: Some((density_per_m2: 30, nodes: (NODES), draw_subdivision: CUT)), \
    wind: (strength: 0.1, gust: 0.1), solver: (recovery_s: 0.5), \
    bodies: [(name: \"ball\", shape: Ball(radius_m: 0.4), position_m: (0, 0.4, 1), motion: Fixed)], \
    script: [(at_s: 0.1, action: Remove(body: \"ball\"))])";

fn pressed(nodes: &str, cut: u32) -> String {
    PRESSED
        .replace("NODES", nodes)
        .replace("CUT", &cut.to_string())
}

/// The form that is drawn of billboards in tiles that are awake: that of their nodes, or quads.
fn forms(gpu: &Gpu, stage: &mut Stage, shown: Shown) -> Result<[Picture; 2], Failed> {
    let awake = stage.shoot(
        gpu,
        Shown {
            active: true,
            ..shown
        },
    )?;
    let counts = stage.renderer.billboard_counts().unwrap_or_default();
    hold(
        counts.refined_tiles > 0 && counts.refined > 0 && counts.nodes_bytes > 16,
        format!("nothing is refined: {counts:?}"),
    )?;
    let asleep = stage.shoot(
        gpu,
        Shown {
            active: false,
            ..shown
        },
    )?;
    Ok([awake, asleep])
}

/// Root mean square difference over the texels that differ at all: that of the parts that change, however
/// little of the picture they fill.
fn where_changed([a, b]: &[Picture; 2]) -> (usize, f64) {
    let texels = a.rgba8.chunks_exact(4).zip(b.rgba8.chunks_exact(4));
    let changed: Vec<f64> = texels
        .filter(|(a, b)| a != b)
        .map(|(a, b)| {
            let squares = (0..3).map(|n| (f64::from(a[n]) - f64::from(b[n])).powi(2));
            squares.sum::<f64>() / 3.0
        })
        .collect();
    let mean = changed.iter().fold(0.0, |sum, one| sum + one) / changed.len().max(1) as f64;
    (changed.len(), mean.sqrt())
}

/// A tile that wakes draws its billboards from their nodes in place of their records. Where nothing pushes
/// them that changes no texel.
pub fn waking_changes_no_clump(gpu: &Gpu) -> Result<(), Failed> {
    let mut stage = Stage::new(gpu, NEAR, 2)?;
    let pair = forms(gpu, &mut stage, ALL)?;
    let (count, there) = where_changed(&pair);
    hold(
        count == 0,
        format!("waking changes {count} texels by {there} grey levels"),
    )
}

/// Tiles, each with the row at which its billboards' nodes begin, and the nodes.
type Nodes = (Vec<(u32, u32)>, Buffer<[f32; 4]>);

/// Nodes of every billboard of a field in the wind, as of refined forms whose last offset has just faded.
fn faded(gpu: &Gpu, meadow: &Meadow) -> Result<Nodes, Failed> {
    let field = &meadow.field;
    let weave = meadow.weave.as_ref().ok_or("the scene has billboards")?;
    let (mut tiles, mut rows) = (Vec::new(), Vec::new());
    for tile in 0..field.grid.tile_count() {
        let anchor = field.grid.anchor_of(tile, &field.ground);
        tiles.push((tile, rows.len() as u32));
        for billboard in field.billboards_in(tile) {
            let quad: Quad<f32> = Quad::in_wind(billboard, &anchor, &meadow.work.wind);
            quad.nodes(weave.grid, |_, node| {
                rows.push([node.x, node.y, node.z, 1.0])
            });
        }
    }
    let nodes = Buffer::with(gpu, "faded", &rows, wgpu::BufferUsages::STORAGE)?;
    Ok((tiles, nodes))
}

/// At the moment of change, either way, a refined form is in its quad's place: all of a meadow drawn in one
/// form and in the other differ by less than one grey level, root mean square. Its light is that of the
/// quad's corners, mixed as over the quad's two triangles: alike within a step of 8 bits where a form has as
/// many segments across as up, else between the two forms' diagonals only.
pub fn refined_forms_in_the_wind_are_quads(gpu: &Gpu) -> Result<(), Failed> {
    for (nodes, cut) in [("3, 3", 1), ("4, 4", 2), ("5, 4", 3), ("9, 3", 2)] {
        let mut stage = Stage::new(gpu, &pressed(nodes, cut), 0)?;
        let plain = stage.shoot(gpu, ALL)?;
        let (tiles, nodes_of) = faded(gpu, &stage.meadow)?;
        let input = FrameInput {
            view: &ALL.view,
            sun: ALL.sun,
            exposure: Exposure::default(),
            bodies: &bodies_at(&stage.meadow, 1.0),
            blades: Some(BladesInput {
                field: &stage.meadow.field,
                wind: &stage.meadow.work.wind,
                active: &[],
                active_nodes: &stage.nodes.nodes,
                billboards: Some(BillboardNodes {
                    tiles: &tiles,
                    nodes: &nodes_of,
                }),
                detail: BladeDetail {
                    full_m: ALL.full_m,
                    reach_m: 40.0,
                    tuft: 1,
                    ..BladeDetail::default()
                },
            }),
            marks: &[],
            time_s: 0.0,
        };
        let mut timer = PassTimer::new(gpu, 8);
        let target = &stage.target.view;
        stage.renderer.draw(gpu, &input, target, &mut timer)?;
        let counts = stage.renderer.billboard_counts().unwrap_or_default();
        hold(
            counts.refined > 100 && counts.refined == counts.billboards,
            format!("{counts:?}"),
        )?;
        let refined = stage.target.read(gpu)?;
        let step = difference(&plain, &refined, WHOLE);
        let (count, there) = where_changed(&[plain, refined]);
        println!("{nodes} cut by {cut}: {step:.3} grey levels; {count} texels by {there:.2}");
        hold(
            step < 1.0,
            format!("({nodes}) cut by {cut}: {step} grey levels"),
        )?;
    }
    Ok(())
}

/// The last tick at which a tile is awake.
fn last_awake(scene: &str) -> Result<u32, Failed> {
    let mut meadow = Meadow::new(ron::from_str(scene)?, &Default::default())?;
    let mut grass = Grass::<f32>::new();
    for _ in 0..400 {
        tick(&mut meadow, &mut grass)?;
        if meadow.ticks > 40 && meadow.work.tiles.is_empty() {
            return Ok(meadow.ticks - 1);
        }
    }
    Err("tiles never come to rest".into())
}

/// In the last sub-steps before a touched billboard is its quad again the two differ by less than one grey
/// level, where it stands; while it is pressed they differ by far more.
pub fn a_clump_that_is_back_is_its_quad(gpu: &Gpu) -> Result<(), Failed> {
    for (nodes, cut) in [("3, 3", 1), ("4, 4", 1), ("4, 4", 2), ("5, 4", 3)] {
        let scene = pressed(nodes, cut);
        let last = last_awake(&scene)?;
        let near = [0.3, 0.2, 0.7, 0.7];
        let mut told = Vec::new();
        for before in [last - 20, last - 4, last] {
            let mut stage = Stage::new(gpu, &scene, before)?;
            let shown = Shown {
                bodies: false,
                ..ALL
            };
            let pair = forms(gpu, &mut stage, shown)?;
            let (count, there) = where_changed(&pair);
            told.push((
                last - before,
                difference(&pair[0], &pair[1], near),
                count,
                there,
            ));
        }
        println!("{nodes} cut by {cut}, sub-steps before rest: {told:.3?}");
        for &(before, step, ..) in &told[1..] {
            hold(
                step < 1.0,
                format!("{before} before rest: {step} grey levels"),
            )?;
        }
    }
    Ok(())
}

/// A pressed clump is drawn pressed, and the smooth surface through its nodes is another than their
/// straight lines.
pub fn pressed_clumps_show(gpu: &Gpu) -> Result<(), Failed> {
    let shown = Shown {
        bodies: false,
        ..ALL
    };
    let mut pictures = Vec::new();
    for cut in [0, 1, 4] {
        let mut stage = Stage::new(gpu, &pressed("3, 3", cut), 20)?;
        pictures.push(stage.shoot(gpu, shown)?);
    }
    let near = [0.35, 0.3, 0.65, 0.6];
    let bent = difference(&pictures[0], &pictures[1], near);
    let smooth = difference(&pictures[1], &pictures[2], near);
    println!("pressed {bent:.1}, smooth {smooth:.1} grey levels");
    hold(
        bent > 5.0 && smooth > 1.0,
        format!("pressing changes {bent} grey levels, smoothing {smooth}"),
    )
}

/// How long it takes to judge all tiles of a field from an eye, the horizon included.
fn judging_ms(meadow: &Meadow, view: View) -> f64 {
    let (field, ground) = (&meadow.field, &meadow.field.ground);
    let started = Instant::now();
    let mut horizon = Horizon::new(ground, view.eye_in_world, 91.0, 0.0);
    for tile in 0..field.grid.tile_count() {
        let [low, high] = field.grid.tile_bounds(tile, ground);
        let [lowest, highest] = field.grid.tile_heights(tile, ground).map(f64::from);
        horizon.hides([low[0], lowest, low[1]], [high[0], highest + 0.8, high[1]]);
    }
    1e3 * started.elapsed().as_secs_f64()
}

/// Tiles of billboards behind hills are left out, and no texel changes.
pub fn hidden_clumps_change_nothing(gpu: &Gpu) -> Result<(), Failed> {
    let scene = "(terrain: (ground: Rolling(size_m: (64, 64), amplitude_m: 3, wavelength_m: 15, seed: 3)), \
        grass: (species: []), billboards: Some((density_per_m2: 12)))";
    let mut stage = Stage::new(gpu, scene, 0)?;
    let ground = &stage.meadow.field.ground;
    let views = [[-20.0, -9.0], [3.0, 14.0], [25.0, -25.0], [0.0, 0.0]].map(|[x, z]| {
        let eye = Vec3::new(x, ground.height_in_world(x, z) + 1.0, z);
        View::look_at(eye, Vec3::new(0.3, eye.y - 0.5, 1.0), 60.0)
    });
    println!(
        "{:.2} ms to judge every tile",
        judging_ms(&stage.meadow, views[0])
    );
    let mut all_hidden = 0;
    for view in views {
        let shown = Shown { view, ..ALL };
        let dropped = stage.shoot(gpu, shown)?;
        let counts = stage.renderer.billboard_counts().unwrap_or_default();
        let full = stage.shoot(
            gpu,
            Shown {
                drops_hidden: false,
                ..shown
            },
        )?;
        let all = stage.renderer.billboard_counts().unwrap_or_default();
        println!(
            "{} of {} tiles in view are hidden",
            counts.hidden_tiles, all.tiles
        );
        hold(
            counts.tiles + counts.hidden_tiles == all.tiles && all.hidden_tiles == 0,
            format!("{counts:?} of {all:?}"),
        )?;
        let changed = dropped
            .rgba8
            .iter()
            .zip(&full.rgba8)
            .filter(|(a, b)| a != b)
            .count();
        hold(changed == 0, format!("{changed} bytes change"))?;
        all_hidden += counts.hidden_tiles;
    }
    hold(
        all_hidden > 100,
        format!("only {all_hidden} tiles are hidden"),
    )
}

/// Milliseconds of both passes by form: a measurement, asked for by name.
pub fn forms_are_timed(gpu: &Gpu) -> Result<(), Failed> {
    for nodes in ["3, 3", "4, 4", "9, 9"] {
        for cut in [0, 1, 2, 4] {
            let mut stage = Stage::new(gpu, &pressed(nodes, cut), 20)?;
            let mut all = Vec::new();
            for _ in 0..12 {
                stage.shoot(gpu, ALL)?;
                all.push(stage.pass_ms.clone());
            }
            let counts = stage.renderer.billboard_counts().unwrap_or_default();
            for pass in ["billboards RU", "billboards RA"] {
                let named = all.iter().flatten().filter(|(name, _)| *name == pass);
                let mut ms: Vec<f64> = named.map(|&(_, ms)| ms).collect();
                ms.sort_by(f64::total_cmp);
                let median = ms.get(ms.len() / 2).copied().unwrap_or(0.0);
                let of = match pass {
                    "billboards RA" => counts.refined,
                    _ => counts.billboards - counts.refined,
                };
                println!(
                    "nodes ({nodes}), cut by {cut}: {pass} {median:.2} ms for {of} billboards"
                );
            }
        }
    }
    Ok(())
}
