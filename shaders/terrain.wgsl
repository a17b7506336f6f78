// The ground: the exact triangles of the height samples, and a land around them that runs to
// the horizon. Host: src/render/terrain.rs.
#import "shared/canopy_light.wgsl"
#import "shared/frame.wgsl"
#import "shared/kinds.wgsl"
#import "shared/light.wgsl"
#import "shared/noise.wgsl"
#import "shared/shadow.wgsl"
#import "shared/volume_light.wgsl"

struct Ground {
    columns: u32,
    rows: u32,
    spacing_m: f32,
    canopy_m: f32, // height of the grass; 0 where none grows
    size_m: vec2f,
    edge_y_m: f32, // mean height of the field's edge
    edge_steps: u32, // samples around the edge
    corner_from_eye: vec3f, // the field's corner, at height 0
    hill_m: f32, // height of the far land's hills
    soil_rgb: vec3f,
    cover: f32, // share of the ground that plants hide, 0 to 1
    mean_rgb: vec3f, // of the base colours, for the land far away
    pad: f32,
    map_m: vec2f, // extent of the base-colour map
    pad_b: vec2f,
    eye_sample_from_eye: vec3f, // a sample near the eye, at height 0
    pad_c: f32,
    eye_sample: vec2i, // its column and row
    pad_d: vec2i,
    // What the ground of each kind and bare ground looks like, four a row: LOOK_GRASS and so on.
    looks: array<vec4u, TASTE_ROWS>,
}

struct Chunk {
    first_from_eye: vec3f, // place of the chunk's first sample, at height 0
    first_column: u32,
    first_row: u32,
    pad_a: u32,
    pad_b: u32,
    pad_c: u32,
}

@group(3) @binding(0) var<uniform> ground: Ground;
@group(3) @binding(1) var<storage, read> chunks: array<Chunk>;
@group(3) @binding(2) var base_colour: texture_2d<f32>;
@group(3) @binding(3) var base_sampler: sampler;
// Drawn height of the field's edge, sample by sample around it; see `edge_sample`.
@group(3) @binding(4) var<storage, read> edge_heights_m: array<f32>;

struct GroundPoint {
    @builtin(position) clip: vec4f,
    @location(0) position_from_eye: vec3f,
    @location(1) normal: vec3f,
    @location(2) place_in_field: vec2f,
    @location(3) beyond_m: f32, // distance from the field's edge, 0 on the field
}

fn height_at(column: u32, row: u32) -> f32 {
    let i = min(column, ground.columns - 1u);
    let j = min(row, ground.rows - 1u);
    return heights_m[j * ground.columns + i];
}

// Smooth normal at a sample, from its neighbours.
fn normal_at(column: u32, row: u32) -> vec3f {
    let west = select(column - 1u, 0u, column == 0u);
    let north = select(row - 1u, 0u, row == 0u);
    let east = min(column + 1u, ground.columns - 1u);
    let south = min(row + 1u, ground.rows - 1u);
    let rise_x = (height_at(east, row) - height_at(west, row)) / f32(east - west);
    let rise_z = (height_at(column, south) - height_at(column, north)) / f32(south - north);
    return normalize(vec3f(-rise_x, ground.spacing_m, -rise_z));
}

// `vertex` counts the samples of a chunk, row by row; the index list cuts its squares by parity.
@vertex
fn field_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
) -> GroundPoint {
    let chunk = chunks[instance];
    // Squares beyond the field's edge shrink to nothing.
    let column = min(chunk.first_column + vertex % CHUNK_SAMPLES, ground.columns - 1u);
    let row = min(chunk.first_row + vertex / CHUNK_SAMPLES, ground.rows - 1u);
    let local = vec2f(f32(column - chunk.first_column), f32(row - chunk.first_row));
    let across = local * ground.spacing_m;
    let position = chunk.first_from_eye + vec3f(across.x, height_at(column, row), across.y);
    let place = vec2f(f32(column), f32(row)) * ground.spacing_m;
    let clip = frame.clip_from_eye * vec4f(position, 1.0);
    return GroundPoint(clip, position, normal_at(column, row), place, 0.0);
}

