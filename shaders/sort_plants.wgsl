// The first of two stages of drawing plants (P15 section 3.5): which plants are seen, sorted by form
// and detail into the ranges that the second stage draws. Host: src/render/sort_plants.rs.
//
// A job is WORKGROUP places of a tile's order. Every place writes its candidate; prefix sums over
// the jobs give every bucket's exact count and every candidate its place, the same in every run.
#import "shared/count.wgsl"
#import "shared/field.wgsl"
#import "shared/plant.wgsl"
#import "shared/tile.wgsl"
#import "shared/drawn_tile.wgsl"

struct SortUniform {
    clip_from_eye: mat4x4f,
    // How much farther than its middle a ball of radius 1 reaches in clip space, across and up.
    clip_reach: vec2f,
    // End of sight, in metres.
    reach_m: f32,
    // Largest distance of a companion's root from its plant's.
    tuft_m: f32,
    jobs: u32,
    groups_wide: u32,
    spare: vec2u,
    count: CountUniform,
    // Form of each kind, four a row.
    forms: array<vec4u, 2>,
    // Vertices of a plant of each bucket, four a row: one row per form, one column per detail.
    vertices: array<vec4u, FORM_COUNT>,
}

// WORKGROUP places of a tile's order.
struct Job {
    tile: u32,
    first_rank: u32,
}

// Arguments of an indirect draw.
struct DrawArgs {
    vertices: u32,
    instances: u32,
    first_vertex: u32,
    first_instance: u32,
}

@group(1) @binding(0) var<uniform> sorting: SortUniform;
@group(1) @binding(1) var<storage, read> drawn_tiles: array<DrawnTile>;
@group(1) @binding(2) var<storage, read> jobs: array<Job>;
// Tile, rank, kind and how it thrives, and halves: share of its size and one over its width's factor.
@group(1) @binding(3) var<storage, read_write> candidates: array<vec4u>;
// The candidates' buckets, NO_BUCKET for what is not seen, and above them ranks within the job.
@group(1) @binding(8) var<storage, read_write> slots: array<u32>;
// Plants of each bucket and job, bucket by bucket; then the sums of those of earlier jobs.
@group(1) @binding(4) var<storage, read_write> job_counts: array<u32>;
// Plants of each bucket.
@group(1) @binding(5) var<storage, read_write> totals: array<u32, BUCKETS>;
@group(1) @binding(6) var<storage, read_write> sorted: array<vec4u>;
@group(1) @binding(7) var<storage, read_write> draws: array<DrawArgs, BUCKETS>;

var<workgroup> buckets: array<u32, WORKGROUP>;
var<workgroup> sums: array<u32, WORKGROUP>;

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

// How many of a triangle's plants and companions are drawn.
fn count_on(drawn: DrawnTile, cell: vec2u, half: u32) -> f32 {
    let view = sorting.count;
    if view.rule == COUNT_BY_DISTANCE {
        return drawn.share * view.most;
    }
    let corners = triangle_corners(drawn.tile, drawn.anchor_from_eye, cell, half);
    if view.rule == COUNT_BY_PROJECTED_AREA {
        return min(drawn.boost * count_by_projected_area(corners, view), view.most);
    }
    return min(drawn.boost * count_by_world_area(corners, view), view.most);
}

// The candidate at a rank of a tile: a plant, or a companion of one. Only blades have companions.
fn candidate_at(tile_index: u32, rank: u32) -> Candidate {
    let drawn = drawn_tiles[tile_index];
    let none = Candidate(vec4u(0u), NO_BUCKET);
    if rank >= drawn.ranks {
        return none;
    }
    let seed = seed_at(drawn.tile, rank % field.plants_per_tile);
    if !seed.exists {
        return none;
    }
    let half = rank & 1u;
    let triangle = ((seed.cell.y * field.cells.x + seed.cell.x) << 1u) | half;
    let index = rank / (2u * field.tile_cells * field.tile_cells);
    let count = count_on(drawn, seed.cell, half);
    let shown = shown_share(count, count_rounding(triangle), index);
    if shown < LEAST_GROWN {
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
    let grown = shown * (1.0 - smoothstep(0.75, 1.0, length(root) / sorting.reach_m));
    if grown < LEAST_GROWN || !is_seen(root, plant.height_m) {
        return none;
    }
    // The drawn plants' width makes up for most of those left out.
    let narrow = pow(saturate(count / sorting.count.most), WIDEN_POWER);
    let what = (choice.kind << 20u) | choice.thrives;
    let entry = vec4u(tile_index, rank, what, pack2x16unorm(vec2f(grown, narrow)));
    return Candidate(entry, form * DETAILS + drawn.detail);
}

@compute @workgroup_size(WORKGROUP)
fn list_plants(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let job = group.y * sorting.groups_wide + group.x;
    var candidate = Candidate(vec4u(0u), NO_BUCKET);
    if job < sorting.jobs {
        candidate = candidate_at(jobs[job].tile, jobs[job].first_rank + local);
    }
    buckets[local] = candidate.bucket;
    workgroupBarrier();
    if job >= sorting.jobs {
        return;
    }
    var rank = 0u;
    for (var i = 0u; i < local; i++) {
        rank += select(0u, 1u, buckets[i] == candidate.bucket);
    }
    candidates[job * WORKGROUP + local] = candidate.entry;
    slots[job * WORKGROUP + local] = candidate.bucket | (rank << 8u);
    if local < BUCKETS {
        var count = 0u;
        for (var i = 0u; i < WORKGROUP; i++) {
            count += select(0u, 1u, buckets[i] == local);
        }
        job_counts[local * sorting.jobs + job] = count;
    }
}

// One workgroup per bucket: every job's count becomes the sum of those before it.
@compute @workgroup_size(WORKGROUP)
fn sum_jobs(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let row = group.x * sorting.jobs;
    let share = (sorting.jobs + WORKGROUP - 1u) / WORKGROUP;
    let first = min(local * share, sorting.jobs);
    let end = min(first + share, sorting.jobs);
    var sum = 0u;
    for (var job = first; job < end; job++) {
        sum += job_counts[row + job];
    }
    sums[local] = sum;
    workgroupBarrier();
    var before = 0u;
    for (var i = 0u; i < local; i++) {
        before += sums[i];
    }
    for (var job = first; job < end; job++) {
        let count = job_counts[row + job];
        job_counts[row + job] = before;
        before += count;
    }
    if local == WORKGROUP - 1u {
        totals[group.x] = before;
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
    let job = group.y * sorting.groups_wide + group.x;
    if job >= sorting.jobs {
        return;
    }
    if job == 0u && local < BUCKETS {
        let vertices = sorting.vertices[local / DETAILS][local % DETAILS];
        draws[local] = DrawArgs(vertices, totals[local], local * BUCKET_VERTICES, 0u);
    }
    let slot = slots[job * WORKGROUP + local];
    let bucket = slot & 255u;
    if bucket == NO_BUCKET {
        return;
    }
    let before = job_counts[bucket * sorting.jobs + job] + (slot >> 8u);
    sorted[first_of_bucket(bucket) + before] = candidates[job * WORKGROUP + local];
}
