// How many clusters every seeding triangle in view gets, and where in the list of all clusters they
// lie: P15 section 3.2. Hosts: src/render/seed_triangles.rs, src/render/sort_plants.rs.
//
// Exactly: every triangle has the clusters that its count fills, and prefix sums over the triangles tell
// where they begin. By bins: triangles of similar counts are put together and all get their bin's
// (eq. 15), so that a cluster's triangle follows from a division. Deviation: the batches of all bins are
// one dispatch, one after the other, where P15 submits each by itself.
#import "shared/count.wgsl"
#import "shared/drawn_tile.wgsl"
#import "shared/sorting.wgsl"

// Of every triangle: its count as a float's bits, then either the clusters before its own in its group
// of WORKGROUP triangles, or its bin and, above it, its rank in the bin within the group.
@group(1) @binding(1) var<storage, read> drawn_tiles: array<DrawnTile>;
@group(1) @binding(2) var<storage, read_write> triangles: array<vec2u>;
// Exactly: clusters of each group. By bins: triangles of each bin and group, bin by bin. Then sums of
// those of earlier groups.
@group(1) @binding(3) var<storage, read_write> rows: array<u32>;
@group(1) @binding(4) var<storage, read_write> totals: array<u32>;
// By bins: the triangles, bin by bin.
@group(1) @binding(5) var<storage, read_write> order: array<u32>;
@group(1) @binding(6) var<storage, read_write> list: array<u32>;

var<workgroup> numbers: array<u32, WORKGROUP>;

// The count of a triangle: its own, or its bin's.
struct Counted {
    count: f32,
    clusters: u32,
    bin: u32,
}

fn nearest_bin(count: f32) -> u32 {
    var bin = 0u;
    while bin + 1u < BINS && count > 0.5 * (bin_centre(bin) + bin_centre(bin + 1u)) {
        bin++;
    }
    return bin;
}

// How many of a triangle's plants and companions are drawn.
fn count_on(drawn: DrawnTile, cell: vec2u, half: u32) -> f32 {
    let view = sorting.count;
    if view.rule == COUNT_BY_DISTANCE {
        return drawn.bound;
    }
    let corners = triangle_corners(drawn.tile, drawn.anchor_from_eye, cell, half);
    if view.rule == COUNT_BY_PROJECTED_AREA {
        return min(count_by_projected_area(corners, view), drawn.bound);
    }
    return min(count_by_world_area(corners, view), drawn.bound);
}

fn counted(number: u32) -> Counted {
    let none = Counted(0.0, 0u, NO_BIN);
    if number >= sorting.triangles {
        return none;
    }
    let drawn = drawn_tiles[number / triangles_per_tile()];
    let within = number % triangles_per_tile();
    let half = within & 1u;
    let across = within >> 1u;
    let cell = drawn.tile.first_cell + vec2u(across % field.tile_cells, across / field.tile_cells);
    if cell.x >= field.cells.x || cell.y >= field.cells.y {
        return none;
    }
    let triangle = ((cell.y * field.cells.x + cell.x) << 1u) | half;
    var count = count_on(drawn, cell, half);
    var bin = NO_BIN;
    let rounding = count_rounding(triangle);
    if sorting.by_bins == 1u && places_of(count, rounding) > 0u {
        bin = nearest_bin(count);
        count = select(bin_centre(bin), count, count < 1.0);
    }
    return Counted(count, clusters_in(places_of(count, rounding)), bin);
}

@compute @workgroup_size(WORKGROUP)
fn count_triangles(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let at = group.y * sorting.triangle_groups_wide + group.x;
    let number = at * WORKGROUP + local;
    let own = counted(number);
    numbers[local] = select(own.clusters, own.bin, sorting.by_bins == 1u);
    workgroupBarrier();
    if at >= sorting.triangle_groups {
        return;
    }
    var before = 0u;
    if sorting.by_bins == 1u {
        for (var i = 0u; i < local; i++) {
            before += select(0u, 1u, numbers[i] == own.bin);
        }
        triangles[number] = vec2u(bitcast<u32>(own.count), own.bin | (before << 8u));
        if local < BINS {
            var count = 0u;
            for (var i = 0u; i < WORKGROUP; i++) {
                count += select(0u, 1u, numbers[i] == local);
            }
            rows[local * sorting.triangle_groups + at] = count;
        }
        return;
    }
    for (var i = 0u; i < local; i++) {
        before += numbers[i];
    }
    triangles[number] = vec2u(bitcast<u32>(own.count), before);
    if local == WORKGROUP - 1u {
        rows[at] = before + own.clusters;
    }
}

// By bins only.
@compute @workgroup_size(WORKGROUP)
fn order_triangles(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let at = group.y * sorting.triangle_groups_wide + group.x;
    if at >= sorting.triangle_groups {
        return;
    }
    let number = at * WORKGROUP + local;
    let word = triangles[number].y;
    let bin = word & 255u;
    if bin == NO_BIN {
        return;
    }
    var first = 0u;
    for (var i = 0u; i < bin; i++) {
        first += totals[i];
    }
    order[first + rows[bin * sorting.triangle_groups + at] + (word >> 8u)] = number;
}

// How long the list of clusters is, and the groups that the later kernels take.
@compute @workgroup_size(1)
fn size_list() {
    var clusters = totals[0];
    if sorting.by_bins == 1u {
        clusters = 0u;
        var first = 0u;
        for (var bin = 0u; bin < BINS; bin++) {
            list[LIST_BIN_TRIANGLES + bin] = first;
            first += totals[bin];
            clusters += totals[bin] * clusters_in_bin(bin);
            list[LIST_BIN_ENDS + bin] = clusters;
        }
    }
    // One job at least writes that there is nothing to draw.
    let jobs = max((clusters + WORKGROUP - 1u) / WORKGROUP, 1u);
    let wide = min(jobs, MOST_GROUPS);
    list[LIST_JOBS] = jobs;
    list[LIST_GROUPS] = wide;
    list[LIST_GROUPS + 1u] = (jobs + wide - 1u) / wide;
    list[LIST_GROUPS + 2u] = 1u;
    list[LIST_CLUSTERS] = clusters;
}