// `vertex` is a sample's rank, row by row: a corner of the bintree's mesh. Places are counted from
// a sample near the eye, so that near ones are exact on a field of any size.
@vertex
fn mesh_vertex(@builtin(vertex_index) vertex: u32) -> GroundPoint {
    let column = vertex % ground.columns;
    let row = vertex / ground.columns;
    let across = vec2f(vec2i(i32(column), i32(row)) - ground.eye_sample) * ground.spacing_m;
    let position = ground.eye_sample_from_eye + vec3f(across.x, height_at(column, row), across.y);
    let place = vec2f(f32(column), f32(row)) * ground.spacing_m;
    let clip = frame.clip_from_eye * vec4f(position, 1.0);
    return GroundPoint(clip, position, vec3f(0.0, 1.0, 0.0), place, 0.0);
}

// Height between samples, smoothed over the squares; `at` counts samples.
fn smooth_height(at: vec2f) -> f32 {
    let low = floor(at);
    let part = at - low;
    let first = vec2u(max(low, vec2f(0.0)));
    let last = vec2u(max(low + 1.0, vec2f(0.0)));
    let near = mix(height_at(first.x, first.y), height_at(last.x, first.y), part.x);
    let far = mix(height_at(first.x, last.y), height_at(last.x, last.y), part.x);
    return mix(near, far, part.y);
}

// Smooth normal at a place, from heights as far apart as the samples, or as a pixel is long.
// It is that of the full ground, however coarsely it is drawn.
fn smooth_normal(place: vec2f, pixel_m: f32) -> vec3f {
    let at = place / ground.spacing_m;
    let step = max(1.0, pixel_m / ground.spacing_m);
    let end = vec2f(f32(ground.columns - 1u), f32(ground.rows - 1u));
    let west = max(at.x - step, 0.0);
    let east = min(at.x + step, end.x);
    let north = max(at.y - step, 0.0);
    let south = min(at.y + step, end.y);
    let rise_x = (smooth_height(vec2f(east, at.y)) - smooth_height(vec2f(west, at.y)))
        / (east - west);
    let rise_z = (smooth_height(vec2f(at.x, south)) - smooth_height(vec2f(at.x, north)))
        / (south - north);
    return normalize(vec3f(-rise_x, ground.spacing_m, -rise_z));
}

// Sample `step` of the walk around the field's edge, from its corner along x first.
fn edge_sample(step: u32) -> vec2u {
    let east = ground.columns - 1u;
    let south = ground.rows - 1u;
    let s = step % ground.edge_steps;
    if s < east {
        return vec2u(s, 0u);
    } else if s < east + south {
        return vec2u(east, s - east);
    } else if s < 2u * east + south {
        return vec2u(2u * east + south - s, south);
    }
    return vec2u(0u, 2u * (east + south) - s);
}

fn far_hills(place: vec2f, out_m: f32) -> f32 {
    let rolling = cloudy_noise(place / 170.0 + 3.0) - 0.42;
    let ridges = cloudy_noise(place / 800.0 + 11.0) - 0.36;
    let grows = smoothstep(20.0, 500.0, out_m);
    return ground.hill_m * (rolling * grows + 7.0 * ridges * smoothstep(100.0, 2500.0, out_m));
}

fn land_height(edge_y: f32, place: vec2f, out_m: f32) -> f32 {
    // The land starts at the edge's own height and is lifted to the top of the grass, so that the
    // end of the field shows no step.
    let settled = mix(edge_y, ground.edge_y_m, smoothstep(0.0, 60.0, out_m));
    let canopy = 0.55 * ground.canopy_m * smoothstep(0.0, 2.0, out_m);
    return settled + canopy + far_hills(place, out_m);
}

@vertex
fn land_vertex(@builtin(vertex_index) vertex: u32) -> GroundPoint {
    let cell = vertex / 6u;
    let corner = vertex % 6u;
    // Two triangles of a cell, counter-clockwise from above.
    let along = select(0u, 1u, corner == 2u || corner == 3u || corner == 5u);
    let outward = select(0u, 1u, corner == 1u || corner == 4u || corner == 5u);
    let step = cell % ground.edge_steps + along;
    let ring = cell / ground.edge_steps + outward;
    let sample = edge_sample(step);
    let edge = vec2f(sample) * ground.spacing_m;
    let middle = 0.5 * ground.size_m;
    let direction = (edge - middle) / min(middle.x, middle.y);
    let out_m = LAND_RINGS_M[ring];
    let shift = direction * out_m;
    let place = edge + shift;
    let edge_y = edge_heights_m[step % ground.edge_steps];
    let y = land_height(edge_y, place, max(out_m, 0.0));
    let step_m = 2.0 + 0.1 * max(out_m, 0.0);
    let rise_x = far_hills(place + vec2f(step_m, 0.0), out_m) - far_hills(place, out_m);
    let rise_z = far_hills(place + vec2f(0.0, step_m), out_m) - far_hills(place, out_m);
    let hills = normalize(vec3f(-rise_x, step_m, -rise_z));
    let here = normal_at(sample.x, sample.y);
    let normal = normalize(mix(here, hills, smoothstep(0.0, 60.0, out_m)));
    // A finger's breadth lower where it slips under the field's edge.
    let sunk = select(0.0, 0.02, out_m <= 0.0);
    let position = ground.corner_from_eye + vec3f(place.x, y - sunk, place.y);
    let clip = frame.clip_from_eye * vec4f(position, 1.0);
    return GroundPoint(clip, position, normal, place, max(out_m, 0.0));
}

