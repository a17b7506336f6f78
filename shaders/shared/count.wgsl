// The ground's seeding triangles, and how many plants of one are drawn. Twin: src/field/count.rs.
#import "shared/area_count.wgsl"
#import "shared/field.wgsl"
#import "shared/ground.wgsl"
#import "shared/philox.wgsl"

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
