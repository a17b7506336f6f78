// What a meadow's plants are made of: constant for a scene. Twin: src/gpu/field_data.rs.

// A kind of plant. Pairs are the smallest value and the span above it.
struct SpeciesUniform {
    height_m: vec2f,
    width_m: vec2f,
    // Places in the blade table, 0…1.
    stiffness: vec2f,
    lean: vec2f,
    tint_rgb: vec3f,
    flexibility: f32,
    // A plant is of the first kind whose bound lies above its random word.
    share_below: u32,
    // Part of its height and stiffness that a plant lacks where the ground is another kind's.
    dwindle: f32,
    // 1 if bodies push it aside.
    responds: u32,
    spare_a: u32,
    // Azimuth of the light and how far from it plants lean, in turns; the latter below 0 where they
    // lean to all sides alike.
    towards: vec2f,
    spare_b: vec2u,
}

// A liking for a colour of the ground; units in src/field/kinds.rs.
struct TasteUniform {
    hsv: vec3u,
    exponent: u32,
    weights: vec3u,
    share_log: i32,
    threshold_log: i32,
    spare_a: u32,
    spare_b: vec2u,
}

struct FieldUniform {
    // Seeding cells and squares of height samples, along x and z.
    cells: vec2u,
    squares: vec2u,
    // Height samples along x.
    columns: u32,
    // Seeding cells along the side of a tile.
    tile_cells: u32,
    // Plants of every seeding triangle, and the chance of one more in 2⁻³².
    sure_plants: u32,
    one_more: u32,
    plants_per_tile: u32,
    // Key and rounds of the random numbers.
    key: u32,
    rounds: u32,
    species_count: u32,
    // Segments of a blade.
    segments: u32,
    stiffness_entries: u32,
    lean_entries: u32,
    // Side of a seeding cell.
    cell_m: f32,
    // Squares of height samples per metre.
    squares_per_m: f32,
    // One segment's share of a blade.
    segment_share: f32,
    // Length of the longest blade.
    reach_m: f32,
    // Fraction of the stiffness axis of the blade table at which its entries are densest, below 0
    // where both axes are even.
    stiffness_knee: f32,
    // Texels of the base map, texels along a seeding cell in units of 2⁻¹⁸, and how many kinds and
    // bare grounds are compared with it; 0 where kinds grow everywhere.
    map_texels: vec2u,
    map_step: u32,
    taste_count: u32,
    // Seeds of a cluster; 1 for seeds that lie alone.
    cluster: u32,
    spare_a: u32,
    spare_b: vec2u,
    // Share of the wind's push that each segment takes, four a row.
    wind_shares: array<vec4f, 4>,
    species: array<SpeciesUniform, MAX_SPECIES>,
    tastes: array<TasteUniform, MAX_TASTES>,
}

@group(0) @binding(0) var<uniform> field: FieldUniform;
// Height samples, row by row.
@group(0) @binding(1) var<storage, read> heights_m: array<f32>;
// [sin θ, cos θ] of segment j at (lean entry · stiffness entries + stiffness entry) · segments + j.
@group(0) @binding(2) var<storage, read> blade_directions: array<vec2f>;

const UP = vec3f(0.0, 1.0, 0.0);

// The unit vector along v, or `fallback` where v is too short to have a direction.
fn unit_or(v: vec3f, fallback: vec3f) -> vec3f {
    let squared = dot(v, v);
    if squared > 1e-24 {
        return v * (1.0 / sqrt(squared));
    }
    return fallback;
}


// Some unit vector at right angles to a unit vector.
fn across(n: vec3f) -> vec3f {
    let axis = select(vec3f(0.0, 0.0, 1.0), vec3f(1.0, 0.0, 0.0), abs(n.x) < 0.5);
    return unit_or(axis - n * dot(n, axis), UP);
}
