// How many plants of a seeding triangle are drawn: P15 eq. 1 and 2. Twin: src/field/count.rs.
#import "shared/field.wgsl"
#import "shared/ground.wgsl"
#import "shared/philox.wgsl"

struct CountUniform {
    right: vec3f,
    pixel_rad: f32,
    up: vec3f,
    per_px: f32,
    forward: vec3f,
    // COUNT_BY_DISTANCE, COUNT_BY_PROJECTED_AREA or COUNT_BY_WORLD_AREA.
    rule: u32,
    // Ceiling: the plants of a triangle and their companions.
    most: f32,
    // 1 if plants and segments come and go at once.
    is_plain: u32,
    spare_a: vec2f,
    // The place from which distances decide.
    judge_from_eye: vec3f,
    spare_b: f32,
}

// The corners of a seeding triangle, relative to the eye: the right angle, then the ends of its
// legs along x and z.
fn triangle_corners(
    tile: TileRecord,
    anchor_from_eye: vec3f,
    cell: vec2u,
    half: u32,
) -> array<vec3f, 3> {
    let even = ((cell.x + cell.y) & 1u) == 0u;
    let second = half == 1u;
    let at_end = vec2<bool>(even != second, second);
    let right_angle = select(vec2u(0u), vec2u(1u), at_end);
    var corners: array<vec3f, 3>;
    for (var i = 0u; i < 3u; i++) {
        var corner = right_angle;
        if i == 1u {
            corner.x = 1u - corner.x;
        } else if i == 2u {
            corner.y = 1u - corner.y;
        }
        let xz = vec2f(cell % vec2u(ANCHOR_CELLS) + corner) * field.cell_m;
        corners[i] = anchor_from_eye + vec3f(xz.x, ground_in_anchor(tile, xz.x, xz.y), xz.y);
    }
    return corners;
}

// Place on the picture in pixels, and depth.
fn on_picture(corner: vec3f, view: CountUniform) -> vec3f {
    let depth = dot(corner, view.forward);
    let px = 1.0 / (max(depth, 1e-6) * view.pixel_rad);
    return vec3f(dot(corner, view.right) * px, dot(corner, view.up) * px, depth);
}

fn count_by_projected_area(corners: array<vec3f, 3>, view: CountUniform) -> f32 {
    let a = on_picture(corners[0], view);
    let b = on_picture(corners[1], view) - a;
    let c = on_picture(corners[2], view) - a;
    let nearest = a.z + min(min(b.z, c.z), 0.0);
    if nearest < NEAR_M {
        return view.most;
    }
    return min(view.per_px * 0.5 * abs(b.x * c.y - b.y * c.x), view.most);
}

fn count_by_world_area(corners: array<vec3f, 3>, view: CountUniform) -> f32 {
    let across = cross(corners[1] - corners[0], corners[2] - corners[0]);
    let upwards = select(across, -across, across.y < 0.0);
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let away = max(dot(middle, middle), NEAR_M * NEAR_M);
    let facing = max(-dot(upwards, middle), 0.0) / sqrt(away);
    let area_px = 0.5 * facing / (away * view.pixel_rad * view.pixel_rad);
    return min(view.per_px * area_px, view.most);
}

// Places of a triangle of this count: the plants of smaller indices are shown, more or less.
fn places_of(count: f32, rounding: f32) -> u32 {
    return u32(max(ceil(count + rounding) - 1.0, 0.0));
}

// Clusters of one copy of a triangle's plants: the plants themselves, or one companion of each.
fn clusters_per_copy() -> u32 {
    return (plants_per_triangle() + field.cluster - 1u) / field.cluster;
}

fn plants_per_triangle() -> u32 {
    return field.plants_per_tile / (2u * field.tile_cells * field.tile_cells);
}

// Clusters, whole or begun, that hold this many of a triangle's places.
fn clusters_in(places: u32) -> u32 {
    let copies = places / plants_per_triangle();
    let rest = places % plants_per_triangle();
    return copies * clusters_per_copy() + (rest + field.cluster - 1u) / field.cluster;
}

// What is added to a count before its fraction is cut off.
fn count_rounding(triangle: u32) -> f32 {
    return unit(philox2x32(vec2u(triangle, COUNT_WORD), field.key, field.rounds).x);
}

// How much of plant `index` of a triangle is drawn, 0 to 1: `end` is its count, rounded.
fn shown_share(end: f32, ramp: f32, index: u32) -> f32 {
    return saturate((end - (f32(index) + 1.0)) / ramp);
}

// Plants over which the shares of a prefix's last ones fall to nothing.
fn ramp_of(count: f32) -> f32 {
    return max(0.2 * count, 1.0);
}
