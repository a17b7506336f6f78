// The first of two stages of drawing plants (P15 section 3.5): which plants are seen, sorted by form
// and detail into the ranges that the second stage draws. Host: src/render/sort_plants.rs.
//
// A job is WORKGROUP clusters of the list that seed_triangles.wgsl lays out (P15 section 3.4): runs of
// plants of one triangle that lie together and are of one kind; of one plant where seeds lie alone. What
// grows, and whether it is in sight, is decided once for a cluster. Prefix sums over the jobs give every
// bucket's exact count and every cluster's plants their place, the same in every run.
#import "shared/ball_in_view.wgsl"
#import "shared/count.wgsl"
#import "shared/draw_args.wgsl"
#import "shared/field.wgsl"
#import "shared/plant.wgsl"
#import "shared/tile.wgsl"
#import "shared/drawn_tile.wgsl"
#import "shared/sorting.wgsl"

// A cluster of the list, and what is drawn of it.
struct ClusterRecord {
    tile: u32,
    // Of its first plant; that of the next is larger by the triangles of a tile.
    rank: u32,
    // How it thrives in 17 bits, then its kind in 3.
    what: u32,
    // Plants that are drawn.
    members: u32,
    // NO_BUCKET out of sight, BARE_BUCKET where nothing grows.
    bucket: u32,
    // Plants of the bucket in the job before these.
    before: u32,
    // Halves: share of their size at their distance, and one over their width's factor.
    sizes: u32,
    // The triangle's count, rounded, and the plants over which the last ones fade.
    end: f32,
    ramp: f32,
    // Of its first plant.
    index: u32,
    spare: vec2u,
}

@group(1) @binding(1) var<storage, read> drawn_tiles: array<DrawnTile>;
@group(1) @binding(2) var<storage, read> triangles: array<vec2u>;
// Exactly: clusters before those of each group of triangles. By bins: the triangles, bin by bin.
@group(1) @binding(3) var<storage, read> order: array<u32>;
@group(1) @binding(4) var<storage, read> list: array<u32>;
@group(1) @binding(5) var<storage, read_write> clusters: array<ClusterRecord>;
// Plants of each bucket and job, bucket by bucket; then the sums of those of earlier jobs.
@group(1) @binding(6) var<storage, read_write> job_counts: array<u32>;
// Plants of each bucket.
@group(1) @binding(7) var<storage, read> totals: array<u32>;
@group(1) @binding(8) var<storage, read_write> sorted: array<vec4u>;
@group(1) @binding(9) var<storage, read_write> draws: array<DrawArgs, BUCKETS>;

var<workgroup> buckets: array<u32, WORKGROUP>;
var<workgroup> members: array<u32, WORKGROUP>;

// A triangle of the tiles in view, and the number of its cluster.
struct Place {
    triangle: u32,
    cluster: u32,
}

fn exact_place(at: u32) -> Place {
    // The last group that begins at or before the cluster; then the last triangle in it.
    var low = 0u;
    var high = sorting.triangle_groups;
    while low + 1u < high {
        let middle = (low + high) / 2u;
        if order[middle] <= at {
            low = middle;
        } else {
            high = middle;
        }
    }
    let rest = at - order[low];
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
    let per_triangle = clusters_in_bin(bin);
    let rank = (at - before) / per_triangle;
    return Place(order[list[LIST_BIN_TRIANGLES + bin] + rank], (at - before) % per_triangle);
}

// Whether plants of this height within a distance of a root may be in the picture.
fn is_seen(root: vec3f, height_m: f32, spread_m: f32) -> bool {
    let middle = root + vec3f(0.0, 0.5 * height_m, 0.0);
    let radius = height_m + spread_m + sorting.tuft_m;
    return ball_in_view(sorting.clip_from_eye, sorting.clip_reach, middle, radius);
}

// How far a cluster's plants are from its middle at most: across its stratum, which may be steep.
fn spread_of(cluster: u32, slope: vec2f) -> f32 {
    if field.cluster == 1u {
        return 0.0;
    }
    let side_m = field.cell_m / f32(grid_of(cluster).x);
    return side_m * sqrt(2.0 * (1.0 + dot(slope, slope)));
}

// Plants of a cluster, by the triangle's own count and by how many are shown.
fn members_of(triangle: u32, own: u32, index: u32, places: u32) -> u32 {
    var on_triangle = field.sure_plants;
    if own + field.cluster > on_triangle {
        on_triangle = plants_on(triangle);
    }
    let whole = min(field.cluster, max(on_triangle, own) - own);
    return min(whole, max(places, index) - index);
}