struct Surface {
    albedo: vec3f,
    canopy: vec3f, // colour of blades that are not drawn, where there are some
    relief_m: f32, // small height for bumps
    open: f32, // share of the light that comes past the plants
}

// Earth, moss and thatch between the blades, seen from near. Under grass it is mostly the green
// and straw of the lowest leaves; bare ground is mostly earth.
fn floor_of_grass(place: vec2f, base: vec3f, pixel_m: f32) -> Surface {
    let patches = cloudy_noise(place * 3.7);
    let lumps = mix(0.5, cloudy_noise(place * 14.0 + 5.0), detail_weight(0.07, pixel_m));
    let grains = mix(0.5, value_noise(place * 130.0), detail_weight(0.008, pixel_m));
    let turn = value_noise(place * 1.7 + 19.0) * 6.0;
    let fibre_place = vec2f(
        cos(turn) * place.x + sin(turn) * place.y,
        cos(turn) * place.y - sin(turn) * place.x,
    );
    let fibres = value_noise(fibre_place * vec2f(14.0, 190.0))
        * value_noise(fibre_place.yx * vec2f(17.0, 150.0) + 40.0);
    let thatch = smoothstep(0.22, 0.5, fibres) * detail_weight(0.02, pixel_m);

    let earth = ground.soil_rgb * (0.55 + 0.9 * lumps) * (0.85 + 0.3 * grains);
    let moss = mix(base, ground.soil_rgb, 0.25) * (0.25 + 0.9 * lumps) * (0.85 + 0.3 * grains);
    let leaves = mix(base * 1.1, vec3f(0.30, 0.24, 0.11), 0.55) * (0.6 + 0.6 * lumps);
    let green = smoothstep(0.25, 0.75, patches + 0.7 * (lumps - 0.5) + 0.35 * ground.cover);
    var albedo = mix(earth, moss, green);
    albedo = mix(albedo, leaves, thatch * mix(0.35, 0.6, ground.cover));
    return Surface(albedo, vec3f(0.0), 0.010 * lumps, 1.0 - 0.88 * ground.cover);
}

// The field where single blades are too small to draw: tops of clumps, with dark between them.
// `long_pixel_m` is the longer side of a pixel's footprint.
fn top_of_grass(place: vec2f, base: vec3f, pixel_m: f32, long_pixel_m: f32) -> Surface {
    let clumps = mix(0.5, value_noise(place * 3.1), detail_weight(0.3, pixel_m));
    let tufts = mix(0.5, value_noise(place * 13.0), detail_weight(0.08, pixel_m));
    let tips = mix(0.5, value_noise(place * vec2f(90.0, 70.0)), detail_weight(0.012, pixel_m));
    let swathes = mix(0.5, cloudy_noise(place * 0.21), detail_weight(4.0, long_pixel_m));
    let fields = mix(0.5, cloudy_noise(place * 0.009 + 8.0), detail_weight(90.0, long_pixel_m));
    let light = 0.45 + 0.25 * clumps + 0.45 * tufts + 0.35 * tips;
    let dry = vec3f(1.2, 1.04, 0.85);
    let lush = vec3f(0.88, 0.97, 0.95);
    let tint = mix(lush, dry, saturate(0.55 * swathes + 0.45 * fields));
    let rgb = base * tint * light;
    // As many dry blades as among the drawn ones.
    let straw = dot(rgb, vec3f(0.3, 0.6, 0.1)) * vec3f(1.55, 1.2, 0.5);
    return Surface(vec3f(0.0), mix(rgb, straw, 0.2), 0.05 * clumps + 0.02 * tufts, 1.0);
}

