// Plants of coats: strips along a curve that leaves the surface. P15 sections 2.3 and 2.4. Hosts:
// src/render/coat.rs, src/render/coat_place.rs.
//
// Deviations: a plant bends by a formula in place of eq. 12, since most are short beside their lean; its
// segments follow its height on the picture, in place of eq. 4; leaves are shaped by their
// strip in place of an alpha mask, and are as the blades of shaders/blades.wgsl widened to a pixel.
#import "shared/coat.wgsl"
#import "shared/frame.wgsl"
#import "shared/light.wgsl"
#import "shared/philox.wgsl"
#import "shared/plant_light.wgsl"
#import "shared/shadow.wgsl"

struct CoatLook {
    // Segments of a plant of each bucket.
    steps: array<vec4u, 2>,
    samples: u32, // per pixel; 1 means that coverage is drawn by lot
    spare_a: u32,
    spare_b: vec2u,
}

@group(3) @binding(0) var<uniform> coat_look: CoatLook;
@group(3) @binding(1) var<storage, read> coat_bodies: array<CoatBody>;
@group(3) @binding(2) var<storage, read> placed: array<PlacedPlant>;
@group(3) @binding(3) var<storage, read> totals: array<u32>;

struct CoatPoint {
    @builtin(position) clip: vec4f,
    // At the middle of the covered samples: outside the plant colours would run on.
    @location(0) @interpolate(perspective, centroid) radiance: vec3f,
    @location(1) @interpolate(perspective, centroid) opacity: f32,
    @location(2) across: f32, // from the midrib, -1 and 1 at the edges
}

const FORM_IS_BLADE = 1u;

// Half the width at a height, of the widest: a leaf is an egg on a short stalk, a blade tapers.
fn outline(form: u32, along: f32) -> f32 {
    if form == FORM_IS_BLADE {
        return mix(0.75, 1.0, smoothstep(0.0, 0.25, along)) * sqrt(max(1.0 - along * along, 0.0));
    }
    let lamina = saturate((along - 0.08) / 0.92);
    return max(pow(sin(3.1416 * pow(lamina, 0.8)), 0.8), 0.1 * (1.0 - along));
}

// Light of a leaf's colour at a point of it. Its neighbours' faces are about as the surface's, so that
// the coat as a whole is shaded like what it grows on.
fn coat_radiance(body: CoatBody, plant: PlacedPlant, facing: vec3f, along: f32, at: vec3f) -> vec3f {
    let lightness = 0.6 + 0.4 * byte_of(plant.shade, 0u) + 0.45 * plant.tone;
    let dry = smoothstep(0.85, 1.0, byte_of(plant.shade, 1u)) * 0.35;
    let rgb = body.rgb * lightness * mix(0.8, 1.2, along);
    let grey = dot(rgb, vec3f(0.3, 0.6, 0.1));
    let surface = mix(rgb, grey * vec3f(1.5, 1.25, 0.45), dry);
    let outward = select(facing, -facing, dot(facing, plant.normal) < 0.0);
    let normal = normalize(outward + 0.7 * plant.normal);
    let lifted = at + plant.normal * (1.5 * frame.shadow_texel_m);
    // The surface's own height in the coat differs from plant to plant, which parts the tops.
    let depth = (1.0 - along) * mix(0.7, 1.0, byte_of(plant.shade, 3u));
    return leaf_radiance(surface, normal, light_between(body.cover, depth, lifted), at);
}

@vertex
fn coat_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> CoatPoint {
    let bucket = vertex / COAT_VERTICES;
    let corner = vertex % COAT_VERTICES;
    var first = 0u;
    for (var i = 0u; i < bucket; i++) {
        first += totals[i];
    }
    let plant = placed[first + instance];
    let body = coat_bodies[plant.body];
    let steps = coat_look.steps[bucket / 4u][bucket % 4u];
    let step = corner / 2u;
    let along = f32(step) / f32(steps);
    let side = select(select(-1.0, 1.0, (corner & 1u) == 1u), 0.0, step == steps);

    // From its direction the plant bends further away from the normal, and a little down.
    let away = plant.direction - plant.normal * dot(plant.direction, plant.normal);
    let droop = (away - plant.normal * 0.25 - UP * 0.2) * (0.25 + 0.5 * byte_of(plant.shade, 2u));
    let centre = plant.root_from_eye
        + (plant.direction * along + droop * (along * along)) * plant.height_m;
    let direction = normalize(plant.direction + droop * (2.0 * along));
    let level = unit_or(cross(direction, plant.normal), across(direction));
    let roll = (byte_of(plant.shade, 3u) - 0.5) * 1.6;
    let strip = level * cos(roll) + cross(level, direction) * sin(roll);
    let facing = cross(direction, strip);

    // The whole plant is widened by one factor, from its mean width as seen.
    let sight = centre / max(length(centre), 1e-6);
    let seen = strip - sight * dot(strip, sight);
    let half_m = 0.5 * plant.width_m;
    let pixel_m = length(plant.root_from_eye) * frame.pixel_rad;
    let seen_half_px = 0.7 * half_m * max(length(seen), 0.1) / pixel_m;
    let widened = max(LEAST_HALF_PX / max(seen_half_px, 1e-4), 1.0);
    let spread = mix(strip, unit_or(seen, strip), saturate(widened - 1.0));
    let position = centre + spread * (side * half_m * widened * outline(body.form, along));
    let bent = normalize(facing + strip * (0.4 * side * saturate(0.5 * seen_half_px - 0.5)));
    let radiance = coat_radiance(body, plant, bent, along, position);
    // Coverage has few steps; a lot per plant makes up for what lies between.
    let lot = (byte_of(plant.shade, 0u) - 0.5) / f32(coat_look.samples);
    let clip = frame.clip_from_eye * vec4f(position, 1.0);
    return CoatPoint(clip, through_air(radiance, position), 1.33 / widened + lot, side);
}

@fragment
fn coat_fragment(in: CoatPoint) -> @location(0) vec4f {
    // Without multisampling coverage is drawn by lot, pixel by pixel.
    if coat_look.samples == 1u && in.opacity < lattice(vec2i(in.clip.xy)) {
        discard;
    }
    let width = fwidth(in.across);
    let rib = 1.0 - smoothstep(0.05, 0.2, abs(in.across));
    let tone = 0.97 + 0.2 * rib * (1.0 - smoothstep(0.15, 0.45, width));
    return vec4f(in.radiance * tone, saturate(in.opacity));
}
