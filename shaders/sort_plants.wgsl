// The first of two stages of drawing plants (P15 section 3.5): which plants are seen, sorted by form
// and detail into the ranges that the second stage draws. Host: src/render/sort_plants.rs.
//
// A job is WORKGROUP places of the list that seed_triangles.wgsl lays out. Every place writes its
// candidate; prefix sums over the jobs give every bucket's exact count and every candidate its place,
// the same in every run.
#import "shared/count.wgsl"
#import "shared/field.wgsl"
#import "shared/plant.wgsl"
#import "shared/tile.wgsl"
#import "shared/drawn_tile.wgsl"
#import "shared/sorting.wgsl"

// Arguments of an indirect draw.
struct DrawArgs {
    vertices: u32,
    instances: u32,
    first_vertex: u32,
    first_instance: u32,
}

@group(1) @binding(1) var<storage, read> drawn_tiles: array<DrawnTile>;
@group(1) @binding(2) var<storage, read> triangles: array<vec2u>;
// Exactly: places before those of each group of triangles. By bins: the triangles, bin by bin.
@group(1) @binding(3) var<storage, read> places: array<u32>;
@group(1) @binding(4) var<storage, read> list: array<u32>;
// Tile; rank; how it thrives in 17 bits, then its kind in 3, its rank within the job in 6 and its
// bucket in 6, NO_BUCKET for what is not seen; and halves: share of its size and one over its width's
// factor.
@group(1) @binding(5) var<storage, read_write> candidates: array<vec4u>;
// Plants of each bucket and job, bucket by bucket; then the sums of those of earlier jobs.
@group(1) @binding(6) var<storage, read_write> job_counts: array<u32>;
// Plants of each bucket.
@group(1) @binding(7) var<storage, read> totals: array<u32>;
@group(1) @binding(8) var<storage, read_write> sorted: array<vec4u>;
@group(1) @binding(9) var<storage, read_write> draws: array<DrawArgs, BUCKETS>;

var<workgroup> buckets: array<u32, WORKGROUP>;

// A triangle of the tiles in view, and the plant of it that a place stands for.
struct Place {
    triangle: u32,
    index: u32,
}

fn exact_place(at: u32) -> Place {
    // The last group that begins at or before the place; then the last triangle in it.
    var low = 0u;
    var high = sorting.triangle_groups;
    while low + 1u < high {
        let middle = (low + high) / 2u;
        if places[middle] <= at {
            low = middle;
        } else {
            high = middle;
        }
    }
    let rest = at - places[low];
    var first = low * WORKGROUP;
    var end = first + WORKGROUP;
    while first + 1u < end {
        let middle = (first + end) / 2u;
        if triangles[middle].y <= rest {
            first = middle;
        } else {
            end = middle;
        }
    }
    return Place(first, rest - triangles[first].y);
}

fn place_in_bins(at: u32) -> Place {
    var bin = 0u;
    var before = 0u;
    while bin + 1u < BINS && list[LIST_BIN_ENDS + bin] <= at {
        before = list[LIST_BIN_ENDS + bin];
        bin++;
    }
    let per_triangle = places_in_bin(bin);
    let rank = (at - before) / per_triangle;
    return Place(places[list[LIST_BIN_TRIANGLES + bin] + rank], (at - before) % per_triangle);
}

fn is_seen(root: vec3f, height_m: f32) -> bool {
    let middle = root + vec3f(0.0, 0.5 * height_m, 0.0);
    let radius = height_m + sorting.tuft_m;
    let clip = sorting.clip_from_eye * vec4f(middle, 1.0);
    let reach = sorting.clip_reach * radius;
    return clip.w > -radius && abs(clip.x) <= clip.w + reach.x && abs(clip.y) <= clip.w + reach.y;
}

struct Candidate {
    entry: vec4u,
    bucket: u32,
}