// Stones side by side. Their relief ends before four pixels that share a slope are as long as a stone.
fn gravel_floor(place: vec2f, base: vec3f, pixel_m: f32, long_pixel_m: f32) -> Surface {
    let stones = mix(0.5, value_noise(place * 45.0), detail_weight(0.022, pixel_m));
    let grains = mix(0.5, value_noise(place * 140.0 + 9.0), detail_weight(0.008, pixel_m));
    let lumps = mix(0.5, cloudy_noise(place * 5.0 + 2.0), detail_weight(0.2, pixel_m));
    let tone = 0.3 + 0.75 * stones + 0.35 * grains + 0.2 * lumps;
    let relief_m = 0.005 * stones * detail_weight(0.022, long_pixel_m);
    return Surface(base * tone, vec3f(0.0), relief_m, 0.72);
}

// Dead leaves over each other, with relief as that of stones.
fn litter_floor(place: vec2f, base: vec3f, pixel_m: f32, long_pixel_m: f32) -> Surface {
    let leaves = mix(0.5, value_noise(place * vec2f(19.0, 24.0)), detail_weight(0.05, pixel_m));
    let edges = mix(0.5, value_noise(place * 60.0 + 3.0), detail_weight(0.016, pixel_m));
    let pale = mix(0.5, cloudy_noise(place * 7.0 + 6.0), detail_weight(0.14, pixel_m));
    let rgb = base * mix(vec3f(0.85, 0.85, 0.85), vec3f(1.25, 1.1, 0.9), pale);
    let relief_m = 0.012 * leaves * detail_weight(0.05, long_pixel_m);
    let tone = 0.45 + 0.6 * leaves + 0.3 * edges;
    return Surface(rgb * tone, vec3f(0.0), relief_m, 0.72);
}

fn bare_floor(place: vec2f, base: vec3f, pixel_m: f32) -> Surface {
    let lumps = mix(0.5, cloudy_noise(place * 9.0), detail_weight(0.11, pixel_m));
    let grains = mix(0.5, value_noise(place * 130.0), detail_weight(0.008, pixel_m));
    let tone = 0.6 + 0.6 * lumps + 0.2 * grains;
    return Surface(base * tone, vec3f(0.0), 0.012 * lumps, 0.95);
}

// Distance from the field's edge within which kinds by colour end.
const LAND_BLENDS_M = 8.0;

// Shares of the looks at a place: eq. 17's weights, the scores of the kinds and bare grounds.
fn look_shares(uv: vec2f, beyond_m: f32) -> vec4f {
    var shares = vec4f(0.0);
    if field.taste_count == 0u || beyond_m > LAND_BLENDS_M {
        shares[LOOK_GRASS] = 1.0;
        return shares;
    }
    // The map is mirrored beyond its edges.
    let mirrored = 1.0 - abs(1.0 - (uv - 2.0 * floor(0.5 * uv)));
    let hsv = hsv_of(map_colour(vec2u(mirrored * vec2f(field.map_texels) * 65536.0)));
    var logs: array<f32, MAX_TASTES>;
    var best = -1e9;
    for (var i = 0u; i < field.taste_count; i++) {
        let own = score_log(field.tastes[i], hsv);
        logs[i] = -1e9;
        if own >= field.tastes[i].threshold_log {
            logs[i] = f32(own + field.tastes[i].share_log) / 4096.0;
        }
        best = max(best, logs[i]);
    }
    for (var i = 0u; i < field.taste_count; i++) {
        shares[ground.looks[i >> 2u][i & 3u]] += exp2(max(logs[i] - best, -60.0));
    }
    // The land around the field is grass.
    let land = smoothstep(0.0, LAND_BLENDS_M, beyond_m);
    shares *= (1.0 - land) / dot(shares, vec4f(1.0));
    shares[LOOK_GRASS] += land;
    return shares;
}

fn add_surface(sum: Surface, part: Surface, share: f32) -> Surface {
    return Surface(
        sum.albedo + part.albedo * (part.open * share),
        sum.canopy + part.canopy * share,
        sum.relief_m + part.relief_m * share,
        sum.open + part.open * share,
    );
}

