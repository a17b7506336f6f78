//! Depth cubes texel by texel, for every kind of solid and for parts that hide each other.

use libtest_mimic::Failed;
use sward::base::{Vec3, vec3};
use sward::gpu::GpuGrass;
use sward::sim::depth_cube::{COVER_MARGIN_M, DEPTH_STEPS, DepthCube, HIDDEN, HIT, unpack_normal};
use sward::sim::parts::Part;
use sward::sim::solid::Solid;
use sward::sim::{Grass, Meadow};

use super::Device;
use super::compare::{Difference, ensure};
use super::meadows::parade;

/// How far rounding moves a surface or a ray, in metres: both sides add at most eight roundings of
/// 2⁻²⁴ in lengths below 0.5 m (a ray's start, a product with an axis, a square and its root).
const SURFACE_M: f64 = 2.0 * 8.0 * 0.5 / 16_777_216.0;
/// Half a step of the packed normal, on either side (see the unit test of the packing).
const NORMAL_STEP: f64 = 2.0 * 6.5e-5;

/// A texel's ray in the part's space.
struct Ray {
    start: Vec3<f64>,
    along: Vec3<f64>,
    axis: usize,
    extent_m: f64,
}

fn ray(cube: &DepthCube, texel: usize) -> Ray {
    let n = cube.resolution as usize;
    let (face, row, column) = (texel / (n * n), texel / n % n, texel % n);
    let axis = face / 2;
    let (low, high) = (cube.low.to_f64(), cube.high.to_f64());
    let mut start = if face % 2 == 0 { high } else { low };
    for (b, at) in [((axis + 1) % 3, column), ((axis + 2) % 3, row)] {
        start[b] = low[b] + (at as f64 + 0.5) / n as f64 * (high[b] - low[b]);
    }
    let mut along = [0.0; 3];
    along[axis] = if face % 2 == 0 { -1.0 } else { 1.0 };
    Ray {
        start: Vec3::of(start),
        along: Vec3::of(along),
        axis,
        extent_m: high[axis] - low[axis],
    }
}

/// Greatest depth that a ray reaches in a convex solid: negative for a miss. Depth is concave along
/// the ray.
fn deepest(solid: &Solid<f64>, ray: &Ray) -> f64 {
    let depth = |t: f64| solid.depth(ray.start + ray.along * t);
    let (mut low, mut high) = (0.0, ray.extent_m);
    for _ in 0..200 {
        let third = (high - low) / 3.0;
        if depth(low + third) < depth(high - third) {
            low += third;
        } else {
            high -= third;
        }
    }
    depth(low)
}

/// Flat faces that a point lies on.
fn faces_at(solid: &Solid<f64>, p: Vec3<f64>, within_m: f64) -> usize {
    match solid {
        Solid::Box { half } => [half.x - p.x.abs(), half.y - p.y.abs(), half.z - p.z.abs()]
            .iter()
            .filter(|d| d.abs() <= within_m)
            .count(),
        Solid::Convex { planes, .. } => planes
            .iter()
            .filter(|plane| (plane.offset - plane.normal.dot(p)).abs() <= within_m)
            .count(),
        _ => 0,
    }
}

#[derive(Debug)]
struct Compared {
    depth: Difference,
    normal: Difference,
    hits: u32,
    grazing: u32,
    edges: u32,
}

impl Compared {
    fn new() -> Self {
        Self {
            depth: Difference::new("texel depth across the surface", "m"),
            normal: Difference::new("texel normal", ""),
            hits: 0,
            grazing: 0,
            edges: 0,
        }
    }

    fn add(
        &mut self,
        name: &str,
        solid: &Solid<f64>,
        cpu: &DepthCube,
        gpu: &DepthCube,
    ) -> Result<(), Failed> {
        ensure(cpu.texels.len() == gpu.texels.len(), || {
            format!("{name}: {} texels", gpu.texels.len())
        })?;
        for (n, (&ours, &theirs)) in cpu.texels.iter().zip(&gpu.texels).enumerate() {
            let ray = ray(cpu, n);
            if (ours[0] ^ theirs[0]) & HIT != 0 {
                let depth = deepest(solid, &ray);
                self.grazing += 1;
                ensure(depth.abs() <= SURFACE_M, || {
                    format!("{name} texel {n}: hit on one side only, {depth:.1e} m deep")
                })?;
            } else if ours[0] & HIT != 0 {
                self.hits += 1;
                self.add_hit(&format!("{name} texel {n}"), solid, &ray, ours, theirs)?;
            }
        }
        Ok(())
    }

