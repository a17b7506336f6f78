// The first of two stages of drawing coats: how many plants of every triangle of the coated bodies are
// drawn, and where they stand. P15 sections 2.1 and 2.2. Twin: src/field/coat.rs; host:
// src/render/coat_place.rs.
//
// Prefix sums over the triangles (shaders/sum_rows.wgsl) run between the two kernels, so that a plant's
// place in the list is the same in every run. Plants lie by form and detail, a bucket each.
#import "shared/area_count.wgsl"
#import "shared/ball_in_view.wgsl"
#import "shared/clusters.wgsl"
#import "shared/coat.wgsl"
#import "shared/noise.wgsl"
#import "shared/philox.wgsl"
#import "shared/rigid.wgsl"
#import "shared/trig.wgsl"

struct CoatView {
    clip_from_eye: mat4x4f,
    // How much farther than its middle a ball of radius 1 reaches in clip space, across and up.
    clip_reach: vec2f,
    bodies: u32,
    // Triangles of all of them, in groups of WORKGROUP.
    triangles: u32,
    groups: u32,
    groups_wide: u32,
    // Factor of every triangle's ceiling, at most 1.
    density: f32,
    spare: u32,
    count: CountUniform,
    // Least heights on the picture of the details but the last, in pixels.
    detail_px: vec4f,
    // Vertices of a plant of each bucket.
    vertices: array<vec4u, 2>,
}

// A triangle of a coat, in its body's space.
struct CoatTriangle {
    a: vec3f,
    full: f32, // plants on it
    b: vec3f,
    spare_b: f32,
    c: vec3f,
    spare_c: f32,
    normal_a: vec3f,
    spare_d: f32,
    normal_b: vec3f,
    spare_e: f32,
    normal_c: vec3f,
    spare_f: f32,
}

@group(1) @binding(0) var<uniform> coat_view: CoatView;
@group(1) @binding(1) var<storage, read> coat_bodies: array<CoatBody>;
@group(1) @binding(2) var<storage, read> coat_triangles: array<CoatTriangle>;
// Of every triangle: its count as a float's bits; then its bucket, and above it the plants of the bucket
// before its own in its group.
@group(1) @binding(3) var<storage, read_write> counted: array<vec2u>;
// Plants of each bucket and group, bucket by bucket; then the sums of those of earlier groups.
@group(1) @binding(4) var<storage, read_write> rows: array<u32>;
// Plants of each bucket.
@group(1) @binding(5) var<storage, read> totals: array<u32>;
@group(1) @binding(6) var<storage, read_write> placed: array<PlacedPlant>;
// Arguments of an indirect draw per bucket.
@group(1) @binding(7) var<storage, read_write> draws: array<vec4u, COAT_BUCKETS>;

var<workgroup> buckets: array<u32, WORKGROUP>;
var<workgroup> numbers: array<u32, WORKGROUP>;

