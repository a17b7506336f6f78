//! Light volumes as a shader finds them at places, beside the same lookup in Rust.

use libtest_mimic::Failed;
use sward::base::Vec3;
use sward::bodies::{Bodies, Occluders};
use sward::gpu::wgsl::{self, WgslFile};
use sward::gpu::{Buffer, Gpu};
use sward::render::light::{LightGrid, LightTexels, LightTextures, TraceProgress, Visibility};
use sward::render::{SHADERS, Sun, View};
use sward::scene::Scene;
use sward::terrain::height_grid;
use wgpu::{BindingType, BufferBindingType, BufferUsages, ShaderStages};

use super::Device;

/// Rows of four words per place: red, green, blue with their means, the openness, light on a normal, and on
/// a leaf with it.
const ROWS: usize = 6;
/// Share of a leaf's light that comes from its other side.
const LETS_THROUGH: f32 = 0.3;

const PROBE: &str = r#"
#import "shared/volume_light.wgsl"

@group(0) @binding(0) var<storage, read> places_from_eye: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> found: array<vec4f>;

@compute @workgroup_size(1)
fn probe(@builtin(global_invocation_id) id: vec3u) {
    let at = sky_light_at(places_from_eye[id.x].xyz);
    let first = id.x * 6u;
    found[first] = vec4f(at.leans[0], at.mean.r);
    found[first + 1u] = vec4f(at.leans[1], at.mean.g);
    found[first + 2u] = vec4f(at.leans[2], at.mean.b);
    found[first + 3u] = vec4f(at.openness);
    found[first + 4u] = vec4f(sky_light(at, vec3f(0.6, 0.0, 0.8)), 0.0);
    found[first + 5u] = vec4f(leaf_sky_light(at, vec3f(0.6, 0.0, 0.8)), 0.0);
}
"#;

const SCENE: &str = "(terrain: (ground: Rolling(size_m: (9, 7), amplitude_m: 1, wavelength_m: 5)), \
    light: Some((cell_m: 0.7, height_m: 1.5, slices: 4, rays: 128)), \
    bodies: [(name: \"wall\", shape: Box(size_m: (3, 2, 0.5)), position_m: (1, 0.5, 0.3), motion: Fixed)])";

fn texels() -> Result<LightTexels, Failed> {
    let scene: Scene = ron::from_str(SCENE)?;
    let light = scene.light.ok_or("the key")?;
    let ground = height_grid(&scene.terrain, &Default::default())?;
    let bodies = Bodies::new(&scene, &Default::default(), &ground)?;
    let occluders = Occluders::new(&bodies)?;
    let sight = |from, along| occluders.sight(from, along);
    let (grid, progress) = (LightGrid::new(&light, &ground), TraceProgress::default());
    let seen = Visibility::trace(grid, light.rays, light.seed, &sight, &progress);
    Ok(LightTexels::new(
        &seen.ok_or("it ended")?,
        &Sun::default().daylight(),
    ))
}

/// Places in the volume, on its edges, above and beside it.
fn places() -> Vec<[f64; 3]> {
    let mut places = Vec::new();
    for x in 0..13_u8 {
        for y in 0..7_u8 {
            for z in 0..11_u8 {
                let [x, y, z] = [x, y, z].map(f64::from);
                places.push([x * 0.83 - 5.1, y * 0.53 - 1.2, z * 0.77 - 3.9]);
            }
        }
    }
    places
}

/// Texture units of a device may weigh texels in steps of 2⁻⁸ along each of two axes, so that what lies
/// between four of them is off by two steps of their range at most; between slices the shader mixes in f32.
/// Places from the eye are f32: 2⁻²⁴ of 10 m over a cell is below that by three digits.
pub fn lookups_agree(device: &Device) -> Result<(), Failed> {
    let gpu = &device.gpu;
    let texels = texels()?;
    let places = places();
    let view = View {
        eye_in_world: Vec3::new(1.5, 2.0, 4.0),
        forward: Vec3::new(0.0, 0.0, -1.0),
        fov_rad: 0.8,
    };
    let found = probed(gpu, &texels, &places, &view)?;
    let limits = limits(&texels);
    let normal = Vec3::new(0.6, 0.0, 0.8);
    let mut wrong = Vec::new();
    for (n, &place) in places.iter().enumerate() {
        let wanted = texels.at(place);
        let (lit, other) = (wanted.on(normal), wanted.on(-normal));
        let rows = &found[n * ROWS..][..ROWS];
        let mut check = |what: &str, found: f32, wanted: f32, limit: f32| {
            // What is no number is not within the limit either.
            let agrees = (found - wanted).abs() <= limit;
            if !agrees {
                wrong.push(format!(
                    "{place:?} {what}: {found}, {wanted}, limit {limit}"
                ));
            }
        };
        for colour in 0..3 {
            let limit = &limits[4 * colour..][..4];
            for part in 0..4 {
                let wanted = wanted.irradiance[colour][part];
                check("stored", rows[colour][part], wanted, limit[part]);
            }
            check(
                "on a normal",
                rows[4][colour],
                lit[colour],
                limit.iter().sum(),
            );
            check(
                "on a leaf",
                rows[5][colour],
                lit[colour] + LETS_THROUGH * (other[colour] - lit[colour]),
                limit.iter().sum(),
            );
        }
        check("openness", rows[3][0], wanted.openness, limits[12]);
    }
    match wrong.first() {
        None => Ok(()),
        Some(first) => Err(format!("{} values differ, first {first}", wrong.len()).into()),
    }
}