// The ground as it looks from here; `grown` is how far it has taken over the grass's look. The
// albedo has the openness in it.
fn blended_surface(
    in: GroundPoint,
    base: vec3f,
    pixel_m: f32,
    long_pixel_m: f32,
    grown: f32,
) -> Surface {
    let place = in.place_in_field;
    let shares = look_shares(place / ground.map_m, in.beyond_m);
    var sum = Surface(vec3f(0.0), vec3f(0.0), 0.0, 0.0);
    if shares[LOOK_GRASS] > 0.004 {
        let near = floor_of_grass(place, base, pixel_m);
        let far = top_of_grass(place, base, pixel_m, long_pixel_m);
        let grass = Surface(
            near.albedo * (1.0 - grown),
            far.canopy * grown,
            mix(near.relief_m, far.relief_m, grown),
            near.open,
        );
        sum = add_surface(sum, grass, shares[LOOK_GRASS]);
    }
    if shares[LOOK_GRAVEL] > 0.004 {
        let gravel = gravel_floor(place, base, pixel_m, long_pixel_m);
        sum = add_surface(sum, gravel, shares[LOOK_GRAVEL]);
    }
    if shares[LOOK_LITTER] > 0.004 {
        let litter = litter_floor(place, base, pixel_m, long_pixel_m);
        sum = add_surface(sum, litter, shares[LOOK_LITTER]);
    }
    if shares[LOOK_BARE] > 0.004 {
        sum = add_surface(sum, bare_floor(place, base, pixel_m), shares[LOOK_BARE]);
    }
    return sum;
}

// Bends a normal by a small height that varies over the screen (Mikkelsen 2010).
fn bumped(normal: vec3f, position: vec3f, relief_m: f32) -> vec3f {
    let right = dpdx(position);
    let down = dpdy(position);
    let across = cross(down, normal);
    let along = cross(normal, right);
    let area = dot(right, across);
    let slope = sign(area) * (dpdx(relief_m) * across + dpdy(relief_m) * along);
    return normalize(abs(area) * normal - slope + normal * 1e-12);
}

@fragment
fn ground_fragment(in: GroundPoint) -> @location(0) vec4f {
    return lit_ground(in);
}

@fragment
fn mesh_fragment(in: GroundPoint) -> @location(0) vec4f {
    var point = in;
    point.normal = smooth_normal(in.place_in_field, length(in.position_from_eye) * frame.pixel_rad);
    return lit_ground(point);
}

fn lit_ground(in: GroundPoint) -> vec4f {
    let distance = length(in.position_from_eye);
    let to_eye = -in.position_from_eye / max(distance, 1e-6);
    let facing_eye = max(dot(to_eye, normalize(in.normal)), 0.004);
    let long_pixel_m = distance * frame.pixel_rad / facing_eye;
    // Between the two sides of the footprint, so that near detail does not blur at once.
    let pixel_m = distance * frame.pixel_rad / sqrt(facing_eye);
    let uv = in.place_in_field / ground.map_m;
    let map_rgb = textureSampleGrad(base_colour, base_sampler, uv, dpdx(uv), dpdy(uv)).rgb;
    // Mirror images of the field would show from a hill: the land turns to its mean colour.
    // Sharp figures, such as paths, would show sooner.
    let mirrored_m = max(50.0, 0.4 * min(ground.size_m.x, ground.size_m.y));
    let strays = select(vec2f(5.0, mirrored_m), vec2f(0.0, LAND_BLENDS_M), field.taste_count > 0u);
    let base = mix(map_rgb, ground.mean_rgb, smoothstep(strays.x, strays.y, in.beyond_m));

    // As fewer blades are drawn, the ground takes over their look.
    let full = frame.blade_full_m;
    let reach = frame.blade_reach_m;
    let away = length(in.position_from_eye - frame.judge_from_eye);
    var grown = 0.8 * smoothstep(full, 4.0 * full, away);
    grown = max(grown, smoothstep(0.5 * reach, 0.95 * reach, away));
    grown = max(grown, smoothstep(0.0, 1.5, in.beyond_m)) * select(0.0, 1.0, ground.canopy_m > 0.0);
    let surface = blended_surface(in, base, pixel_m, long_pixel_m, grown);

    let flat_normal = normalize(in.normal);
    let bumpy = bumped(flat_normal, in.position_from_eye, surface.relief_m);
    let normal = normalize(mix(flat_normal, bumpy, detail_weight(0.06, pixel_m)));
    let facing = max(dot(normal, frame.sun_direction), 0.0);
    let reaches = sun_reaches(in.position_from_eye, flat_normal);
    let sky = sky_light(sky_light_at(in.position_from_eye), normal);
    var light = surface.albedo * (frame.sun_rgb * (reaches * facing) + sky);
    if any(surface.canopy > vec3f(0.0)) {
        light += canopy_radiance(surface.canopy, normal, in.position_from_eye, reaches);
    }
    return vec4f(through_air(light, in.position_from_eye), 1.0);
}