// The last body whose triangles begin at or before a number.
fn body_of(number: u32) -> u32 {
    var low = 0u;
    var high = coat_view.bodies;
    while low + 1u < high {
        let middle = (low + high) / 2u;
        if coat_bodies[middle].first_number <= number {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

fn rounding_of(key: u32, triangle: u32) -> f32 {
    return unit(philox2x32(vec2u(triangle, COUNT_WORD), key, field.rounds).x);
}

// Whether anything that stands on a triangle may be in the picture.
fn is_seen(corners: array<vec3f, 3>, middle: vec3f, reach_m: f32) -> bool {
    let far = max(
        distance(middle, corners[0]),
        max(distance(middle, corners[1]), distance(middle, corners[2])),
    );
    let radius = far + reach_m;
    return ball_in_view(coat_view.clip_from_eye, coat_view.clip_reach, middle, radius);
}

struct Counted {
    count: f32,
    places: u32,
    bucket: u32,
}

fn counted_at(number: u32) -> Counted {
    let none = Counted(0.0, 0u, NO_COAT_BUCKET);
    if number >= coat_view.triangles {
        return none;
    }
    let body = coat_bodies[body_of(number)];
    let own = number - body.first_number;
    let on = coat_triangles[body.first_triangle + own];
    let corners = array<vec3f, 3>(
        rotate(body.turn, on.a) + body.place_from_eye,
        rotate(body.turn, on.b) + body.place_from_eye,
        rotate(body.turn, on.c) + body.place_from_eye,
    );
    if dot(cross(corners[1] - corners[0], corners[2] - corners[0]), corners[0]) >= 0.0 {
        return none;
    }
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    if !is_seen(corners, middle, body.height_m.x + body.height_m.y) {
        return none;
    }
    var view = coat_view.count;
    view.most = on.full * coat_view.density;
    let count = count_by_projected_area(corners, view);
    let places = places_of(count, rounding_of(body.key, own));
    let pixel_m = max(length(middle), NEAR_M) * view.pixel_rad;
    let tall_px = (body.height_m.x + 0.5 * body.height_m.y) / pixel_m;
    var detail = 0u;
    while detail + 1u < COAT_DETAILS && tall_px < coat_view.detail_px[detail] {
        detail++;
    }
    return Counted(count, places, body.form * COAT_DETAILS + detail);
}

@compute @workgroup_size(WORKGROUP)
fn count_coats(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let at = group.y * coat_view.groups_wide + group.x;
    let number = at * WORKGROUP + local;
    let own = counted_at(number);
    buckets[local] = own.bucket;
    numbers[local] = own.places;
    workgroupBarrier();
    if at >= coat_view.groups {
        return;
    }
    var before = 0u;
    for (var i = 0u; i < local; i++) {
        before += select(0u, numbers[i], buckets[i] == own.bucket);
    }
    counted[number] = vec2u(bitcast<u32>(own.count), own.bucket | (before << 8u));
    if local < COAT_BUCKETS {
        var count = 0u;
        for (var i = 0u; i < WORKGROUP; i++) {
            count += select(0u, numbers[i], buckets[i] == local);
        }
        rows[local * coat_view.groups + at] = count;
    }
}

// Plant `index` of a triangle: P15 eq. 23 to 25 for its root, the small generator for the rest.
fn plant_of_coat(body: CoatBody, on: CoatTriangle, own: u32, index: u32) -> PlacedPlant {
    let words = philox2x32(vec2u(own, index), body.key, field.rounds);
    let place = folded(words);
    let r1 = unit(place.x);
    let r2 = unit(place.y);
    let root = on.a + (on.b - on.a) * r1 + (on.c - on.a) * r2;
    let smooth_normal = on.normal_a
        + (on.normal_b - on.normal_a) * r1
        + (on.normal_c - on.normal_a) * r2;
    let normal = unit_or(smooth_normal, on.normal_a);
    var random = pcg_from_words(words);
    let height_m = body.height_m.x + body.height_m.y * unit(pcg_next(&random));
    let width_m = body.width_m.x + body.width_m.y * unit(pcg_next(&random));
    let lean = body.lean_turns.x + body.lean_turns.y * unit(pcg_next(&random));
    let azimuth = unit(pcg_next(&random));
    let east = across(normal);
    let north = cross(normal, east);
    let aside = east * cos_turns(azimuth) + north * sin_turns(azimuth);
    let direction = normal * cos_turns(lean) + aside * sin_turns(lean);
    var plant: PlacedPlant;
    plant.root_from_eye = rotate(body.turn, root) + body.place_from_eye;
    plant.height_m = height_m;
    plant.direction = rotate(body.turn, direction);
    plant.width_m = width_m;
    plant.normal = rotate(body.turn, normal);
    plant.shade = pcg_next(&random);
    plant.triangle = own;
    plant.index = index;
    // Parts of a coat about as wide as a hand, on the body so that they move with it.
    plant.tone = cloudy_noise(root.xy * 5.0 + root.zx * vec2f(3.1, 4.3));
    return plant;
}

// The width of the plants that are drawn makes up for most of those left out. A triangle that is seen
// aslant lacks none for that: its plants hide each other.
fn widening(body: CoatBody, on: CoatTriangle, count: f32) -> f32 {
    let across = rotate(body.turn, cross(on.b - on.a, on.c - on.a));
    let sight = rotate(body.turn, (on.a + on.b + on.c) / 3.0) + body.place_from_eye;
    let facing = -dot(across, sight) / max(length(across) * length(sight), 1e-20);
    let share = saturate(count / max(on.full * facing, 1e-6));
    return 1.0 / max(pow(share, WIDEN_POWER), 1e-2);
}

@compute @workgroup_size(WORKGROUP)
fn place_coats(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let at = group.y * coat_view.groups_wide + group.x;
    let number = at * WORKGROUP + local;
    if at >= coat_view.groups || number >= coat_view.triangles {
        return;
    }
    let count = bitcast<f32>(counted[number].x);
    let word = counted[number].y;
    let bucket = word & 255u;
    if bucket == NO_COAT_BUCKET {
        return;
    }
    var first = rows[bucket * coat_view.groups + at] + (word >> 8u);
    for (var i = 0u; i < bucket; i++) {
        first += totals[i];
    }
    let body_index = body_of(number);
    let body = coat_bodies[body_index];
    let own = number - body.first_number;
    let on = coat_triangles[body.first_triangle + own];
    let end = count + rounding_of(body.key, own);
    let places = places_of(count, end - count);
    let widen = widening(body, on, count);
    // As `ramp_of`, but for triangles far smaller than the ground's: of few plants most would be small.
    let ramp = max(0.2 * count, 0.2);
    for (var index = 0u; index < places; index++) {
        var plant = plant_of_coat(body, on, own, index);
        let grown = max(shown_share(end, ramp, index), LEAST_GROWN);
        plant.height_m *= grown;
        plant.width_m *= grown * widen;
        plant.body = body_index;
        placed[first + index] = plant;
    }
}

@compute @workgroup_size(WORKGROUP)
fn size_coat_draws(@builtin(local_invocation_index) bucket: u32) {
    if bucket < COAT_BUCKETS {
        let vertices = coat_view.vertices[bucket / 4u][bucket % 4u];
        draws[bucket] = vec4u(vertices, totals[bucket], bucket * COAT_VERTICES, 0u);
    }
}