    fn add_hit(
        &mut self,
        name: &str,
        solid: &Solid<f64>,
        ray: &Ray,
        ours: [u32; 2],
        theirs: [u32; 2],
    ) -> Result<(), Failed> {
        let depth = |word: u32| f64::from(word & (HIDDEN - 1)) / DEPTH_STEPS * ray.extent_m;
        let off = (depth(ours[0]) - depth(theirs[0])).abs();
        let normal = unpack_normal::<f64>(ours[1]);
        // A surface that moves by s along its normal moves by s/|n·a| along the ray.
        let facing = normal.to_f64()[ray.axis].abs();
        self.depth.add(off * facing, || name.to_owned());
        let turned = (normal - unpack_normal(theirs[1])).length();
        let p = ray.start + ray.along * depth(ours[0]);
        if turned > NORMAL_STEP && faces_at(solid, p, 2.0 * SURFACE_M) > 1 {
            self.edges += 1;
            return Ok(());
        }
        // A round surface of at least 0.1 m radius turns by `off` over that radius.
        self.normal
            .add((turned - off / 0.1).max(0.0), || name.to_owned());
        Ok(())
    }

    fn check(self) -> Result<(), Failed> {
        println!(
            "{} texels hit on both sides, {} grazed, {} on an edge",
            self.hits, self.grazing, self.edges
        );
        self.depth.check(SURFACE_M)?;
        self.normal.check(NORMAL_STEP)
    }
}

/// A meadow with all its cubes drawn on both sides.
fn drawn(device: &Device) -> Result<(Meadow, GpuGrass), Failed> {
    let mut meadow = parade("cube")?;
    let mut gpu = GpuGrass::new(&device.gpu, &device.kernels, &mut meadow)?;
    meadow.move_bodies();
    for part in 0..meadow.parts.parts.len() {
        meadow.parts.want(part, sward::sim::parts::Tested::Cube);
    }
    gpu.draw_depth_cubes(&meadow)?;
    gpu.submit();
    Grass::<f32>::new().draw_depth_cubes(&mut meadow);
    Ok((meadow, gpu))
}

fn pair<'a>(
    gpu: &GpuGrass,
    device: &Device,
    index: usize,
    part: &'a Part,
) -> Result<(&'a DepthCube, DepthCube), Failed> {
    let missing = || Failed::from(format!("part {index} has no cube"));
    let theirs = gpu.cubes.read(&device.gpu, index as u32)?;
    Ok((
        part.cube.as_ref().ok_or_else(missing)?,
        theirs.ok_or_else(missing)?,
    ))
}

pub fn closed_forms_agree(device: &Device) -> Result<(), Failed> {
    let (meadow, gpu) = drawn(device)?;
    let skin = f64::from(meadow.scene.solver.skin_m);
    let mut compared = Compared::new();
    for (index, part) in meadow.parts.parts.iter().enumerate() {
        let (ours, theirs) = pair(&gpu, device, index, part)?;
        let grown = part.solid.grown_by(skin);
        compared.add(&format!("part {index}"), &grown, ours, &theirs)?;
    }
    ensure(compared.hits > 100_000, || {
        format!("{} hits", compared.hits)
    })?;
    compared.check()
}

/// A texel is hidden on one side only where its point is within rounding of the margin.
pub fn hidden_faces_agree(device: &Device) -> Result<(), Failed> {
    let (meadow, gpu) = drawn(device)?;
    let mut hidden = 0;
    for (index, part) in meadow.parts.parts.iter().enumerate() {
        let (ours, theirs) = pair(&gpu, device, index, part)?;
        for (n, (a, b)) in ours.texels.iter().zip(&theirs.texels).enumerate() {
            hidden += a[0] >> 30 & 1;
            if a[0] & b[0] & HIT == 0 || (a[0] ^ b[0]) & HIDDEN == 0 {
                continue;
            }
            let ray = ray(ours, n);
            let depth = f64::from(a[0] & (HIDDEN - 1)) / DEPTH_STEPS * ray.extent_m;
            let in_body = part.pose.point(ray.start + ray.along * depth);
            let covered = meadow
                .parts
                .siblings(index)
                .map(|other| other.solid.depth(other.pose.inverse_point(in_body)))
                .fold(f64::NEG_INFINITY, f64::max);
            // A turn to the body and one to the sibling add their own roundings to the point's.
            ensure((covered - COVER_MARGIN_M).abs() <= 4.0 * SURFACE_M, || {
                format!("part {index} texel {n}: {covered} m inside another part")
            })?;
        }
    }
    ensure(hidden > 100, || format!("only {hidden} hidden texels"))?;
    let unit = vec3(0.0, 0.0, 1.0);
    ensure(
        (unpack_normal::<f64>(0x8000_8000) - unit).length() < 1e-4,
        || "the normal's packing has changed".into(),
    )
}
