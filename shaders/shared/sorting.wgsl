// What a frame sorts. Host: src/render/sort_plants.rs.
#import "shared/count.wgsl"

struct SortUniform {
    clip_from_eye: mat4x4f,
    // How much farther than its middle a ball of radius 1 reaches in clip space, across and up.
    clip_reach: vec2f,
    // End of sight, in metres.
    reach_m: f32,
    // Largest distance of a companion's root from its plant's.
    tuft_m: f32,
    // Seeding triangles of the tiles in view, and groups of WORKGROUP of them.
    triangles: u32,
    triangle_groups: u32,
    triangle_groups_wide: u32,
    // 1 if triangles get the counts of their bins.
    by_bins: u32,
    count: CountUniform,
    // Counts of the bins, four a row.
    bins: array<vec4f, 8>,
    // Form of each kind, four a row.
    forms: array<vec4u, 2>,
    // Vertices of a plant of each bucket, four a row: one row per form, one column per detail.
    vertices: array<vec4u, FORM_COUNT>,
}

@group(1) @binding(0) var<uniform> sorting: SortUniform;

fn bin_centre(bin: u32) -> f32 {
    return sorting.bins[bin >> 2u][bin & 3u];
}

// Clusters of every triangle of a bin.
fn clusters_in_bin(bin: u32) -> u32 {
    return clusters_in(u32(ceil(bin_centre(bin))));
}

fn triangles_per_tile() -> u32 {
    return 2u * field.tile_cells * field.tile_cells;
}