/// How far a lookup may be off, for each of the numbers that a cell stores.
fn limits(texels: &LightTexels) -> [f32; 13] {
    let mut range = [[f32::MAX, f32::MIN]; 13];
    let ([wide, deep], [x, z]) = (texels.columns, texels.corner_in_world);
    for cell in 0..wide * deep * texels.slices {
        let (column, row, slice) = (cell % wide, cell / wide % deep, cell / wide / deep);
        let ground_m = texels.ground_m[(row * wide + column) as usize];
        let at = texels.at([
            x + f64::from(column) * texels.cell_m[0],
            f64::from(ground_m) + f64::from(slice) * texels.slice_m,
            z + f64::from(row) * texels.cell_m[1],
        ]);
        let stored = at.irradiance.as_flattened().iter().chain([&at.openness]);
        for (range, &number) in range.iter_mut().zip(stored) {
            *range = [range[0].min(number), range[1].max(number)];
        }
    }
    range.map(|[least, most]| 2.0 / 256.0 * (most - least) + 1e-5)
}

/// Rows of every place, from the device.
fn probed(
    gpu: &Gpu,
    texels: &LightTexels,
    places: &[[f64; 3]],
    view: &View,
) -> Result<Vec<[f32; 4]>, Failed> {
    let file = WgslFile {
        path: "probe",
        text: PROBE,
        constants: Vec::new,
    };
    let source = wgsl::assemble(&file, &[SHADERS, wgsl::SHARED])?;
    let from_eye: Vec<[f32; 4]> = (places.iter())
        .map(|&place| {
            let [x, y, z] = view.from_eye(Vec3::of(place));
            [x, y, z, 0.0]
        })
        .collect();
    let asked = Buffer::with(gpu, "places", &from_eye, BufferUsages::STORAGE)?;
    let count = places.len() * ROWS;
    let found: Buffer<[f32; 4]> = Buffer::new(gpu, "found", count, BufferUsages::STORAGE)?;
    // A view of zeroes: the ground throws nothing up.
    let frame: Buffer<[f32; 4]> = Buffer::new(gpu, "frame", 32, BufferUsages::UNIFORM)?;
    let textures = LightTextures::new(gpu, texels)?;
    textures.write(gpu, view)?;

    let buffer = |ty| BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let storage = |read_only| buffer(BufferBindingType::Storage { read_only });
    let of_volume = LightTextures::bindings().map(|(_, ty)| ty);
    let groups = [
        group(
            gpu,
            0,
            &[storage(true), storage(false)],
            &[asked.binding(), found.binding()],
        ),
        group(
            gpu,
            0,
            &[buffer(BufferBindingType::Uniform)],
            &[frame.binding()],
        ),
        // After the shadow map's two.
        group(gpu, 2, &of_volume, &textures.resources()),
    ];
    let layouts: Vec<_> = groups.iter().map(|(layout, _)| layout).collect();
    let pipeline = gpu.compute_pipeline(&source, "probe", &layouts)?;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        for (n, (_, group)) in (0..).zip(&groups) {
            pass.set_bind_group(n, group, &[]);
        }
        pass.dispatch_workgroups(places.len() as u32, 1, 1);
    }
    gpu.queue.submit([encoder.finish()]);
    Ok(found.read(gpu, count)?)
}

/// A bind group whose first binding has a number, for a kernel.
fn group(
    gpu: &Gpu,
    first: u32,
    types: &[BindingType],
    resources: &[wgpu::BindingResource<'_>],
) -> (wgpu::BindGroupLayout, wgpu::BindGroup) {
    let layout_entries: Vec<_> = (first..)
        .zip(types)
        .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: ShaderStages::COMPUTE,
            ty,
            count: None,
        })
        .collect();
    let layout = (gpu.device).create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("probe"),
        entries: &layout_entries,
    });
    let entries: Vec<_> = (first..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry {
            binding,
            resource: resource.clone(),
        })
        .collect();
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("probe"),
        layout: &layout,
        entries: &entries,
    });
    (layout, group)
}