// Share of its size at which a plant is drawn. 0 is not drawn.
fn grown_share(record: ClusterRecord, member: u32) -> f32 {
    let fade = unpack2x16unorm(record.sizes).x;
    let grown = shown_share(record.end, record.ramp, record.index + member) * fade;
    if sorting.count.is_plain == 1u {
        return select(0.0, 1.0, grown > 0.0);
    }
    return select(0.0, grown, grown >= LEAST_GROWN);
}

// What is drawn of a cluster, but for its place in the job. A companion has the rank of its plant in a
// later copy of them; only blades have companions.
fn cluster_at(place: Place) -> ClusterRecord {
    var record: ClusterRecord;
    record.bucket = NO_BUCKET;
    record.tile = place.triangle / triangles_per_tile();
    let drawn = drawn_tiles[record.tile];
    let copy = place.cluster / clusters_per_copy();
    let cluster = place.cluster % clusters_per_copy();
    let own = cluster * field.cluster;
    record.index = copy * plants_per_triangle() + own;
    let within = place.triangle % triangles_per_tile();
    record.rank = record.index * triangles_per_tile() + within;
    let seed = seed_at(drawn.tile, own * triangles_per_tile() + within);
    if !seed.exists {
        return record;
    }
    let triangle = ((seed.cell.y * field.cells.x + seed.cell.x) << 1u) | (within & 1u);
    let count = bitcast<f32>(triangles[place.triangle].x);
    let rounding = count_rounding(triangle);
    record.end = count + rounding;
    record.ramp = ramp_of(count);
    let choice = choice_of(drawn.tile, seed);
    if choice.kind >= field.species_count {
        record.bucket = BARE_BUCKET;
        return record;
    }
    let form = sorting.forms[choice.kind >> 2u][choice.kind & 3u];
    if form != FORM_BLADE && copy > 0u {
        return record;
    }
    let in_anchor = vec2f(seed.cell % vec2u(ANCHOR_CELLS));
    let xz = (in_anchor + vec2f(seed.middle) * (1.0 / f32(CELL_STEPS))) * field.cell_m;
    let ground = ground_plane_in_anchor(drawn.tile, xz.x, xz.y);
    let middle = drawn.anchor_from_eye + vec3f(xz.x, ground.height, xz.y);
    let heights_m = field.species[choice.kind].height_m;
    if !is_seen(middle, heights_m.x + heights_m.y, spread_of(cluster, ground.slope)) {
        return record;
    }
    // Plants at the end of sight are small; the width of those that are drawn makes up for most of
    // those left out.
    let away = distance(middle, sorting.count.judge_from_eye);
    let fade = 1.0 - smoothstep(0.75, 1.0, away / sorting.reach_m);
    let narrow = pow(saturate(count / sorting.count.most), WIDEN_POWER);
    record.sizes = pack2x16unorm(vec2f(fade, narrow));
    record.what = choice.thrives | (choice.kind << 17u);
    var members = members_of(triangle, own, record.index, places_of(count, rounding));
    while members > 0u && grown_share(record, members - 1u) == 0.0 {
        members--;
    }
    record.members = members;
    record.bucket = select(NO_BUCKET, form * DETAILS + drawn.detail, members > 0u);
    return record;
}

@compute @workgroup_size(WORKGROUP)
fn list_plants(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let job = group.y * list[LIST_GROUPS] + group.x;
    let jobs = list[LIST_JOBS];
    let at = job * WORKGROUP + local;
    var record: ClusterRecord;
    record.bucket = NO_BUCKET;
    if at < list[LIST_CLUSTERS] {
        if sorting.by_bins == 1u {
            record = cluster_at(place_in_bins(at));
        } else {
            record = cluster_at(exact_place(at));
        }
    }
    buckets[local] = record.bucket;
    members[local] = record.members;
    workgroupBarrier();
    if job >= jobs {
        return;
    }
    for (var i = 0u; i < local; i++) {
        record.before += select(0u, members[i], buckets[i] == record.bucket);
    }
    clusters[at] = record;
    if local < BUCKETS {
        var count = 0u;
        for (var i = 0u; i < WORKGROUP; i++) {
            count += select(0u, members[i], buckets[i] == local);
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
        let first_vertex = local * BUCKET_VERTICES;
        draws[local] = DrawArgs(vertices, totals[local], first_vertex, 0u, first_of_bucket(local));
    }
    let record = clusters[job * WORKGROUP + local];
    if record.bucket >= BUCKETS {
        return;
    }
    let before = job_counts[record.bucket * jobs + job] + record.before;
    let first = first_of_bucket(record.bucket) + before;
    let narrow = unpack2x16unorm(record.sizes).y;
    for (var member = 0u; member < record.members; member++) {
        let rank = record.rank + member * triangles_per_tile();
        let sizes = pack2x16unorm(vec2f(grown_share(record, member), narrow));
        sorted[first + member] = vec4u(record.tile, rank, record.what, sizes);
    }
}