// The candidate at a place: a plant, or a companion of one. Only blades have companions.
fn candidate_at(place: Place) -> Candidate {
    let none = Candidate(vec4u(0u), NO_BUCKET);
    let tile_index = place.triangle / triangles_per_tile();
    let drawn = drawn_tiles[tile_index];
    let rank = place.index * triangles_per_tile() + place.triangle % triangles_per_tile();
    let seed = seed_at(drawn.tile, rank % field.plants_per_tile);
    if !seed.exists {
        return none;
    }
    let triangle = ((seed.cell.y * field.cells.x + seed.cell.x) << 1u) | (rank & 1u);
    let count = bitcast<f32>(triangles[place.triangle].x);
    let shown = shown_share(count, count_rounding(triangle), place.index);
    if shown < LEAST_GROWN && sorting.count.is_plain == 0u {
        return none;
    }
    let choice = choice_of(drawn.tile, seed);
    if choice.kind >= field.species_count {
        return none;
    }
    let form = sorting.forms[choice.kind >> 2u][choice.kind & 3u];
    if form != FORM_BLADE && rank >= field.plants_per_tile {
        return none;
    }
    let plant = plant_of(drawn.tile, seed, choice);
    let root = drawn.anchor_from_eye + plant.root;
    // Plants at the end of sight are small.
    let away = distance(root, sorting.count.judge_from_eye);
    var grown = shown * (1.0 - smoothstep(0.75, 1.0, away / sorting.reach_m));
    if sorting.count.is_plain == 1u && grown > 0.0 {
        grown = 1.0;
    }
    if grown < LEAST_GROWN || !is_seen(root, plant.height_m) {
        return none;
    }
    // The drawn plants' width makes up for most of those left out.
    let narrow = pow(saturate(count / sorting.count.most), WIDEN_POWER);
    let what = choice.thrives | (choice.kind << 17u);
    let entry = vec4u(tile_index, rank, what, pack2x16unorm(vec2f(grown, narrow)));
    return Candidate(entry, form * DETAILS + drawn.detail);
}

@compute @workgroup_size(WORKGROUP)
fn list_plants(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let job = group.y * list[LIST_GROUPS] + group.x;
    let jobs = list[LIST_JOBS];
    let at = job * WORKGROUP + local;
    var candidate = Candidate(vec4u(0u), NO_BUCKET);
    if at < list[LIST_PLACES] {
        if sorting.by_bins == 1u {
            candidate = candidate_at(place_in_bins(at));
        } else {
            candidate = candidate_at(exact_place(at));
        }
    }
    buckets[local] = candidate.bucket;
    workgroupBarrier();
    if job >= jobs {
        return;
    }
    var rank = 0u;
    for (var i = 0u; i < local; i++) {
        rank += select(0u, 1u, buckets[i] == candidate.bucket);
    }
    candidate.entry.z |= (rank << 20u) | (candidate.bucket << 26u);
    candidates[at] = candidate.entry;
    if local < BUCKETS {
        var count = 0u;
        for (var i = 0u; i < WORKGROUP; i++) {
            count += select(0u, 1u, buckets[i] == local);
        }
        job_counts[local * jobs + job] = count;
    }
}

fn first_of_bucket(bucket: u32) -> u32 {
    var first = 0u;
    for (var i = 0u; i < bucket; i++) {
        first += totals[i];
    }
    return first;
}

@compute @workgroup_size(WORKGROUP)
fn sort_plants(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let job = group.y * list[LIST_GROUPS] + group.x;
    let jobs = list[LIST_JOBS];
    if job >= jobs {
        return;
    }
    if job == 0u && local < BUCKETS {
        let vertices = sorting.vertices[local / DETAILS][local % DETAILS];
        draws[local] = DrawArgs(vertices, totals[local], local * BUCKET_VERTICES, 0u);
    }
    let candidate = candidates[job * WORKGROUP + local];
    let bucket = candidate.z >> 26u;
    if bucket == NO_BUCKET {
        return;
    }
    let before = job_counts[bucket * jobs + job] + ((candidate.z >> 20u) & 63u);
    sorted[first_of_bucket(bucket) + before] = candidate;
}
